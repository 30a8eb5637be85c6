"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const NS = "http://www.w3.org/2000/svg";
  const SAYS = ["", "WAIT", "PROCEED", "ACKNOWLEDGED", "EXCUSE ME", "FOLLOW ME"];
  const MARKS = { // color, path around 0 0, words of the legend
    leaf: ["#767d87", "M-1.5 -6h3v12h-3z", "starts to do something"],
    sees: ["#56b4e9", "M0 -5a5 5 0 1 0 .01 0z", "sees the robot"],
    gesture: ["#e69f00", "M-5 -5h10v10h-10z", "gesture"],
    encounter: ["#00795c", "M0 -7l7 7l-7 7l-7 -7z", "encounter"],
    contact: ["#b3400b", "M0 -7l7 12h-14z", "touches"],
    stuck: ["#b3400b", "M-6 -2h12v4h-12z", "stuck"],
    door: ["#8a5216", "M-4 -7h3v14h-3zM1 -7h3v14h-3z", "door"],
    goal: ["#0072b2", "M-4 -7h2v14h-2zM-2 -7l9 4l-9 4z", "at the goal"],
  };
  const TOP = ["success", "time_to_goal", "path_length", "path_efficiency", "human_collisions", "wall_collisions",
    "human_distance_min", "ttc_min", "near_misses", "stalled_time"];
  const ZONES = [["zone_intimate", "#b3400b", "intimate"], ["zone_personal", "#e69f00", "personal"],
    ["zone_social", "#56b4e9", "social"], ["zone_public", "#cfd6de", "public"]];
  const STANDINGS = { holds: ["✔", ""], late: ["✔", "late"], not_triggered: ["✘", "not triggered"], fails: ["✘", "fails"], not_applicable: ["–", "not judged"] };
  const plain = (text) => text.replace(/_/g, " ");
  const secs = (t) => t.toFixed(1) + " s";
  const make = (tag, attrs, parent) => {
    const node = document.createElementNS(NS, tag);
    for (const key in attrs) node.setAttribute(key, attrs[key]);
    if (parent) parent.appendChild(node);
    return node;
  };
  const word = (tag, text, parent, look) => {
    const node = document.createElement(tag);
    if (look) node.className = look;
    node.textContent = text;
    if (parent) parent.appendChild(node);
    return node;
  };
  // Text in which `names` are set as code.
  const words = (tag, text, parent) => {
    const node = word(tag, "", parent);
    text.split("`").forEach((part, i) => { if (part) node.appendChild(i % 2 ? word("code", part) : document.createTextNode(part)); });
    return node;
  };
  let run = null, shapes = [], doors = [], story = [], frame = 0, playing = false, last = 0, cursor = null, plot = null;
  let focused = data.focus[2] < data.whole[2] - 1 || data.focus[3] < data.whole[3] - 1;
  if (focused) at("zoom").hidden = false;

  function play(on) {
    playing = on;
    at("play").textContent = on ? "❚❚" : "▶";
    at("play").setAttribute("aria-label", on ? "pause" : "play");
  }
  function jump(t) {
    play(false); show(t * run.hz);
    const box = at("picture").getBoundingClientRect();
    if (box.top < 0 || box.bottom > innerHeight) at("stage").scrollIntoView({ block: "start" });
  }
  function timeButton(t, parent) {
    const b = word("button", secs(t), parent);
    b.type = "button";
    b.addEventListener("click", () => jump(t));
  }

  function choose(index) {
    run = data.runs[index];
    if (!run) return;
    [...at("runs").querySelectorAll("tbody tr")].forEach((row, i) => row.setAttribute("aria-current", String(i === index)));
    at("verdict").textContent = plain(run.verdict);
    at("verdict").className = "verdict" + (run.verdict.startsWith("realised") ? " good" : "");
    at("gap").textContent = gap(run);
    at("gap").title = Object.entries(run.gaps).map(([who, s]) => who + " " + secs(s)).join(", ");
    at("robot").textContent = run.success ? "arrived, no collision" : "no success";
    at("planner").textContent = run.planner; at("seed").textContent = run.seed; at("simulated").textContent = secs(run.simulated);
    at("verdict-text").textContent = run.verdict_text;
    at("robot-text").textContent = "Robot: " + run.robot_text;
    at("trails").textContent = ""; at("agents").textContent = "";
    doors = run.doors.map((d) => ({ ...d, node: make("path", { stroke: "#a8641c", "vector-effect": "non-scaling-stroke", fill: "none" }, at("trails")) }));
    shapes = run.agents.map((agent) => {
      const trail = make("polyline", { fill: "none", stroke: agent.color, "stroke-width": 3, opacity: 0.6, "stroke-linejoin": "round" }, at("trails"));
      const group = make("g", {}, at("agents"));
      const ring = make("circle", { r: agent.radius * 1.7, fill: "none", stroke: "#e69f00", "vector-effect": "non-scaling-stroke", "stroke-width": 3 }, group);
      const turned = make("g", {}, group), r = agent.radius;
      make("circle", { r, fill: agent.color, stroke: "#fff", "stroke-width": 1.5, "vector-effect": "non-scaling-stroke" }, turned);
      if (agent.number === 0) make("path", { d: `M${r * 0.75} 0L${-r * 0.45} ${r * 0.55}L${-r * 0.2} 0L${-r * 0.45} ${-r * 0.55}z`, fill: "#fff" }, turned);
      else make("line", { x1: 0, y1: 0, x2: r, y2: 0, stroke: "#fff", "stroke-width": 2.5 }, turned);
      const name = make("text", { "text-anchor": "middle", "font-weight": 600, fill: agent.words, stroke: "#fff", "paint-order": "stroke", "stroke-linejoin": "round" }, group);
      name.textContent = agent.name.replace("human_", "h");
      const bubble = make("rect", { fill: "#fff4d6", stroke: "#b07a00", "vector-effect": "non-scaling-stroke" }, group);
      const says = make("text", { "text-anchor": "middle", "font-weight": 700, fill: "#1f2328" }, group);
      return { agent, trail, group, ring, turned, name, bubble, says };
    });
    at("time").max = Math.max(1, ...run.agents.map((a) => a.track.length)) - 1;
    fillLists();
    lay();
    show(0);
  }
  function gap(r) {
    const all = Object.values(r.gaps).map(Math.abs);
    return all.length ? secs(Math.max(...all)) + (all.length > 1 ? " at most" : "") : "none";
  }

  // Everything that depends on the size of the window.
  function lay() {
    if (!run) return;
    const box = focused ? data.focus : data.whole, map = at("map");
    map.setAttribute("viewBox", box.join(" "));
    at("zoom").textContent = focused ? "whole map" : "where it happens";
    const shown = map.getBoundingClientRect();
    const k = Math.max(box[2] / Math.max(shown.width, 1), box[3] / Math.max(shown.height, 1));
    for (const s of shapes) {
      s.name.setAttribute("font-size", 14 * k); s.name.setAttribute("stroke-width", 4 * k);
      s.says.setAttribute("font-size", 14 * k); s.k = k; s.top = box[1];
    }
    const bar = at("scale"); bar.textContent = "";
    const metres = [0.5, 1, 2, 5, 10, 20, 50].find((m) => m * data.px_per_m / k >= 50) || 100;
    const x = box[0] + 14 * k, y = box[1] + box[3] - 14 * k, w = metres * data.px_per_m;
    make("rect", { x: x - 6 * k, y: y - 12 * k, width: w + 52 * k, height: 20 * k, fill: "#fff", opacity: 0.85, rx: 3 * k }, bar);
    make("path", { d: `M${x} ${y - 4 * k}v${8 * k}M${x} ${y}h${w}M${x + w} ${y - 4 * k}v${8 * k}`, stroke: "#5b636e", "stroke-width": 2 * k }, bar);
    make("text", { x: x + w + 7 * k, y: y + 4 * k, "font-size": 12 * k, fill: "#3b3f46" }, bar).textContent = metres + " m";
    drawTimeline();
    show(frame);
  }

  function show(next) {
    frame = Math.max(0, Math.min(next, Number(at("time").max)));
    const index = Math.floor(frame + 1e-6), now = frame / run.hz;
    at("time").value = index;
    at("time").setAttribute("aria-valuetext", secs(now));
    at("clock").textContent = secs(now);
    for (const s of shapes) {
      const track = s.agent.track, p = track[Math.min(index, track.length - 1)];
      if (!p) continue;
      const q = track[Math.min(index + 1, track.length - 1)], u = Math.max(0, frame - index);
      const x = p[0] + (q[0] - p[0]) * u, y = p[1] + (q[1] - p[1]) * u, k = s.k || 1, r = s.agent.radius;
      s.group.setAttribute("transform", `translate(${x} ${y})`);
      s.turned.setAttribute("transform", `rotate(${-p[2] * 180 / Math.PI})`);
      const said = SAYS[p[3]] || "";
      s.ring.setAttribute("opacity", said ? 1 : 0);
      const below = y - r - 48 * k < s.top;
      const rim = said ? r * 1.7 : r;
      s.name.setAttribute("y", below ? rim + 15 * k : -rim - 5 * k);
      s.says.textContent = said;
      s.bubble.setAttribute("opacity", said ? 1 : 0);
      if (said) {
        const base = below ? rim + 37 * k : -rim - 28 * k, w = s.says.getComputedTextLength() + 14 * k;
        s.says.setAttribute("y", base);
        for (const [key, value] of Object.entries({ x: -w / 2, y: base - 16 * k, width: w, height: 22 * k, rx: 5 * k })) s.bubble.setAttribute(key, value);
      }
      s.trail.setAttribute("points", track.slice(0, index + 1).map((t) => t[0] + "," + t[1]).join(" ") + ` ${x},${y}`);
    }
    for (const d of doors) {
      let open = false;
      for (const [t, state] of d.times) if (t <= now + 1e-6) open = state;
      const [x1, y1, x2, y2] = d.line, part = open ? 0.14 : 0.5, dx = (x2 - x1) * part, dy = (y2 - y1) * part;
      d.node.setAttribute("d", `M${x1} ${y1}l${dx} ${dy}M${x2} ${y2}l${-dx} ${-dy}`);
      d.node.setAttribute("stroke-width", open ? 4 : 5);
    }
    const recent = run.events.filter(([t]) => t <= now + 0.05 && now - t < 2.5), newest = recent.length ? recent[recent.length - 1][0] : 0;
    const told = recent.filter(([t]) => t === newest).map((e) => e[3]);
    at("caption").textContent = told.length ? secs(newest) + " · " + told.join(", ") : "";
    for (const [t, item] of story) item.className = t <= now + 0.05 ? "" : "later";
    if (cursor) cursor.setAttribute("transform", `translate(${plot.left + now * plot.k} 0)`);
  }

  function drawTimeline() {
    const box = at("timeline"), width = Math.max(280, box.clientWidth), narrow = width < 600;
    const left = narrow ? 66 : 92, lane = 24, lanes = run.agents, h = lanes.length * lane + 24;
    const total = Number(at("time").max) / run.hz, k = (width - left - 12) / Math.max(total, 0.1);
    plot = { left, k };
    // The thumb of a range is 16 px wide: its middle then stands right above the cursor.
    at("time").style.marginLeft = left - 8 + "px"; at("time").style.width = width - left - 12 + 16 + "px";
    box.textContent = "";
    const svg = make("svg", { viewBox: `0 0 ${width} ${h}`, height: h, "aria-hidden": "true" }, box);
    const steps = [1, 2, 5, 10, 20, 30, 60, 120].find((s) => s * k >= 44) || 300;
    for (let t = 0; t <= total; t += steps) {
      make("line", { x1: left + t * k, x2: left + t * k, y1: 0, y2: h - 18, stroke: "#eceff2" }, svg);
      make("text", { x: left + t * k, y: h - 4, "font-size": 12, "text-anchor": "middle", fill: "#5b636e" }, svg).textContent = t + " s";
    }
    lanes.forEach((agent, i) => {
      make("line", { x1: left, y1: i * lane + 14, x2: width - 12, y2: i * lane + 14, stroke: "#ccd2d9" }, svg);
      make("text", { x: 0, y: i * lane + 18, "font-size": 13, fill: agent.words, "font-weight": 600 }, svg).textContent = agent.name;
    });
    cursor = make("line", { x1: 0, x2: 0, y1: 0, y2: h - 18, stroke: "#1f2328", "stroke-width": 1.4 }, svg);
    const used = Object.keys(MARKS).filter((kind) => run.events.some((e) => e[2] === kind));
    for (const wanted of used) for (const [t, who, kind, text] of run.events) {
      const i = lanes.findIndex((a) => a.number === who);
      if (kind !== wanted || i < 0) continue;
      const mark = make("path", { d: MARKS[kind][1], transform: `translate(${left + t * k} ${i * lane + 14})`, fill: MARKS[kind][0], stroke: "#fff", style: "cursor:pointer" }, svg);
      make("title", {}, mark).textContent = secs(t) + "  " + text;
      mark.addEventListener("click", () => { play(false); show(t * run.hz); });
    }
    const legend = at("legend"); legend.textContent = "";
    for (const kind of used) {
      const part = word("span", "", legend);
      make("path", { d: MARKS[kind][1], fill: MARKS[kind][0] }, make("svg", { viewBox: "-8 -8 16 16", "aria-hidden": "true" }, part));
      part.append(MARKS[kind][2]);
    }
  }

  function fillLists() {
    for (const [id, setup] of [["setup", true], ["outcome", false]]) {
      const list = at(id); list.textContent = "";
      const clauses = run.clauses.filter((c) => c.setup === setup);
      const good = (c) => c.standing === "holds" || c.standing === "late", judged = (c) => c.standing !== "not_applicable";
      const needed = clauses.filter((c) => c.must && judged(c)), open = clauses.filter((c) => !judged(c)).length;
      at(id + "-sum").textContent = (needed.length ? `${needed.filter(good).length} of ${needed.length} needed` : "") + (open ? ` · ${open} not judged` : "");
      for (const c of clauses) {
        const [sign, state] = STANDINGS[c.standing] || ["–", plain(c.standing)];
        const item = words("li", c.text, list);
        item.className = good(c) ? "" : c.standing === "not_applicable" ? "na" : "no";
        word("b", sign, item).setAttribute("aria-label", plain(c.standing));
        if (state) word("span", state, item, "tag state");
        if (!c.must) word("span", "optional", item, "tag");
        for (const t of [...new Set(c.times.map((x) => x.toFixed(1)))].slice(0, 3)) timeButton(Number(t), item);
        words("small", c.evidence, item);
      }
      if (!clauses.length) { const none = word("li", "nothing to judge", list, "na"); word("b", "–", none); }
    }
    at("story").textContent = "";
    story = run.story.map((line) => {
      const parts = /^\s*([\d.]+) s\s+(.*)$/.exec(line), item = word("li", "", at("story"));
      if (parts) timeButton(Number(parts[1]), item); else word("span", "", item);
      words("span", parts ? parts[2] : line, item);
      return [parts ? Number(parts[1]) : 0, item];
    });
    const top = at("top").tBodies[0]; top.textContent = "";
    for (const id of TOP) {
      const m = run.metrics.find((x) => x.id === id);
      if (!m) continue;
      const row = word("tr", "", top);
      word("th", plain(m.id), row).scope = "row";
      word("td", value(m), row, "n").title = m.note || "";
      word("td", better(m), row, "quiet");
    }
    const zones = at("zones"), parts = ZONES.map(([id, color, name]) => [run.metrics.find((m) => m.id === id), color, name]);
    zones.textContent = "";
    if (parts.every(([m]) => m && m.value !== null)) {
      word("div", "Time in each zone of the nearest person", zones, "quiet").style.marginTop = "12px";
      const bar = word("div", "", zones, "bar");
      for (const [m, color] of parts) { const piece = word("div", "", bar); piece.style.cssText = `width:${m.value}%;background:${color}`; }
      for (const [m, color, name] of parts) { const s = word("span", "", zones); word("i", "", s).style.background = color; s.append(`${name} ${m.value.toFixed(0)} %`); }
    }
  }
  const better = (m) => (m.direction > 0 ? "more is better" : m.direction < 0 ? "less is better" : "");
  function value(m) {
    if (!m || m.value === null) return "n/a";
    const v = m.value === 0 ? 0 : m.value, size = Math.abs(v);
    if (m.unit === "0/1") return v === 1 ? "yes" : v === 0 ? "no" : v.toFixed(2);
    if (m.unit === "count") return Number.isInteger(v) ? String(v) : v.toFixed(2);
    const number = size >= 100 ? v.toFixed(0) : size > 0 && size < 0.01 ? v.toPrecision(2) : v.toFixed(2);
    return number + " " + m.unit.replace(/\^2/g, "²").replace(/\^3/g, "³").replace(/\*/g, "·").replace("share", "").trim();
  }
  function heading(table, names) {
    const row = word("tr", "", word("thead", "", table));
    names.forEach((name) => { word("th", name, row).scope = "col"; });
    return word("tbody", "", table);
  }

  function fillOnce() {
    const body = heading(at("runs"), ["run", "verdict", "encounter gap", "success", "time to goal", "smallest distance"]);
    data.runs.forEach((r, i) => {
      const row = word("tr", "", body), of = (id) => value(r.metrics.find((m) => m.id === id));
      const b = word("button", r.name, word("td", "", row));
      b.type = "button";
      b.addEventListener("click", () => { play(false); choose(i); });
      word("td", plain(r.verdict), row, r.verdict.startsWith("realised") ? "" : "bad");
      for (const text of [gap(r), r.success ? "yes" : "no", of("time_to_goal"), of("human_distance_min")]) word("td", text, row);
    });
    at("compare").hidden = data.runs.length < 2;
    const all = heading(at("metrics"), ["metric", ...data.runs.map((r) => r.name), "", "note"]);
    for (const m of data.runs.length ? data.runs[0].metrics : []) {
      const row = word("tr", "", all);
      word("th", plain(m.id), row).scope = "row";
      for (const r of data.runs) word("td", value(r.metrics.find((x) => x.id === m.id)), row);
      word("td", better(m), row, "quiet"); word("td", m.note || "", row, "quiet");
    }
  }

  function tick(now) {
    if (playing && run) {
      const speed = Number(at("speed").value), total = Number(at("time").max);
      const rate = speed === 0 ? Math.max(total / 10, run.hz) : speed * run.hz;
      show(frame + (Math.min(now - last, 100) / 1000) * rate);
      if (frame >= total) play(false);
    }
    last = now;
    requestAnimationFrame(tick);
  }
  function toggle() {
    if (!run) return;
    if (!playing && frame >= Number(at("time").max)) show(0);
    play(!playing);
  }

  at("play").addEventListener("click", toggle);
  at("zoom").addEventListener("click", () => { focused = !focused; lay(); });
  at("time").addEventListener("input", (e) => { if (run) { play(false); show(Number(e.target.value)); } });
  addEventListener("resize", lay);
  addEventListener("keydown", (e) => {
    if (!run || e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|BUTTON|SUMMARY)$/.test(e.target.tagName)) return;
    if (e.key === " ") toggle();
    else if (e.key === "ArrowRight" || e.key === "ArrowLeft") { play(false); show(frame + (e.key === "ArrowRight" ? 5 : -5)); }
    else return;
    e.preventDefault();
  });
  // Without a size of its own the map takes the shape of what it shows.
  at("map").removeAttribute("width"); at("map").removeAttribute("height");
  fillOnce();
  choose(0);
  play(data.runs.length > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  requestAnimationFrame((now) => { last = now; tick(now); });
})();
