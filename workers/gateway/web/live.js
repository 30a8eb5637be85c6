// The page of the gateway: the list of runs, or a run with its maps, controls and panel, perhaps with a second run beside it.
import { drawnAlike } from "./camera.js";
import { Clock } from "./clock.js";
import { Controls, keys } from "./controls.js";
import { showList } from "./list.js";
import { Panel } from "./panel.js";
import { Stage } from "./stage.js";
import { at, plain, press, runs, say, url, word } from "./words.js";

// Panels are for reading: five times a second is as fast as anybody can.
const PANEL_MS = 200, CONTROLS_MS = 90, AIM_MS = 100;
// Beyond this latency what one sees is no longer what happens, ms.
const AMBER_MS = 250;
const MOST_ERRORS = 50;
// Live frames may be this many times farther apart than smooth ones before the picture stops to mix them: the next one is on its way.
const PATIENCE = 4;
// A press of an arrow moves the map by this share of itself, or with shift the time by so much, s.
const PAN_SHARE = 0.12, HOP_SECS = 0.5;

/** What tests read: counts since the page was loaded. */
const seen = window.socrates = { frames: 0, acked: 0, drawn: 0, behind_ms: null, time_s: 0, live: false, agents: 0, renderer: "canvas", errors: [] };
const fault = (error) => { if (seen.errors.length < MOST_ERRORS) seen.errors.push(String((error && error.message) || error)); };
addEventListener("error", (e) => fault(e.error || e.message));
addEventListener("unhandledrejection", (e) => fault(e.reason));

class App {
  constructor(run, beside) {
    this.dirty = true; this.followed = null; this.stages = []; this.shown = 0; this.paneled = 0; this.aimed = 0; this.written = 0; this.late = true;
    this.clock = new Clock(() => this.changed());
    this.controls = new Controls(this);
    this.panel = new Panel((t) => this.go(t), (number) => this.follow(number));
    this.add(run);
    this.heading();
    this.read(0);
    if (beside && beside !== run) this.beside(beside);
    at("beside").addEventListener("change", () => this.beside(at("beside").value));
    for (const moment of ["pointerdown", "focus"]) at("beside").addEventListener(moment, () => this.offer());
    this.offer();
    this.listen();
    requestAnimationFrame((stamp) => this.tick(stamp));
  }

  add(run) {
    const stage = new Stage(run, at("maps"), {
      changed: () => this.changed(), scene: (s) => this.begun(s), picked: (number) => this.follow(this.followed === number ? null : number),
      dragged: () => this.follow(null), moved: (s) => this.moved(s), ended: (s) => this.ended(s), fault,
    });
    this.stages.push(stage);
    return stage;
  }

  changed() { this.dirty = true; }

  // A scene has come: a run that lives is followed, another one plays from its beginning.
  begun(stage) {
    stage.view.followed = this.followed;
    this.span();
    if (stage === this.stages[0]) {
      if (stage.reel.live()) this.clock.follow();
      else {
        this.clock.now = this.clock.first;
        this.clock.playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.clock.following = false;
      }
    }
    else if (this.alike(stage)) stage.view.lookAs(this.stages[0].view);
    this.heading();
    this.changed();
  }

  // Maps of one place show the same part of it: that is what makes two runs comparable.
  alike(stage) {
    const [a, b] = [stage.reel.scene, this.stages[0].reel.scene];
    return Boolean(a && b) && drawnAlike(a.place, b.place);
  }
  moved(stage) {
    for (const other of this.stages) if (other !== stage && this.alike(other) && this.alike(stage)) other.view.lookAs(stage.view);
  }

  ended(stage) {
    this.heading();
    if (stage.told) this.controls.announce(`the run ${stage.run} has ended`, true);
  }

  heading() {
    const { reel, run } = this.stages[0], scene = reel.scene;
    say(at("title"), scene ? `${plain(scene.title)} · ${plain(scene.location)}` : run);
    say(at("facts"), scene ? `${plain(scene.planner)} · seed ${scene.seed}` : "");
    document.title = (scene ? `${plain(scene.title)} · ${plain(scene.planner)}, seed ${scene.seed}` : run) + " · SocRATES";
    const recording = this.stages[0].recording();
    at("recording").hidden = !recording;
    if (recording) at("recording").href = recording;
    for (const stage of this.stages) {
      const s = stage.reel.scene;
      say(stage.view.caption, stage.run + (s ? ` · ${plain(s.planner)}, seed ${s.seed}` : ""));
    }
  }

  // Chooses the run that the panel and the caption are about.
  read(index) {
    this.about = Math.min(index, this.stages.length - 1);
    this.panel.load(this.stages[this.about].reel);
    const whose = at("whose");
    whose.hidden = this.stages.length < 2;
    whose.textContent = "";
    if (this.stages.length > 1) this.stages.forEach((stage, i) => {
      const button = press(stage.run, whose, () => this.read(i));
      button.title = stage.run;
      button.setAttribute("aria-pressed", String(i === this.about));
    });
    this.paneled = 0;
    this.changed();
  }

  beside(run) {
    while (this.stages.length > 1) this.stages.pop().close();
    if (run) this.add(run);
    at("maps").classList.toggle("two", this.stages.length > 1);
    const address = new URL(location.href);
    if (run) address.searchParams.set("beside", run); else address.searchParams.delete("beside");
    history.replaceState(null, "", address);
    this.chosen = run;
    this.offer();
    this.span();
    this.read(0);
    this.heading();
  }

  // The runs that can stand beside this one.
  async offer() {
    let all = [];
    try { all = await runs(); } catch { return; }
    const select = at("beside"), names = all.map((r) => r.run).filter((name) => name !== this.stages[0].run).sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
    if (this.chosen && !names.includes(this.chosen)) names.push(this.chosen);
    if (select.dataset.key !== names.join("\n")) {
      select.dataset.key = names.join("\n");
      select.textContent = "";
      word("option", "nothing", select).value = "";
      for (const name of names) word("option", name, select).value = name;
    }
    select.value = this.chosen || "";
    at("beside-label").hidden = names.length === 0;
  }

  listen() {
    const { clock } = this;
    const each = (does) => { for (const stage of this.stages) if (stage === this.stages[0] || !this.alike(stage)) does(stage); };
    const zoom = (by) => each((stage) => stage.view.camera.zoom(by));
    const pan = (across, down) => { this.follow(null); each((stage) => stage.view.camera.pan(across * PAN_SHARE, down * PAN_SHARE)); };
    keys({
      " ": () => this.toggle(), ArrowLeft: () => pan(-1, 0), ArrowRight: () => pan(1, 0), ArrowUp: () => pan(0, -1), ArrowDown: () => pan(0, 1),
      ShiftArrowLeft: () => this.go(clock.now - HOP_SECS), ShiftArrowRight: () => this.go(clock.now + HOP_SECS), ",": () => this.step(-1), ".": () => this.step(1),
      "[": () => this.event(-1), "]": () => this.event(1), Home: () => this.go(clock.first), End: () => (this.alive() ? this.live() : this.go(clock.last)),
      l: () => this.live(), f: () => this.robot(), "+": () => zoom(1.4), "=": () => zoom(1.4), "-": () => zoom(1 / 1.4),
      0: () => { this.follow(null); each((stage) => stage.view.camera.show("whole")); }, "?": () => at("help").showModal(),
    });
    at("help-open").addEventListener("click", () => at("help").showModal());
    // A press beside the help closes it, as Escape does.
    at("help").addEventListener("click", (e) => { if (e.target === at("help")) at("help").close(); });
    addEventListener("resize", () => this.changed());
  }

  robot() {
    if (this.followed === 0) this.follow(null);
    else if (this.stages.some((s) => s.reel.scene && s.reel.scene.agents.some((a) => a.number === 0))) this.follow(0);
  }
  alive() { return this.stages.some((s) => s.reel.scene && s.reel.live()); }
  linked() { return this.stages.some((s) => s.reel.scene && s.reel.live() && s.link === "open"); }
  toggle() { this.clock.toggle(this.alive()); }
  go(t) { this.clock.go(t); }
  live() { if (this.alive()) this.clock.follow(); }
  step(ticks) {
    const step = this.stages[0].reel.step || 0.01;
    this.go((Math.round(this.clock.now / step) + ticks) * step);
  }
  event(way) {
    const { now } = this.clock, times = this.stages[this.about].reel.events.map((e) => e.t);
    const next = way > 0 ? times.find((t) => t > now + 0.06) : times.reverse().find((t) => t < now - 0.06);
    this.go(next === undefined ? (way > 0 ? this.clock.last : this.clock.first) : next);
  }
  pace(speed) {
    this.clock.speed = speed;
    // What is newest cannot be played slower and stay the newest.
    if (this.clock.following && speed !== 0 && speed < 1) { this.clock.following = false; this.clock.playing = true; }
    this.changed();
  }
  follow(number) {
    if (this.followed === number) return;
    this.followed = number;
    this.panel.followed = number;
    for (const stage of this.stages) stage.view.followed = number;
    this.changed();
  }

  span() {
    const known = this.stages.filter((s) => s.reel.scene).map((s) => s.reel);
    if (known.length === 0) return;
    this.clock.first = Math.min(...known.map((r) => r.first_s()));
    this.clock.last = Math.max(...known.map((r) => r.last_s()));
  }

  tick(stamp) {
    requestAnimationFrame((next) => this.tick(next));
    this.span();
    const heads = this.stages.map((s) => (s.reel.scene && s.reel.live() ? s.head.at(stamp, s.reel.scene.pace) : null)).filter((t) => t !== null);
    const alive = heads.length > 0 ? heads[0] : null;
    const moved = this.clock.advance(stamp, alive, alive === null && this.alive()), rate = this.clock.playing && !this.clock.following ? this.clock.rate() : 0;
    const pace = (stage) => Math.max(1, stage.head.rate(stage.reel.scene.pace)), follows = (stage) => this.clock.following && stage.reel.live();
    if (stamp - this.aimed > AIM_MS) {
      this.aimed = stamp;
      for (const stage of this.stages) {
        if (!stage.reel.scene) continue;
        const now = Math.min(this.clock.now, stage.reel.last_s());
        if (follows(stage)) stage.reel.aim(now, pace(stage), true); else stage.reel.aim(now, this.clock.following ? 1 : rate, false);
      }
    }
    if (moved || this.dirty) {
      this.dirty = false;
      for (const stage of this.stages) if (stage.reel.scene) stage.draw(this.clock.now, follows(stage) ? pace(stage) * PATIENCE : this.clock.following ? 1 : rate);
      seen.drawn++;
      this.late = true;
    }
    // Words and slider change less often than the picture: each time the browser lays out the page anew.
    if (this.late && (stamp - this.written > CONTROLS_MS || !this.clock.playing)) {
      this.late = false; this.written = stamp;
      this.controls.show(this.stages[this.about].reel, this.alive() ? alive : null, this.stages[0].reel.scene ? this.stages[0].reel.state : "waiting", this.linked());
    }
    for (const stage of this.stages) stage.line.drawn();
    if (stamp - this.paneled > PANEL_MS) { this.paneled = stamp; this.refresh(); }
    this.report();
  }

  refresh() {
    const stage = this.stages[this.about], first = this.stages[0];
    for (const s of this.stages) s.tell();
    this.panel.show(this.clock.now, stage.view.moment || null);
    if (stage.reel.scene) { this.controls.people(stage.reel.scene.agents, this.followed); this.controls.ticks(stage.reel); }
    const lag = at("lag"), late = first.lag !== null && first.lag > AMBER_MS;
    lag.className = late ? "slow" : "quiet";
    say(lag, first.lag === null ? "" : `${late ? "▲ " : ""}${Math.round(first.lag)} ms behind`);
    const left = [first.skipped ? `frames left out: ${first.skipped}` : "", first.reel.lost ? `ticks lost on the way: ${first.reel.lost}` : ""].filter(Boolean);
    at("skipped").hidden = left.length === 0;
    say(at("skipped"), left.join(" · "));
  }

  report() {
    const [first] = this.stages;
    seen.frames = this.stages.reduce((sum, s) => sum + s.received, 0);
    seen.acked = this.stages.reduce((sum, s) => sum + s.line.acked, 0);
    seen.behind_ms = first.lag;
    seen.time_s = this.clock.now;
    seen.live = this.clock.following && this.linked();
    seen.agents = first.view.moment ? first.view.moment.a.n : 0;
    seen.renderer = first.view.renderer;
  }
}

function open() {
  const wish = new URLSearchParams(location.search), parts = /\/run\/([^/]+)\/?$/.exec(location.pathname);
  document.body.classList.toggle("embed", wish.get("embed") === "1");
  at("home").href = new URL("../?list=1", import.meta.url).href;
  if (!parts) { showList(wish.get("list") !== "1"); return; }
  at("run-page").hidden = false;
  let run = parts[1];
  try { run = decodeURIComponent(run); } catch { /* the name stays as it was written */ }
  new App(run, wish.get("beside"));
}

// An address from elsewhere brings its token behind the #, which no server is sent: it is handed in once, and the answer keeps this page in.
async function enter() {
  const token = /^#token=([A-Za-z0-9]+)$/.exec(location.hash);
  if (!token) return;
  await fetch(url("enter"), { method: "POST", headers: { Authorization: "Bearer " + token[1] } }).catch(fault);
  history.replaceState(null, "", location.pathname + location.search);
}

addEventListener("hashchange", () => enter().then(() => location.reload()));
enter().then(open);
