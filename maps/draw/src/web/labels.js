(() => {
  const { View, Clock, keys, word, secs, seconds } = player;
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const COLUMNS = ["run", "rater", "simulable", "appropriate", "as_asked"];
  const QUESTIONS = [
    ["simulable", "Is it simulable?", "Everybody moves as people and robots can: nobody passes through walls or others, jumps, or is stuck."],
    ["appropriate", "Is it appropriate?", "People, places and what happens fit the social context, the task and the location."],
    ["as_asked", "Is it as asked?", "What the request describes is what you see: who, where, how they react, and the robot meets them."],
  ];
  const ANSWERS = [["yes", "y"], ["no", "n"], ["unsure", "u"]];
  const KEY = "socrates-labels-" + data.key;
  if (!data.runs.length) { at("none").hidden = false; at("stage").hidden = true; return; }

  // Answers by rater, by run. A browser that keeps nothing still labels; the table can be saved all the same.
  let kept = {};
  try { kept = JSON.parse(localStorage.getItem(KEY)) || {}; } catch { kept = {}; }
  if (typeof kept !== "object" || Array.isArray(kept)) kept = {};
  const keep = () => { try { localStorage.setItem(KEY, JSON.stringify({ rater, answers })); } catch { /* nothing is kept */ } };
  let rater = typeof kept.rater === "string" ? kept.rater : "", answers = kept.answers && typeof kept.answers === "object" ? kept.answers : {};
  let order = [], place = 0, run = null, view = null;
  const mine = () => { const own = Object.prototype.hasOwnProperty.call(answers, rater) ? answers[rater] : {}; return own; };
  const of = (r) => (Object.prototype.hasOwnProperty.call(mine(), r.name) ? mine()[r.name] : {});
  const whole = (r) => QUESTIONS.every(([id]) => of(r)[id]);
  // Nothing in a name that would need quotes in a table.
  const clean = (name) => name.replace(/[",;\r\n\t]/g, " ").replace(/^[=+@-]+/, "").replace(/\s+/g, " ").trim();

  // Every rater has an order of their own, always the same, so that fatigue does not fall on the same runs.
  function shuffle() {
    let state = 2166136261;
    for (const c of data.key + rater) state = Math.imul(state ^ c.codePointAt(0), 16777619) >>> 0;
    const draw = () => { state = (Math.imul(state, 1664525) + 1013904223) >>> 0; return state / 4294967296; };
    order = data.runs.map((r, i) => i);
    for (let i = order.length - 1; i > 0; i--) { const j = Math.floor(draw() * (i + 1)); [order[i], order[j]] = [order[j], order[i]]; }
  }

  const clock = new Clock((now) => {
    at("time").value = now; at("clock").textContent = secs(now);
    at("time").setAttribute("aria-valuetext", secs(now));
    if (view) view.show(now);
  }, (on) => { at("play").textContent = on ? "❚❚" : "▶"; at("play").setAttribute("aria-label", on ? "pause" : "play"); });
  const go = (t) => { clock.play(false); clock.set(t); };

  function choose(index) {
    place = Math.max(0, Math.min(index, order.length - 1));
    run = data.runs[order[place]];
    view = new View(at("map"), data.places[run.place]);
    // The name of the run would tell the planner.
    view.load(run); at("map").setAttribute("aria-label", "the run, seen from above");
    clock.end = seconds(run); clock.rate = Number(at("speed").value);
    at("time").max = clock.end;
    at("number").textContent = `Run ${place + 1} of ${order.length}`;
    const asked = at("asked"); asked.textContent = "";
    for (const [name, text] of [["Social context", run.context], ["Task of the robot", run.task], ["Asked for", run.rough || "nothing in particular"], ["Location", run.location + (run.about ? ": " + run.about : "")]]) {
      word("dt", name, asked); word("dd", text, asked, "said");
    }
    ask();
    view.lay(run.focus); clock.set(0);
    clock.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
  function ask() {
    const box = at("questions"); box.textContent = "";
    for (const [id, question, about] of QUESTIONS) {
      const part = word("fieldset", "", box); word("legend", question, part); word("p", about, part, "quiet");
      for (const [answer] of ANSWERS) {
        const b = word("button", answer, part, "answer " + answer);
        b.type = "button"; b.disabled = !rater;
        b.setAttribute("aria-pressed", String(of(run)[id] === answer));
        b.addEventListener("click", () => set(id, of(run)[id] === answer ? null : answer));
      }
    }
    if (!rater) word("p", "Write your name above first.", box, "bad");
    progress();
  }
  function set(id, answer) {
    if (!rater) return;
    if (!Object.prototype.hasOwnProperty.call(answers, rater)) answers[rater] = {};
    const own = answers[rater];
    if (!Object.prototype.hasOwnProperty.call(own, run.name)) own[run.name] = {};
    if (answer) own[run.name][id] = answer; else delete own[run.name][id];
    keep(); ask();
  }
  function progress() {
    const done = data.runs.filter(whole).length;
    at("progress").textContent = `${done} of ${data.runs.length} labeled`;
    at("bar").firstElementChild.style.width = 100 * done / data.runs.length + "%";
    at("table").value = csv(); at("export").disabled = !done;
  }
  // Runs in the order of the page, never of the rater: tables of two raters can be laid side by side.
  function csv() {
    const cell = (text) => (/[",\r\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text);
    const rows = data.runs.filter(whole).map((r) => [r.name, rater, ...QUESTIONS.map(([id]) => of(r)[id])]);
    return [COLUMNS, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
  }
  function save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
    link.download = "labels-" + (rater.replace(/[^\w-]+/g, "_") || "nobody") + ".csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  function open() {
    for (let step = 1; step <= order.length; step++) {
      const index = (place + step) % order.length;
      if (!whole(data.runs[order[index]])) { choose(index); return; }
    }
  }
  function answer(what) {
    const question = QUESTIONS.find(([id]) => !of(run)[id]);
    if (question) set(question[0], what);
  }
  function undo() {
    const question = [...QUESTIONS].reverse().find(([id]) => of(run)[id]);
    if (question) set(question[0], null);
  }

  at("rater").value = rater;
  at("rater").addEventListener("input", (e) => { rater = clean(e.target.value); keep(); shuffle(); ask(); });
  at("rater").addEventListener("change", () => { at("rater").value = rater; choose(0); });
  at("play").addEventListener("click", () => clock.toggle());
  at("speed").addEventListener("change", (e) => { clock.rate = Number(e.target.value); });
  at("time").addEventListener("input", (e) => go(Number(e.target.value)));
  at("back").addEventListener("click", () => choose(place - 1));
  at("next").addEventListener("click", () => choose(place + 1));
  at("open").addEventListener("click", open);
  at("export").addEventListener("click", save);
  addEventListener("resize", () => { view.lay(run.focus); view.show(clock.now); });
  addEventListener("keydown", (e) => { if (e.key === "Enter" && !/^(BUTTON|INPUT|SUMMARY|SELECT|TEXTAREA)$/.test(e.target.tagName)) choose(place + 1); });
  keys({ " ": () => clock.toggle(), ArrowRight: () => go(clock.now + 0.5), ArrowLeft: () => go(clock.now - 0.5), Home: () => go(0), End: () => go(clock.end),
    y: () => answer("yes"), n: () => answer("no"), u: () => answer("unsure"), x: undo, p: () => choose(place - 1) });
  shuffle();
  const first = order.findIndex((i) => !whole(data.runs[i]));
  choose(Math.max(0, first));
})();
