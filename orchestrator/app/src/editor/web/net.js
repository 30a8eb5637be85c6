"use strict";
// What the server knows, and how it is asked: one change after the other, each of the sketch that the page shows.
const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.hash.slice(1)).get("token") || "";
const FINDINGS_AFTER_MS = 120;
// The map, the sketch as it stands, what is said of it, what is proposed, and the way that is looked at.
let map = null, now = null, findings = [], proposal = null, way = null;
let turn = Promise.resolve(), findingsTimer = null, busy = 0;

class Refused extends Error {
  constructor(status, error, state) { super(error.message); this.status = status; this.code = error.code; this.files = error.files || []; this.state = state; }
}

async function ask(path, what) {
  const headers = { authorization: `Bearer ${token}` };
  const options = what === undefined ? { headers } : { method: "POST", headers: { ...headers, "content-type": "application/json" }, body: JSON.stringify(what) };
  const answer = await fetch(path, options);
  const read = await answer.json();
  if (!answer.ok) throw new Refused(answer.status, read.error || { message: `status ${answer.status}` }, read.state);
  return read;
}

function trouble(words) {
  $("trouble").textContent = words;
  $("trouble").hidden = !words;
  if (words) say(words);
}

function say(words) {
  $("said").textContent = words;
  $("hint").textContent = words;
}

function told(why) {
  if (why instanceof TypeError) return "The editor has ended, or this machine cannot reach it. What you drew is in its journal: begin it again.";
  return `${why.message}.`;
}

// Takes over how things stand.
function take(state) {
  now = state;
  choice.keep();
  drawAll();
  showAll();
  if (state.said) say(state.said);
  clearTimeout(findingsTimer);
  findingsTimer = setTimeout(look, FINDINGS_AFTER_MS);
}

// Changes something: waits until everything before is done, then asks with the number of the sketch that is shown. What is asked may be
// a function, called at that moment: what it reads of the sketch then holds all changes before.
function change(path, what = {}) {
  busy += 1;
  const mine = turn.then(async () => {
    try {
      const state = await ask(path, { rev: now.rev, ...(typeof what === "function" ? what() : what) });
      trouble("");
      take(state);
      return state;
    } catch (why) {
      if (why.state) take(why.state);
      if (why.code === "changed") conflict(why);
      else trouble(told(why));
      drawAll();
      showAll();
      return null;
    } finally {
      busy -= 1;
    }
  });
  turn = mine;
  return mine;
}

const edit = (what) => change("/edit", typeof what === "function" ? () => ({ edit: what() }) : { edit: what });

// Asks what is wrong with the sketch, and for the way that is looked at.
async function look() {
  const rev = now.rev;
  try {
    const found = await ask("/findings");
    if (found.rev === now.rev) { findings = found.findings; drawMarks(); showFindings(); document.body.dataset.checked = String(found.rev); }
    if (way && way.rev !== now.rev) await askWay(way.from, way.to, false);
  } catch (why) {
    trouble(told(why));
  }
  if (rev !== now.rev) { clearTimeout(findingsTimer); findingsTimer = setTimeout(look, FINDINGS_AFTER_MS); }
}

async function askWay(from, to, walks) {
  const known = (id) => now.sketch.nodes.some((node) => node.id === id);
  if (!known(from) || !known(to)) { way = null; drawWay(); showWay(); return; }
  try {
    const found = await ask("/way", { from, to });
    way = { from, to, rev: found.rev, ...found };
  } catch (why) {
    way = { from, to, rev: now.rev, none: why.message };
  }
  drawWay();
  showWay();
  if (walks) startWalk();
}

async function proposeAll() {
  $("propose").disabled = true;
  say("Looking at the map…");
  try {
    proposal = { ...(await ask("/propose", {})), chosen: new Set() };
    say(`Found ${proposal.sketch.nodes.length} nodes and ${proposal.sketch.edges.length} edges.`);
  } catch (why) {
    trouble(told(why));
  }
  $("propose").disabled = now.read_only;
  drawProposal();
  showProposal();
}

function conflict(why) {
  $("conflict-words").textContent = `${why.message}. Nothing was written. You can write yours (theirs is then kept as a copy in .socrates-edit), take theirs in place of what you drew, or go on drawing.`;
  $("conflict").hidden = false;
  $("keep-mine").focus();
}

async function save(overwrite) {
  $("conflict").hidden = true;
  const state = await change("/save", { overwrite });
  if (state) $("stand").dataset.saved = state.said;
  showStand();
}
