(() => {
  const { View, controls, word, seconds } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const { has, clean, kept, shuffler, remark, row, plain, save } = raters;
  const COLUMNS = data.columns, QUESTIONS = data.questions;
  // An answer that something was not as asked comes with the words.
  const NAMES = COLUMNS.includes("sentence"), AGREES = "as_asked";
  const KEY = "socrates-labels-" + data.key;
  if (!data.runs.length) { at("none").hidden = false; at("stage").hidden = true; return; }

  // Answers by rater, by run.
  const book = kept(KEY), mine = () => book.of(rater), keep = () => book.keep(rater);
  let rater = book.rater;
  let order = [], place = 0, run = null, view = null;
  const of = (r) => (has(mine(), r.name) ? mine()[r.name] : {});
  const owes = (r) => NAMES && of(r).as_asked && of(r).as_asked !== AGREES;
  const whole = (r) => QUESTIONS.every((q) => of(r)[q.id]) && (!owes(r) || Boolean(of(r).sentence));

  // Every rater has an order of their own, always the same, so that fatigue does not fall on the same runs.
  function shuffle() {
    const numbers = data.runs.map((r, i) => i);
    // Runs that are known by their numbers stay in the order of these.
    order = data.named ? numbers : shuffler(data.key + rater)(numbers);
  }

  const own = { ...Object.fromEntries(QUESTIONS[0].answers.map(([what, key]) => [key, () => answer(what)])), x: () => undo(), p: () => choose(place - 1) };
  const { clock, until } = controls((now) => { if (view) view.show(now); }, own);

  // Films that are too large for the page lie beside it.
  globalThis.film = (name, parts) => { const r = data.runs.find((r) => r.name === name); if (r) Object.assign(r, parts); };
  function fetched(r, then) {
    if (r.agents) { then(); return; }
    const script = document.createElement("script");
    script.src = r.film;
    script.addEventListener("load", then);
    script.addEventListener("error", () => { at("number").textContent = `${r.name}: ${r.film} is not beside this page`; });
    document.head.appendChild(script);
  }
  function choose(index) {
    place = Math.max(0, Math.min(index, order.length - 1));
    const chosen = data.runs[order[place]];
    fetched(chosen, () => { if (data.runs[order[place]] === chosen && chosen.agents) look(chosen); });
  }
  function look(chosen) {
    run = chosen;
    view = new View(at("map"), data.places[run.place]);
    // The name of the run would tell the planner.
    view.load(run); at("map").setAttribute("aria-label", "the run, seen from above");
    until(seconds(run));
    at("number").textContent = data.named ? `${run.name} · ${place + 1} of ${order.length}` : `Run ${place + 1} of ${order.length}`;
    const asked = at("asked"); asked.textContent = "";
    for (const [name, text] of run.texts) { word("dt", name, asked); word("dd", text, asked, "said"); }
    ask();
    view.lay(run.focus); clock.set(0);
    clock.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
  function ask() {
    if (!run) { progress(); return; }
    const box = at("questions"); box.textContent = "";
    for (const { id, words, about, answers: allowed } of QUESTIONS) {
      const part = word("fieldset", "", box); word("legend", words, part); word("p", about, part, "quiet");
      for (const [answer] of allowed) {
        const b = word("button", player.plain(answer), part, "answer " + answer);
        b.type = "button"; b.disabled = !rater;
        b.setAttribute("aria-pressed", String(of(run)[id] === answer));
        b.addEventListener("click", () => set(id, of(run)[id] === answer ? null : answer));
      }
    }
    if (owes(run)) {
      const part = word("label", "words of the request that did not happen ", box), field = document.createElement("textarea");
      field.rows = 3; field.id = "sentence"; field.value = of(run).sentence || ""; part.appendChild(field);
      field.addEventListener("input", () => { note(field.value); });
    }
    if (rater) remark(box, of(run).comment || "", comment); else word("p", "Write your name above first.", box, "bad");
    progress();
  }
  function ours() {
    const own = book.own(rater);
    if (!has(own, run.name)) own[run.name] = {};
    return own;
  }
  function set(id, answer) {
    if (!rater) return;
    const own = ours();
    if (answer) own[run.name][id] = answer; else delete own[run.name][id];
    if (!owes(run)) delete own[run.name].sentence;
    keep(); ask();
  }
  // The words are written while they are typed; the field itself stays.
  function note(text) {
    mine()[run.name].sentence = text.replace(/\s+/g, " ").trim();
    keep(); progress();
  }
  function comment(text) {
    if (text) ours()[run.name].comment = plain(text); else delete ours()[run.name].comment;
    keep(); progress();
  }
  function progress() {
    const done = data.runs.filter(whole).length;
    at("progress").textContent = `${done} of ${data.runs.length} labeled`;
    at("bar").firstElementChild.style.width = 100 * done / data.runs.length + "%";
    at("table").value = csv(); at("export").disabled = !done;
  }
  // Runs in the order of the page, never of the rater: tables of two raters can be laid side by side.
  function csv() {
    const rows = data.runs.filter(whole).map((r) => COLUMNS.map((column) => ({ run: r.name, rater })[column] ?? of(r)[column] ?? ""));
    return [COLUMNS, ...rows].map(row).join("\n") + "\n";
  }
  function open() {
    for (let step = 1; step <= order.length; step++) {
      const index = (place + step) % order.length;
      if (!whole(data.runs[order[index]])) { choose(index); return; }
    }
  }
  function answer(what) {
    if (!run) return;
    const question = QUESTIONS.find((q) => !of(run)[q.id]);
    if (question) set(question.id, what);
  }
  function undo() {
    if (!run) return;
    const question = [...QUESTIONS].reverse().find((q) => of(run)[q.id]);
    if (question) set(question.id, null);
  }

  at("rater").value = rater;
  at("rater").addEventListener("input", (e) => { rater = clean(e.target.value); keep(); shuffle(); ask(); });
  at("rater").addEventListener("change", () => { at("rater").value = rater; choose(0); });
  at("back").addEventListener("click", () => choose(place - 1));
  at("next").addEventListener("click", () => choose(place + 1));
  at("open").addEventListener("click", open);
  at("export").addEventListener("click", () => save(csv(), "labels", rater));
  addEventListener("resize", () => { if (!view) return; view.lay(run.focus); view.show(clock.now); });
  addEventListener("keydown", (e) => { if (e.key === "Enter" && !/^(BUTTON|INPUT|SUMMARY|SELECT|TEXTAREA)$/.test(e.target.tagName)) choose(place + 1); });
  shuffle();
  const first = order.findIndex((i) => !whole(data.runs[i]));
  choose(Math.max(0, first));
})();
