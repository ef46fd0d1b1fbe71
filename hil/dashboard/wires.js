// The table of wires: each device against what it should do, and the messages of one wire live.

const MOST_MESSAGES = 60;

function cell(row, text, className = "") {
  const cell = row.insertCell();
  cell.textContent = text;
  cell.className = className;
  return cell;
}

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
    this.rows.replaceChildren();
    for (const [name, device] of Object.entries(status.devices)) {
      const row = this.rows.insertRow();
      row.dataset.device = name;
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.addEventListener("click", () => this.choose(name, device.wire));
      row.insertCell().append(button);
      const sent = device.frames - (this.before?.devices[name]?.frames ?? device.frames);
      cell(row, elapsed_s > 0 ? (sent / elapsed_s).toFixed(1) : "–", "number rate");
      cell(row, device.nominal_rate_hz > 0 ? device.nominal_rate_hz.toFixed(1) : "–", "number");
      cell(row, whole(device.frames), "number frames");
      cell(row, whole(device.bytes), "number bytes");
      cell(row, whole(device.lateness_p99_us), "number");
      cell(row, whole(device.lateness_max_us), "number");
      cell(row, whole(device.dropped), device.dropped > 0 ? "number drops bad" : "number drops");
      cell(row, device.client_present ? (device.readers > 1 ? `${device.readers}` : "yes") : "–");
      cell(row, device.wire);
      cell(row, device.last_request
        ? `${(device.last_request.time_ns * 1e-9).toFixed(1)} s ${device.last_request.text}` : "–");
    }
    if (!this.before || elapsed_s > 0) this.before = status;
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
