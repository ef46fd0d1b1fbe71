// The table of wires: each device against what it should do, how late one of them is, the messages of one
// wire live, and one of them with its fields, each of which marks its bytes when it is pointed at.

import { keep, kept } from "/page/kept.js";
import { drawLateness } from "/page/lateness.js";

const MOST_MESSAGES = 60;
const DETAIL_MS = 500; // from one message to the next in the detail, until one is chosen

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
  // `detail`: {head, bytes, fields, follow}, of one message, and {lateness}, of one device.
  // `recent`: the statuses of the last seconds, which takes each before it is shown here.
  constructor(run, recent, rows, choice, list, detail, plot) {
    this.run = run;
    this.recent = recent;
    this.plot = plot;
    this.rows = rows;
    this.choice = choice;
    this.list = list;
    this.detail = detail;
    this.device = null; // whose lateness is shown
    this.chosen = null; // message whose detail stays
    this.detailAt = 0;
    this.status = null; // the latest
    run.listen("/status", (status) => this.show(status));
    run.addEventListener("topics", () => this.offer());
    choice.addEventListener("change", () => this.watch());
    list.addEventListener("click", ({ target }) => this.pick(target.closest("li")));
    list.addEventListener("keydown", (event) => this.key(event));
    detail.follow.addEventListener("click", () => this.pick(null));
    for (const type of ["mouseover", "focusin"]) detail.fields.addEventListener(type, ({ target }) => this.mark(target.closest("li")));
    for (const type of ["mouseleave", "focusout"]) detail.fields.addEventListener(type, () => this.mark(null));
  }

  show(status) {
    for (const [name, device] of Object.entries(status.devices)) {
      const row = [...this.rows.rows].find(({ dataset }) => dataset.device === name) ?? this.newRow(name);
      row.wire = device.wire;
      const rate = this.recent.rate(name);
      COLUMNS.forEach(([, show], index) => {
        row.cells[index + 1].textContent = show(device, rate);
      });
      row.querySelector(".drops").classList.toggle("bad", device.dropped > 0);
    }
    this.status = status;
    this.showLateness();
  }

  showLateness() {
    const known = this.status?.devices[this.device];
    if (known) drawLateness(this.detail.lateness, this.device, known.lateness_us);
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
    const chosen = this.choice.value || kept("wire", "");
    this.choice.replaceChildren(new Option("–", ""), ...names.map((topic) => new Option(topic.slice(6), topic)));
    this.choice.value = names.includes(chosen) ? chosen : "";
    if (!this.end && this.choice.value) this.watch();
  }

  // A device on a shared wire is on the one that its address names.
  choose(device, wire) {
    this.device = device;
    this.showLateness();
    const topics = [...this.choice.options].map((option) => option.value);
    const own = `/wire/${device}`;
    const shared = topics.find((topic) => topic && wire.includes(topic.slice(6)));
    this.choice.value = topics.includes(own) ? own : (shared ?? "");
    this.watch();
  }

  watch() {
    keep("wire", this.choice.value);
    this.end?.();
    this.list.replaceChildren();
    this.pick(null);
    this.showDetail(null);
    this.end = this.choice.value
      ? this.run.listen(this.choice.value, (message) => this.add(message))
      : null;
  }

  add(message) {
    const { time_ns, from, size, bytes, text, signals, left_out: leftOut } = message;
    if (signals) this.plot(this.choice.value.slice(1).replace("/", "."), signals, time_ns * 1e-9);
    const item = document.createElement("li");
    item.className = from;
    item.message = message;
    const before = leftOut ? ` (${whole(leftOut)} more before it)` : "";
    item.textContent =
      `${(time_ns * 1e-9).toFixed(6)} ${from === "client" ? "<" : ">"} ${text} [${size}] ${bytes}${before}`;
    this.list.prepend(item);
    for (let last; this.list.childElementCount > MOST_MESSAGES; last.remove()) {
      last = this.list.lastElementChild;
      if (last.message === this.chosen) last = last.previousElementSibling; // stays while it is chosen
    }
    if (!this.chosen && performance.now() - this.detailAt > DETAIL_MS) this.showDetail(message);
  }

  // Its detail stays; null: the newest is shown again.
  pick(item) {
    this.list.querySelector("[aria-current]")?.removeAttribute("aria-current");
    this.chosen = item?.message ?? null;
    this.detail.follow.hidden = !this.chosen;
    if (!this.chosen) return;
    item.setAttribute("aria-current", "true");
    this.showDetail(this.chosen);
  }

  key(event) {
    const step = { ArrowUp: "previousElementSibling", ArrowDown: "nextElementSibling" }[event.key];
    if (!step) return;
    event.preventDefault();
    const now = this.list.querySelector("[aria-current]");
    const next = now ? now[step] : this.list.firstElementChild;
    if (next) {
      this.pick(next);
      next.scrollIntoView({ block: "nearest" });
    }
  }

  showDetail(message) {
    const { head, bytes, fields } = this.detail;
    this.detailAt = performance.now();
    head.textContent = message ? `${(message.time_ns * 1e-9).toFixed(6)} s, ${message.text}` : "";
    bytes.replaceChildren(...(message?.bytes.match(/../g) ?? []).map((byte) => {
      const span = document.createElement("span");
      span.textContent = byte;
      return span;
    }));
    fields.replaceChildren(...(message?.fields ?? []).map(({ name, value, from, bytes: count }) => {
      const item = document.createElement("li");
      item.tabIndex = 0;
      item.dataset.from = from;
      item.dataset.bytes = count;
      item.textContent = value ? `${name}: ${value}` : name;
      return item;
    }));
  }

  mark(field) {
    const from = Number(field?.dataset.from ?? 0);
    const count = Number(field?.dataset.bytes ?? 0);
    [...this.detail.bytes.children].forEach((byte, at) => {
      byte.classList.toggle("marked", at >= from && at < from + count);
    });
  }
}
