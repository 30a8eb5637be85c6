"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const NS = "http://www.w3.org/2000/svg";
  const GESTURES = ["", "WAIT", "PROCEED", "ACKNOWLEDGED", "EXCUSE ME", "FOLLOW ME"];
  const make = (tag, attrs, parent) => {
    const node = document.createElementNS(NS, tag);
    for (const key in attrs) node.setAttribute(key, attrs[key]);
    if (parent) parent.appendChild(node);
    return node;
  };
  const word = (tag, text, parent) => {
    const node = document.createElement(tag);
    node.textContent = text;
    parent.appendChild(node);
    return node;
  };
  let run = null, shapes = [], doors = [], frame = 0, playing = false, last = 0, cursor = null;

  function choose(index) {
    run = data.runs[index];
    if (!run) return;
    [...at("runs").children].forEach((b, i) => b.setAttribute("aria-selected", String(i === index)));
    at("verdict-text").textContent = run.verdict + " · " + run.verdict_text;
    at("robot-text").textContent = "Robot: " + run.robot_text;
    at("trails").textContent = ""; at("agents").textContent = "";
    doors = run.doors.map((d) => ({ times: d.times, node: make("line",
      { x1: d.line[0], y1: d.line[1], x2: d.line[2], y2: d.line[3], stroke: "#a8641c", "stroke-width": 5 }, at("trails")) }));
    shapes = run.agents.map((agent) => {
      const trail = make("polyline", { fill: "none", stroke: agent.color, "stroke-width": 2.4, opacity: 0.55 }, at("trails"));
      const group = make("g", {}, at("agents"));
      make("circle", { r: agent.radius, fill: agent.color, stroke: "#fff", "stroke-width": 1.5 }, group);
      const nose = make("line", { x1: 0, y1: 0, x2: agent.radius, y2: 0, stroke: "#fff", "stroke-width": 2.5 }, group);
      const name = make("text", { y: -agent.radius - 5, "text-anchor": "middle", "font-size": 13, "font-weight": 600,
        fill: agent.color, stroke: "#fff", "stroke-width": 3, "paint-order": "stroke" }, group);
      name.textContent = agent.name.replace("human_", "h");
      const says = make("text", { y: -agent.radius - 20, "text-anchor": "middle", "font-size": 13, "font-weight": 700,
        fill: "#1f2328", stroke: "#fff", "stroke-width": 4, "paint-order": "stroke" }, group);
      return { agent, trail, group, nose, says };
    });
    const frames = Math.max(1, ...run.agents.map((a) => a.track.length));
    at("time").max = frames - 1;
    drawTimeline(frames / run.hz);
    fillLists();
    show(0);
  }

  function show(next) {
    frame = Math.max(0, Math.min(next, Number(at("time").max)));
    const index = Math.floor(frame);
    at("time").value = index;
    const secs = index / run.hz;
    at("clock").textContent = secs.toFixed(1) + " s";
    for (const s of shapes) {
      const p = s.agent.track[Math.min(index, s.agent.track.length - 1)];
      if (!p) continue;
      s.group.setAttribute("transform", `translate(${p[0]} ${p[1]})`);
      s.nose.setAttribute("x2", Math.cos(p[2]) * s.agent.radius);
      s.nose.setAttribute("y2", -Math.sin(p[2]) * s.agent.radius);
      s.says.textContent = GESTURES[p[3]] || "";
      s.trail.setAttribute("points", s.agent.track.slice(0, index + 1).map((q) => q[0] + "," + q[1]).join(" "));
    }
    for (const d of doors) {
      let open = false;
      for (const [t, now] of d.times) if (t <= secs + 1e-6) open = now;
      d.node.setAttribute("opacity", open ? 0.12 : 0.95);
    }
    if (cursor) cursor.setAttribute("transform", `translate(${cursor.dataset.x0 * 1 + secs * cursor.dataset.k} 0)`);
  }

  function drawTimeline(total) {
    const box = at("timeline"); box.textContent = "";
    const lanes = run.agents, w = 1120, left = 96, lane = 22, h = lanes.length * lane + 26, k = (w - left - 12) / Math.max(total, 1);
    const svg = make("svg", { viewBox: `0 0 ${w} ${h}` }, box);
    lanes.forEach((agent, i) => {
      const y = i * lane + 14;
      make("line", { x1: left, y1: y, x2: w - 10, y2: y, stroke: "#dde1e6" }, svg);
      make("text", { x: 0, y: y + 4, "font-size": 13, fill: agent.color, "font-weight": 600 }, svg).textContent = agent.name;
    });
    const colors = { gesture: "#E69F00", leaf: "#9aa3ae", sees: "#56B4E9", encounter: "#009E73", contact: "#b3400b", door: "#a8641c", goal: "#0072B2" };
    for (const [t, who, kind, text] of run.events) {
      const i = lanes.findIndex((a) => a.name === (who === 0 ? "robot" : "human_" + who));
      if (i < 0) continue;
      const mark = make("circle", { cx: left + t * k, cy: i * lane + 14, r: kind === "leaf" ? 3.5 : 5.5, fill: colors[kind] || "#999", stroke: "#fff", style: "cursor:pointer" }, svg);
      make("title", {}, mark).textContent = t.toFixed(1) + " s  " + text;
      mark.addEventListener("click", () => show(Math.round(t * run.hz)));
    }
    const step = total > 60 ? 10 : total > 20 ? 5 : 2;
    for (let t = 0; t <= total; t += step)
      make("text", { x: left + t * k, y: h - 4, "font-size": 11, "text-anchor": "middle", fill: "#5b636e" }, svg).textContent = t + " s";
    cursor = make("line", { x1: 0, x2: 0, y1: 0, y2: h - 16, stroke: "#1f2328", "stroke-width": 1.2 }, svg);
    cursor.dataset.x0 = left; cursor.dataset.k = k;
  }

  function fillLists() {
    for (const [id, setup] of [["setup", true], ["outcome", false]]) {
      const list = at(id); list.textContent = "";
      const clauses = run.clauses.filter((c) => c.setup === setup);
      for (const c of clauses) {
        const item = word("li", c.text, list);
        item.className = c.standing === "holds" || c.standing === "late" ? "" : c.standing === "not_applicable" ? "na" : "no";
        for (const t of c.times.slice(0, 3)) {
          const b = word("button", t.toFixed(1) + " s", item);
          b.addEventListener("click", () => { playing = false; at("play").textContent = "▶"; show(Math.round(t * run.hz)); at("stage").scrollIntoView(); });
        }
        word("small", c.evidence, item);
      }
      if (!clauses.length) word("li", "nothing to judge", list).className = "na";
    }
    const story = at("story"); story.textContent = "";
    for (const line of run.story) word("li", line, story);
    const metrics = at("metrics"); metrics.textContent = "";
    for (const m of run.metrics) {
      const row = document.createElement("tr"); metrics.appendChild(row);
      word("td", m.id, row);
      const value = word("td", m.value === null ? "n/a" : Math.abs(m.value) >= 100 ? m.value.toFixed(0) : m.value.toFixed(2), row);
      value.className = "n";
      const unit = word("td", m.unit, row);
      if (m.note) unit.title = m.note;
    }
  }

  function tick(now) {
    if (playing && run) {
      const speed = Number(at("speed").value), total = Number(at("time").max);
      const rate = speed === 0 ? Math.max(total / 10, run.hz) : speed * run.hz;
      show(frame + (Math.min(now - last, 100) / 1000) * rate);
      if (frame >= total) { playing = false; at("play").textContent = "▶"; }
    }
    last = now;
    requestAnimationFrame(tick);
  }

  data.runs.forEach((r, i) => {
    const b = word("button", r.name, at("runs"));
    b.setAttribute("role", "tab");
    b.addEventListener("click", () => choose(i));
  });
  if (data.runs.length < 2) at("runs").style.display = "none";
  at("play").addEventListener("click", () => {
    if (!playing && frame >= Number(at("time").max)) show(0);
    playing = !playing;
    at("play").textContent = playing ? "❚❚" : "▶";
  });
  at("time").addEventListener("input", (e) => show(Number(e.target.value)));
  choose(0);
  playing = data.runs.length > 0;
  at("play").textContent = playing ? "❚❚" : "▶";
  requestAnimationFrame((now) => { last = now; tick(now); });
})();
