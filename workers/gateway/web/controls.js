// The controls below the maps: play, time, speed, what is followed, and the keys.
import { at, plain, say, secs, word } from "./words.js";

// Colors of the marks above the slider, as in the pages of a bundle; a leaf that starts is too common to be marked.
const MARKS = { clause: "#00795c", sees: "#56b4e9", gesture: "#e69f00", encounter: "#00795c", contact: "#b3400b", wall: "#b3400b", stuck: "#b3400b", door: "#8a5216", arrived: "#0072b2", end: "#5b636e" };
const THUMB_PX = 8;
// Events younger than this are news, s.
const NEWS_SECS = 2.5;
// Words for screen readers come at most this often, ms.
const QUIET_MS = 4000;
const MOST_FOLLOWED = 60;

const MOVES = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];
// Keys that do the same again while they are held.
const HELD = [...MOVES, ",", ".", "[", "]", "+", "=", "-"];

// Whether the part of the page that has the focus does something itself with a key.
function wanted(node, key) {
  if (node.isContentEditable || /^(TEXTAREA|SELECT)$/.test(node.tagName)) return true;
  if (node.tagName === "INPUT") return node.type !== "range" || MOVES.includes(key);
  if (/^(BUTTON|SUMMARY|A)$/.test(node.tagName) && key === " ") return true;
  if (!MOVES.includes(key)) return false;
  const list = node.closest?.(".clauses, #events, .rows");
  if (list && list.scrollHeight > list.clientHeight + 1) return true;
  // On a page that is scrolled down to its panel the arrows scroll on: there is no map to be moved.
  return key.startsWith("Arrow") && at("maps").getBoundingClientRect().bottom < 40;
}

/** Keys that no field wants: `act` gives what each one does, by name. */
export function keys(act) {
  let pressed = false;
  addEventListener("keydown", (e) => {
    pressed = false;
    if (e.ctrlKey || e.metaKey || e.altKey || e.isComposing || e.key === "Enter") return;
    const help = document.querySelector("dialog[open]");
    if (help) { if (e.key === "?") { help.close(); e.preventDefault(); } return; }
    const does = act[(e.shiftKey && e.key.startsWith("Arrow") ? "Shift" : "") + e.key];
    if (!does || wanted(e.target, e.key)) return;
    e.preventDefault();
    if (!e.repeat || HELD.includes(e.key)) does();
  });
  // After a press of the mouse or a finger the keys belong to the player again; from the keyboard the focus stays.
  addEventListener("pointerdown", () => { pressed = true; }, true);
  addEventListener("click", (e) => {
    if (e.detail > 0 && e.target.closest?.("button") && !document.querySelector("dialog[open]") && document.activeElement && document.activeElement.getAttribute("role") !== "tab") document.activeElement.blur();
  });
  addEventListener("change", (e) => { if (pressed && e.target.matches?.("select, input[type=range]")) e.target.blur(); });
}

export class Controls {
  /** `app` has `clock`, `go(t)`, `toggle()`, `step(ticks)`, `live()`, `follow(number)`, `pace(speed)`. */
  constructor(app) {
    this.app = app; this.toldAt = 0; this.marks = "";
    at("play").addEventListener("click", () => app.toggle());
    at("back").addEventListener("click", () => app.step(-1));
    at("on").addEventListener("click", () => app.step(1));
    at("live").addEventListener("click", () => app.live());
    at("time").addEventListener("input", (e) => app.go(Number(e.target.value)));
    at("speed").addEventListener("change", () => app.pace(Number(at("speed").value)));
    at("follow").addEventListener("change", () => app.follow(at("follow").value === "" ? null : Number(at("follow").value)));
  }

  /** Offers to follow everybody of a small run; of a crowd the robot and the agent that was pressed. */
  people(agents, followed) {
    const select = at("follow"), shown = agents.length <= MOST_FOLLOWED ? agents : agents.filter((a) => a.number === 0 || a.number === followed);
    const key = shown.map((a) => a.number).join();
    if (select.dataset.key !== key) {
      select.dataset.key = key;
      select.textContent = "";
      word("option", "nobody", select).value = "";
      for (const agent of shown) word("option", plain(agent.id), select).value = String(agent.number);
    }
    select.value = followed === null ? "" : String(followed);
  }

  /** Draws the time; `alive` is the live time or null, `state` that of the run, `linked` says whether the gateway answers. */
  show(reel, alive, state, linked) {
    const { clock } = this.app, time = at("time");
    const low = clock.first.toFixed(3), high = clock.last.toFixed(3);
    if (time.min !== low) time.min = low;
    if (time.max !== high) time.max = high;
    time.value = clock.now;
    const words = secs(clock.now);
    if (at("clock").textContent !== words) { say(at("clock"), words); time.setAttribute("aria-valuetext", words); }
    const playing = clock.playing ? "❚❚" : "▶";
    if (at("play").textContent !== playing) { say(at("play"), playing); at("play").setAttribute("aria-label", clock.playing ? "pause" : "play"); }
    const badge = at("badge"), following = clock.following && alive !== null;
    badge.hidden = state === "waiting";
    badge.className = "badge" + (!following ? "" : linked ? " live" : " cut");
    say(badge, following ? (linked ? "LIVE" : "⚠ no signal") : alive !== null ? "−" + secs(Math.max(0, alive - clock.now)) : plain(state));
    badge.title = following ? "the newest that the gateway has sent" : alive !== null ? "behind the newest" : "";
    at("live").hidden = alive === null || following;
    this.caption(reel, clock.now);
  }

  caption(reel, t) {
    if (!reel) return;
    const told = reel.told_by(t + 0.05), newest = told > 0 ? reel.events[told - 1] : null;
    let text = "";
    if (newest) {
      const same = reel.events.slice(Math.max(0, told - 12), told).filter((e) => e.t === newest.t).map((e) => e.text.replace(/`/g, ""));
      text = secs(newest.t) + " · " + same.slice(0, 3).join(", ") + (same.length > 3 ? ", …" : "");
    }
    say(at("caption"), text);
    at("caption").className = newest && t - newest.t > NEWS_SECS ? "old" : "";
    if (newest && newest !== this.newest && newest.kind !== "leaf") this.announce(text);
    this.newest = newest;
  }

  /** For screen readers: not more than they can say. */
  announce(text, urgent = false) {
    const now = performance.now();
    if (!urgent && now - this.toldAt < QUIET_MS) return;
    this.toldAt = now;
    say(at("told"), text);
  }

  /** The marks of events above the slider. */
  ticks(reel) {
    const canvas = at("ticks"), { first, last } = this.app.clock, ratio = Math.min(2, devicePixelRatio || 1);
    const key = [reel.events.length, last.toFixed(1), canvas.clientWidth, reel.run].join(" ");
    if (key === this.marks || last <= first) return;
    this.marks = key;
    const w = canvas.clientWidth, h = canvas.clientHeight, g = canvas.getContext("2d");
    canvas.width = w * ratio; canvas.height = h * ratio;
    g.scale(ratio, ratio);
    const marked = reel.events.filter((e) => MARKS[e.kind]), wide = marked.length * 6 > w ? 1 : 2.5;
    for (const e of marked) {
      const x = THUMB_PX + (w - 2 * THUMB_PX) * (e.t - first) / (last - first);
      g.fillStyle = MARKS[e.kind];
      g.fillRect(x - wide / 2, 2, wide, h - 2);
    }
  }
}
