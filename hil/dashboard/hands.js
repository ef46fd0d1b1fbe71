// Controls of the run: time, faults, overrides, recordings. They all use the control surface.

const FAULTS_MS = 500;
// Manual overrides of the air, beside the rig's weather: the slider goes from 0, nothing, to 1.
const AIR = [
  { kind: "rain", title: "rain", value: (share) => `${(100 ** share).toFixed(1)} mm/h` },
  { kind: "snow", title: "snow", value: (share) => `${(20 ** share).toFixed(1)} mm/h` },
  { kind: "fog", title: "fog, visibility", value: (share) => `${Math.round(2000 * 0.005 ** share)} m` },
];

export class Hands {
  // Calls `faultsAre(faults, time_s)` with all faults, periodically.
  constructor(run, parts, faultsAre) {
    this.run = run;
    this.faultsAre = faultsAre;
    this.held = new Map(); // set point -> its override, of whatever client
    this.commands = new Map(); // set point -> what the client on the wire commands
    this.parts = parts;
    this.paused = false;
    this.recording = null;
    this.targets = {};
    run.listen("/status", (status) => this.show(status));
    run.addEventListener("open", () => this.offerFaults());
    parts.pause.addEventListener("click", () => this.ask(this.paused ? "resume" : "pause"));
    parts.step.addEventListener("click", () => this.ask("step", { length: parts.stepLength.value }));
    parts.go.addEventListener("click", () => this.ask("run_until", { time: parts.goTime.value }));
    // Enter in a field does what the button beside it does.
    for (const [field, button] of [[parts.stepLength, parts.step], [parts.goTime, parts.go]]) {
      field.addEventListener("keydown", (event) => {
        if (event.key === "Enter") button.click();
      });
    }
    parts.speed.addEventListener("change", () => this.ask("speed", { factor: parts.speed.value }));
    parts.record.addEventListener("click", () => this.record());
    parts.faultOn.addEventListener("change", () => this.offerKinds());
    parts.faultType.addEventListener("change", () => this.describeKind());
    parts.fault.addEventListener("submit", (event) => {
      event.preventDefault();
      this.addFault();
    });
    setInterval(() => this.listFaults(), FAULTS_MS);
  }

  // Says on the page what came of it; undefined when it was refused.
  async ask(verb, keys) {
    try {
      const reply = await this.run.command(verb, keys);
      this.parts.answer.textContent = "";
      if ("paused" in reply) this.showPaused(reply.paused);
      return reply;
    } catch (error) {
      this.parts.answer.textContent = `${verb}: ${error.message}`;
      return undefined;
    }
  }

  show(status) {
    this.showPaused(status.paused);
    if (document.activeElement !== this.parts.speed) this.parts.speed.value = status.clock.split(":")[1] ?? 1;
    this.recording = status.recording;
    this.parts.record.textContent = status.recording ? "End recording" : "Record";
    this.parts.record.title = status.recording ?? "";
    this.offerSticks(status.machine.settable ?? []);
    this.showAir(status.air);
  }

  showPaused(paused) {
    this.paused = paused;
    this.parts.pause.textContent = paused ? "Resume" : "Pause";
  }

  record() {
    if (this.recording) {
      this.ask("record", { stop: true });
    } else {
      const stamp = new Date().toISOString().replace(/[:.]/g, "-");
      this.ask("record", { folder: `recording-${stamp}` });
    }
  }

  // Faults -----------------------------------------------------------------------------------------

  async offerFaults() {
    const reply = await this.ask("fault_list");
    if (!reply) return;
    this.targets = reply.targets;
    this.parts.faultOn.replaceChildren(...Object.keys(this.targets).map((name) => new Option(name, name)));
    this.offerKinds();
    this.listFaults();
  }

  offerKinds() {
    const kinds = this.targets[this.parts.faultOn.value] ?? {};
    this.parts.faultType.replaceChildren(...Object.keys(kinds).map((name) => new Option(name, name)));
    this.describeKind();
  }

  describeKind() {
    this.parts.faultText.textContent = this.targets[this.parts.faultOn.value]?.[this.parts.faultType.value] ?? "";
  }

  async addFault() {
    const keys = this.parts.faultKeys.value.trim();
    const type = this.parts.faultType.value;
    await this.ask("fault_add", {
      on: this.parts.faultOn.value,
      fault: keys ? `{type: ${type}, ${keys}}` : `{type: ${type}}`,
    });
    this.listFaults();
  }

  async listFaults() {
    let reply;
    try {
      reply = await this.run.command("fault_list");
    } catch {
      return; // said elsewhere: the connection is lost
    }
    this.faultsAre(reply.faults, reply.time_ns * 1e-9);
    const open = reply.faults.filter(({ end_ns }) => end_ns === null || end_ns > reply.time_ns);
    // Buttons stay as long as their faults do, under the mouse and with the focus.
    for (const item of [...this.parts.faults.children]) {
      if (!open.some(({ id }) => String(id) === item.dataset.fault)) item.remove();
    }
    for (const fault of open) {
      const item = this.parts.faults.querySelector(`[data-fault="${fault.id}"]`) ?? this.faultItem(fault.id);
      const left = fault.end_ns === null ? "" : `, ${((fault.end_ns - reply.time_ns) * 1e-9).toFixed(1)} s left`;
      const acts = fault.begin_ns !== null && fault.begin_ns <= reply.time_ns;
      item.firstElementChild.textContent = `${fault.where}: ${fault.type}${acts ? left : " waits"}`;
    }
  }

  faultItem(id) {
    const item = document.createElement("li");
    item.dataset.fault = id;
    const undo = document.createElement("button");
    undo.type = "button";
    undo.textContent = "End";
    undo.addEventListener("click", () => this.endFault(id));
    item.append(document.createElement("span"), undo);
    this.parts.faults.append(item);
    return item;
  }

  async endFault(id) {
    await this.ask("fault_clear", { id });
    this.listFaults();
  }

  // Weather ----------------------------------------------------------------------------------------

  showAir(air) {
    if (!air) return; // a run without a world
    if (this.parts.weather.childElementCount === 0) this.parts.weather.append(...AIR.map((one) => this.airRow(one)));
    for (const { kind } of AIR) {
      const row = this.parts.weather.querySelector(`[data-air=${kind}]`);
      row.classList.toggle("held", air[kind] !== null);
      row.querySelector("output").textContent = air[kind] ?? "none";
      // A slider goes back when another client releases it; one that is being moved stays.
      if (air[kind] === null && !row.contains(document.activeElement)) row.querySelector("input").value = 0;
    }
  }

  airRow({ kind, title, value }) {
    const row = document.createElement("div");
    row.className = "stick";
    row.dataset.air = kind;
    const label = document.createElement("label");
    label.htmlFor = `air-${kind}`;
    const name = document.createElement("span");
    name.textContent = title;
    label.append(name, " ", document.createElement("output"));
    const input = document.createElement("input");
    Object.assign(input, { id: label.htmlFor, type: "range", min: 0, max: 1, step: 0.01, value: 0 });
    input.addEventListener("change", () => {
      const share = Number(input.value);
      this.ask("set", { on: "air", set: { [kind]: share > 0 ? value(share) : null } });
    });
    const release = document.createElement("button");
    release.type = "button";
    release.textContent = "Release";
    release.addEventListener("click", () => {
      input.value = 0;
      this.ask("set", { on: "air", set: { [kind]: null } });
    });
    row.append(label, input, release);
    return row;
  }

  // Sticks -----------------------------------------------------------------------------------------

  // A slider for each set point of the machine that has a range, else a field.
  offerSticks(names) {
    if (this.sticks === names.map(({ name }) => name).join()) return;
    this.sticks = names.map(({ name }) => name).join();
    this.parts.sticks.replaceChildren(...names.map(({ name, least, most }) => {
      const row = document.createElement("div");
      row.className = "stick";
      const label = document.createElement("label");
      label.textContent = name;
      label.htmlFor = `stick-${name}`;
      const input = document.createElement("input");
      input.id = label.htmlFor;
      const shown = document.createElement("output");
      if (least !== undefined && most !== undefined) {
        Object.assign(input, { type: "range", min: least, max: most, step: (most - least) / 200, value: 0 });
      } else {
        input.size = 6;
      }
      input.addEventListener("change", () => {
        this.ask("set", { set: { [name]: input.type === "range" ? Number(input.value) : input.value } });
      });
      const release = document.createElement("button");
      release.type = "button";
      release.textContent = "Release";
      release.addEventListener("click", () => this.ask("set", { set: { [name]: null } }));
      row.dataset.stick = name;
      row.append(label, input, shown, release);
      return row;
    }));
    for (const name of this.held.keys()) this.showStick(name);
  }

  // What happened to a set point, by whatever hand: the page's, `ctl`'s, a program's.
  note({ kind, where, text }) {
    if (where === "air" || !text.startsWith("manual override: ")) return; // settings of a device are not held
    if (kind === "set") this.held.set(where, text.slice(text.lastIndexOf(" ") + 1));
    else if (kind === "released") this.held.delete(where);
    else return;
    this.showStick(where);
    this.hearCommands();
  }

  showStick(name) {
    const row = this.parts.sticks.querySelector(`[data-stick="${CSS.escape(name)}"]`);
    if (!row) return; // of a device
    const held = this.held.get(name);
    const input = row.querySelector("input");
    row.classList.toggle("held", held !== undefined);
    if (document.activeElement !== input || held === undefined) input.value = held ?? (input.type === "range" ? 0 : "");
    const asks = this.commands.get(name);
    row.querySelector("output").textContent =
      held === undefined ? "" : `hand ${held}${asks === undefined ? "" : `, client ${asks}`}`;
  }

  // While a set point is overridden, the client's own command is read from its bytes.
  hearCommands() {
    const wanted = this.held.size > 0;
    for (const topic of wanted ? this.run.topics.keys() : []) {
      if (topic.startsWith("/registers/") && !this.ends?.has(topic)) {
        this.ends ??= new Map();
        this.ends.set(topic, this.run.listen(topic, ({ registers }) => this.showCommands(registers)));
      }
    }
    if (!wanted) {
      for (const end of this.ends?.values() ?? []) end();
      this.ends = null;
    }
  }

  showCommands(registers) {
    for (const { signal, section, value, unit } of registers) {
      if (signal !== "command" || value === undefined) continue;
      this.commands.set(section, `${Number(value.toPrecision(4))} ${unit}`);
      this.showStick(section);
    }
  }
}
