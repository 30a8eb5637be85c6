(() => {
  const { View, Clock, keys, make, word, words, put, plain, secs, seconds } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const MARKS = { // color, path around 0 0, words of the legend
    clause: ["#00795c", "M-4 -1l3 3l6 -7l2 2l-8 9l-5 -5z", "clause seen"],
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
  // Series, title, unit, largest value shown, value from which the scale is another one, lines with names.
  const PLOTS = [
    { id: "distance", title: "surface distance to the nearest human", unit: "m", top: null, bend: 4, lines: [[0.45, "intimate"], [1.2, "personal"]] },
    { id: "speed", title: "speed of the robot", unit: "m/s", top: null, bend: null, lines: [] },
    { id: "ttc", title: "time to collision at constant velocity, up to 8 s", unit: "s", top: 8, bend: null, lines: [[3, "exposed"]] },
  ];
  // Part of a plot's height that is left for values beyond its bend.
  const BEYOND = 0.3;
  // What a metric is called here; its distances are between surfaces.
  const NAMES = { human_distance_min: "smallest surface distance to a human" };
  const named = (m) => NAMES[m.id] || plain(m.id);
  const LANES = 14;
  const good = (c) => c.standing === "holds" || c.standing === "late", judged = (c) => c.standing !== "not_applicable";
  const hold = (r) => r.verdict.startsWith("realised");
  let run = null, other = null, story = [], cursors = [], readouts = [];
  const view = new View(at("map"), data.places[0]), second = new View(at("map-beside"), data.places[0]);
  let focused = data.focus[2] < data.whole[2] - 1 || data.focus[3] < data.whole[3] - 1;
  if (focused) at("zoom").hidden = false;

  const clock = new Clock(show, (on) => {
    at("play").textContent = on ? "❚❚" : "▶";
    at("play").setAttribute("aria-label", on ? "pause" : "play");
  });
  function go(t) { clock.play(false); clock.set(t); }
  function jump(t) {
    go(t);
    const box = at("picture").getBoundingClientRect();
    if (box.top < 0 || box.bottom > innerHeight) at("stage").scrollIntoView({ block: "start" });
  }
  function timeButton(t, parent) {
    const b = word("button", secs(t), parent);
    b.type = "button";
    b.addEventListener("click", () => jump(t));
  }
  const times = (c) => [...new Set(c.times.map((x) => x.toFixed(1)))].slice(0, 3).map(Number);

  function pace() {
    const speed = Number(at("speed").value);
    clock.rate = speed === 0 ? Math.max(clock.end / 10, 1) : speed;
  }

  function choose(index) {
    if (!data.runs[index]) return;
    run = data.runs[index];
    [...at("runs").querySelectorAll("tbody tr")].forEach((row, i) => row.setAttribute("aria-current", String(i === index)));
    at("verdict").textContent = plain(run.verdict);
    at("verdict").className = "verdict" + (hold(run) ? " good" : "");
    at("gap").textContent = run.gap;
    at("gap").title = run.gaps;
    at("robot").textContent = run.planner === "none" ? "no robot" : run.success ? "arrived, no collision" : "no success";
    at("planner").textContent = run.planner; at("seed").textContent = run.seed; at("simulated").textContent = secs(run.simulated);
    put(at("verdict-text"), run.verdict_text);
    put(at("robot-text"), "Robot: " + run.robot_text);
    at("first-name").textContent = run.name;
    view.load(run);
    fillLists();
    fillFacts();
    span();
    lay();
    show(0); clock.now = 0;
  }
  function compare(index) {
    other = data.runs[index] || null;
    at("second").hidden = at("first-name").hidden = !other;
    at("picture").classList.toggle("two", Boolean(other));
    if (other) { second.load(other); at("second-name").textContent = other.name + " · " + plain(other.verdict); }
    span(); lay(); show(Math.min(clock.now, clock.end));
  }
  function span() {
    clock.end = Math.max(seconds(run), other ? seconds(other) : 0);
    at("time").max = clock.end;
    pace();
  }

  function lay() {
    if (!run) return;
    const box = focused ? data.focus : data.whole;
    at("zoom").textContent = focused ? "whole map" : "where it happens";
    view.lay(box);
    if (other) second.lay(box);
    cursors = []; readouts = [];
    drawTimeline();
    drawPlots();
    show(clock.now);
  }

  function show(now) {
    if (!run) return;
    at("time").value = now;
    at("time").setAttribute("aria-valuetext", secs(now));
    at("clock").textContent = secs(now);
    view.show(now);
    if (other) second.show(now);
    const recent = run.events.filter(([t]) => t <= now + 0.05 && now - t < 2.5), newest = recent.length ? recent[recent.length - 1][0] : 0;
    const told = recent.filter(([t]) => t === newest).map((e) => e[3]);
    at("caption").textContent = told.length ? secs(newest) + " · " + told.slice(0, 3).join(", ") + (told.length > 3 ? ", …" : "") : "";
    for (const [t, item] of story) item.className = t <= now + 0.05 ? "" : "later";
    for (const [node, left, k] of cursors) node.setAttribute("transform", `translate(${left + now * k} 0)`);
    for (const read of readouts) read(now);
  }

  // Left edge and pixels per second of everything that has time from left to right.
  function axis() {
    const width = Math.max(280, at("timeline").clientWidth), left = width < 600 ? 66 : 92;
    return { width, left, right: width - 12, k: (width - left - 12) / Math.max(clock.end, 0.1) };
  }
  function grid(svg, ax, h) {
    const steps = [1, 2, 5, 10, 20, 30, 60, 120, 300].find((s) => s * ax.k >= 44) || 600;
    for (let t = 0; t <= clock.end + 1e-6; t += steps) {
      make("line", { x1: ax.left + t * ax.k, x2: ax.left + t * ax.k, y1: 0, y2: h, stroke: "#eceff2" }, svg);
      if (svg.dataset.axis) make("text", { x: ax.left + t * ax.k, y: h + 14, "font-size": 12, "text-anchor": "middle", fill: "#5b636e" }, svg).textContent = t + " s";
    }
  }
  function seek(svg, ax) {
    const to = (e) => go((e.clientX - svg.getBoundingClientRect().left - ax.left) / ax.k);
    svg.addEventListener("pointerdown", (e) => { if (e.target.style.cursor !== "pointer") to(e); });
    svg.addEventListener("pointermove", (e) => { if (e.buttons === 1) to(e); });
  }

  function drawTimeline() {
    const box = at("timeline"), ax = axis(), lane = 24;
    // Everybody where they fit; in a crowd the robot and those who do most.
    const busy = (a) => (a.number === 0 ? 1e9 : run.events.filter((e) => e[1] === a.number && e[2] !== "leaf").length * 100 - a.number / 1000);
    const chosen = run.agents.length <= LANES ? run.agents : run.agents.filter((a) => busy(a) >= 100).sort((a, b) => busy(b) - busy(a)).slice(0, LANES).sort((a, b) => a.number - b.number);
    const lanes = [...chosen, { name: "checklist", words: "#1f2328", number: -1 }];
    const h = lanes.length * lane + 24, rest = run.agents.length - chosen.length;
    // The thumb of a range is 16 px wide: its middle then stands right above the cursor.
    at("time").style.marginLeft = ax.left - 8 + "px"; at("time").style.width = ax.width - ax.left - 12 + 16 + "px";
    box.textContent = "";
    const svg = make("svg", { viewBox: `0 0 ${ax.width} ${h}`, height: h, "aria-hidden": "true" }, box);
    svg.dataset.axis = "yes";
    grid(svg, ax, h - 18);
    lanes.forEach((agent, i) => {
      make("line", { x1: ax.left, y1: i * lane + 14, x2: ax.right, y2: i * lane + 14, stroke: "#ccd2d9" }, svg);
      make("text", { x: 0, y: i * lane + 18, "font-size": 13, fill: agent.words, "font-weight": 600 }, svg).textContent = agent.name;
    });
    cursors.push([make("line", { x1: 0, x2: 0, y1: 0, y2: h - 18, stroke: "#1f2328", "stroke-width": 1.4 }, svg), ax.left, ax.k]);
    const seen = run.clauses.filter((c) => judged(c) && c.times.length).map((c) => [c.times[0], -1, "clause", c.id + " " + c.text + (good(c) ? "" : " (" + plain(c.standing) + ")"), good(c)]);
    const all = [...run.events, ...seen], used = Object.keys(MARKS).filter((kind) => all.some((e) => e[2] === kind));
    for (const wanted of used) for (const [t, who, kind, text, fine] of all) {
      const i = lanes.findIndex((a) => a.number === who);
      if (kind !== wanted || i < 0) continue;
      const path = fine === false ? "M-5 -3l2 -2l3 3l3 -3l2 2l-3 3l3 3l-2 2l-3 -3l-3 3l-2 -2l3 -3z" : MARKS[kind][1];
      const mark = make("path", { d: path, transform: `translate(${ax.left + t * ax.k} ${i * lane + 14})`, fill: fine === false ? "#b3400b" : MARKS[kind][0], stroke: "#fff", style: "cursor:pointer" }, svg);
      make("title", {}, mark).textContent = secs(t) + "  " + text;
      mark.addEventListener("click", () => go(t));
    }
    seek(svg, ax);
    const legend = at("legend"); legend.textContent = "";
    for (const kind of used) {
      const part = word("span", "", legend);
      make("path", { d: MARKS[kind][1], fill: MARKS[kind][0] }, make("svg", { viewBox: "-8 -8 16 16", "aria-hidden": "true" }, part));
      part.append(MARKS[kind][2]);
    }
    if (rest > 0) word("span", `${rest} more agents have no line of their own`, legend);
  }

  function drawPlots() {
    const box = at("plots"); box.textContent = "";
    const ax = axis(), low = 8;
    for (const plot of PLOTS) {
      const mine = run.series[plot.id], theirs = other ? other.series[plot.id] : [];
      const known = [...mine, ...theirs].filter((v) => v !== null);
      const frame = word("div", "", box, "plot"), head = word("p", plot.title, frame, "quiet"), value = word("b", "", head);
      if (!known.length) { word("span", plot.id === "ttc" ? "never on a collision course" : "nothing to measure", head); continue; }
      const most = Math.min(plot.top || Infinity, Math.max(...known) * 1.08, 1e6) || 1, least = Math.min(0, ...known);
      // Far values matter less than near ones: beyond the bend the scale is coarser, and marked as such.
      const bend = plot.bend !== null && most > plot.bend * 1.25 ? plot.bend : null, h = bend === null ? 104 : 150, room = h - 2 * low;
      const svg = make("svg", { viewBox: `0 0 ${ax.width} ${h + 2}`, height: h + 2, role: "img", "aria-label": plot.title }, frame);
      if (bend !== null) make("rect", { x: ax.left, y: 0, width: ax.right - ax.left, height: low + BEYOND * room, fill: "#f3f5f8", class: "beyond" }, svg);
      grid(svg, ax, h);
      const y = (v) => {
        const value = Math.min(v, most);
        if (bend === null) return h - low - (value - least) / Math.max(most - least, 1e-9) * room;
        const near = (Math.min(value, bend) - least) / (bend - least) * (1 - BEYOND), far = Math.max(value - bend, 0) / (most - bend) * BEYOND;
        return h - low - (near + far) * room;
      };
      const step = [0.1, 0.2, 0.5, 1, 2, 5, 10].find((s) => ((bend || most) - least) / s <= 4) || 20;
      const ticks = [];
      for (let v = Math.ceil(least / step) * step; v <= (bend || most) + 1e-9; v += step) ticks.push(v);
      if (bend !== null) ticks.push(Math.floor(most));
      for (const v of ticks) {
        make("line", { x1: ax.left, x2: ax.right, y1: y(v), y2: y(v), stroke: "#eceff2" }, svg);
        make("text", { x: ax.left - 8, y: y(v) + 4, "font-size": 12, "text-anchor": "end", fill: "#5b636e" }, svg).textContent = +v.toFixed(1) + " " + plot.unit;
      }
      if (bend !== null) {
        make("path", { d: `M${ax.left - 5} ${y(bend) - 1}l10 -4m-10 -1l10 -4`, stroke: "#5b636e", "stroke-width": 1.4, fill: "none", class: "bend" }, svg);
        make("text", { x: ax.right, y: 11, "font-size": 11, "text-anchor": "end", fill: "#5b636e" }, svg).textContent = "coarser above " + bend + " " + plot.unit;
      }
      const lines = [];
      for (const [v, name] of plot.lines) if (v > least && v < most) {
        make("line", { x1: ax.left, x2: ax.right, y1: y(v), y2: y(v), stroke: "#b3400b", "stroke-width": 1, "stroke-dasharray": "2 4" }, svg);
        lines.push(() => make("text", { x: ax.right, y: y(v) - 3, "font-size": 11, "text-anchor": "end", fill: "#b3400b", stroke: "#fff", "stroke-width": 3, "paint-order": "stroke" }, svg).textContent = name + " " + v + " " + plot.unit);
      }
      const curve = (r, values, look) => {
        let d = "", pen = false;
        values.forEach((v, i) => {
          // What is beyond the largest value shown is not drawn; a single sample is a dot.
          if (v === null || v > most) { pen = false; return; }
          d += (pen ? "L" : "M") + (ax.left + i / r.hz * ax.k).toFixed(1) + " " + y(v).toFixed(1) + (pen ? "" : "h.01");
          pen = true;
        });
        make("path", { d, fill: "none", "stroke-linejoin": "round", "stroke-linecap": "round", ...look }, svg);
      };
      if (other) curve(other, theirs, { stroke: "#d55e00", "stroke-width": 1.6, "stroke-dasharray": "6 4" });
      curve(run, mine, { stroke: "#0072b2", "stroke-width": 2 });
      for (const write of lines) write();
      if (plot.id !== "speed") {
        let i = -1;
        mine.forEach((v, j) => { if (v !== null && (i < 0 || v < mine[i])) i = j; });
        if (i >= 0) {
          const dot = make("circle", { cx: ax.left + i / run.hz * ax.k, cy: y(mine[i]), r: 4, fill: "#0072b2", stroke: "#fff", style: "cursor:pointer" }, svg);
          make("title", {}, dot).textContent = `smallest: ${mine[i].toFixed(2)} ${plot.unit} at ${secs(i / run.hz)}`;
          dot.addEventListener("click", () => go(i / run.hz));
        }
      }
      cursors.push([make("line", { x1: 0, x2: 0, y1: 0, y2: h, stroke: "#1f2328", "stroke-width": 1.4 }, svg), ax.left, ax.k]);
      seek(svg, ax);
      const told = (r, now) => {
        const values = r.series[plot.id], i = Math.round(now * r.hz), v = i < values.length ? values[i] : undefined;
        if (v === undefined) return "–";
        if (v === null) return plot.id === "ttc" ? "no collision course" : "–";
        const who = plot.id === "speed" ? "" : r.series[plot.id + "_to"][i];
        return v.toFixed(2) + " " + plot.unit + (who ? " to human_" + who : "");
      };
      readouts.push((now) => { value.textContent = told(run, now) + (other ? "  ┄ " + told(other, now) : ""); });
    }
    if (other) word("p", `straight: ${run.name} · dashed: ${other.name}`, box, "quiet");
  }

  function fillFacts() {
    const table = at("facts"); table.textContent = "";
    const sources = (c) => c.source.split(/[\s,]+/);
    const body = heading(table, ["asked", "read as", "promised by", "seen"]);
    for (const fact of data.facts) {
      const row = word("tr", "", body);
      const asked = word("td", "", row);
      word("code", fact.id, asked); asked.append(" ");
      if (fact.quote) word("q", fact.quote, asked); else word("span", "by default", asked, "quiet");
      words("td", fact.says, row);
      const promised = word("td", "", row), seen = word("td", "", row, "seen");
      const clauses = run.clauses.filter((c) => sources(c).includes(fact.id));
      for (const c of clauses) {
        const line = word("div", "", promised);
        const link = word("a", c.id, line); link.href = "#clause-" + c.id;
        words("span", " " + c.text, line);
        const when = word("div", "", seen, good(c) ? "" : judged(c) ? "bad" : "quiet");
        const [sign, state] = STANDINGS[c.standing] || ["–", plain(c.standing)];
        word("b", sign, when).setAttribute("aria-label", plain(c.standing));
        when.append(" " + state);
        for (const t of times(c).slice(0, 2)) timeButton(t, when);
      }
      if (!clauses.length) { word("span", "no clause names it", promised, "quiet"); word("span", "–", seen, "quiet"); }
    }
    for (const wish of data.missing || []) {
      const row = word("tr", "", body);
      word("q", wish.quote, word("td", "", row));
      words("td", wish.why, row);
      word("td", "nothing: " + wish.fate, row, "quiet");
      word("td", wish.fate === "waived" ? "– given up" : "✘ not in this run", row, wish.fate === "waived" ? "quiet" : "bad");
    }
    if (!data.facts.length && !(data.missing || []).length) { const cell = word("td", "nothing was asked for in particular: the author was free", word("tr", "", body), "quiet"); cell.colSpan = 4; }
    const known = new Set(data.facts.map((f) => f.id)), rest = run.clauses.filter((c) => !sources(c).some((s) => known.has(s)));
    const line = at("unasked"); line.textContent = "";
    if (rest.length) {
      line.append("Promised by the pattern and the paths, not by your words: ");
      rest.forEach((c, i) => { if (i) line.append(", "); const link = word("a", c.id, line); link.href = "#clause-" + c.id; link.title = c.text; });
    }
  }

  function fillLists() {
    for (const [id, setup] of [["setup", true], ["outcome", false]]) {
      const list = at(id); list.textContent = "";
      const clauses = run.clauses.filter((c) => c.setup === setup);
      const needed = clauses.filter((c) => c.must && judged(c)), open = clauses.filter((c) => !judged(c)).length;
      at(id + "-sum").textContent = (needed.length ? `${needed.filter(good).length} of ${needed.length} needed` : "") + (open ? ` · ${open} not judged` : "");
      for (const c of clauses) {
        const [sign, state] = STANDINGS[c.standing] || ["–", plain(c.standing)];
        const item = words("li", c.text, list);
        item.id = "clause-" + c.id;
        item.className = good(c) ? "" : c.standing === "not_applicable" ? "na" : "no";
        word("b", sign, item).setAttribute("aria-label", plain(c.standing));
        if (state) word("span", state, item, "tag state");
        if (!c.must) word("span", "optional", item, "tag");
        for (const t of times(c)) timeButton(t, item);
        const spare = c.shift === null || c.shift === undefined ? "" : c.shift < 0 ? ` · ${secs(-c.shift)} too much` : ` · ${secs(c.shift)} to spare`;
        const proof = words("small", c.evidence + spare, item);
        word("code", c.id, proof, "id");
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
      word("th", named(m), row).scope = "row";
      word("td", value(m), row, "n").title = m.note || "";
      word("td", better(m), row, "quiet");
    }
    const zones = at("zones"), parts = ZONES.map(([id, color, name]) => [run.metrics.find((m) => m.id === id), color, name]);
    zones.textContent = "";
    if (parts.every(([m]) => m && m.value !== null)) {
      word("div", "Time in each zone of the nearest person", zones, "quiet").style.marginTop = "12px";
      const bar = word("div", "", zones, "bar");
      const shares = whole(parts.map(([m]) => m.value));
      for (const [m, color] of parts) { const piece = word("div", "", bar); piece.style.cssText = `width:${m.value}%;background:${color}`; }
      parts.forEach(([, color, name], i) => { const s = word("span", "", zones); word("i", "", s).style.background = color; s.append(`${name} ${shares[i]} %`); });
    }
  }
  // Whole numbers that add up as the shares do: the largest rests are rounded up.
  function whole(shares) {
    const down = shares.map(Math.floor), missing = Math.round(shares.reduce((a, b) => a + b, 0)) - down.reduce((a, b) => a + b, 0);
    const order = shares.map((v, i) => [v - down[i], i]).sort((a, b) => b[0] - a[0]).map(([, i]) => i);
    order.slice(0, Math.max(0, missing)).forEach((i) => { down[i] += 1; });
    return down;
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
    const body = heading(at("runs"), ["run", "verdict", "encounter gap", "success", "time to goal", "smallest surface distance"]);
    const beside = at("beside");
    word("option", "nothing", beside).value = "-1";
    data.runs.forEach((r, i) => {
      const row = word("tr", "", body), of = (id) => value(r.metrics.find((m) => m.id === id));
      const b = word("button", r.name, word("td", "", row));
      b.type = "button";
      b.addEventListener("click", () => { clock.play(false); choose(i); });
      word("td", plain(r.verdict), row, hold(r) ? "" : "bad");
      for (const text of [r.gap, r.planner === "none" ? "–" : r.success ? "yes" : "no", of("time_to_goal"), of("human_distance_min")]) word("td", text, row);
      word("option", r.name, beside).value = String(i);
    });
    const many = data.runs.length > 1;
    at("compare").hidden = !many; at("beside-label").hidden = !many; at("run-keys").hidden = !many;
    beside.addEventListener("change", () => compare(Number(beside.value)));
    const all = heading(at("metrics"), ["metric", ...data.runs.map((r) => r.name), "", "note"]);
    for (const m of data.runs.length ? data.runs[0].metrics : []) {
      const row = word("tr", "", all);
      word("th", named(m), row).scope = "row";
      for (const r of data.runs) word("td", value(r.metrics.find((x) => x.id === m.id)), row);
      word("td", better(m), row, "quiet"); words("td", m.note || "", row, "quiet");
    }
  }
  // The next mark of the time line in a direction.
  function event(way) {
    const all = run.events.map((e) => e[0]).sort((a, b) => a - b);
    const next = way > 0 ? all.find((t) => t > clock.now + 0.06) : all.reverse().find((t) => t < clock.now - 0.06);
    go(next === undefined ? (way > 0 ? clock.end : 0) : next);
  }

  at("play").addEventListener("click", () => { if (run) clock.toggle(); });
  at("zoom").addEventListener("click", () => { focused = !focused; lay(); });
  at("speed").addEventListener("change", pace);
  at("time").addEventListener("input", (e) => { if (run) go(Number(e.target.value)); });
  addEventListener("resize", lay);
  // On paper everything is open and the run is at its end, with whole trails.
  let before = 0;
  addEventListener("beforeprint", () => {
    before = clock.now; clock.play(false);
    for (const part of document.querySelectorAll("details")) part.open = true;
    lay(); clock.set(clock.end);
  });
  addEventListener("afterprint", () => { lay(); clock.set(before); });
  const act = {
    " ": () => run && clock.toggle(), ArrowRight: () => go(clock.now + 0.5), ArrowLeft: () => go(clock.now - 0.5),
    ShiftArrowRight: () => go(clock.now + 0.1), ShiftArrowLeft: () => go(clock.now - 0.1),
    Home: () => go(0), End: () => go(clock.end), ".": () => run && event(1), ",": () => run && event(-1),
  };
  for (let i = 0; i < Math.min(9, data.runs.length); i++) act[String(i + 1)] = () => { clock.play(false); choose(i); };
  keys(act);
  fillOnce();
  // report.html#run=reactive-2&t=12.5 opens a run at a time.
  const wish = new URLSearchParams(location.hash.slice(1)), wanted = data.runs.findIndex((r) => r.planner + "-" + r.seed === wish.get("run"));
  choose(Math.max(0, wanted));
  if (wish.get("beside")) { const i = data.runs.findIndex((r) => r.planner + "-" + r.seed === wish.get("beside")); at("beside").value = String(i); compare(i); }
  const moment = Number(wish.get("t"));
  if (wish.has("t") && Number.isFinite(moment)) go(moment);
  else if (data.runs.length > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches) clock.play(true);
})();
