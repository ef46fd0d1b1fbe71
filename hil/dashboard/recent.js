// Statuses of the last seconds of simulated time, for rates and the pace. All of them come from the run's own
// figures: a browser that handles messages late or several at once changes none of them.

const SPAN_S = 5; // as the table of a terminal
const MAX_STATUSES = 600; // while the run is paused or slow

export class Recent {
  constructor() {
    this.statuses = [];
  }

  // Takes the next status. A run that begins again, or a recording that goes back, begins anew.
  take(status) {
    const last = this.statuses.at(-1);
    if (last && (status.time_ns < last.time_ns || status.wall_s < last.wall_s)) this.statuses = [];
    this.statuses.push(status);
    while (
      this.statuses.length > MAX_STATUSES ||
      (this.statuses.length > 2 && status.time_ns - this.statuses[1].time_ns >= SPAN_S * 1e9)
    ) {
      this.statuses.shift();
    }
  }

  // Simulated seconds for each second of wall time; null: not known yet.
  pace() {
    const last = this.statuses.at(-1);
    const first = this.statuses.find(({ wall_s }) => wall_s >= last.wall_s - SPAN_S);
    const wall_s = last ? last.wall_s - first.wall_s : 0;
    return wall_s > 0 ? ((last.time_ns - first.time_ns) * 1e-9) / wall_s : null;
  }

  // Messages of a device for each simulated second; null: not known yet.
  rate(device) {
    const [first, last] = [this.statuses[0], this.statuses.at(-1)];
    const [before, now] = [first?.devices[device], last?.devices[device]];
    const elapsed_s = last ? (last.time_ns - first.time_ns) * 1e-9 : 0;
    return before && now && elapsed_s > 0 ? (now.frames - before.frames) / elapsed_s : null;
  }
}
