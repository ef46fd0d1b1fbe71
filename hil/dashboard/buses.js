// The CAN buses: load, nodes with their state and error counters as the emulated controllers have them,
// and how often each identifier comes, which is asked for while the list is open.

const SPAN_S = 5; // over which identifiers are counted

const whole = (number) => Math.round(number).toLocaleString("en");

// By column, as the tables' heads have them.
const NODE = [
  ["", ({ bus }) => bus],
  ["", ({ name }) => name || "client"],
  ["state", ({ state }) => state],
  ["number", ({ transmit_errors }) => whole(transmit_errors)],
  ["number", ({ receive_errors }) => whole(receive_errors)],
  ["number", ({ sent }) => whole(sent)],
  ["number", ({ received }) => whole(received)],
  ["number", ({ retransmissions }) => whole(retransmissions)],
  ["number", ({ overflowed }) => whole(overflowed)],
  ["number", ({ bus_offs }) => whole(bus_offs)],
];
const IDENTIFIER = [
  ["", ({ bus }) => bus],
  ["", ({ id }) => id],
  ["number rate", ({ rate }) => rate.toFixed(1)],
  ["number", ({ size }) => String(size)],
  ["", ({ from }) => from],
  ["", ({ text }) => text],
];

export class Buses {
  // `parts`: {details, loads, nodes, identifiers}
  constructor(run, parts) {
    this.run = run;
    this.parts = parts;
    this.rows = new Map(); // of both tables
    this.told = new Map(); // bus -> [[simulated s, identifier -> count], ...] of the last SPAN_S
    this.ends = new Map(); // bus -> what ends listening
    this.names = [];
    run.listen("/status", ({ buses }) => this.show(buses));
    parts.details.addEventListener("toggle", () => this.watch());
  }

  show(buses) {
    this.names = Object.keys(buses);
    this.parts.details.hidden = this.names.length === 0;
    this.watch();
    if (!this.parts.details.open) return;
    this.parts.loads.textContent = Object.entries(buses)
      .map(([name, { load, frames, error_frames }]) =>
        `${name}: load ${(100 * load).toFixed(1)} %, ${whole(frames)} frames, ${whole(error_frames)} error frames`)
      .join("; ");
    for (const [bus, { nodes }] of Object.entries(buses)) {
      nodes.forEach((node, at) => {
        const row = this.fill(this.parts.nodes, `${bus} node ${at}`, NODE, { ...node, bus });
        row.querySelector(".state").classList.toggle("bad", node.state !== "active");
      });
    }
  }

  watch() {
    for (const bus of this.names) {
      if (this.parts.details.open && !this.ends.has(bus)) {
        this.told.set(bus, []);
        this.ends.set(bus, this.run.listen(`/identifiers/${bus}`, ({ identifiers }, time) => this.count(bus, identifiers, time)));
      } else if (!this.parts.details.open) {
        this.ends.get(bus)?.();
        this.ends.delete(bus);
      }
    }
  }

  count(bus, identifiers, time) {
    const now_s = Number(time) * 1e-9;
    const told = this.told.get(bus);
    if (time > 0n) told.push([now_s, new Map(identifiers.map(({ id, count }) => [id, count]))]);
    while (told.length > 2 && told[0][0] < now_s - SPAN_S) told.shift();
    const [before_s, before] = told[0] ?? [now_s, new Map()];
    for (const one of identifiers) {
      const rate = now_s > before_s ? (one.count - (before.get(one.id) ?? 0)) / (now_s - before_s) : 0;
      this.fill(this.parts.identifiers, `${bus} ${one.id}`, IDENTIFIER, { ...one, bus, rate });
    }
  }

  fill(table, key, columns, what) {
    let row = this.rows.get(key);
    if (!row) {
      row = table.insertRow();
      for (const [className] of columns) row.insertCell().className = className;
      this.rows.set(key, row);
    }
    columns.forEach(([, show], index) => {
      row.cells[index].textContent = show(what);
    });
    return row;
  }
}
