(() => {
  const { View, Clock, make, word, seconds, secs } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const { clean, kept, shuffler, remark, row, plain, save } = raters;
  const KEY = "socrates-observers-" + data.key, HZ = 10;
  if (!data.tasks.length) { at("none").hidden = false; at("stage").hidden = true; return; }

  // Answers by rater, by task.
  const book = kept(KEY), mine = () => book.of(rater);
  let rater = book.rater;
  let order = [], task = null, views = [], answer = null, ended = false, words = "";

  // Every rater has an order of their own, always the same: sliders, then beliefs, then pairs. Films that come again come in the
  // first half and at the end, with all others in between.
  function deal() {
    const shuffled = shuffler(data.key + rater);
    const of = (kind) => data.tasks.filter((t) => t.kind === kind);
    const again = of("again"), twice = new Set(again.map((t) => t.films[0]));
    const first = of("rate").filter((t) => t.all), others = shuffled(of("rate").filter((t) => !t.all)).slice(0, data.each);
    const once = shuffled([...first, ...others].filter((t) => !twice.has(t.films[0])));
    const half = Math.floor(once.length / 2);
    const early = shuffled([...first.filter((t) => twice.has(t.films[0])), ...once.slice(0, half)]);
    order = [...early, ...once.slice(half), ...shuffled(again), ...shuffled(of("belief")), ...shuffled(of("pair"))];
  }

  const clock = new Clock((now) => {
    for (const view of views) view.show(Math.min(now, view.end));
    at("clock").textContent = clock && clock.end ? `${secs(now)} of ${secs(clock.end)}` : "";
    if (task && task.kind === "belief" && Array.isArray(answer)) {
      const value = Number(at("belief").value) / 100;
      while (answer.length <= Math.floor(now * HZ + 1e-6)) answer.push(value);
    }
  }, (playing) => {
    at("play").disabled = playing || ended || !rater;
    if (!playing && task && clock.end && clock.now >= clock.end) { ended = true; at("play").disabled = true; open(); }
  });

  function show() {
    task = order.find((t) => mine()[t.id] === undefined) || null;
    at("stage").hidden = !task; at("end").hidden = Boolean(task);
    answer = null; ended = false; views = []; words = "";
    // The clock stands at the end of the film before: without this the next one would count as seen.
    clock.end = 0; clock.set(0); clock.play(false);
    progress();
    if (!task) return;
    const films = task.films.map((i) => data.films[i]), pair = films.length > 1;
    at("number").textContent = `${order.indexOf(task) + 1} of ${order.length}`;
    at("context").textContent = films[0].context;
    const box = at("picture"); box.textContent = ""; box.className = pair ? "two" : "";
    for (const [side, film] of films.entries()) {
      const figure = word("figure", "", box);
      const svg = make("svg", {}, null); figure.appendChild(svg);
      if (pair) word("figcaption", side ? "second" : "first", figure);
      const view = new View(svg, data.places[film.place]);
      view.load(film); svg.setAttribute("aria-label", "the film, seen from above");
      view.end = seconds(film); view.focus = film.focus;
      view.lay(film.focus);
      if (task.kind === "belief") film.goals.forEach(([x, y], i) => mark(view, x, y, "AB"[i]));
      views.push(view);
    }
    clock.end = Math.max(...views.map((view) => view.end));
    question();
    at("play").disabled = !rater; at("next").disabled = true;
    clock.set(0);
  }
  function mark(view, x, y, name) {
    const k = view.k, group = make("g", { class: "goal" }, view.trails);
    make("circle", { cx: x, cy: y, r: 15 * k, fill: "#fff", stroke: "#1f2328", "stroke-width": 2.5 * k }, group);
    make("text", { x, y: y + 6 * k, "text-anchor": "middle", "font-size": 17 * k, "font-weight": 700, fill: "#1f2328" }, group).textContent = name;
  }
  function slider(id, ends, box) {
    const part = word("div", "", box, "slide");
    const input = document.createElement("input");
    Object.assign(input, { type: "range", min: 0, max: 100, step: 1, value: 50, id });
    part.appendChild(input);
    const labels = word("p", "", part, "ends");
    ends.forEach((end) => word("span", end, labels));
    return input;
  }
  function question() {
    const box = at("questions"); box.textContent = "";
    if (!rater) word("p", "Write your name above first.", box, "bad");
    if (task.kind === "belief") {
      word("p", "Which way will it go? While the film plays, keep the slider where you think the robot is going: to A, to B, or in the middle when you cannot tell.", box, "lead");
      slider("belief", ["surely to A", "cannot tell", "surely to B"], box).setAttribute("aria-label", "which way will it go, A to B");
      answer = [];
    } else if (task.kind === "pair") {
      word("p", "Which robot behaves better among the people?", box, "lead");
      const part = word("div", "", box, "choices");
      for (const [what, words] of [["left", "the first one"], ["equal", "both alike"], ["right", "the second one"]]) {
        const b = word("button", words, part, "answer");
        b.type = "button"; b.disabled = true; b.dataset.answer = what; b.setAttribute("aria-pressed", "false");
        b.addEventListener("click", () => { answer = what; for (const other of part.children) other.setAttribute("aria-pressed", String(other === b)); ready(); });
      }
    } else {
      word("p", "How good is the behavior of the robot in this film, as a whole?", box, "lead");
      const input = slider("rate", ["extremely bad", "fair", "extremely good"], box);
      input.setAttribute("aria-label", "how good, extremely bad to extremely good");
      input.disabled = true; input.classList.add("unmoved");
      const moved = () => { if (!ended) return; input.classList.remove("unmoved"); answer = Number(input.value) / 100; ready(); };
      input.addEventListener("input", moved); input.addEventListener("change", moved);
      // A click on the middle is an answer too.
      input.addEventListener("pointerup", moved);
    }
  }
  // What was shut until the film had ended.
  function open() {
    for (const node of at("questions").querySelectorAll("input, button")) node.disabled = task.kind === "belief";
    remark(at("questions"), words, (said) => { words = said; });
    ready();
  }
  const ready = () => { at("next").disabled = !(ended && answer !== null); };
  function next() {
    if (at("next").disabled || !rater) return;
    book.own(rater)[task.id] = answer;
    // Under a name that no question has.
    if (words) book.own(rater)[task.id + " comment"] = plain(words);
    book.keep(rater); show();
  }
  function progress() {
    const done = order.filter((t) => mine()[t.id] !== undefined).length;
    at("progress").textContent = `${done} of ${order.length} answered`;
    at("bar").firstElementChild.style.width = 100 * done / Math.max(order.length, 1) + "%";
    at("export").disabled = !done;
  }
  // One line for each answer; of a belief one for each tenth of a second.
  function csv() {
    const rows = [["task", "rater", "t", "value", "comment"]];
    for (const t of data.tasks) {
      const said = mine()[t.id];
      if (said === undefined) continue;
      const noted = mine()[t.id + " comment"] || "";
      if (Array.isArray(said)) said.forEach((value, i) => rows.push([t.id, rater, (i / HZ).toFixed(1), value.toFixed(2), i ? "" : noted]));
      else rows.push([t.id, rater, "", typeof said === "number" ? said.toFixed(2) : said, noted]);
    }
    return rows.map(row).join("\n") + "\n";
  }
  globalThis.observed = csv;

  at("rater").value = rater;
  at("rater").addEventListener("input", (e) => { rater = clean(e.target.value); if (task && !clock.playing && !ended) { deal(); show(); } });
  at("rater").addEventListener("change", () => { at("rater").value = rater; book.keep(rater); clock.play(false); deal(); show(); });
  at("play").addEventListener("click", () => { if (!rater || ended) return; at("rater").disabled = true; document.querySelector("details").open = false; at("stage").scrollIntoView(); clock.play(true); });
  at("next").addEventListener("click", next);
  at("export").addEventListener("click", () => save(csv(), "observer", rater));
  addEventListener("resize", () => { for (const view of views) { view.lay(view.focus); view.show(Math.min(clock.now, view.end)); } });
  // A film that nobody looks at does not run on.
  addEventListener("visibilitychange", () => { if (document.hidden && clock.playing) { clock.play(false); at("play").disabled = false; } });
  deal(); show();
})();
