// One run on the page: its store, its line to the gateway, and its map.
import { Head } from "./clock.js";
import { Reel } from "./model.js";
import { Line } from "./socket.js";
import { View } from "./view.js";
import { plain, press, put, runUrl, say, secs, url, word } from "./words.js";

// Words of the gateway that are no alarm go away after this long, ms.
const STATUS_MS = 15000;
const LEVELS = ["info", "warning", "error"];

export class Stage {
  /** `app` has `changed()`, `scene(stage)`, `picked(number)`, `dragged()`, `moved(stage)`, `ended(stage)`, `fault(error)`. */
  constructor(run, parent, app) {
    this.run = run; this.app = app; this.received = 0; this.lag = null; this.skipped = 0; this.link = "waiting"; this.detail = ""; this.status = null;
    this.view = new View(parent, () => app.changed(), (number) => app.picked(number));
    this.view.camera.dragged = () => app.dragged();
    this.view.camera.moved = () => app.moved(this);
    this.reel = new Reel(run, () => app.changed(), (fault) => this.stored(fault));
    this.head = new Head();
    this.zoom = word("div", "", this.view.map, "zoom");
    press("+", this.zoom, () => this.view.camera.zoom(1.4)).setAttribute("aria-label", "zoom in");
    press("−", this.zoom, () => this.view.camera.zoom(1 / 1.4)).setAttribute("aria-label", "zoom out");
    this.whole = press("whole map", this.zoom, () => this.toggleMap());
    this.notice = word("p", "", null, "notice"); this.view.map.after(this.notice); this.notice.hidden = true; this.notice.setAttribute("role", "status");
    this.loading = word("p", "loading…", this.view.map, "loading"); this.loading.hidden = true;
    this.line = new Line(run, {
      frame: (frame) => this.frame(frame), text: (message) => this.text(message),
      state: (state, detail) => this.linked(state, detail), fault: (fault) => app.fault(fault),
    });
    this.tell();
    this.line.start();
  }

  toggleMap() {
    this.app.dragged();
    const camera = this.view.camera;
    camera.show(camera.mode === "whole" && camera.area ? "area" : "whole");
  }

  frame(frame) {
    this.received++;
    this.reel.add(frame);
    this.head.arrive(frame.t, performance.now());
    this.app.changed();
  }

  text(message) {
    switch (message.op) {
      case "scene": this.setScene(message.scene); break;
      case "events": this.events(message); break;
      case "standing": this.reel.stand(message); break;
      case "gap": this.reel.lost += Math.max(0, message.to - message.from + 1); break;
      case "lag": this.lag = message.ms; this.skipped = message.skipped; break;
      case "status": this.status = { level: LEVELS.includes(message.level) ? message.level : "info", text: String(message.text), until: message.level === "error" ? Infinity : performance.now() + STATUS_MS }; this.tell(); break;
      case "end": this.end(message); break;
    }
    this.app.changed();
  }

  setScene(scene) {
    const first = !this.reel.scene, anew = this.reel.setScene(scene);
    if (anew) this.head.forget();
    this.view.load(scene);
    this.tell();
    if (first || anew) this.app.scene(this);
  }

  async events({ from, events }) {
    if (this.reel.addEvents(from, events)) return;
    // Some are missing in between, as after a pause of the line: the gateway has them all.
    try {
      const answer = await fetch(runUrl(this.run, "/events"), { cache: "no-store" });
      if (answer.ok) this.reel.addEvents(0, (await answer.json()).events);
    } catch (fault) { this.stored(fault); }
  }

  end(message) {
    const live = this.reel.live();
    this.reel.ended = message;
    this.line.finished = true;
    if (live) this.reel.state = "ended";
    this.told = live;
    this.until = performance.now() + STATUS_MS;
    this.lag = null;
    this.tell();
    this.app.ended(this);
  }

  linked(state, detail) {
    this.link = state; this.detail = detail;
    if (state === "gone") this.lag = null;
    this.tell();
  }

  // Frames or events that could not be fetched: the store asks again by itself.
  stored(fault) {
    if (!(fault instanceof TypeError)) { this.app.fault(fault); return; }
    this.missed = performance.now();
    this.tell();
  }

  /** Says on the map what the viewer waits for, if anything. */
  tell() {
    const [look, text, small] = this.state();
    this.notice.hidden = text === "";
    this.zoom.hidden = this.reel.scene === null;
    if (text === "") return;
    const key = look + text + small;
    if (this.notice.dataset.said === key) return;
    this.notice.dataset.said = key;
    this.notice.className = "notice " + look;
    put(this.notice, text);
    if (small) put(word("small", "", this.notice), small);
  }

  state() {
    const known = this.reel.scene !== null, now = performance.now();
    if (this.link === "waiting" && known) return ["warning", "⚠ The gateway does not know this run any more.", "The page keeps what it has and asks again every second."];
    if (this.link === "waiting") return ["wait", `Waiting for ${this.run} to begin…`, this.detail ? this.detail + "." : ""];
    if (this.link === "gone") return [known ? "warning" : "warning wait", "⚠ The gateway does not answer.", `${known ? "The page keeps what it has and tries" : "The page tries"} again ${this.detail >= 1000 ? `every ${Math.round(this.detail / 1000)} s` : "at once"}.`];
    if (this.missed && now - this.missed < 4000) return ["warning", "⚠ The gateway does not answer.", "What is stored here can still be seen; the rest is asked for again."];
    if (this.status && now < this.status.until) return [this.status.level, (this.status.level === "info" ? "" : "⚠ ") + this.status.text, ""];
    if (this.told && this.reel.ended && now < this.until) return ["", `The run has ended at ${secs(this.reel.ended.time_s)}: ${plain(this.reel.ended.reason || "given up")}.`, ""];
    if (known && this.reel.live() && this.received === 0) return ["wait", "The run is about to begin…", "No frame has come yet."];
    return ["", "", ""];
  }

  recording() {
    return this.reel.scene && !this.reel.live() ? url("run/" + encodeURIComponent(this.run) + "/recording.mcap").href : null;
  }

  draw(t, rate) {
    if (!this.reel.scene) return;
    const moment = this.reel.moment(t, rate);
    this.view.moment = moment;
    this.view.draw(this.reel, moment, t, rate);
    this.loading.hidden = !(moment ? moment.loading : this.reel.flying > 0 && !this.reel.live());
    this.whole.hidden = this.view.camera.mode === "whole" && !this.view.camera.area;
    say(this.whole, this.view.camera.mode === "whole" && this.view.camera.area ? "where it happens" : "whole map");
  }

  close() { this.line.close(); this.view.remove(); }
}
