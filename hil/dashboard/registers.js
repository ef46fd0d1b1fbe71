// The registers of Modbus lines by name: value as a client read it last, and who wrote it last. They
// are asked for while the list is open.

const seconds = (ns) => (ns === undefined ? "–" : `${(ns * 1e-9).toFixed(2)} s`);

// By column, as the table's head has them.
const COLUMNS = [
  ["", ({ device }) => device],
  ["", ({ name }) => name],
  ["", ({ table, address }) => `${table} ${address}`],
  ["number value", ({ value, unit }) => (value === undefined ? "–" : `${Number(value.toPrecision(6))} ${unit}`)],
  ["number", ({ seen_ns }) => seconds(seen_ns)],
  ["by", ({ by }) => by ?? "–"],
  ["number", ({ written_ns }) => seconds(written_ns)],
];

export class Registers {
  constructor(run, details, rows) {
    this.run = run;
    this.details = details;
    this.rows = rows;
    this.known = new Map(); // topic and register -> row
    this.ends = new Map(); // topic -> what ends listening
    run.addEventListener("topics", () => this.watch());
    details.addEventListener("toggle", () => this.watch());
  }

  watch() {
    const topics = [...this.run.topics.keys()].filter((topic) => topic.startsWith("/registers/"));
    this.details.hidden = topics.length === 0;
    for (const topic of topics) {
      if (this.details.open && !this.ends.has(topic)) {
        this.ends.set(topic, this.run.listen(topic, ({ registers }) => this.show(topic, registers)));
      } else if (!this.details.open) {
        this.ends.get(topic)?.();
        this.ends.delete(topic);
      }
    }
  }

  show(topic, registers) {
    for (const register of registers) {
      const key = `${topic} ${register.device} ${register.table} ${register.address} ${register.name}`;
      const row = this.known.get(key) ?? this.newRow(key, register);
      COLUMNS.forEach(([, show], index) => {
        row.cells[index].textContent = show(register);
      });
    }
  }

  newRow(key, { name, text }) {
    const row = this.rows.insertRow();
    row.dataset.register = name;
    row.title = text;
    for (const [className] of COLUMNS) row.insertCell().className = className;
    this.known.set(key, row);
    return row;
  }
}
