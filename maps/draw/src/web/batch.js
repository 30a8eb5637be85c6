(() => {
  const { make, word, words, plain } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const VERDICTS = { // color, sign
    realised: ["#00795c", "✔"], realised_late: ["#56b4e9", "✔"], not_triggered: ["#e69f00", "✘"], contradicted: ["#d55e00", "✘"],
    robot_prevented: ["#cc79a7", "✘"], invalid: ["#767d87", "✘"], failed: ["#1f2328", "✘"],
  };
  const ROBOT = "#0072B2";
  const ORDER = Object.keys(VERDICTS), STEP = 30;
  let page = 0, whole = false, rows = data.rows, folds = new Map();
  const count = (n, one) => n + " " + one + (n === 1 ? "" : "s");

  // 95 % interval of a share (Wilson), in percent.
  function wilson(k, n) {
    if (!n) return "–";
    const z = 1.959964, p = k / n, d = 1 + z * z / n, m = (p + z * z / (2 * n)) / d, h = z * Math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / d;
    return `${(100 * p).toFixed(0)} % [${(100 * Math.max(0, m - h)).toFixed(0)}, ${(100 * Math.min(1, m + h)).toFixed(0)}]`;
  }
  function median(values) {
    const v = values.filter((x) => x !== null && x !== undefined).sort((a, b) => a - b), n = v.length;
    return n ? (n % 2 ? v[(n - 1) / 2] : (v[n / 2 - 1] + v[n / 2]) / 2) : null;
  }
  const number = (v, unit) => (v === null || v === undefined ? "n/a" : v.toFixed(2) + " " + unit);

  function summary() {
    // What repeats an earlier scenario is no evidence of its own: shares are of distinct ones.
    const single = rows.filter((r) => !r.repeats), whole = single.length, good = single.filter((r) => r.verdict === "realised").length, again = rows.length - whole;
    at("sum").textContent = count(data.rows.length, "scenario") + (rows.length === data.rows.length ? "" : `, ${rows.length} shown`) + (again ? ` · ${whole} distinct, ${again} repeat one of them` : "") + ` · ${good} realised` + (whole ? ` · ${wilson(good, whole)}` : "");
    const bar = at("shares"), legend = at("shares-legend");
    bar.textContent = ""; legend.textContent = "";
    for (const verdict of ORDER) {
      const n = single.filter((r) => r.verdict === verdict).length;
      if (!n) continue;
      const part = word("span", "", bar);
      part.style.cssText = `width:${100 * n / whole}%;background:${VERDICTS[verdict][0]}`;
      part.title = plain(verdict) + ": " + n;
      const said = word("span", "", legend);
      word("i", "", said).style.background = VERDICTS[verdict][0];
      said.append(`${plain(verdict)} ${n}`);
    }
    const table = at("planners"); table.textContent = "";
    if (data.figures && data.figures.why) { at("planners-note").textContent = data.figures.why; return; }
    const head = word("tr", "", word("thead", "", table));
    for (const name of ["planner", "runs", "realised", "success", "contacts per run", "smallest surface distance, median", "time to goal, median"]) word("th", name, head).scope = "col";
    const body = word("tbody", "", table), planners = new Map();
    // Planners stand side by side over what all of them ran, the same scenario with the same seed.
    const names = new Set(single.flatMap((r) => r.runs.map((x) => x.planner)).filter((name) => name !== "none"));
    const all = (row, run) => [...names].every((name) => row.runs.some((x) => x.planner === name && x.seed === run.seed));
    const shared = single.some((row) => row.runs.some((run) => all(row, run)));
    const left = single.reduce((n, row) => n + (shared ? row.runs.filter((run) => run.planner !== "none" && !all(row, run)).length : 0), 0);
    at("planners-left").textContent = names.size < 2 ? "" : !shared ? " No run is one that all planners have: do not compare these lines." : left ? ` ${count(left, "run")} that not all planners have ${left === 1 ? "is" : "are"} left out.` : "";
    for (const row of single) for (const run of row.runs) {
      if (run.planner === "none" || (shared && !all(row, run))) continue;
      if (!planners.has(run.planner)) planners.set(run.planner, []);
      planners.get(run.planner).push(run);
    }
    for (const [planner, runs] of planners) {
      const line = word("tr", "", body), n = runs.length;
      word("th", planner, line).scope = "row";
      const contacts = runs.map((r) => r.contacts).filter((v) => v !== null);
      const cells = [String(n), wilson(runs.filter((r) => r.verdict === "realised").length, n), wilson(runs.filter((r) => r.success).length, n),
        contacts.length ? (contacts.reduce((a, b) => a + b, 0) / contacts.length).toFixed(2) : "n/a",
        number(median(runs.map((r) => r.distance)), "m"), number(median(runs.map((r) => r.time)), "s")];
      for (const cell of cells) word("td", cell, line);
    }
  }

  // Estimates with their intervals over everything in the folder, whatever is shown.
  function figures() {
    const told = data.figures;
    if (!told || !told.rows || !told.rows.length || told.head.length < 3) return;
    at("figures").hidden = false;
    const table = at("figures-table"), head = word("tr", "", word("thead", "", table)), body = word("tbody", "", table);
    for (const name of told.head) word("th", name, head).scope = "col";
    for (const [name, ...cells] of told.rows) {
      const line = word("tr", "", body);
      word("th", name, line).scope = "row";
      for (const cell of cells) word("td", cell, line);
    }
    at("figures-note").textContent = "Shares, means of counts, medians; in brackets the 95 % interval (Wilson, bootstrap). Order: the best first; tau: mean agreement of the order in each scenario (or seed) with it, 1 is the same." + (told.thresholds ? ` Thresholds ${told.thresholds}. ` : " ") + "planners.csv beside this page has every metric, of at most 1000 scenarios for each of them too.";
  }

  // What the whole library covers; what lacks stands first.
  function covered() {
    const told = data.covered;
    if (!told || !data.rows.length) return;
    at("covered").hidden = false;
    at("covered-shares").textContent = told.shares.join(" · ");
    for (const gap of told.gaps) word("li", gap, at("covered-gaps"));
    const table = at("covered-encounters"), head = word("tr", "", word("thead", "", table)), body = word("tbody", "", table);
    told.head.forEach((name, column) => { word("th", column ? name : "encounter angle", head).scope = "col"; });
    for (const [name, ...cells] of told.encounters) {
      const line = word("tr", "", body);
      word("th", name, line).scope = "row";
      for (const cell of cells) word("td", cell, line).className = cell === "·" ? "quiet" : "";
    }
    for (const [id, cells] of [["covered-scenarios", told.scenarios], ["covered-places", told.places]])
      for (const [name, count] of cells) {
        const cell = word("span", name, at(id));
        cell.className = count === "·" ? "quiet" : "";
        word("b", count, cell);
      }
  }

  function thumbnail(row, link) {
    const svg = make("svg", { class: "thumb", role: "img", "aria-label": "tracks of " + row.title }, link), picture = row.picture;
    if (!picture) { svg.setAttribute("viewBox", "0 0 16 9"); return; }
    // Every picture has the same shape: the box is widened, never cut.
    const [x, y, w, h] = picture.focus, W = Math.max(w, h * 16 / 9), H = Math.max(h, w * 9 / 16);
    svg.setAttribute("viewBox", [x - (W - w) / 2, y - (H - h) / 2, W, H].join(" "));
    make("use", { href: "#floor-" + picture.place }, svg);
    for (const [color, points] of picture.tracks) {
      make("polyline", { points, fill: "none", stroke: color, "stroke-width": 2.5, "vector-effect": "non-scaling-stroke", "stroke-linejoin": "round", "stroke-linecap": "round" }, svg);
      const last = points.split(" ").pop().split(",");
      const r = W / 50, look = { fill: color, stroke: "#fff", "stroke-width": 1, "vector-effect": "non-scaling-stroke" };
      if (color === ROBOT) make("rect", { x: last[0] - r, y: last[1] - r, width: 2 * r, height: 2 * r, rx: r * 0.3, ...look }, svg);
      else make("circle", { cx: last[0], cy: last[1], r, ...look }, svg);
    }
  }

  const address = (row) => row.folder.split("/").map(encodeURIComponent).join("/") + "/report.html";
  function item(row) {
    const node = word("li", ""), href = row.folder === undefined ? null : address(row);
    if (href) { const link = word("a", "", node); link.href = href; link.tabIndex = -1; thumbnail(row, link); } else thumbnail(row, word("span", "", node));
    const middle = word("div", "", node), title = word("h3", "", middle);
    if (href) { const link = word("a", row.title || row.scenario, title); link.href = href; } else title.textContent = row.title || row.scenario;
    word("span", row.scenario, title, "tag");
    if (row.file !== undefined) { const link = word("a", "packed bundle", title, "tag"); link.href = row.file.split("/").map(encodeURIComponent).join("/"); link.download = ""; }
    if (row.reading) words("p", row.reading, middle);
    if (row.rough || row.context) { const said = word("p", "", middle, "quiet said"); word("q", (row.rough || row.context + " · " + row.task).trim(), said); }
    if (row.location) word("p", [row.location, plain(row.place), plain(row.pattern), count(row.humans, "human"), row.author].join(" · "), middle, "quiet");
    const side = word("div", "", node), [color, sign] = VERDICTS[row.verdict] || ["#1f2328", "–"];
    const verdict = word("p", sign + " " + plain(row.verdict), side, "verdict-word");
    verdict.style.borderColor = color;
    if (row.why) words("p", row.why, side, "bad"); else if (row.told) words("p", row.told, side, "quiet");
    const planners = new Map();
    for (const run of row.runs) { if (!planners.has(run.planner)) planners.set(run.planner, []); planners.get(run.planner).push(run); }
    for (const [planner, runs] of planners) {
      const line = word("p", "", side, "runs-of");
      word("b", planner, line);
      for (const run of runs.slice(0, 24)) {
        const box = word(href ? "a" : "span", run.verdict.startsWith("realised") ? (run.success || planner === "none" ? "✔" : "◐") : "✘", line);
        if (href) box.href = href + "#run=" + encodeURIComponent(planner + "-" + run.seed);
        box.title = `seed ${run.seed}: ${plain(run.verdict)}` + (planner === "none" ? "" : run.success ? ", robot arrived without a collision" : ", robot without success") + (run.distance === null ? "" : `, smallest surface distance ${run.distance.toFixed(2)} m`);
        box.style.color = (VERDICTS[run.verdict] || ["#1f2328"])[0];
      }
      if (runs.length > 24) line.append(` and ${runs.length - 24} more`);
    }
    const again = folds.get(row) || [];
    if (again.length) fold(again, middle);
    return node;
  }
  // Scenarios that repeat this one: a line each, written when they are first looked at.
  function fold(again, parent) {
    const box = word("details", "", parent, "fold"), sum = word("summary", count(again.length, "repeat") + " of this scenario", box);
    const differs = again.filter((r) => r.verdict !== again[0].verdict).length > 0;
    sum.append(" · " + (differs ? ORDER.map((v) => [v, again.filter((r) => r.verdict === v).length]).filter(([, n]) => n).map(([v, n]) => n + " " + plain(v)).join(", ") : plain(again[0].verdict)));
    box.addEventListener("toggle", () => {
      if (!box.open || box.querySelector("ul")) return;
      const list = word("ul", "", box);
      for (const row of again) {
        const line = word("li", "", list), [color, sign] = VERDICTS[row.verdict] || ["#1f2328", "–"];
        const name = word(row.folder === undefined ? "span" : "a", row.scenario, line);
        if (row.folder !== undefined) name.href = address(row);
        word("span", ` ${sign} ${plain(row.verdict)}`, line).style.color = color;
      }
    });
  }

  const searched = (row) => [row.scenario, row.title, row.reading, row.context, row.task, row.rough, row.pattern, row.location].join(" ").toLowerCase();
  const LEAST = { verdict: (r) => ORDER.indexOf(r.verdict), title: (r) => r.title || r.scenario, humans: (r) => r.humans || 0,
    distance: (r) => Math.min(Infinity, ...r.runs.map((x) => x.distance).filter((x) => x !== null)) };
  function filter() {
    const words = at("words").value.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (id, key) => { const wanted = at(id).value; return (row) => !wanted || row[key] === wanted; };
    const tests = [fits("verdict-of", "verdict"), fits("location-of", "location"), fits("pattern-of", "pattern"), (row) => { const text = words.length ? searched(row) : ""; return words.every((w) => text.includes(w)); }];
    rows = data.rows.filter((row) => tests.every((test) => test(row)));
    const key = LEAST[at("order").value];
    if (key) rows = rows.map((row) => [key(row), row]).sort((a, b) => (a[0] < b[0] ? -1 : a[0] > b[0] ? 1 : 0)).map(([, row]) => row);
    page = 0;
    summary(); list();
  }
  // What repeats a scenario that is listed stands folded below it.
  function folded() {
    folds = new Map();
    if (at("fold").value) return rows;
    const first = new Map(rows.filter((r) => !r.repeats).flatMap((r) => [[r.folder, r], [r.scenario, r]]));
    return rows.filter((row) => {
      const of = row.repeats ? first.get(row.repeats) : undefined;
      if (!of) return true;
      if (!folds.has(of)) folds.set(of, []);
      folds.get(of).push(row);
      return false;
    });
  }
  function list() {
    const box = at("rows"), listed = folded(), pages = Math.max(1, Math.ceil(listed.length / STEP));
    box.textContent = "";
    page = Math.max(0, Math.min(page, pages - 1));
    const from = whole ? 0 : page * STEP, to = whole ? listed.length : Math.min(from + STEP, listed.length);
    for (const row of listed.slice(from, to)) box.appendChild(item(row));
    at("part").textContent = listed.length > to - from ? `${from + 1} to ${to} of ${listed.length}` : "";
    turn(pages);
    if (!rows.length) word("li", data.rows.length ? "nothing fits these filters" : "there is no scenario in this folder", box, "quiet");
  }
  // Buttons for the first, the last and the pages around this one.
  function turn(pages) {
    const nav = at("pages"); nav.textContent = "";
    nav.hidden = whole || pages < 2;
    const button = (text, to, name) => {
      const b = word("button", text, nav);
      b.type = "button"; b.setAttribute("aria-label", name);
      if (to === page && name.startsWith("page")) b.setAttribute("aria-current", "page");
      b.disabled = to < 0 || to >= pages;
      b.addEventListener("click", () => { page = to; list(); at("filters").scrollIntoView({ block: "start" }); });
    };
    button("‹", page - 1, "previous page");
    let last = -1;
    for (let i = 0; i < pages; i++) {
      if (i > 0 && i < pages - 1 && Math.abs(i - page) > 2) continue;
      if (i - last > 1) word("span", "…", nav);
      button(String(i + 1), i, "page " + (i + 1));
      last = i;
    }
    button("›", page + 1, "next page");
  }
  function options(id, key) {
    const select = at(id), found = new Map();
    for (const row of data.rows) if (row[key] !== undefined) found.set(row[key], (found.get(row[key]) || 0) + 1);
    word("option", "any", select).value = "";
    for (const name of [...found.keys()].sort()) { const option = word("option", `${plain(name)} (${found.get(name)})`, select); option.value = name; }
    select.addEventListener("change", filter);
  }
  options("verdict-of", "verdict"); options("location-of", "location"); options("pattern-of", "pattern");
  at("order").addEventListener("change", filter);
  at("words").addEventListener("input", filter);
  at("filters").addEventListener("submit", (e) => e.preventDefault());
  at("clear").addEventListener("click", () => { at("filters").reset(); filter(); });
  at("fold-of").hidden = !data.rows.some((r) => r.repeats);
  at("fold").addEventListener("change", () => { page = 0; list(); });
  addEventListener("beforeprint", () => { whole = true; list(); });
  addEventListener("afterprint", () => { whole = false; list(); });
  // Other pages of a large library: filters act on the scenarios of this one.
  function parts() {
    if (!data.parts) return;
    const nav = at("parts"), { links, here, all } = data.parts;
    nav.hidden = false;
    word("p", `${count(all.scenarios, "scenario")} on ${links.length} pages · ${all.distinct} distinct · ${all.realised} realised · ${wilson(all.realised, all.distinct)}. Lists and filters are of this page; socrates library query searches all.`, nav, "quiet");
    links.forEach((link, number) => {
      const node = word(number === here ? "b" : "a", `${link.from}–${link.to}`, nav);
      if (number !== here) node.href = link.href;
    });
  }
  parts();
  figures();
  covered();
  filter();
})();
