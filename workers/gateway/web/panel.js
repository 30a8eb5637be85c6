// The panel beside the map: checklist, events, metrics, people. What it says comes from the gateway; it computes nothing.
import { GESTURE, SEES, THERE, place } from "./wire.js";
import { SAYS, at, color, plain, press, put, say, secs, value, word } from "./words.js";

// Sign, words, look of each standing.
const STANDINGS = {
  open: ["○", "open", "open"], holds: ["✔", "holds", ""], late: ["✔", "late", ""], not_triggered: ["✘", "not triggered", "no"],
  fails: ["✘", "fails", "no"], not_applicable: ["–", "not judged", "na"],
};
const VERDICTS = { realised: ["✔", "good"], not_realised: ["✘", "bad"] };
// Rows that a list shows at once: more of them slow the page down and nobody reads them.
const MOST_ROWS = 200;
const MOST_PEOPLE = 60;
// A live picture is this far behind its judgment and still the newest, s of the run.
const BEHIND_SECS = 0.3;

export class Panel {
  /** `go(t)` shows a time, `follow(number)` follows somebody or, with null, nobody. */
  constructor(go, follow) {
    this.go = go; this.follow = follow; this.reel = null; this.kind = "";
    this.forget();
    for (const tab of document.querySelectorAll("#tabs button")) tab.addEventListener("click", () => this.choose(tab));
    at("tabs").addEventListener("keydown", (e) => {
      const tabs = [...document.querySelectorAll("#tabs button")], i = tabs.indexOf(e.target);
      const step = e.key === "ArrowRight" ? 1 : e.key === "ArrowLeft" ? -1 : 0;
      if (i < 0 || step === 0) return;
      e.preventDefault(); e.stopPropagation();
      const next = tabs[(i + step + tabs.length) % tabs.length];
      next.focus(); this.choose(next);
    });
    at("kind").addEventListener("change", () => { this.kind = at("kind").value; this.events = -1; this.from = -1; });
    at("find").addEventListener("input", () => { this.people = null; });
  }

  forget() { this.standing = null; this.clauses = ""; this.metrics = null; this.events = -1; this.people = null; this.from = -1; this.items = []; }

  choose(tab) {
    for (const other of document.querySelectorAll("#tabs button")) {
      const on = other === tab;
      other.setAttribute("aria-selected", String(on)); other.tabIndex = on ? 0 : -1;
      at(other.getAttribute("aria-controls")).hidden = !on;
    }
    this.people = null; this.events = -1;
  }

  load(reel) {
    this.reel = reel;
    this.forget();
    for (const list of ["clauses", "events", "metrics", "people"]) at(list).textContent = "";
    word("li", "nothing yet", at("clauses"), "na");
    word("li", "nothing has happened yet", at("events"), "quiet");
    for (const line of ["clauses-sum", "metrics-when", "events-sum", "people-sum"]) say(at(line), "");
    say(at("verdict"), "not yet judged");
    at("verdict").className = "verdict";
  }

  timeButton(t, parent) {
    press(secs(t), parent, () => this.go(t), "when").setAttribute("aria-label", "show " + secs(t));
  }

  /** Brings everything up to the shown time; cheap where nothing is new. */
  show(t, moment) {
    if (!this.reel || !this.reel.scene) return;
    this.showStanding(t);
    this.showEvents(t);
    if (!at("people-page").hidden) this.showPeople(moment);
  }

  showStanding(t) {
    const standing = this.reel.standing;
    if (standing && standing !== this.standing) {
      this.standing = standing;
      // The list is built anew only where a clause has changed: somebody may have put the focus into it.
      const clauses = JSON.stringify([standing.clauses, standing.verdict, standing.final]);
      if (clauses !== this.clauses) { this.clauses = clauses; this.items = []; this.fillClauses(standing); }
      this.fillMetrics(standing);
    }
    if (this.standing) this.judge(this.standing, t);
  }

  // The checklist as of the shown time: what was seen later is still open.
  judge(standing, t) {
    const newest = t >= Math.min(standing.time_s, this.reel.last_s()) - (standing.final ? 0.05 : BEHIND_SECS), clauses = standing.clauses || [];
    let judged = 0;
    for (const row of this.items) {
      const { clause, item, sign, state, when } = row, [is, at_s] = newest ? [clause.standing, clause.at_s] : this.reel.stood(clause, t), [mark, words, look] = STANDINGS[is] || ["–", plain(is), "na"];
      if (is !== "open") judged++;
      const later = !newest && is === "open" && clause.standing !== "open", full = look + (later ? " later" : "");
      if (item.className !== full) item.className = full;
      say(sign, mark); say(state, words);
      row.to = (later ? clause.at_s : at_s) ?? null;
      when.hidden = row.to === null;
      const told = when.hidden ? "" : (later ? "→ " : "") + secs(row.to);
      if (when.hidden || when.textContent === told) continue;
      say(when, told);
      when.setAttribute("aria-label", (later ? "go on to " : "show ") + secs(row.to));
      when.title = later ? "seen later than the time shown" : "";
    }
    const moment = newest ? (standing.final ? "" : standing.time_s) : t;
    say(at("clauses-sum"), clauses.length ? `${judged} of ${clauses.length} judged` + (moment === "" ? "" : ` · as of ${secs(moment)}`) : "");
    const [mark, look] = VERDICTS[standing.verdict] || ["", ""], verdict = standing.verdict ? (mark ? mark + " " : "") + plain(standing.verdict) : "not yet judged";
    const early = !newest && Boolean(standing.verdict);
    say(at("verdict"), early ? "in the end " + verdict : verdict);
    at("verdict").className = "verdict " + (early ? "" : look);
    const whole = standing.final ? "of the whole run" : "as of " + secs(standing.time_s);
    say(at("metrics-when"), whole + (newest ? "" : ", not of the time shown"));
  }

  fillClauses(standing) {
    const list = at("clauses"), kept = list.scrollTop;
    list.textContent = "";
    const clauses = standing.clauses || [];
    for (const [part, title] of [["setup", "Did it happen?"], ["outcome", "What the robot did"]]) {
      const mine = clauses.filter((c) => c.part === part);
      if (mine.length === 0) continue;
      word("li", title, list, "part");
      for (const c of mine) {
        const item = word("li", "", list);
        put(word("span", "", item, "text"), c.text);
        const sign = word("b", "", item), state = word("span", "", item, "tag state");
        sign.setAttribute("aria-hidden", "true");
        const row = { clause: c, item, sign, state, to: null };
        row.when = press("", item, () => this.go(row.to), "when");
        word("code", c.id, item, "id");
        this.items.push(row);
      }
    }
    if (clauses.length === 0) word("li", "nothing to judge", list, "na");
    list.scrollTop = kept;
  }

  fillMetrics(standing) {
    const metrics = standing.metrics || [], body = at("metrics");
    const same = this.metrics && this.metrics.length === metrics.length && metrics.every((m, i) => m.id === this.metrics[i].id);
    if (!same) {
      body.textContent = "";
      this.cells = metrics.map((m) => {
        const row = word("tr", "", body);
        const name = word("th", m.name || plain(m.id), row); name.scope = "row"; name.title = m.id;
        return word("td", "", row, "n");
      });
    }
    this.metrics = metrics;
    metrics.forEach((m, i) => say(this.cells[i], value(m)));
  }

  // The events around the shown time; all of them where they are few.
  showEvents(t) {
    const all = this.reel.events;
    if (this.events !== all.length) {
      const kinds = [...new Set(all.map((e) => e.kind))].sort(), select = at("kind");
      if (select.options.length !== kinds.length + 1) {
        select.textContent = "";
        word("option", "all kinds", select).value = "";
        for (const kind of kinds) word("option", plain(kind), select).value = kind;
        select.value = kinds.includes(this.kind) ? this.kind : "";
      }
      this.chosen = this.kind ? all.filter((e) => e.kind === this.kind) : all;
    }
    if (at("events-page").hidden) return;
    const chosen = this.chosen, low = chosen.findIndex((e) => e.t > t + 0.05), told = low < 0 ? chosen.length : low;
    const from = Math.max(0, Math.min(chosen.length - MOST_ROWS, told - MOST_ROWS / 2)), list = at("events");
    // New events are put below the others; the window moves, and the list is built anew, only when the shown time is far from its middle.
    const fresh = this.events !== all.length, moved = Math.abs(from - this.from) > MOST_ROWS / 4 || (from === 0 && this.from !== 0);
    if (this.from < 0 || moved || this.drawn !== this.kind) {
      list.textContent = ""; this.rows = []; this.from = from; this.told = -1;
      if (chosen.length === 0) word("li", "nothing has happened yet", list, "quiet");
    }
    for (const e of chosen.slice(this.from + this.rows.length, this.from + MOST_ROWS * 1.25)) this.row(e, list);
    this.events = all.length; this.drawn = this.kind;
    say(at("events-sum"), chosen.length > MOST_ROWS ? `${chosen.length}, those around the shown time` : String(chosen.length));
    const now = told - this.from;
    if (now === this.told && !fresh) return;
    this.told = now;
    this.rows.forEach((row, i) => { row.classList.toggle("later", i >= now); row.classList.toggle("now", i === now - 1); });
    const row = this.rows[Math.max(0, Math.min(this.rows.length, now) - 1)];
    if (!row || list.matches(":hover, :focus-within")) return;
    const top = row.offsetTop;
    if (top < list.scrollTop || top + row.offsetHeight > list.scrollTop + list.clientHeight) list.scrollTop = top - list.clientHeight + row.offsetHeight + 8;
  }

  row(e, list) {
    if (this.rows.length === 0) list.textContent = "";
    const item = word("li", "", list);
    this.timeButton(e.t, item);
    put(word("span", "", item), e.text);
    this.rows.push(item);
  }

  showPeople(moment) {
    const scene = this.reel.scene;
    if (!this.people) {
      const list = at("people"), asked = at("find").value.trim().toLowerCase();
      at("find").hidden = scene.agents.length <= MOST_PEOPLE;
      const fits = asked && !at("find").hidden ? scene.agents.filter((a) => (a.id + " " + a.role).toLowerCase().includes(asked)) : scene.agents;
      list.textContent = "";
      this.people = fits.slice(0, MOST_PEOPLE).map((agent) => {
        const row = word("tr", "", list), name = word("td", "", row);
        const dot = word("i", "", name, agent.number === 0 ? "robot" : ""); dot.style.background = color(agent.number);
        const chosen = press(plain(agent.id), name, () => this.follow(chosen.getAttribute("aria-pressed") === "true" ? null : agent.number), "who");
        chosen.title = "follow " + plain(agent.id);
        if (agent.role !== agent.id) word("small", plain(agent.role), name);
        return { agent, chosen, does: word("td", "", row), speed: word("td", "", row, "n"), guess: scene.agents.indexOf(agent) };
      });
      say(at("people-sum"), fits.length > MOST_PEOPLE ? `${MOST_PEOPLE} of ${fits.length} shown` : "");
    }
    for (const p of this.people) {
      p.chosen.setAttribute("aria-pressed", String(this.followed === p.agent.number));
      const i = moment ? place(moment.a, p.agent.number, p.guess) : -1, flags = i < 0 ? 0 : moment.a.words[8 * i + 7];
      if (!(flags & THERE)) { say(p.does, i < 0 ? "–" : "not there"); say(p.speed, ""); continue; }
      const leaf = scene.leaves && scene.leaves[flags >> 8];
      say(p.does, [leaf ? plain(leaf) : "", SAYS[flags & GESTURE] || "", flags & SEES ? "sees the robot" : ""].filter(Boolean).join(" · ") || "–");
      say(p.speed, (moment.a.words[8 * i + 5] / 1000).toFixed(1) + " m/s");
    }
  }
}
