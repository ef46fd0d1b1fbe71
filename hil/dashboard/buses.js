// The CAN buses: load, nodes with their state and error counters as the emulated controllers have them,
// and how often each identifier comes. Identifiers are counted while the list is open.

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
    this.rows = new Map();
    this.heard = new Map(); // bus and identifier -> {bus, id, size, from, text, times}
    this.since_s = new Map(); // bus -> when its first message was heard
    this.ends = new Map(); // bus -> what ends listening
    this.names = [];
    run.listen("/status", (status) => this.show(status));
    parts.details.addEventListener("toggle", () => this.watch());
  }

  show({ time_ns, buses }) {
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
    const now_s = time_ns * 1e-9;
    for (const [key, one] of this.heard) {
      one.times = one.times.filter((time_s) => time_s > now_s - SPAN_S);
      const span_s = Math.min(SPAN_S, now_s - this.since_s.get(one.bus));
      this.fill(this.parts.identifiers, key, IDENTIFIER, { ...one, rate: span_s > 0 ? one.times.length / span_s : 0 });
    }
  }

  watch() {
    for (const bus of this.names) {
      if (this.parts.details.open && !this.ends.has(bus)) {
        this.since_s.delete(bus);
        this.ends.set(bus, this.run.listen(`/wire/${bus}`, (message) => this.hear(bus, message)));
      } else if (!this.parts.details.open) {
        this.ends.get(bus)?.();
        this.ends.delete(bus);
        this.heard.clear();
      }
    }
  }

  hear(bus, { time_ns, id, size, from, text }) {
    const time_s = time_ns * 1e-9;
    if (!this.since_s.has(bus)) this.since_s.set(bus, time_s);
    const key = `${bus} ${id}`;
    if (!this.heard.has(key)) this.heard.set(key, { bus, id, times: [] });
    const one = this.heard.get(key);
    Object.assign(one, { size, from, text });
    one.times.push(time_s);
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
