"use strict";
// The survey: consent, who, what is seen, then each film and its questions, and the end. Answers go to the server that sent this page, film by
// film; opened from a disk, the page keeps them itself and saves them as a file at the end.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id), main = at("main"), KEY = "socrates-survey-" + data.key;
  const query = new URLSearchParams(location.search);
  const NS = "http://www.w3.org/2000/svg";
  const make = (tag, text, parent, look) => {
    const node = document.createElement(tag);
    if (look) node.className = look;
    if (text) node.textContent = text;
    if (parent) parent.appendChild(node);
    return node;
  };
  const button = (text, parent, act, look) => { const b = make("button", text, parent, look); b.type = "button"; b.addEventListener("click", act); return b; };
  const paragraphs = (text, parent) => text.split(/\n\s*\n/).filter((part) => part.trim()).forEach((part) => make("p", part.trim(), parent, "text"));
  const round = (x) => Math.round(x * 10) / 10;

  // What this browser remembers: who, their order, how far they are, answers that nobody else has, and the ones being given.
  let kept = {};
  try { kept = JSON.parse(localStorage.getItem(KEY)) || {}; } catch { kept = {}; }
  if (typeof kept !== "object" || Array.isArray(kept)) kept = {};
  const keep = () => { try { localStorage.setItem(KEY, JSON.stringify(kept)); } catch { /* a private window remembers nothing */ } };
  // Time that people spent here; a page that is out of sight does not count.
  let since = performance.now();
  const spent = () => { const now = performance.now(); if (!document.hidden) kept.spent_s = (kept.spent_s || 0) + (now - since) / 1000; since = now; keep(); };
  document.addEventListener("visibilitychange", () => { if (document.hidden) { const now = performance.now(); kept.spent_s = (kept.spent_s || 0) + (now - since) / 1000; keep(); } since = performance.now(); });

  // Nobody at the other end: the page was opened from a disk, or lies where nobody takes answers.
  let alone = location.protocol === "file:";
  async function send(what, body) {
    let answer;
    try {
      answer = await fetch("api/" + what, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
    } catch { throw new Error("The connection was lost. Your answers are kept here; please try again."); }
    if (answer.status === 404 || answer.status === 405 || answer.status === 501) { const none = new Error("nobody takes answers here"); none.nobody = true; throw none; }
    const told = await answer.json().catch(() => ({}));
    if (!answer.ok) { const why = new Error((told.error && told.error.message) || "The server did not take it (" + answer.status + ")."); why.status = answer.status; throw why; }
    return told;
  }
  // Without a server the order follows from the id, so that it is the same after a reload.
  function drawn(id) {
    const asked = data.orders.find((order) => order.name === query.get("order"));
    if (asked) return asked;
    let state = 2166136261;
    for (const c of data.key + id) state = Math.imul(state ^ c.codePointAt(0), 16777619) >>> 0;
    return data.orders[state % data.orders.length];
  }
  async function begin(id) {
    if (!alone) {
      try {
        const told = await send("begin", { participant: id, token: kept.token || null });
        Object.assign(kept, { token: told.token, order: told.order, films: told.films, done: told.done, ended: told.ended });
        keep();
        return;
      } catch (why) { if (!why.nobody) throw why; alone = true; }
    }
    if (kept.participant !== id || !kept.films) {
      const order = drawn(id);
      Object.assign(kept, { participant: id, order: order.name, films: order.films, done: 0, lines: [], spent_s: 0, ended: false });
    }
    keep();
  }

  function screen(title, step) {
    main.textContent = "";
    if (title) make("h1", title, main);
    at("step").textContent = step || "";
    const films = kept.films ? kept.films.length : 0;
    at("bar").firstElementChild.style.width = films ? 100 * Math.min(1, kept.done / films) + "%" : "0";
    scrollTo(0, 0); main.focus({ preventScroll: true }); since = performance.now();
  }
  // Does something that can fail; says why and lets people try again.
  async function tried(b, act) {
    const box = b.closest(".moves");
    b.disabled = true;
    main.querySelectorAll(".moves + .bad").forEach((node) => node.remove());
    try { await act(); } catch (why) { b.disabled = false; const told = make("p", why.message, null, "bad"); told.setAttribute("role", "alert"); box.after(told); }
  }

  function consent() {
    screen("Before you begin");
    data.consent.forEach((part) => make("p", part, main, "text"));
    const moves = make("div", "", main, "moves");
    button("I agree and take part", moves, who, "main").id = "agree";
    button("I do not take part", moves, () => { screen("Thank you"); make("p", "Nothing is recorded of this visit. You can close this page.", main); }).id = "decline";
  }
  function who() {
    const given = query.get("PROLIFIC_PID") || query.get("participant") || (alone ? kept.participant : "") || "";
    if (given) { screen("One moment"); const moves = make("div", "", main, "moves"), b = button("Continue", moves, () => tried(b, () => begin(given).then(look)), "main"); b.click(); return; }
    screen("Who are you?");
    make("p", "Please type the id under which you were invited, for example your Prolific id. Do not type your name.", main, "text");
    const field = make("input", "", main); field.type = "text"; field.id = "who"; field.maxLength = 64; field.autocomplete = "off"; field.setAttribute("aria-label", "your id");
    const moves = make("div", "", main, "moves"), b = button("Continue", moves, () => tried(b, () => begin(field.value.trim()).then(look)), "main");
    b.id = "go"; b.disabled = true;
    field.addEventListener("input", () => { b.disabled = !field.value.trim(); });
    field.addEventListener("keydown", (e) => { if (e.key === "Enter" && !b.disabled) b.click(); });
    field.focus();
  }
  function drawing(parent, inside) {
    const svg = document.createElementNS(NS, "svg"); svg.setAttribute("viewBox", "-22 -22 44 44"); svg.setAttribute("aria-hidden", "true");
    svg.innerHTML = inside; parent.appendChild(svg);
  }
  function look() {
    if (kept.ended) { finish(); return; }
    screen("What you will see");
    if (kept.done) make("p", `Welcome back: the questions about ${kept.done} of ${kept.films.length} films are answered, and you go on with the next one.`, main, "text");
    make("p", `You will watch ${kept.films.length} short films of robots that move among people. ${data.about} Each film can be watched again before you answer.`, main, "text");
    const key = make("ul", "", main, "key");
    const pictures = {
      robot: '<rect x="-14" y="-14" width="28" height="28" rx="5" fill="#0072B2"/><path d="M10 0L-6 8L-3 0L-6 -8z" fill="#fff"/>',
      person: '<circle r="14" fill="#D55E00"/><path d="M11 0L3 5L3 -5z" fill="#fff"/>',
      place: '<path d="M-20 -12h18v8h-18zM2 -12h18v8h-18z" fill="#3a3d46"/><rect x="-20" y="4" width="16" height="8" fill="#e6e8ee"/><rect x="2" y="6" width="18" height="4" fill="#b5651d"/>',
      front: '<rect x="-11" y="-14" width="22" height="32" rx="5" fill="#0072B2"/><rect x="-7" y="-10" width="14" height="9" rx="2" fill="#fff"/><circle cx="-3" cy="-5.500" r="1.600"/><circle cx="3" cy="-5.500" r="1.600"/>',
      bubble: '<rect x="-20" y="-10" width="40" height="20" rx="4" fill="#fff4d6" stroke="#b07a00"/><text y="5" font-size="13" text-anchor="middle">wait</text>',
    };
    data.shapes.forEach(([kind, words]) => { const li = make("li", "", key); drawing(li, pictures[kind]); make("span", words, li); });
    if (data.instructions) paragraphs(data.instructions, main);
    const moves = make("div", "", main, "moves");
    button(kept.done ? "Go on" : "Start", moves, next, "main").id = "start";
  }
  function next() { if (kept.done >= kept.films.length) end(); else watch(kept.films[kept.done]); }

  // Films lie beside the page.
  const films = {};
  globalThis.film = (id, parts) => { films[id] = parts; };
  function fetched(id, then, fail) {
    if (films[id]) { then(films[id]); return; }
    const script = document.createElement("script");
    script.src = "films/" + id + ".js";
    script.addEventListener("load", () => (films[id] ? then(films[id]) : fail()));
    script.addEventListener("error", () => { script.remove(); fail(); });
    document.head.appendChild(script);
  }
  const place = () => `Film ${kept.done + 1} of ${kept.films.length}`;
  function watch(id) {
    const about = data.films[id];
    screen("", place());
    const context = data.contexts[about.scenario];
    if (context) { const box = make("div", "", main, "context"); make("p", context, box).style.margin = 0; }
    const how = make("p", "Please watch the film to its end. The questions come after it.", main, "quiet");
    make("span", " Turn your phone sideways to see it larger.", how, "turn");
    const figure = make("figure", "", main), svg = document.createElementNS(NS, "svg");
    svg.setAttribute("role", "img"); svg.setAttribute("aria-label", "film of a robot among people"); svg.id = "film"; figure.appendChild(svg);
    const bar = make("div", "", figure, "played"); make("i", "", bar);
    const moves = make("div", "", main, "moves");
    const go = button("Continue to the questions", moves, () => ask(id, watched), "main"); go.id = "questions"; go.disabled = true;
    const again = button("Watch again", moves, () => play()); again.id = "again"; again.hidden = true;
    let watched = 0, start = null;
    function ready(film) {
      const [w, h] = film.size;
      svg.setAttribute("viewBox", `0 0 ${w} ${h}`); svg.setAttribute("font-family", "Ubuntu, 'Segoe UI', Helvetica, Arial, sans-serif");
      svg.innerHTML = `<clipPath id="frame"><rect width="${w}" height="${h}"/></clipPath><g clip-path="url(#frame)">${film.ground}<g></g></g>`;
      const moving = svg.lastElementChild.lastElementChild;
      let shown = -1;
      const show = (time) => {
        const index = Math.min(film.pictures.length - 1, Math.floor(time * film.fps + 1e-6));
        if (index === shown) return;
        let source = index; while (source > 0 && !film.pictures[source]) source--;
        moving.innerHTML = film.pictures[source]; shown = index;
      };
      show(0);
      start = button("▶ Play the film", figure, () => play(), "main start"); start.id = "play";
      let now = 0, last = 0, playing = false;
      play = () => {
        if (start) { start.remove(); start = null; }
        if (figure.getBoundingClientRect().bottom > innerHeight) figure.scrollIntoView({ block: "start" });
        again.hidden = true; now = 0; last = performance.now(); playing = true;
        requestAnimationFrame(tick);
      };
      // A tab that is out of sight draws nothing: the film waits there.
      const tick = (stamp) => {
        if (!playing || !svg.isConnected) return;
        const step = Math.max(0, Math.min((stamp - last) / 1000, 0.25)); last = Math.max(last, stamp);
        now = Math.min(film.length_s, now + step);
        show(now); bar.firstElementChild.style.width = 100 * now / film.length_s + "%";
        watched = Math.max(watched, now);
        if (now < film.length_s) { requestAnimationFrame(tick); return; }
        playing = false; go.disabled = false; again.hidden = false; go.focus({ preventScroll: true }); moves.scrollIntoView({ block: "nearest" });
      };
    }
    let play = () => {};
    const failed = () => { const told = make("p", "The film could not be loaded. ", main, "bad"); told.setAttribute("role", "alert"); button("Try again", told, () => { told.remove(); fetched(id, ready, failed); }); };
    fetched(id, ready, failed);
  }

  // The questions about a film. `given` holds points by item, those not touched are absent.
  function ask(id, watched) {
    spent();
    screen("What do you think of this film?", place());
    const began = performance.now();
    if (!kept.given || kept.given.film !== id) kept.given = { film: id, answers: {}, checks: {} };
    const given = kept.given, rows = [];
    const checks = data.checks.filter((check) => check.position === kept.done + 1);
    for (const block of data.blocks) {
      const box = make("section", "", main, "block");
      if (block.stem) make("p", block.stem, box);
      if (block.points.length && !block.worded && !block.pairs) make("p", block.anchors.map(([at, words]) => `${at} = ${words}`).join(" · "), box, "ends");
      block.items.forEach(([code, text], index) => {
        checks.filter((check) => check.block === block.id && check.before === index).forEach((check) => row(box, block, check.name, check.text, given.checks, true));
        row(box, block, code, text, given.answers, false);
      });
    }
    function row(box, block, code, text, into, check) {
      const set = make("fieldset", "", box), pair = block.pairs && !check;
      set.dataset.item = code;
      const open = () => !(code in into);
      const mark = () => set.classList.remove("open");
      const take = (points) => { into[code] = points; mark(); keep(); whole(); };
      rows.push({ set, open });
      if (!block.points.length) { slider(set, block, text, into, code, take); return; }
      set.setAttribute("role", "radiogroup"); set.setAttribute("aria-label", text);
      if (pair) { set.className = "pair"; const [left] = text.split(" / "); make("div", left, set, "asked left"); } else make("div", text, set, "asked");
      const points = make("div", "", set, "points");
      for (const [value, words] of block.points) {
        const label = make("label", "", points), radio = document.createElement("input");
        radio.type = "radio"; radio.name = code; radio.value = value; radio.checked = into[code] === value;
        radio.addEventListener("change", () => take(value));
        label.appendChild(radio);
        if (pair) radio.setAttribute("aria-label", String(value)); else make("span", block.worded ? words : String(value), label);
      }
      if (pair) make("div", text.split(" / ")[1], set, "asked right");
    }
    function slider(set, block, text, into, code, take) {
      set.className = "slider";
      if (block.items.length > 1) make("div", text, set, "asked");
      const range = make("input", "", set); range.type = "range"; [range.min, range.max] = block.range; range.step = "any"; range.setAttribute("aria-label", text);
      range.value = code in into ? into[code] : (block.range[0] + block.range[1]) / 2; if (!(code in into)) range.className = "untouched";
      const took = () => { range.className = ""; take(Math.round(Number(range.value))); };
      range.addEventListener("input", took); range.addEventListener("click", took);
      const marks = make("div", "", set, "marks"); block.anchors.forEach(([, words]) => make("span", words, marks));
    }
    const moves = make("div", "", main, "moves");
    let warned = false;
    // Once everything is answered nothing is said of what was open.
    function whole() {
      if (!warned || rows.some(({ open }) => open())) return;
      warned = false; b.textContent = "Continue"; main.querySelectorAll(".moves + .bad").forEach((node) => node.remove());
    }
    const b = button("Continue", moves, () => tried(b, async () => {
      const left = rows.filter(({ set, open }) => { set.classList.toggle("open", open()); return open(); });
      if (left.length && !warned) {
        warned = true; b.textContent = "Continue without these answers"; left[0].set.scrollIntoView({ block: "center" });
        throw new Error(left.length === 1 ? "One question is open; it is marked above. You may leave it open." : `${left.length} questions are open; they are marked above. You may leave them open.`);
      }
      await answered(id, watched, (performance.now() - began) / 1000);
    }), "main");
    b.id = "send";
  }
  async function answered(id, watched, took) {
    const of = (names, from) => Object.fromEntries(names.map((name) => [name, name in from ? from[name] : null]));
    const codes = data.blocks.flatMap((block) => block.items.map(([code]) => code));
    const checks = data.checks.filter((check) => check.position === kept.done + 1).map((check) => check.name);
    const said = kept.said && kept.said.film === id ? kept.said : { film: id, watched_s: round(watched), rt_s: round(took), answers: of(codes, kept.given.answers), checks: of(checks, kept.given.checks) };
    // Sent again as it was, should the answer of the server be lost.
    kept.said = said; spent();
    if (alone) {
      kept.lines.push({ kind: "film", participant: kept.participant, position: kept.done + 1, ...said }); kept.done += 1;
    } else {
      try { kept.done = (await send("film", { token: kept.token, said })).done; } catch (why) { if (why.status) delete kept.said; keep(); throw why; }
    }
    delete kept.said; delete kept.given; keep(); next();
  }
  function end() {
    screen("One moment");
    const moves = make("div", "", main, "moves");
    const b = button("Finish", moves, () => tried(b, async () => {
      spent();
      if (!alone) { finish(await send("end", { token: kept.token, duration_s: round(kept.spent_s || 0) })); return; }
      if (!kept.ended) { kept.lines.push({ kind: "person", participant: kept.participant, order: kept.order, duration_s: round(kept.spent_s || 0) }); kept.ended = true; keep(); }
      finish();
    }), "main");
    b.click();
  }
  async function finish(told) {
    if (!alone && !told) { end(); return; }
    kept.ended = true; keep();
    screen("Thank you", "Done");
    at("bar").firstElementChild.style.width = "100%";
    if (alone) {
      make("p", "Your answers are in this browser only. Please save them, and send the file to whoever invited you.", main, "text");
      const moves = make("div", "", main, "moves");
      button("Save my answers", moves, () => {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([kept.lines.map((line) => JSON.stringify(line) + "\n").join("")], { type: "application/x-ndjson" }));
        link.download = "answers-" + (kept.participant || "").replace(/[^\w-]+/g, "_").slice(0, 24) + ".jsonl"; link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      }, "main").id = "save";
      return;
    }
    make("p", "Your answers have arrived.", main, "text");
    if (told.code) { make("p", "Your completion code:", main); make("p", told.code, main, "code").id = "code"; }
    if (told.url) { const moves = make("div", "", main, "moves"), link = make("a", "Back to where you came from", moves); link.href = told.url; link.id = "back"; }
    if (!told.code && !told.url) make("p", "You can close this page.", main);
  }

  if (!data.orders.length) { screen("There is no film"); return; }
  consent();
})();
