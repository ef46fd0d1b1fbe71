// A recording that is shown (`rigwire replay FOLDER --dashboard`): time goes to any instant of it, by
// the slider or by a click on what happened. Backward the run begins anew, and the page with it.

const SETTLE_MS = 300; // from the slider's last move until time goes there
const WARNING = 3; // of foxglove.Log

export class Recording {
  constructor(run, parts, timeLine) {
    this.run = run;
    this.parts = parts;
    this.timeLine = timeLine;
    this.end_s = null; // null: it is a run of its own
    this.wanted_s = null; // where time is to go
    run.listen("/recorded", (recorded) => this.begin(recorded));
    run.listen("/status", ({ time_ns }) => this.show(time_ns * 1e-9));
    parts.time.addEventListener("input", () => {
      this.wanted_s = Number(parts.time.value);
      this.say();
    });
    parts.time.addEventListener("change", () => {
      clearTimeout(this.settling);
      this.settling = setTimeout(() => this.goTo(Number(parts.time.value)), SETTLE_MS);
    });
  }

  begin({ end_ns, events }) {
    this.end_s = end_ns * 1e-9;
    document.body.classList.add("recorded");
    this.parts.scrub.hidden = false;
    // Whole steps of a round length, of which the last reaches the end.
    const step = 10 ** Math.ceil(Math.log10(this.end_s / 20000));
    this.parts.time.step = step;
    this.parts.time.max = step * Math.ceil(this.end_s / step);
    this.timeLine.showRecorded(this.end_s, events.filter(({ log }) => log).map(({ time_ns, log }) => (
      { time_s: time_ns * 1e-9, kind: log.name, where: "", text: log.message, bad: log.level >= WARNING })));
  }

  // The answer comes when time is there, backward when the run is about to begin anew.
  async goTo(time_s) {
    if (this.end_s === null) return;
    const wanted_s = (this.wanted_s = Math.min(time_s, this.end_s));
    this.say();
    let refused = "";
    try {
      await this.run.command("seek", { time: `${wanted_s.toFixed(9)} s` });
    } catch (error) {
      refused = error.message;
    }
    if (this.wanted_s !== wanted_s) return; // it is sent elsewhere meanwhile
    this.wanted_s = null;
    this.parts.words.textContent = refused;
  }

  show(now_s) {
    if (this.end_s === null || this.wanted_s !== null) return;
    this.parts.time.value = now_s;
    this.parts.words.textContent = `${now_s.toFixed(2)} of ${this.end_s.toFixed(2)} s`;
  }

  say() {
    this.parts.words.textContent = `to ${this.wanted_s.toFixed(2)} of ${this.end_s.toFixed(2)} s`;
  }
}
