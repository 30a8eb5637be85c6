"use strict";
// The page of the console: asks which questions there are, shows one of them, and sends what a person types. Texts of prompts are
// set as text, never as markup.
const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.hash.slice(1)).get("token") || "";
const ASK_EVERY_MS = 1000, CHECK_AFTER_MS = 500, OPEN_DATA = 6000, DATA_LEAST = 60, LINE = 60;
let questions = [], shown = null, checking = 0, timer = null;

function node(kind, name, ...inside) {
  const made = document.createElement(kind);
  if (name) made.className = name;
  made.append(...inside);
  return made;
}

async function ask(path, what) {
  const headers = { authorization: `Bearer ${token}` };
  const options = what === undefined ? { headers } : { method: "POST", headers: { ...headers, "content-type": "application/json" }, body: JSON.stringify(what) };
  const answer = await fetch(path, options);
  const read = await answer.json();
  if (!answer.ok && answer.status !== 422) throw new Error(read.error ? read.error.message : `status ${answer.status}`);
  return { ok: answer.ok, ...read };
}

function trouble(words) {
  $("trouble").textContent = words;
  $("trouble").hidden = !words;
}

function span(seconds) {
  if (seconds < 60) return `${seconds} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min`;
  return `${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
}

const plural = (count, word) => `${count} ${word}${count === 1 ? "" : "s"}`;
const draft = (number) => `draft-${token.slice(0, 8)}-${number}`;

// ---- the list

const MARKS = { waits: "", answered: "answered", refused: "refused", left: "whoever asked has left" };

function line(question) {
  const button = node("button", question.state, node("span", "what", `${question.number} · ${question.form}`));
  button.type = "button";
  button.append(node("span", "when", span(question.waited_s)));
  const mark = question.state === "waits" ? `for ${question.model}` : MARKS[question.state];
  button.append(node("span", "mark", mark));
  button.setAttribute("aria-current", String(shown !== null && shown.number === question.number));
  button.addEventListener("click", () => show(question.number, true));
  return node("li", "", button);
}

function list() {
  const waiting = questions.filter((one) => one.state === "waits");
  const done = questions.filter((one) => one.state !== "waits").reverse();
  const focused = document.activeElement && document.activeElement.closest("#list li");
  const place = focused ? [focused.parentElement.id, [...focused.parentElement.children].indexOf(focused)] : null;
  $("waiting").replaceChildren(...waiting.map(line));
  $("done").replaceChildren(...done.map(line));
  if (place) $(place[0]).children[place[1]]?.querySelector("button").focus();
  $("none").hidden = waiting.length > 0;
  $("done-head").hidden = done.length === 0;
  $("state").textContent = waiting.length ? `${plural(waiting.length, "question")} ${waiting.length === 1 ? "waits" : "wait"} for you` : "No question waits.";
  document.title = `${waiting.length ? `(${waiting.length}) ` : ""}SocRATES author console`;
  const current = shown && questions.find((one) => one.number === shown.number);
  if (current && current.state !== shown.state) show(current.number, false);
  else if (!shown && waiting.length) show(waiting[0].number, false);
}

async function look() {
  try {
    questions = (await ask("/questions")).questions;
    trouble("");
    list();
  } catch (why) {
    const gone = why instanceof TypeError;
    trouble(gone ? "The console has ended, or this machine cannot reach it. Your drafts are kept as long as this page is open." : `${why.message}.`);
  }
  setTimeout(look, ASK_EVERY_MS);
}

/** A text whose words in backticks are set as code. */
function words(text) {
  return text.split(/`([^`\n]+)`/).map((part, index) => (index % 2 ? node("code", "", part) : part));
}

// ---- the prompt

function json(text) {
  try { return JSON.parse(text); } catch { return undefined; }
}

/** JSON with its members under each other, and what is short on one line. */
function pretty(value, before = "") {
  const short = JSON.stringify(value, null, 1)?.replace(/\n\s*/g, " ");
  if (short === undefined || short.length + before.length <= LINE || value === null || typeof value !== "object") return short;
  const inner = `${before}  `;
  const lines = Array.isArray(value)
    ? value.map((item) => inner + pretty(item, inner))
    : Object.entries(value).map(([name, item]) => `${inner}${JSON.stringify(name)}: ${pretty(item, inner)}`);
  const [open, close] = Array.isArray(value) ? "[]" : "{}";
  return `${open}\n${lines.join(",\n")}\n${before}${close}`;
}

/** JSON that stands in the text, to be read. */
function data(text) {
  const shown = pretty(json(text));
  const details = node("details", "data", node("summary", "", `JSON, ${plural(text.length, "character")}`), node("pre", "", shown));
  details.open = shown.length <= OPEN_DATA;
  return details;
}

/** Words and the JSON object with which a line ends; none where it ends otherwise. */
function split(line) {
  const at = line.indexOf("{");
  const end = at < 0 ? "" : line.slice(at);
  return end.length >= DATA_LEAST && typeof json(end) === "object" ? [line.slice(0, at), end] : null;
}
const isRow = (text) => /^\|.*\|$/.test(text);

function table(rows) {
  const cells = rows.map((row) => row.slice(1, -1).split("|").map((cell) => cell.trim()));
  const body = cells.filter((row) => !row.every((cell) => /^:?-+:?$/.test(cell)));
  const made = node("table", "");
  body.forEach((row, index) => {
    const head = index === 0 && body.length < cells.length;
    const tr = node("tr", "", ...row.map((cell) => node(head ? "th" : "td", "", ...words(cell))));
    made.append(head ? node("thead", "", tr) : tr);
  });
  return made;
}

/** The text of a turn: headings, lists, tables, code and JSON as what they are, everything else as it was written. */
function body(text, from) {
  const made = node("div", "body");
  const lines = text.replace(/\r/g, "").split("\n");
  let plain = [];
  const flush = () => {
    if (plain.join("").trim()) made.append(node("p", "", ...words(plain.join("\n").trim())));
    plain = [];
  };
  for (let at = from; at < lines.length; at += 1) {
    const own = lines[at], bare = own.trim();
    const parts = split(bare), heading = /^#{1,6} +(.*)$/.exec(bare), item = /^(?:[-*] +|(\d+\. +))(.*)$/.exec(bare);
    if (bare.startsWith("```")) {
      flush();
      const from = at + 1;
      for (at = from; at < lines.length && !lines[at].trim().startsWith("```");) at += 1;
      made.append(node("pre", "", lines.slice(from, at).join("\n")));
    } else if (heading) {
      flush();
      made.append(node("h3", "", ...words(heading[1])));
    } else if (parts) {
      plain.push(parts[0]);
      flush();
      made.append(data(parts[1]));
    } else if (isRow(bare)) {
      flush();
      const from = at;
      while (at + 1 < lines.length && isRow(lines[at + 1].trim())) at += 1;
      made.append(table(lines.slice(from, at + 1).map((row) => row.trim())));
    } else if (item) {
      flush();
      const last = made.lastElementChild;
      const under = last && last.tagName === "UL" ? last : made.appendChild(node("ul", ""));
      const number = item[1] ? [node("span", "number", item[1].trim())] : [];
      under.append(node("li", item[1] ? "counted" : "", ...number, node("span", "", ...words(item[2]))));
    } else if (!bare) flush();
    else plain.push(own);
  }
  flush();
  return made;
}

const ROLES = { system: "Rules of the conversation", developer: "Rules of the conversation", user: "Asked", assistant: "Answered before", tool: "Tool" };

function turn(one, index, count) {
  // The heading with which a message begins stands above it.
  const heading = /^#+ +(.*)/.exec(one.text);
  const about = heading ? heading[1] : ROLES[one.role] || one.role;
  const summary = node("summary", "", about, node("span", "quiet", `${one.role} · ${index + 1} of ${count} · ${plural(one.text.length, "character")}`));
  const inside = body(one.text, heading ? 1 : 0);
  one.pictures.forEach((url, number) => {
    const picture = node("img", "");
    picture.alt = `picture ${number + 1} of this message`;
    picture.src = url;
    const save = node("a", "", "save the picture");
    save.href = url;
    save.download = `question-${shown.number}-picture-${number + 1}.png`;
    inside.append(node("figure", "", picture, node("figcaption", "", save)));
  });
  const made = node("details", `turn ${one.role}`, summary, inside);
  made.open = true;
  return made;
}

function whole(question) {
  const parts = question.turns.map((one) => `[${one.role}]\n${one.text.trim()}${one.pictures.length ? "\n(A picture belongs here.)" : ""}`);
  if (question.schema) parts.push(`[form of the answer]\nAnswer with one JSON object that keeps to this JSON schema, and nothing else:\n${question.schema}`);
  return parts.join("\n\n");
}

async function show(number, chosen) {
  let question;
  try { question = await ask(`/questions/${number}`); } catch (why) { trouble(`${why.message}.`); return; }
  const another = !shown || shown.number !== number;
  shown = question;
  $("welcome").hidden = true;
  $("question").hidden = $("answer").hidden = false;
  $("title").textContent = `Question ${number}: ${question.form}`;
  const limit = question.max_tokens ? ` · at most ${question.max_tokens} tokens` : "";
  $("facts").textContent = `put to ${question.model}${limit} · ${question.schema ? "one JSON object in the given form" : "any text"}`;
  if (another) {
    $("turns").replaceChildren(...question.turns.map((one, index) => turn(one, index, question.turns.length)));
    $("prompt").scrollTop = 0;
    tab("answer");
  }
  const waits = question.state === "waits", text = $("text");
  if (another || !waits) text.value = waits ? sessionStorage.getItem(draft(number)) || "" : question.answer || "";
  text.readOnly = !waits;
  $("tools").hidden = $("deeds").hidden = !waits;
  text.hidden = !waits && question.answer === null;
  $("said").hidden = waits;
  $("said").className = `notice ${question.state === "answered" ? "good" : "bad"}`;
  $("said").textContent = question.state === "answered" ? `You answered this after ${span(question.waited_s)}.` : question.state === "refused" ? `You refused this after ${span(question.waited_s)}: ${question.refusal}` : "Whoever asked this has left; an answer would reach nobody.";
  $("why-row").hidden = true;
  $("cannot").setAttribute("aria-expanded", "false");
  $("fill").hidden = $("tidy").hidden = !question.schema;
  const { $defs, ...form } = json(question.schema || "{}");
  $("schema").textContent = question.schema ? pretty($defs ? { ...form, $defs } : form) : "";
  $("form-about").textContent = question.schema ? "The JSON schema that the answer has to keep to." : "Any text will do; there is no form.";
  if (another) judged(null);
  typed();
  list();
  if (waits && chosen) text.focus();
}

// ---- the answer

function tab(name) {
  for (const other of ["answer", "form"]) {
    $(`tab-${other}`).setAttribute("aria-selected", String(other === name));
    $(`tab-${other}`).tabIndex = other === name ? 0 : -1;
    $(`pane-${other}`).hidden = other !== name;
  }
}

/** Shows what a check found; nothing where there was none. */
function judged(found, tried) {
  const faults = found ? found.faults : [];
  $("check").hidden = !found;
  $("check").className = found && !faults.length ? "good" : "";
  $("verdict").textContent = !faults.length ? "The answer keeps to the form." : tried ? `Not sent: ${plural(faults.length, "fault")}. Mend ${faults.length === 1 ? "it" : "them"}, or send the answer anyway.` : plural(faults.length, "fault");
  $("faults").replaceChildren(...faults.map(({ at, message }) => node("li", "", ...(at ? [node("code", "at", at), " "] : []), ...words(message))));
  $("anyway").hidden = !(tried && faults.length);
  $("strip").hidden = !(found && found.inner);
  $("strip").onclick = () => set(found.inner);
}

function set(text) {
  $("text").value = text;
  $("text").focus();
  changed();
}

function typed() {
  const text = $("text").value;
  $("size").textContent = text ? plural(text.length, "character") : "";
  $("send").disabled = !text.trim();
  $("tidy").disabled = typeof json(text) !== "object";
}

function changed() {
  if (!shown || shown.state !== "waits") return;
  sessionStorage.setItem(draft(shown.number), $("text").value);
  typed();
  $("anyway").hidden = true;
  clearTimeout(timer);
  if (!$("text").value.trim()) judged(null);
  else timer = setTimeout(check, CHECK_AFTER_MS);
}

async function check() {
  if (!shown || !shown.schema || shown.state !== "waits") return;
  checking += 1;
  const own = checking, number = shown.number;
  try {
    const found = await ask(`/questions/${number}/check`, { text: $("text").value });
    // What was typed meanwhile is checked by a later call.
    if (own === checking && shown.number === number) judged(found, false);
  } catch (why) { trouble(`${why.message}.`); }
}

function next(number) {
  sessionStorage.removeItem(draft(number));
  const waiting = questions.filter((one) => one.state === "waits" && one.number !== number);
  return show(waiting.length ? waiting[0].number : number, false);
}

async function send(anyway) {
  if (!shown || shown.state !== "waits" || !$("text").value.trim()) return;
  clearTimeout(timer);
  checking += 1;
  const number = shown.number;
  $("send").disabled = true;
  try {
    const found = await ask(`/questions/${number}/answer`, { text: $("text").value, anyway });
    if (found.ok) await next(number);
    else judged(found, true);
  } catch (why) { trouble(`Not sent: ${why.message}.`); }
  typed();
}

async function refuse() {
  if (!shown || shown.state !== "waits") return;
  const number = shown.number;
  try {
    await ask(`/questions/${number}/refusal`, { text: $("why").value });
    $("why").value = "";
    await next(number);
  } catch (why) { trouble(`Not sent: ${why.message}.`); }
}

/** An empty answer in the form: what has to be there, with the first value that is allowed. */
function skeleton(schema, root, depth = 0) {
  if (!schema || depth > 12) return null;
  if (schema.$ref) return skeleton(schema.$ref.slice(2).split("/").reduce((at, name) => (at ? at[name] : undefined), root), root, depth + 1);
  if ("const" in schema) return schema.const;
  if (schema.enum) return schema.enum[0];
  const kinds = [].concat(schema.type ?? []);
  if (kinds.includes("null")) return null;
  const choice = (schema.anyOf || schema.oneOf || [])[0];
  if (choice) return (schema.anyOf || schema.oneOf).some((one) => one.type === "null") ? null : skeleton(choice, root, depth + 1);
  if (kinds.includes("object") || schema.properties) {
    const names = schema.required || Object.keys(schema.properties || {});
    return Object.fromEntries(names.map((name) => [name, skeleton((schema.properties || {})[name], root, depth + 1)]));
  }
  if (kinds.includes("array")) return Array.from({ length: schema.minItems || 0 }, () => skeleton(schema.items, root, depth + 1));
  if (kinds.includes("number") || kinds.includes("integer")) return schema.minimum ?? 0;
  if (kinds.includes("boolean")) return false;
  return kinds.includes("string") ? "" : null;
}

function fill() {
  const text = $("text").value.trim();
  if (text && !confirm("Replace what you have typed?")) return;
  const schema = json(shown.schema);
  set(pretty(skeleton(schema, schema)));
}

async function copy() {
  const words = whole(shown);
  try {
    await navigator.clipboard.writeText(words);
    $("copy").textContent = "Copied";
  } catch {
    $("copy").textContent = "Cannot copy here";
  }
  setTimeout(() => { $("copy").textContent = "Copy the prompt"; }, 2000);
}

$("text").addEventListener("input", changed);
$("text").addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault();
    send(false);
  }
});
$("send").addEventListener("click", () => send(false));
$("anyway").addEventListener("click", () => send(true));
$("refuse").addEventListener("click", refuse);
$("why").addEventListener("keydown", (event) => { if (event.key === "Enter") refuse(); });
$("cannot").addEventListener("click", () => {
  const open = $("why-row").hidden;
  $("why-row").hidden = !open;
  $("cannot").setAttribute("aria-expanded", String(open));
  if (open) $("why").focus();
});
$("fill").addEventListener("click", fill);
$("tidy").addEventListener("click", () => set(pretty(json($("text").value))));
$("copy").addEventListener("click", copy);
for (const name of ["answer", "form"]) {
  $(`tab-${name}`).addEventListener("click", () => tab(name));
  $(`tab-${name}`).addEventListener("keydown", (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const other = name === "answer" ? "form" : "answer";
    tab(other);
    $(`tab-${other}`).focus();
  });
}
addEventListener("hashchange", () => location.reload());
if (token) look();
else trouble("This address lacks its token. Open the one that `socrates author console` printed, with everything behind the #.");
