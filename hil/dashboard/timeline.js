// The run as a line from its start until now, a recording's until its end: faults as bands,
// everything else that happened as a mark in the lane of its kind. A click moves the plots there, and
// a recording; the arrow keys go from one to the next.

const SVG = "http://www.w3.org/2000/svg";
const LANES = [
  ["faults", ["fault_begun"]], // those to come; then they are bands
  ["run", ["slipped", "impatient", "notice", "recording_began", "recording_ended"]],
  ["contacts", ["contact_begun", "contact_ended"]],
  ["clients", ["client_came", "client_left"]],
  ["requests", ["refused", "set", "released"]],
];
const MOST_MARKS = 500; // the newest
const LANE_PX = 16;
const LABEL_PX = 72;
const DRAW_MS = 500;

const element = (name, attributes, parent) => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent?.append(made);
  return made;
};

export class TimeLine {
  // Calls `show(time_s)` with the instant of the mark that is chosen; `end(fault)` ends a fault.
  constructor(run, svg, words, show, end) {
    this.svg = svg;
    this.words = words;
    this.show = show;
    this.end = end;
    this.marks = []; // {time_s, kind, where, text, bad}
    this.faults = [];
    this.chosen = null; // of the marks
    this.now_s = 0;
    this.end_s = null; // of a recording
    LANES.forEach(([name], lane) => {
      element("text", { x: 0, y: LANE_PX * (lane + 0.75), class: "lane" }, svg).textContent = name;
    });
    this.content = element("g", {}, svg);
    svg.setAttribute("height", LANE_PX * LANES.length);
    run.listen("/status", ({ time_ns }) => (this.now_s = time_ns * 1e-9));
    svg.addEventListener("click", (event) => this.click(event));
    svg.addEventListener("keydown", (event) => this.key(event));
    setInterval(() => this.draw(), DRAW_MS);
  }

  add(time_s, kind, where, text, bad) {
    // its band or the recording shows it
    if (kind.startsWith("fault_") || this.end_s !== null) return;
    this.marks.push({ time_s, kind, where, text, bad });
    if (this.marks.length > MOST_MARKS) this.marks.shift();
  }

  // Shows all events of a recording, until its end.
  showRecorded(end_s, marks) {
    this.end_s = end_s;
    this.marks = marks.slice(0, MOST_MARKS);
    this.draw();
  }

  showFaults(faults, now_s) {
    this.now_s = Math.max(this.now_s, now_s);
    this.faults = faults.filter(({ begin_ns }) => begin_ns !== null && begin_ns * 1e-9 <= now_s);
    this.draw();
  }

  // From simulated time to pixels.
  place(time_s) {
    const width = this.svg.clientWidth - LABEL_PX - 24;
    return LABEL_PX + (width * time_s) / (this.end_s ?? Math.max(this.now_s, 1));
  }

  draw() {
    const made = document.createDocumentFragment();
    LANES.forEach(([, kinds], lane) => {
      const y = LANE_PX * lane;
      element("line", { x1: LABEL_PX, x2: this.place(this.end_s ?? this.now_s), y1: y + LANE_PX / 2, y2: y + LANE_PX / 2 }, made);
      for (const mark of this.marks) {
        const isToCome = mark.time_s > this.now_s;
        if (!kinds.includes(mark.kind) || (mark.kind === "fault_begun" && !isToCome)) continue;
        const dot = element("circle", { cx: this.place(mark.time_s), cy: y + LANE_PX / 2, r: mark === this.chosen ? 6 : 4 }, made);
        dot.setAttribute("class", `${mark.bad ? "bad" : ""} ${isToCome ? "to-come" : ""}`);
        dot.mark = mark;
        element("title", {}, dot).textContent = this.describe(mark);
      }
    });
    for (const fault of this.faults) this.drawFault(fault, made);
    if (this.end_s !== null) {
      const x = this.place(this.now_s);
      element("line", { x1: x, x2: x, y1: 0, y2: LANE_PX * LANES.length, class: "now" }, made);
    }
    this.content.replaceChildren(made);
  }

  drawFault({ id, where, type, begin_ns, end_ns }, made) {
    const begin_s = begin_ns * 1e-9;
    const acts = end_ns === null || end_ns * 1e-9 > this.now_s;
    const x = this.place(begin_s);
    const width = Math.max(3, this.place(acts ? this.now_s : end_ns * 1e-9) - x);
    const band = element("rect", { x, y: 2, width, height: LANE_PX - 4, class: "fault", "data-fault": id }, made);
    band.mark = { time_s: begin_s, kind: type, where, text: "" };
    element("title", {}, band).textContent = `${where}: ${type}, from ${begin_s.toFixed(3)} s`;
    if (acts) {
      const undo = element("text", { x: x + width + 4, y: LANE_PX - 4, class: "undo", "data-undo": id }, made);
      undo.textContent = "✕";
      undo.undoes = id;
      element("title", {}, undo).textContent = `ends ${where}: ${type}`;
    }
  }

  describe({ time_s, kind, where, text }) {
    return `${time_s.toFixed(3)} s ${kind}${where && ` ${where}`}: ${text}`;
  }

  click({ target }) {
    if (target.undoes !== undefined) this.end(target.undoes);
    else if (target.mark) this.choose(target.mark);
  }

  choose(mark) {
    this.chosen = mark;
    this.words.textContent = this.describe(mark);
    this.show(mark.time_s);
    this.draw();
  }

  key(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step || this.marks.length === 0) return;
    event.preventDefault();
    const at = this.marks.indexOf(this.chosen);
    const next = at < 0 ? this.marks.length - 1 : Math.min(this.marks.length - 1, Math.max(0, at + step));
    this.choose(this.marks[next]);
  }
}
