// Joins the parts of the page with the run.

import { Buses } from "/page/buses.js";
import { Events } from "/page/events.js";
import { Hands } from "/page/hands.js";
import { keepChoice } from "/page/kept.js";
import { Plots } from "/page/plots.js";
import { Recent } from "/page/recent.js";
import { Recording } from "/page/recording.js";
import { Registers } from "/page/registers.js";
import { Run } from "/page/run.js";
import { Sensors } from "/page/sensors.js";
import { TimeLine } from "/page/timeline.js";
import { View } from "/page/view.js";
import { Wires } from "/page/wires.js";

const part = (id) => document.getElementById(id);
const run = new Run();
for (const id of ["camera", "colour", "show-axes", "show-cameras", "show-satellites", "plot-span"]) keepChoice(part(id));

const connection = part("connection");
run.addEventListener("open", ({ detail }) => {
  connection.textContent = "connected";
  connection.className = "";
  part("rig").textContent = detail.name;
  document.title = `${detail.name} – Rigwire`;
});
run.addEventListener("lost", () => {
  connection.textContent = run.token ? "no connection; trying again" : "the address lacks the run's token";
  connection.className = "lost";
});
run.addEventListener("status", ({ detail }) => {
  connection.textContent = detail.message;
});

const recent = new Recent();
run.listen("/status", (status) => {
  recent.take(status);
  part("time").textContent = `${(status.time_ns * 1e-9).toFixed(2)} s${status.paused ? ", paused" : ""}`;
  part("clock").textContent = status.clock;
  part("slipped").textContent = `${status.slipped_s.toFixed(2)} s`;
  const pace = recent.pace();
  if (pace !== null) part("pace").textContent = `${pace.toFixed(2)} ×`;
});

const wires = new Wires(run, recent, part("devices"), part("wire"), part("messages"), {
  head: part("message-head"),
  bytes: part("message-bytes"),
  fields: part("message-fields"),
  follow: part("message-follow"),
  lateness: part("lateness"),
}, (...numbers) => plots.take(...numbers));
const buses = new Buses(run, {
  details: part("buses"),
  loads: part("bus-loads"),
  nodes: part("bus-nodes"),
  identifiers: part("bus-identifiers"),
});
const registers = new Registers(run, part("registers"), part("register-rows"));
const hands = new Hands(run, {
  pause: part("pause"),
  step: part("step"),
  stepLength: part("step-length"),
  go: part("go"),
  goTime: part("go-time"),
  speed: part("speed"),
  record: part("record"),
  fault: part("fault"),
  faultOn: part("fault-on"),
  faultType: part("fault-type"),
  faultKeys: part("fault-keys"),
  faultText: part("fault-text"),
  faults: part("faults"),
  weather: part("weather"),
  sticks: part("sticks"),
  answer: part("answer"),
}, (faults, now_s) => {
  timeLine.showFaults(faults, now_s);
  plots.band(faults.filter(({ begin_ns }) => begin_ns !== null).map(({ begin_ns, end_ns }) => (
    { begin: begin_ns * 1e-9, end: end_ns === null ? null : end_ns * 1e-9 })));
});
const plots = new Plots(run, {
  canvas: part("chart"),
  quantity: part("quantity"),
  quantities: part("quantities"),
  add: part("plot-add"),
  clear: part("plot-clear"),
  hold: part("plot-pause"),
  span: part("plot-span"),
  csv: part("plot-csv"),
  answer: part("plot-answer"),
});
const show = (time_s) => {
  plots.showAt(time_s);
  recording.goTo(time_s);
};
const timeLine = new TimeLine(run, part("time-line"), part("time-line-words"), show, (id) => hands.endFault(id));
const events = new Events(run, part("event-rows"), plots, show, (event, bad) => {
  timeLine.add(event.time_ns * 1e-9, event.kind, event.where, event.text, bad);
  hands.note(event);
});
const recording = new Recording(run, { scrub: part("scrub"), time: part("scrub-time"), words: part("scrub-words") }, timeLine);
let view = null;
let sensors = null;
try {
  view = new View(run, part("scene"), part("camera"), part("colour"), part("view-figures"));
  sensors = new Sensors(run, view, {
    axes: part("show-axes"),
    cameras: part("show-cameras"),
    satellites: part("show-satellites"),
  }, part("pictures"));
} catch (error) {
  part("view-figures").textContent = `no 3D view: ${error.message}`;
}

// For programs that drive the page, and for the browser's console.
window.rigwire = { run, view, sensors, wires, buses, registers, events, timeLine, recording, hands, plots };
