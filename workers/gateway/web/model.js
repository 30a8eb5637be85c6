// What is known of one run: the scene, events, standing, and a store of frames in order of time. Frames come from the socket as they
// happen, and from `/frames` around the shown time where the store has holes.
import { frameBytes, framesOf } from "./wire.js";
import { runUrl } from "./words.js";

// Bytes of frames that are kept: some minutes of a small run, some 20 s of 10 000 agents.
const KEPT_BYTES = 64 * 1024 * 1024;
// After a clearing this share is left, so that the next frames do not clear again.
const LEFT_SHARE = 0.8;
// The newest frames are never cleared: the live view stands on them.
const NEWEST = 48;
// An answer of `/frames` has at most 4 MB; a little less leaves room for scans.
const ANSWER_BYTES = 3.6e6;
const MOST_A_CHUNK = 64, LEAST_A_CHUNK = 4;
// Frames a second that look smooth when they are interpolated.
const SMOOTH_HZ = 20;
const LEVELS = 12;
// Seconds of playback that are fetched ahead of the shown time, and seconds before it that trails need.
const AHEAD_SECS = 5, BEHIND_SECS = 4;
const AT_ONCE = 2;
// Pause after an answer that failed, ms.
const AGAIN_MS = 1500;
// Frames larger than this are those of a crowd.
const CROWD_BYTES = 65536;
const MOST_EVENTS = 20000;
// Standings that differ from the one before: a checklist changes some dozen times.
const MOST_STANDINGS = 2000;

export class Reel {
  /** `told` is called with a fault of the stored bytes; `changed` whenever frames came. */
  constructor(run, changed, told) {
    this.run = run; this.changed = changed; this.told = told;
    this.scene = null; this.state = "waiting"; this.standing = null; this.ended = null; this.lost = 0;
    this.clear();
  }

  clear() {
    this.frames = []; this.bytes = 0; this.events = []; this.doors = new Map(); this.standing = null; this.standings = []; this.ended = null; this.lost = 0;
    this.chunks = new Map(); this.flying = 0; this.age = (this.age || 0) + 1;
  }

  setScene(scene) {
    const before = this.scene, newest = this.newest();
    // A run that starts anew under the same name has nothing to do with what is stored.
    const anew = before && (before.seed !== scene.seed || before.first_tick !== scene.first_tick || (newest && scene.ticks > 0 && scene.first_tick + scene.ticks + 1 < newest.tick));
    if (anew) this.clear();
    this.scene = scene; this.state = scene.state; this.step = scene.step_s > 0 ? scene.step_s : 0.01;
    this.base = Math.max(1, Math.round(1 / SMOOTH_HZ / this.step));
    this.numbers = new Map(scene.agents.map((a) => [a.number, a]));
    this.n = scene.agents.length;
    return anew;
  }

  newest() { return this.frames[this.frames.length - 1] || null; }
  first_s() { return this.scene ? this.scene.first_tick * this.step : 0; }
  /** The end of the run so far. */
  last_s() {
    if (!this.scene) return 0;
    if (this.ended) return Math.max(this.first_s(), this.ended.time_s);
    const newest = this.newest();
    const told = this.first_s() + Math.max(0, this.scene.ticks - 1) * this.step;
    return this.live() && newest ? Math.max(newest.t, this.first_s()) : Math.max(told, newest ? newest.t : 0);
  }
  live() { return this.state === "live"; }

  /** Puts one frame of the socket into the store. */
  add(frame) {
    const newest = this.newest();
    if (!newest || frame.tick > newest.tick) { this.frames.push(frame); this.bytes += frame.bytes; } else this.merge([frame]);
  }

  merge(more) {
    let from = this.upto(more[0].tick - 0.5);
    for (const frame of more) {
      while (from < this.frames.length && this.frames[from].tick < frame.tick) from++;
      if (from < this.frames.length && this.frames[from].tick === frame.tick) continue;
      this.frames.splice(from, 0, frame);
      this.bytes += frame.bytes;
    }
  }

  // Number of frames up to this tick.
  upto(tick) {
    let low = 0, high = this.frames.length;
    while (low < high) { const mid = (low + high) >> 1; if (this.frames[mid].tick <= tick) low = mid + 1; else high = mid; }
    return low;
  }
  upto_s(t) {
    let low = 0, high = this.frames.length;
    while (low < high) { const mid = (low + high) >> 1; if (this.frames[mid].t <= t + 1e-6) low = mid + 1; else high = mid; }
    return low;
  }

  // Ticks between frames at this speed of playback; 1 when the picture stands, so that single ticks can be seen.
  every(rate) {
    if (rate === 0) return 1;
    let every = this.base;
    for (let i = 0; i < LEVELS && every * 2 <= this.base * rate * 1.01; i++) every *= 2;
    return every;
  }

  /** The frames around a time: `a` at or before it, `b` after it, `u` how far between them; null where nothing is stored. */
  moment(t, rate) {
    const k = this.upto_s(t), a = this.frames[Math.max(0, k - 1)], b = this.frames[k] || null;
    if (!a) return null;
    const wide = 2.5 * Math.max(this.base, this.every(rate)) * this.step;
    const early = k === 0, hole = b !== null && b.t - a.t > wide;
    const u = !b || early || hole || b.t <= a.t ? 0 : Math.min(1, Math.max(0, (t - a.t) / (b.t - a.t)));
    const far = Math.abs(t - a.t) > wide && t < this.last_s() - 0.5 * this.base * this.step - 1e-6;
    return { t, a, b: hole || early ? null : b, u, loading: this.flying > 0 && (early ? a.t - t > wide : far) };
  }

  /** The stored frames of the seconds before a time, the oldest first. */
  before(t, secs) {
    return this.frames.slice(this.upto_s(t - secs), this.upto_s(t));
  }

  /** Fetches what is missing around the shown time. `rate` is the speed of playback, 0 when it stands; `live` when it
   *  follows the run, whose pace the rate then is. */
  aim(t, rate, live) {
    if (!this.scene || this.flying >= AT_ONCE) return;
    this.spare(t);
    const whole = frameBytes(this.n);
    const size = Math.max(LEAST_A_CHUNK, Math.min(MOST_A_CHUNK, Math.floor(ANSWER_BYTES / whole)));
    const wishes = [];
    const range = (every, from_s, to_s) => {
      const ticks = every * size, first = this.scene.first_tick;
      const index = (s) => Math.floor((s / this.step - first + 1e-6) / ticks);
      for (let i = Math.max(0, index(from_s)); i <= index(to_s) && wishes.length < 64; i++) wishes.push([every, first + i * ticks, ticks]);
    };
    // Trails of what was before the page came; crowds have none.
    if (live) { if (whole < CROWD_BYTES && rate <= BEHIND_SECS) range(this.every(rate), t - BEHIND_SECS, t); }
    else {
      const smooth = this.every(Math.max(rate, 1));
      range(smooth, t, t);
      if (rate === 0) range(1, t - 10 * this.step, t + 10 * this.step);
      const held = KEPT_BYTES * 0.4 / whole * smooth * this.step;
      range(smooth, t, t + Math.min(AHEAD_SECS * Math.max(rate, 1), held));
      range(smooth, t - Math.min(BEHIND_SECS, held / 2), t);
    }
    const last = this.last_s() / this.step;
    for (const [every, from, ticks] of wishes) {
      if (this.flying >= AT_ONCE) return;
      // What is still to come is sent by the socket; a chunk is asked for when all of it was.
      if (from > last + 1e-6 || (live && from + ticks > last)) continue;
      const key = every + ":" + from, known = this.chunks.get(key);
      if (known && (known.until === Infinity || known.until > performance.now())) continue;
      if (this.full(every, from, ticks)) { this.chunks.set(key, { from, to: from + ticks, until: Infinity }); continue; }
      this.fetch(key, every, from, from + ticks - 1);
    }
  }

  // True where the socket has brought all that a chunk would.
  full(every, from, ticks) {
    const to = from + ticks - 1, i = this.upto(from - 1), j = this.upto(to);
    let at = from - every;
    for (const frame of this.frames.slice(i, j)) { if (frame.tick - at > every) return false; at = frame.tick; }
    return to - at <= every;
  }

  async fetch(key, every, from, to) {
    const age = this.age, chunk = { from, to: to + 1, until: Infinity };
    this.chunks.set(key, chunk);
    this.flying++;
    try {
      // Each answer is cut at 4 MB; a chunk is smaller, so that a few rounds are more than enough.
      for (let at = from, round = 0; at <= to && round < 8; round++) {
        const answer = await fetch(runUrl(this.run, `/frames?from=${at}&to=${to}&every=${every}`));
        if (!answer.ok) throw new Error(`frames ${at} to ${to}: ${answer.status}`);
        const frames = framesOf(await answer.arrayBuffer());
        if (age !== this.age) return;
        if (frames.length === 0) break;
        this.merge(frames);
        at = frames[frames.length - 1].tick + every;
      }
      // The end of a living run grows: what was not there yet is asked for again.
      if (this.live() && to >= this.last_s() / this.step) chunk.until = performance.now() + AGAIN_MS;
      this.changed();
    } catch (fault) {
      chunk.until = performance.now() + AGAIN_MS;
      this.told(fault);
    } finally {
      if (age === this.age) this.flying--;
    }
  }

  // Clears frames far from the shown time when there are too many bytes.
  spare(t) {
    if (this.bytes <= KEPT_BYTES) return;
    const shown = this.upto_s(t), keep = Math.max(0, this.frames.length - NEWEST);
    let low = 0, high = keep;
    while (this.bytes > KEPT_BYTES * LEFT_SHARE && low < high) {
      const frame = shown - low >= high - shown ? this.frames[low++] : this.frames[--high];
      this.bytes -= frame.bytes;
    }
    if (low === 0 && high === keep) return;
    const before = low > 0 ? this.frames[low - 1].tick : -1, after = high < keep ? this.frames[high].tick : Infinity;
    this.frames = [...this.frames.slice(low, high), ...this.frames.slice(keep)];
    for (const [key, chunk] of this.chunks) if (chunk.from <= before || chunk.to > after) this.chunks.delete(key);
  }

  /** Events from number `from` on; answers false where some before them are missing. */
  addEvents(from, events) {
    if (from > this.events.length) return false;
    for (const e of events.slice(this.events.length - from)) {
      if (this.events.length >= MOST_EVENTS) break;
      this.events.push(e);
      if (e.kind === "door" && e.door) {
        const times = this.doors.get(e.door) || [];
        times.push([e.t, Boolean(e.open)]);
        this.doors.set(e.door, times);
      }
    }
    return true;
  }

  /** Is a door open at this time? Before its first event it was what that event ended. */
  open(door, t) {
    const times = this.doors.get(door.id);
    if (!times || times.length === 0) return Boolean(door.open);
    let open = !times[0][1];
    for (const [from, is] of times) { if (from > t + 1e-6) break; open = is; }
    return open;
  }

  /** Takes how the run stands now, and keeps how it stood before. */
  stand(standing) {
    this.standing = standing;
    const clauses = standing.clauses || [], key = JSON.stringify(clauses.map((c) => [c.id, c.standing, c.at_s])), last = this.standings[this.standings.length - 1];
    if (standing.final || (last && (last.key === key || standing.time_s <= last.t)) || this.standings.length >= MOST_STANDINGS) return;
    this.standings.push({ t: standing.time_s, key, clauses: new Map(clauses.map((c) => [c.id, c])) });
  }

  /** What had been seen of a clause by a time: `[standing, at_s]`. A clause that nobody had judged yet is `open`. */
  stood(clause, t) {
    const seen = (c) => c.standing !== "open" && c.at_s !== null && c.at_s !== undefined && c.at_s <= t + 0.005;
    if (seen(clause)) return [clause.standing, clause.at_s];
    const then = this.standings.findLast((s) => s.t <= t + 0.005)?.clauses.get(clause.id);
    return then && then.standing !== "open" ? [then.standing, then.at_s] : ["open", null];
  }

  /** Number of events up to a time. */
  told_by(t) {
    let low = 0, high = this.events.length;
    while (low < high) { const mid = (low + high) >> 1; if (this.events[mid].t <= t + 1e-6) low = mid + 1; else high = mid; }
    return low;
  }
}
