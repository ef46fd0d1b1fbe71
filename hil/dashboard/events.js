// What happened, newest first, from the run's list of events (docs/control.md, "Events"). A click on
// an instant moves the plots there, and a recording.

const MOST_ROWS = 500;
const RETRY_MS = 1000;

export class Events {
  // Calls `tell(event)` for each event, too, and `show(time_s)` for the one that is clicked.
  constructor(run, rows, plots, show, tell) {
    this.run = run;
    this.tell = tell;
    this.rows = rows;
    this.plots = plots;
    this.show = show;
    this.last = 0;
    run.addEventListener("open", () => this.follow());
  }

  async follow() {
    if (this.following) return;
    this.following = true;
    try {
      for (;;) {
        const reply = await this.run.command("events", { since: this.last, wait: this.last > 0 });
        for (const event of reply.events) this.add(event);
        this.last = Math.max(this.last, reply.last);
        if (reply.last === 0) await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
      }
    } catch {
      this.following = false; // the run has ended, or the connection is lost: "open" begins anew
    }
  }

  add(event) {
    const { time_ns, kind, level, where, text } = event;
    const time_s = time_ns * 1e-9;
    const bad = level === "warning" || level === "error";
    const row = this.rows.insertRow(0);
    row.className = bad ? "bad" : "";
    const instant = document.createElement("button");
    instant.type = "button";
    instant.textContent = time_s.toFixed(3);
    instant.title = "goes there";
    instant.addEventListener("click", () => this.show(time_s));
    row.insertCell().append(instant);
    row.cells[0].className = "number";
    for (const value of [kind, where, text]) row.insertCell().textContent = value;
    this.plots.mark(time_s, `${kind} ${where}`, bad);
    this.tell(event, bad);
    while (this.rows.rows.length > MOST_ROWS) this.rows.deleteRow(-1);
  }
}
