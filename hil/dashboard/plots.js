// Any quantity of the machine by the word of `read` and `wait` ("boom"), any number of the truth
// ("truth.joint_rad.1", or "joint_rad.1" as in criteria), of the fixes that clients read and of the wires' figures, on
// simulated time, with what happened as lines across and faults as bands. The wheel changes the span, Hold keeps the
// picture, CSV has what is kept.

import { keep, kept } from "/page/kept.js";
import { nearestNames } from "/page/suggest.js";
import { Chart, registerables } from "/lib/chart.js/chart.mjs";

Chart.register(...registerables);

const MOST_SAMPLES = 6000; // of each quantity
const COLOURS = ["#d95f02", "#1b9e77", "#7570b3", "#e7298a", "#66a61e", "#a6761d", "#3288bd", "#999999"];
const DRAW_MS = 200;
const MOST_MARKS = 500;

// Calls use(path, number) for every number in there.
function eachNumber(value, path, use) {
  if (typeof value === "number") use(path, value);
  else if (value && typeof value === "object") {
    for (const [key, inner] of Object.entries(value)) eachNumber(inner, `${path}.${key}`, use);
  }
}

export class Plots {
  constructor(run, parts) {
    this.parts = parts;
    this.lines = new Map(kept("plots", []).map((quantity) => [quantity, []])); // quantity -> samples {x, y}
    this.known = new Set(); // topics of fixes that are listened to
    this.options = new Map(); // quantity -> its entry in the list
    this.units = new Map(); // word of `read` -> unit
    this.marks = []; // {x, text, bad}
    this.bands = []; // {begin, end, text}; end null: it acts on
    this.heldAt_s = null; // the picture's end, while it is held
    this.span_s = Number(parts.span.value) || 30; // what was kept may be no number
    parts.span.value = String(this.span_s);
    this.last_s = 0;
    this.start_ns = null;
    run.addEventListener("open", () => (this.start_ns = null));
    run.listen("/truth", (truth, time) => {
      this.start_ns ??= time - BigInt(Math.round(truth.sim_s * 1e9));
      const { state = {}, ...rest } = truth;
      for (const [word, number] of Object.entries(state)) {
        if (typeof number === "number") this.sample(word, number, truth.sim_s);
      }
      this.take("truth", rest, truth.sim_s);
    });
    run.listen("/status", (status) => {
      for (const [word, { unit }] of Object.entries(status.machine.quantities ?? {})) this.units.set(word, unit);
      for (const [word, option] of this.options) if (this.units.get(word)) option.label = this.label(word);
      const figures = Object.fromEntries(
        Object.entries(status.devices).map(([name, device]) => [name, { ...device, last_request: null }]));
      this.take("wires", figures, status.time_ns * 1e-9);
    });
    run.addEventListener("topics", () => {
      for (const topic of run.topics.keys()) {
        if (topic.startsWith("/fix/") && !this.known.has(topic)) {
          this.known.add(topic);
          run.listen(topic, (fix, time) => {
            if (this.start_ns !== null) this.take(`fix.${topic.slice(5)}`, fix, Number(time - this.start_ns) * 1e-9);
          });
        }
      }
    });
    this.chart = new Chart(parts.canvas, {
      type: "line",
      data: { datasets: [] },
      options: {
        animation: false,
        parsing: false,
        normalized: true,
        responsive: true,
        maintainAspectRatio: false,
        interaction: { mode: "nearest", axis: "x", intersect: false },
        elements: { point: { radius: 0 }, line: { borderWidth: 1.5 } },
        scales: {
          x: { type: "linear", title: { display: true, text: "simulated time, s" } },
          y: {},
        },
      },
      plugins: [{
        id: "marks",
        beforeDatasetsDraw: (chart) => this.drawBands(chart),
        afterDatasetsDraw: (chart) => this.drawMarks(chart),
      }],
    });
    this.colourAxes();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.colourAxes());
    parts.add.addEventListener("click", () => this.add(parts.quantity.value.trim()));
    parts.quantity.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.add(parts.quantity.value.trim());
    });
    parts.clear.addEventListener("click", () => {
      this.lines.clear();
      keep("plots", []);
    });
    parts.hold.addEventListener("click", () => {
      this.hold(this.heldAt_s === null ? this.last_s : null);
    });
    parts.span.addEventListener("change", () => this.setSpan(Number(parts.span.value)));
    parts.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.setSpan(this.span_s * (event.deltaY > 0 ? 1.25 : 0.8));
    }, { passive: false });
    parts.csv.addEventListener("click", () => this.download());
    setInterval(() => this.draw(), DRAW_MS);
  }

  colourAxes() {
    const style = getComputedStyle(document.body);
    const ink = style.getPropertyValue("--ink");
    const line = style.getPropertyValue("--line");
    for (const axis of Object.values(this.chart.options.scales)) {
      axis.ticks = { ...axis.ticks, color: ink };
      axis.grid = { color: line };
      if (axis.title) axis.title.color = ink;
    }
    this.chart.options.plugins.legend.labels.color = ink;
  }

  // What happened, at that simulated time.
  mark(time_s, text, bad) {
    this.marks.push({ x: time_s, text, bad });
    if (this.marks.length > MOST_MARKS) this.marks.shift();
  }

  // Of what acts from one simulated time to another.
  band(bands) {
    this.bands = bands;
  }

  // Keeps the picture that ends there; null: goes on with the run.
  hold(end_s) {
    this.heldAt_s = end_s;
    this.parts.hold.setAttribute("aria-pressed", String(end_s !== null));
    this.parts.hold.textContent = end_s === null ? "Hold" : "Resume";
    this.draw();
  }

  // Keeps the picture with that instant in its middle.
  showAt(time_s) {
    this.hold(time_s + 0.5 * this.span_s);
  }

  drawBands({ ctx, chartArea: area, scales: { x: axis } }) {
    ctx.save();
    ctx.fillStyle = getComputedStyle(document.body).getPropertyValue("--band");
    this.bandsDrawn = 0;
    for (const { begin, end } of this.bands) {
      const from = Math.max(begin, axis.min);
      const to = Math.min(end ?? Infinity, this.last_s, axis.max);
      if (from >= to) continue;
      const left = axis.getPixelForValue(from);
      ctx.fillRect(left, area.top, axis.getPixelForValue(to) - left, area.bottom - area.top);
      ++this.bandsDrawn;
    }
    ctx.restore();
  }

  drawMarks({ ctx, chartArea: area, scales: { x: axis } }) {
    const style = getComputedStyle(document.body);
    ctx.save();
    ctx.font = "11px system-ui, sans-serif";
    let free_px = area.left; // of the words' line
    for (const { x, text, bad } of this.marks) {
      if (x < axis.min || x > axis.max) continue;
      const at_px = axis.getPixelForValue(x);
      ctx.strokeStyle = ctx.fillStyle = style.getPropertyValue(bad ? "--bad" : "--accent");
      ctx.beginPath();
      ctx.moveTo(at_px, area.top);
      ctx.lineTo(at_px, area.bottom);
      ctx.stroke();
      const width_px = ctx.measureText(text).width;
      if (at_px + 3 >= free_px && at_px + 3 + width_px <= area.right) {
        ctx.fillText(text, at_px + 3, area.top + 11);
        free_px = at_px + width_px + 8;
      }
    }
    ctx.restore();
  }

  setSpan(seconds) {
    const isLength = seconds > 0 && seconds < Infinity;
    this.parts.answer.textContent = isLength ? "" : "The span is a number of seconds above 0.";
    if (!isLength) {
      this.parts.span.value = String(Number(this.span_s.toPrecision(3)));
      return;
    }
    this.span_s = Math.min(3600, Math.max(0.1, seconds));
    this.parts.span.value = String(Number(this.span_s.toPrecision(3)));
  }

  take(source, message, time_s) {
    eachNumber(message, source, (path, number) => this.sample(path, number, time_s));
    this.last_s = Math.max(this.last_s, time_s);
  }

  sample(quantity, number, time_s) {
    this.last_s = Math.max(this.last_s, time_s);
    if (!this.options.has(quantity)) {
      const option = new Option(this.label(quantity), quantity);
      this.options.set(quantity, option);
      this.parts.quantities.append(option);
    }
    const samples = this.lines.get(quantity);
    if (!samples) return;
    samples.push({ x: time_s, y: number });
    if (samples.length > MOST_SAMPLES) samples.splice(0, samples.length - MOST_SAMPLES);
  }

  // A word with its unit; keys of the truth name theirs.
  label(quantity) {
    const unit = this.units.get(quantity);
    return unit ? `${quantity} (${unit})` : quantity;
  }

  // Plots the quantity of that name, or says on the page why not.
  add(name) {
    const quantity = [name, `truth.${name}`, name.replace(/^(truth\.)?state\./, "")].find((one) => this.options.has(one));
    if (quantity === undefined) {
      this.parts.answer.textContent = this.unknown(name);
    } else if (this.lines.has(quantity)) {
      this.parts.answer.textContent = `${quantity} is plotted already.`;
    } else {
      this.parts.answer.textContent = "";
      this.lines.set(quantity, []);
      keep("plots", [...this.lines.keys()]);
    }
  }

  unknown(name) {
    if (this.options.size === 0) return "The run has reported no quantity yet.";
    if (name === "") return "Name a quantity of the list.";
    const near = nearestNames(name, this.options.keys());
    return `No quantity is called ${name}. ${near.length > 0 ? `Did you mean ${near.join(", ")}?` : "The list of the field has all names."}`;
  }

  draw() {
    const end_s = this.heldAt_s ?? this.last_s;
    const begin_s = end_s - this.span_s;
    this.chart.data.datasets = [...this.lines].map(([quantity, data], index) => ({
      label: this.label(quantity),
      data: data.filter(({ x }) => x >= begin_s && x <= end_s),
      borderColor: COLOURS[index % COLOURS.length],
      backgroundColor: COLOURS[index % COLOURS.length],
    }));
    this.chart.options.scales.x.min = begin_s;
    this.chart.options.scales.x.max = end_s;
    this.chart.update("none");
  }

  csv() {
    const rows = ["quantity,sim_s,value"];
    for (const [label, samples] of this.lines) {
      for (const { x, y } of samples) rows.push(`${label},${x},${y}`);
    }
    return rows.join("\n") + "\n";
  }

  download() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([this.csv()], { type: "text/csv" }));
    link.download = "rigwire.csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
}
