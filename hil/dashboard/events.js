// What happened, newest first, from the run's list of events (docs/control.md, "Events").

const MOST_ROWS = 500;
const RETRY_MS = 1000;

export class Events {
  constructor(run, rows) {
    this.run = run;
    this.rows = rows;
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

  add({ time_ns, kind, level, where, text }) {
    const row = this.rows.insertRow(0);
    row.className = level === "warning" || level === "error" ? "bad" : "";
    for (const [index, value] of [(time_ns * 1e-9).toFixed(3), kind, where, text].entries()) {
      const cell = row.insertCell();
      cell.textContent = value;
      if (index === 0) cell.className = "number";
    }
    while (this.rows.rows.length > MOST_ROWS) this.rows.deleteRow(-1);
  }
}
