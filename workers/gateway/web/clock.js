// Time of the page. The run goes on by itself; pause and speed only change what is shown of it.

// The picture is this far behind the newest frame, so that there is a frame on both sides of it.
const DELAY_MS = 50;
// Frames that come less often need more; beyond this the picture waits instead.
const MOST_DELAY_MS = 200;
const ARRIVALS = 24;
// Share of a difference that is taken away with each picture: a late frame is not seen as a jump.
const SOFT = 0.12;
// A difference of this many frames' time is not softened but jumped over.
const JUMP_MS = 600;

/** Where the live picture stands: the time of the newest frame less a delay, running on evenly between frames. */
export class Head {
  constructor() { this.forget(); }
  forget() { this.arrivals = []; this.shown = null; this.stamp = 0; }

  arrive(t, stamp) {
    const last = this.arrivals[this.arrivals.length - 1];
    if (last && t <= last.t) return;
    // After a silence what was before says nothing about the pace.
    if (last && stamp - last.stamp > 2000) this.arrivals = [];
    this.arrivals.push({ t, stamp });
    if (this.arrivals.length > ARRIVALS) this.arrivals.shift();
  }

  /** Simulated seconds in a second of ours, as measured, or as the run says while there is little to measure. */
  rate(pace) {
    const first = this.arrivals[0], last = this.arrivals[this.arrivals.length - 1];
    if (!first || last.stamp - first.stamp < 200) return pace || 1;
    const seen = (last.t - first.t) / (last.stamp - first.stamp) * 1000;
    return pace && Math.abs(seen / pace - 1) < 0.15 ? pace : seen;
  }

  at(stamp, pace) {
    const last = this.arrivals[this.arrivals.length - 1];
    if (!last) return null;
    const rate = this.rate(pace), first = this.arrivals[0];
    const apart = this.arrivals.length > 1 ? (last.stamp - first.stamp) / (this.arrivals.length - 1) : 0;
    const delay = Math.min(MOST_DELAY_MS, Math.max(DELAY_MS, apart)) / 1000 * rate;
    // The frame that came most promptly says best which time it is.
    const prompt = Math.max(...this.arrivals.map((a) => a.t + (stamp - a.stamp) / 1000 * rate));
    const wanted = Math.min(last.t, prompt - delay);
    if (this.shown === null || Math.abs(wanted - this.shown) > JUMP_MS / 1000 * rate) this.shown = wanted;
    else {
      const next = this.shown + (stamp - this.stamp) / 1000 * rate;
      this.shown = Math.max(this.shown, Math.min(last.t, next + (wanted - next) * SOFT));
    }
    this.stamp = stamp;
    return this.shown;
  }
}

/** The shown time. `following` shows what is newest; otherwise it plays at `speed` (0: all in 10 s) or stands. */
export class Clock {
  constructor(changed) {
    this.now = 0; this.first = 0; this.last = 0; this.speed = 1; this.playing = false; this.following = false; this.changed = changed; this.stamp = 0;
  }
  rate() { return this.speed === 0 ? Math.max((this.last - this.first) / 10, 1) : this.speed; }
  /**
   * One picture later. `head` is the live time or null; `waits`: there is none yet, because the run is about to begin. True if the shown time
   * is another one.
   */
  advance(stamp, head, waits = false) {
    const before = this.now, dt = Math.min(Math.max(0, stamp - this.stamp), 100) / 1000;
    this.stamp = stamp;
    if (this.following && (head !== null || waits)) this.now = head ?? this.now;
    else if (this.playing) {
      this.now += dt * this.rate();
      if (head !== null && this.now >= head) this.follow();
      else if (head === null && this.now >= this.last) { this.now = this.last; this.playing = false; this.following = false; this.changed(); }
    }
    this.now = Math.max(this.first, Math.min(this.now, Math.max(this.last, this.first)));
    return this.now !== before;
  }
  follow() { this.following = true; this.playing = true; this.changed(); }
  go(t) { this.following = false; this.playing = false; this.now = Math.max(this.first, Math.min(t, this.last)); this.changed(); }
  pause() { this.following = false; this.playing = false; this.changed(); }
  toggle(live) {
    if (this.playing) { this.pause(); return; }
    if (!live && this.now >= this.last - 1e-6) this.now = this.first;
    this.playing = true;
    this.changed();
  }
}
