(() => {
  const { View, controls, make, word, words, plain, secs, seconds } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const INK = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#8a6d00", "#5b636e", "#a8641c"];
  const PART = { realised: "#00795c", late: "#7fc4ae", robot: "#b3400b", scenario: "#8b949e", failed: "#1f2328" };
  const ink = (i) => INK[i % INK.length];
  const count = data.planners.length, name = (i) => data.planners[i].name;
  at("basis").textContent = data.basis; at("thresholds").textContent = data.thresholds; at("first").textContent = name(0);

  // What became of the runs: a bar per planner, and the same as numbers.
  {
    const table = at("outcomes"), parts = [];
    for (const p of data.planners) for (const part of p.parts) if (part.count && !parts.some((o) => o.words === part.words)) parts.push(part);
    const head = word("tr", "", word("thead", "", table));
    for (const text of ["planner", "runs", "", ...parts.map((p) => p.words), "robot's success", "contact"]) word("th", text, head).scope = "col";
    const body = word("tbody", "", table);
    data.planners.forEach((p, i) => {
      const row = word("tr", "", body), who = word("th", "", row);
      who.scope = "row"; word("i", "", who, "dot").style.background = ink(i); who.appendChild(document.createTextNode(p.name));
      word("td", String(p.runs), row, "n");
      const bar = word("div", "", word("td", "", row, "wide"), "bar");
      for (const part of p.parts) { if (part.count) { const piece = word("span", "", bar); piece.style.flex = String(part.count); piece.style.background = PART[part.key]; piece.title = part.words + ": " + part.count; } }
      for (const part of parts) { const own = p.parts.find((o) => o.words === part.words); word("td", own && own.count ? String(own.count) : "–", row, "n"); }
      word("td", String(p.success), row, "n"); word("td", String(p.contact), row, "n");
    });
    const legend = at("outcomes-legend");
    for (const part of parts) { const item = word("span", "", legend); word("i", "", item, "dot").style.background = PART[part.key]; words("b", part.words, item); words("span", " " + part.about, item); }
  }

  // The figures: a card per metric, a line per planner.
  const tidy = (x) => Math.abs(x) >= 100 ? x.toFixed(0) : Math.abs(x) >= 10 ? x.toFixed(1) : x.toFixed(2);
  const figure = (x, row) => row.decimals > 2 ? x.toFixed(row.decimals) : tidy(x);
  const ends = (e, row) => e ? ` [${figure(e[0], row)}, ${figure(e[1], row)}]` : "";
  const sign = (x) => (x > 0 ? "+" : x < 0 ? "−" : "") + tidy(Math.abs(x));
  for (const row of data.rows) {
    const card = word("article", "", at("figures")), title = word("details", "", card), head = word("summary", "", title);
    word("b", plain(row.id), head);
    word("span", (row.unit ? " " + row.unit : "") + (row.sign > 0 ? " · more is better" : row.sign < 0 ? " · less is better" : ""), head, "quiet");
    word("p", row.about, title, "quiet");
    const all = row.means.flatMap((m) => [m.mean, ...(m.interval || []), ...m.parts]);
    let low = Math.min(...all), high = Math.max(...all);
    if (high - low < 1e-9) { low -= 0.5; high += 0.5; }
    const W = 300, H = 22, pad = 8, x = (v) => pad + (v - low) / (high - low) * (W - 2 * pad);
    const table = word("table", "", card), body = word("tbody", "", table);
    row.means.forEach((m, i) => {
      const line = word("tr", "", body), who = word("th", "", line);
      who.scope = "row"; word("i", "", who, "dot").style.background = ink(i); who.appendChild(document.createTextNode(name(i)));
      const svg = make("svg", { viewBox: `0 0 ${W} ${H}`, role: "img", "aria-label": `${name(i)}: ${figure(m.mean, row)}${ends(m.interval, row)}` }, word("td", "", line, "strip"));
      make("line", { x1: pad, x2: W - pad, y1: H / 2, y2: H / 2, stroke: "#dde1e6" }, svg);
      if (low < 0 && high > 0) make("line", { x1: x(0), x2: x(0), y1: 0, y2: H, stroke: "#8b949e", "stroke-dasharray": "2 3" }, svg);
      m.parts.forEach((v, k) => make("circle", { cx: x(v), cy: H / 2 + ((k * 7) % 5 - 2) * 1.6, r: 2, fill: ink(i), opacity: 0.35 }, svg));
      if (m.interval) make("line", { x1: x(m.interval[0]), x2: x(m.interval[1]), y1: H / 2, y2: H / 2, stroke: ink(i), "stroke-width": 3.5, "stroke-linecap": "round" }, svg);
      make("circle", { cx: x(m.mean), cy: H / 2, r: 5, fill: ink(i), stroke: "#fff", "stroke-width": 1.5 }, svg);
      const told = word("td", "", line, "n");
      word(row.marked === i ? "b" : "div", figure(m.mean, row) + ends(m.interval, row), told);
      if (m.difference) { const [d, e] = m.difference, clear = e && (e[0] > 0 || e[1] < 0); word("div", "Δ " + sign(d) + (e ? ` [${sign(e[0])}, ${sign(e[1])}]` : ""), told, clear ? "clear" : "quiet"); }
    });
    const axis = word("tr", "", body, "axis"); word("th", "", axis);
    const scale = word("td", "", axis, "strip"); word("span", tidy(low), scale); word("span", tidy(high), scale);
    word("td", "", axis);
    const said = [];
    if (row.order.length) said.push("best first: " + row.order.map(([i, tie], k) => (k ? (tie ? " = " : " > ") : "") + name(i)).join(""));
    if (row.unordered.length) said.push("not ordered, too few arrivals: " + row.unordered.map(name).join(", "));
    if (row.stable !== null && row.order.length) said.push(`order kept in ${Math.round(row.stable * 100)} % of resamples`);
    if (row.best.length && row.stable !== null) said.push("best in " + row.order.map(([i]) => i).sort((a, b) => a - b).map((i) => `${Math.round(row.best[i] * 100)} % ${name(i)}`).join(", "));
    const lost = row.without.map((n, i) => n ? `${name(i)} has no value in ${n}` : "").filter(Boolean);
    if (row.runs < data.common) said.push(`over ${row.runs} of ${data.common} runs: ${lost.join(", ")}`);
    word("p", said.join(" · "), card, "quiet small");
  }

  // Side by side: a panel per planner, one clock.
  const scenarios = [...new Set(data.beside.map((b) => b.title + "\n" + b.folder))];
  const panels = [];
  let shown = null, focused = true, views = [];
  const grid = at("panels");
  grid.style.setProperty("--across", String(count < 4 ? Math.min(count, 3) : count === 4 ? 2 : 3));
  for (let i = 0; i < count; i++) {
    const figure = word("figure", "", grid), caption = word("figcaption", "", figure), svg = make("svg", {}, figure);
    const told = word("p", "", figure, "told"), robot = word("p", "", figure, "quiet small"), story = word("ol", "", figure, "story");
    panels.push({ figure, caption, svg, told, robot, story, items: [] });
  }
  const { clock, go, until } = controls((now) => {
    for (const view of views) if (view) view.show(now);
    for (const panel of panels) for (const [t, item] of panel.items) item.className = t <= now + 0.05 ? "" : "later";
  });
  function lay() {
    if (!shown) return;
    const place = data.places[shown.place];
    at("zoom").textContent = focused ? "whole map" : "where it happens";
    for (const view of views) if (view) view.lay(focused ? shown.focus : place.whole);
    clock.set(clock.now);
  }
  function load() {
    const [title, folder] = scenarios[Number(at("scenario").value)].split("\n"), seed = Number(at("seed").value);
    shown = data.beside.find((b) => b.title === title && b.folder === folder && b.seed === seed);
    if (!shown) return;
    const hide = at("hide").checked, order = hide ? shown.hidden_order : shown.runs.map((_, i) => i);
    at("bundle").href = shown.folder.endsWith(".tar.zst") ? shown.folder : shown.folder + "/report.html"; at("bundle").hidden = hide || !shown.folder;
    const box = shown.focus;
    views = panels.map((panel, k) => {
      const i = order[k], run = shown.runs[i], label = hide ? "robot " + String.fromCharCode(65 + k) : name(i);
      panel.caption.textContent = "";
      if (!hide) word("i", "", panel.caption, "dot").style.background = ink(i);
      panel.caption.appendChild(document.createTextNode(label));
      panel.story.textContent = ""; panel.items = [];
      panel.svg.textContent = "";
      panel.svg.setAttribute("style", `aspect-ratio:${box[2]} / ${box[3]}`);
      if (!run) { panel.told.textContent = "no result: this run failed, see compare.csv"; panel.robot.textContent = ""; return null; }
      panel.told.textContent = plain(run.verdict) + " · " + (run.success ? "the robot had success" : "the robot had no success");
      panel.told.title = run.verdict_text; panel.robot.textContent = run.robot_text;
      const view = new View(panel.svg, data.places[shown.place]);
      view.load({ ...run, name: label });
      for (const [t, text] of run.story) {
        const item = word("li", "", panel.story), button = word("button", secs(t), item);
        button.type = "button"; button.addEventListener("click", () => go(t)); words("span", text, item); panel.items.push([t, item]);
      }
      return view;
    });
    until(Math.max(...shown.runs.map((run) => run ? seconds(run) : 0)));
    at("zoom").hidden = box[2] >= data.places[shown.place].whole[2] - 1 && box[3] >= data.places[shown.place].whole[3] - 1;
    lay();
  }
  function seeds() {
    const [title, folder] = scenarios[Number(at("scenario").value)].split("\n");
    at("seed").textContent = "";
    for (const b of data.beside) if (b.title === title && b.folder === folder) word("option", String(b.seed), at("seed")).value = String(b.seed);
    load(); clock.set(0);
  }
  if (!data.beside.length) { at("stage").hidden = true; return; }
  scenarios.forEach((key, i) => { const [title, folder] = key.split("\n"); word("option", scenarios.filter((s) => s.startsWith(title + "\n")).length > 1 ? title + " · " + folder : title, at("scenario")).value = String(i); });
  at("left-out").hidden = !data.left_out;
  at("left-out").textContent = `${data.left_out} more scenarios and seeds are not played here, so that the page stays small; each scenario's own page plays its runs.`;
  at("scenario").addEventListener("change", seeds); at("seed").addEventListener("change", () => { load(); clock.set(0); });
  at("hide").addEventListener("change", load);
  at("choose").addEventListener("submit", (e) => e.preventDefault());
  at("zoom").addEventListener("click", () => { focused = !focused; lay(); });
  at("time").style.width = "100%";
  addEventListener("resize", lay);
  seeds();
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) clock.play(true);
})();
