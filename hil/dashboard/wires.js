// The table of wires: each device against what it should do, and the messages of one wire live.

const MOST_MESSAGES = 60;

// By column: class, and what it shows of a device that sent so many messages a second.
const COLUMNS = [
  ["number rate", (device, rate) => (rate === null ? "–" : rate.toFixed(1))],
  ["number", ({ nominal_rate_hz }) => (nominal_rate_hz > 0 ? nominal_rate_hz.toFixed(1) : "–")],
  ["number frames", ({ frames }) => whole(frames)],
  ["number bytes", ({ bytes }) => whole(bytes)],
  ["number", ({ lateness_p99_us }) => whole(lateness_p99_us)],
  ["number", ({ lateness_max_us }) => whole(lateness_max_us)],
  ["number drops", ({ dropped }) => whole(dropped)],
  ["", ({ client_present, readers }) => (client_present ? (readers > 1 ? String(readers) : "yes") : "–")],
  ["", ({ wire }) => wire],
  ["", ({ last_request: asked }) => (asked ? `${(asked.time_ns * 1e-9).toFixed(1)} s ${asked.text}` : "–")],
];

const whole = (number) => Math.round(number).toLocaleString("en");

export class Wires {
  // `plot(source, numbers, time_s)` is given what the messages of a wire say.
  constructor(run, rows, choice, list, plot) {
    this.run = run;
    this.plot = plot;
    this.rows = rows;
    this.choice = choice;
    this.list = list;
    this.before = null; // the status before, for rates
    run.listen("/status", (status) => this.show(status));
    run.addEventListener("topics", () => this.offer());
    choice.addEventListener("change", () => this.watch());
  }

  show(status) {
    const elapsed_s = this.before ? (status.time_ns - this.before.time_ns) * 1e-9 : 0;
    for (const [name, device] of Object.entries(status.devices)) {
      const row = [...this.rows.rows].find(({ dataset }) => dataset.device === name) ?? this.newRow(name);
      row.wire = device.wire;
      const sent = device.frames - (this.before?.devices[name]?.frames ?? device.frames);
      const rate = elapsed_s > 0 ? sent / elapsed_s : null;
      COLUMNS.forEach(([, show], index) => {
        row.cells[index + 1].textContent = show(device, rate);
      });
      row.querySelector(".drops").classList.toggle("bad", device.dropped > 0);
    }
    this.before = status;
  }

  newRow(name) {
    const row = this.rows.insertRow();
    row.dataset.device = name;
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.addEventListener("click", () => this.choose(name, row.wire));
    row.insertCell().append(button);
    for (const [className] of COLUMNS) row.insertCell().className = className;
    return row;
  }

  offer() {
    const names = [...this.run.topics.keys()].filter((topic) => topic.startsWith("/wire/"));
    const chosen = this.choice.value;
    this.choice.replaceChildren(new Option("–", ""), ...names.map((topic) => new Option(topic.slice(6), topic)));
    this.choice.value = names.includes(chosen) ? chosen : "";
  }

  // A device on a shared wire is on the one that its address names.
  choose(device, wire) {
    const topics = [...this.choice.options].map((option) => option.value);
    const own = `/wire/${device}`;
    const shared = topics.find((topic) => topic && wire.includes(topic.slice(6)));
    this.choice.value = topics.includes(own) ? own : (shared ?? "");
    this.watch();
  }

  watch() {
    this.end?.();
    this.list.replaceChildren();
    this.end = this.choice.value
      ? this.run.listen(this.choice.value, (message) => this.add(message))
      : null;
  }

  add({ time_ns, from, size, bytes, text, signals }) {
    if (signals) this.plot(this.choice.value.slice(1).replace("/", "."), signals, time_ns * 1e-9);
    const item = document.createElement("li");
    item.className = from;
    item.textContent = `${(time_ns * 1e-9).toFixed(6)} ${from === "client" ? "<" : ">"} ${text} [${size}] ${bytes ?? ""}`;
    this.list.prepend(item);
    while (this.list.childElementCount > MOST_MESSAGES) this.list.lastElementChild.remove();
  }
}
