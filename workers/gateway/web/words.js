// Small words for building the page. Texts of a run are untrusted: they only ever become text nodes.

/** Gestures by their code in a record; 0 is none. */
export const SAYS = ["", "WAIT", "PROCEED", "ACKNOWLEDGED", "EXCUSE ME", "FOLLOW ME"];
/** Above this many agents names would hide the crowd. */
export const CROWD = 24;
/** Above this many agents one canvas call per agent is too slow: they become points of the graphics card. */
export const POINTS = 1000;

const HUMANS = ["#D55E00", "#009E73", "#CC79A7", "#E69F00", "#6a51a3", "#8c564b", "#4d9221", "#c51b7d"];
const HUMAN_WORDS = ["#a84a00", "#00755a", "#9c3f75", "#8a5f00", "#5d4596", "#784a40", "#3f7a1a", "#a8155f"];

/** Color of an agent by its number; 0 is the robot. The same as in the pages of a bundle. */
export const color = (number) => (number === 0 ? "#0072B2" : HUMANS[(number - 1) % HUMANS.length]);
/** Color for words about an agent, dark enough to be read on white. */
export const ink = (number) => (number === 0 ? "#00619a" : HUMAN_WORDS[(number - 1) % HUMAN_WORDS.length]);
/** The colors of humans as triples from 0 to 1, for the graphics card. */
export const humans = () => HUMANS.flatMap((c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16) / 255));

export const plain = (text) => String(text).replace(/_/g, " ");
export const secs = (t) => t.toFixed(1) + " s";
export const at = (id) => document.getElementById(id);

/** A new element with a text, put into its parent. */
export function word(tag, text, parent, look) {
  const node = document.createElement(tag);
  if (look) node.className = look;
  node.textContent = text;
  if (parent) parent.appendChild(node);
  return node;
}

/** A text in which `names` between backticks are set as code; a backtick without a second one stays as it is. */
export function put(node, text) {
  const parts = String(text).split("`");
  node.textContent = "";
  if (parts.length % 2 === 0) { node.textContent = text; return node; }
  parts.forEach((part, i) => {
    if (part) node.appendChild(i % 2 ? word("code", part) : document.createTextNode(part));
  });
  return node;
}

/** Sets a text only where it differs, so that screen readers and layout have nothing to do for the same words. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** A button that does something. */
export function press(text, parent, does, look) {
  const node = word("button", text, parent, look);
  node.type = "button";
  node.addEventListener("click", does);
  return node;
}

/** The value of a metric in words, with its unit. */
export function value(m) {
  if (m.value === null || m.value === undefined) return "n/a";
  const v = m.value === 0 ? 0 : m.value, size = Math.abs(v);
  if (m.unit === "0/1") return v === 1 ? "yes" : v === 0 ? "no" : v.toFixed(2);
  if (m.unit === "count") return Number.isInteger(v) ? String(v) : v.toFixed(2);
  const number = size >= 100 ? v.toFixed(0) : size > 0 && size < 0.01 ? v.toPrecision(2) : v.toFixed(2);
  const unit = String(m.unit || "").replace(/\^2/g, "²").replace(/\^3/g, "³").replace(/\*/g, "·").replace("share", "");
  return (number + " " + unit).trim();
}

/** Where the gateway is: the modules lie in its `assets` folder, also behind a proxy that adds a prefix. */
export const BASE = new URL("..", import.meta.url);
export const url = (path) => new URL(path, BASE);
/** Said where the gateway lets nobody in without its token. */
export const NO_TOKEN = "⚠ This address lacks the token: open it as `socrates view` printed it, with #token= at its end.";
/** All runs that the gateway has; throws where it does not answer. */
export async function runs() {
  const answer = await fetch(url("runs"), { cache: "no-store" });
  if (!answer.ok) throw Object.assign(new Error(`runs: ${answer.status}`), { status: answer.status });
  return (await answer.json()).runs || [];
}
export const sentence = (text) => String(text).replace(/^./, (first) => first.toUpperCase());
export const runUrl = (run, rest = "") => url("run/" + encodeURIComponent(run) + rest);
