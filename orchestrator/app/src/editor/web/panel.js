// What stands beside the picture: what is chosen, findings, way, proposal, notes, and the palette.
const TOOLS = [["select", "Select", "V"], ["node", "Node", "N"], ["edge", "Edge", "E"], ["door", "Door", "D"], ["elevator", "Elevator", "L"], ["way", "Way", "W"], ["pan", "Move", "H"]];
const HINTS = {
  select: "Click or drag a box to choose, drag what is chosen; arrow keys move it by a pixel.",
  node: "Click free floor for a node, or an edge to split it.",
  edge: "Drag from node to node; on free floor a node is made. The line is red where a robot does not fit.",
  door: "Click an opening between two walls, or drag the line of the door from wall to wall.",
  elevator: "Click the opening of an elevator: door, car and the place before it are drawn.",
  way: "Click two nodes: the way between them, and a person who walks it.",
  pan: "Drag to move the map; the space bar does so with every tool.",
};
const OPENS = { always: null, never: null, near: "How near, m", robot_near: "How near, m", at_times: "At, s", on_event: "Event" };
const SHOWN_FINDINGS = 200;
let tool = "select";

function element(kind, attributes = {}, ...inside) {
  const node = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (typeof value === "boolean") node[name] = value;
    else node.setAttribute(name, value);
  }
  node.append(...inside);
  return node;
}

function showAll() {
  showStand();
  showTools();
  showChosen();
  showWay();
  showProposal();
  showFindings();
  showNames();
  if (document.activeElement !== $("description")) $("description").value = now.sketch.description;
  $("description").readOnly = now.read_only;
  const types = [...new Set([...map.kinds, ...Object.keys(now.classes)])];
  if ($("kinds").childElementCount !== types.length) $("kinds").replaceChildren(...types.map((type) => element("option", { value: type })));
}

function showStand() {
  const { nodes, edges, doors } = now.sketch, count = (many, word) => `${many.length} ${word}${many.length === 1 ? "" : "s"}`;
  const stand = now.read_only ? "read-only" : now.dirty ? "not saved" : $("stand").dataset.saved || "as in the files";
  $("stand").textContent = `${count(nodes, "node")}, ${count(edges, "edge")}, ${count(doors, "door")} · ${stand}`;
  $("stand").title = $("stand").textContent;
  $("undo").disabled = !now.undo;
  $("redo").disabled = !now.redo;
  $("undo").textContent = now.undo ? `Undo (${now.undo})` : "Undo";
  $("redo").textContent = now.redo ? `Redo (${now.redo})` : "Redo";
  $("save").disabled = now.read_only;
  $("propose").disabled = now.read_only;
  document.title = `${now.dirty ? "• " : ""}${map.name} – SocRATES map editor`;
}

function setTool(name) {
  tool = name;
  $("stage").dataset.tool = name;
  cancel();
  say(HINTS[name]);
  showTools();
}

function setKind(kind) {
  $("kind").value = kind;
  showTools();
  if (!choice.nodes.size && !choice.edges.size) return;
  const edges = [...choice.edges].map(pairOf);
  const nodes = [...choice.nodes];
  edit(() => retyped(nodes, edges, kind));
}

function showTools() {
  const focused = document.activeElement?.id;
  const tools = TOOLS.map(([name, word, key]) => element("button", { type: "button", id: `tool-${name}`, "aria-pressed": String(tool === name), title: HINTS[name], onclick: () => setTool(name) }, word, element("kbd", {}, key)));
  const kinds = map.kinds.map((kind, index) => {
    const dot = element("i");
    dot.style.background = COLORS[map.classes[kind]] || COLORS.plain;
    return element("button", { type: "button", class: "kind", id: `kind-${index + 1}`, "aria-pressed": String($("kind").value === kind), onclick: () => setKind(kind) }, dot, element("span", { title: kind }, kind[0] + kind.slice(1).toLowerCase()), index < 9 ? element("kbd", {}, String(index + 1)) : "");
  });
  $("tools").replaceChildren(...tools, element("h2", {}, "Type"), ...kinds);
  if (focused && /^(tool|kind)-/.test(focused)) $(focused)?.focus();
}

// ---- what is chosen

let shownChoice = "";
function showChosen() {
  const box = $("chosen"), [node] = choice.nodes, [edge] = choice.edges, [door] = choice.doors;
  const things = [choice.nodes, choice.edges, choice.doors].map((set) => [...set]);
  const what = choice.size === 1 ? (node ? nodeOf(node) : edge ? now.sketch.edges.find((e) => edgeKey(e) === edge) : now.sketch.doors.find((d) => d.id === door)) : null;
  const print = JSON.stringify([things, what, things[0].map((id) => areaOf(id)?.name), now.read_only]);
  if (print === shownChoice) return;
  shownChoice = print;
  if (!choice.size) box.replaceChildren();
  else if (what && node) box.replaceChildren(...ofNode(what));
  else if (what && edge) box.replaceChildren(...ofEdge(what));
  else if (what && door) box.replaceChildren(...ofDoor(what));
  else box.replaceChildren(...ofMany());
  if (now.read_only) box.querySelectorAll("input, select, button").forEach((one) => { one.disabled = true; });
}

// A labeled field that tells what was typed when it is left or Enter is pressed.
function field(id, words, value, typed, more = {}) {
  const input = element("input", { id, value: String(value), autocomplete: "off", spellcheck: "false", onchange: () => typed(input.value.trim()), ...more });
  return element("div", {}, element("label", { for: id }, words), input);
}

const removal = (join) => element("div", { class: "row" }, element("button", { type: "button", onclick: () => remove(false) }, "Delete"), ...(join ? [element("button", { type: "button", title: "the edges of a node with two of them become one", onclick: () => remove(true) }, "Delete and join")] : []));

// Something of the panel that the server did not take is shown as it is.
async function orAnew(what) {
  if (!(await what)) { shownChoice = ""; showChosen(); }
}

const areaOf = (id) => areas().find((area) => area.nodes.includes(id));

// What people call the area of these nodes.
function called(ids) {
  const names = [...new Set(ids.map((id) => areaOf(id)?.name || ""))];
  return field("area-name", "Called, by people and requests", names.length === 1 ? names[0] : "", (name) => orAnew(edit({ call: { nodes: ids, name } })), { list: "areas", maxlength: "60", placeholder: names.length === 1 ? "pharmacy, ward 2, …" : "several names" });
}

function showNames() {
  const names = areas();
  $("names-head").hidden = !names.length;
  $("areas").replaceChildren(...names.map((area) => element("option", { value: area.name })));
  $("names").replaceChildren(...names.map((area) => element("li", {}, element("button", { type: "button", title: area.nodes.join(", "), onclick: () => chooseArea(area) }, area.name, element("span", { class: "quiet" }, ` ${area.nodes.length === 1 ? area.nodes[0] : `${area.nodes.length} nodes`}`)))));
}

function chooseArea(area) {
  choice.clear();
  area.nodes.forEach((id) => choice.nodes.add(id));
  choice.keep();
  const first = nodeOf(area.nodes[0]), [x, y] = first ? toScreen(first.at) : [0, 0], [w, h] = stageSize();
  if (first && (x < 0 || y < 0 || x > w || y > h - 30)) lookAt(first.at);
  drawAll();
  showChosen();
}

function ofNode(node) {
  const [x, y] = node.at, [mx, my] = meters(node.at);
  const move = (at) => (at.every(Number.isFinite) ? orAnew(edit({ move_nodes: { nodes: [[node.id, at]] } })) : (trouble("A position is a number of pixels from the top left."), shownChoice = "", showChosen()));
  return [
    element("h2", {}, `Node ${node.id}`),
    field("node-id", "Name", node.id, async (to) => { choice.nodes.add(to); if (await edit({ rename_node: { id: node.id, to } })) say(`renamed ${node.id} to ${to}`); else { choice.nodes.delete(to); shownChoice = ""; showChosen(); } }),
    field("node-kind", "Type", node.kind, (kind) => orAnew(edit(() => retyped([node.id], [], kind))), { list: "kinds", maxlength: "100" }),
    called([node.id]),
    element("div", { class: "pair" }, field("node-x", "x, pixels", x, (value) => move([Number(value || "x"), y])), field("node-y", "y, pixels", y, (value) => move([x, Number(value || "x")]))),
    element("p", { class: "quiet small" }, `(${mx.toFixed(2)}, ${my.toFixed(2)}) m on the map`),
    removal(true),
  ];
}

function ofEdge(edge) {
  const [a, b] = [nodeOf(edge.from), nodeOf(edge.to)], long = Math.hypot(a.at[0] - b.at[0], a.at[1] - b.at[1]) * map.resolution_m;
  return [
    element("h2", {}, `Edge ${edge.from} – ${edge.to}`),
    field("edge-type", "Type", edge.kind, (kind) => orAnew(edit({ retype: { nodes: [], edges: [[edge.from, edge.to]], kind } })), { list: "kinds", maxlength: "100" }),
    element("p", { class: "quiet small" }, `${long.toFixed(2)} m straight`),
    removal(false),
  ];
}

function ofDoor(door) {
  const with_ = (more) => { const to = { ...door, ...more }; choice.doors.add(to.id); return orAnew(edit({ change_door: { id: door.id, door: to } })); };
  const [opens, value] = typeof door.opens === "string" ? [door.opens, null] : Object.entries(door.opens)[0];
  const number = (text, act) => (text !== "" && Number.isFinite(Number(text)) ? act(Number(text)) : (trouble(`“${text}” is no number.`), shownChoice = "", showChosen()));
  const asOpens = (how, text) => {
    if (OPENS[how] === null) return with_({ opens: how });
    if (how === "on_event") return with_({ opens: { on_event: text } });
    if (how === "at_times") { const times = text.split(/[\s,]+/).filter(Boolean).map(Number); return times.every(Number.isFinite) ? with_({ opens: { at_times: times } }) : number("", () => null); }
    return number(text, (m) => with_({ opens: { [how]: m } }));
  };
  const options = (all, chosen) => all.map((one) => element("option", { value: one, selected: one === chosen }, one.replace("_", " ")));
  const how = element("select", { id: "door-opens", onchange: () => asOpens(how.value, { near: "1.2", robot_near: "3", at_times: "5", on_event: "encounter" }[how.value] || "") }, ...options(Object.keys(OPENS), opens));
  const kind = element("select", { id: "door-kind", onchange: () => with_({ kind: kind.value }) }, ...options(["room", "elevator"], door.kind));
  const shown = Array.isArray(value) ? value.join(" ") : value;
  const long = Math.hypot(door.from[0] - door.to[0], door.from[1] - door.to[1]) * map.resolution_m;
  return [
    element("h2", {}, `Door ${door.id}`),
    field("door-id", "Name", door.id, (id) => with_({ id }), { maxlength: "100" }),
    element("div", { class: "pair" }, element("div", {}, element("label", { for: "door-kind" }, "Of a"), kind), element("div", {}, element("label", { for: "door-opens" }, "Opens"), how)),
    element("div", { class: "pair" }, ...(OPENS[opens] === null ? [] : [field("door-value", OPENS[opens], shown, (text) => asOpens(opens, text))]), field("door-hold", "Stays open, s", door.hold_s, (text) => number(text, (hold_s) => with_({ hold_s })))),
    field("door-inside", "Nodes behind it", door.inside.join(" "), (text) => with_({ inside: text.split(/[\s,]+/).filter(Boolean) })),
    element("p", { class: "quiet small" }, `${long.toFixed(2)} m wide`),
    element("div", { class: "row" }, element("button", { type: "button", id: "door-guess", onclick: async () => { try { with_({ inside: (await ask("/opening", { on: [door.from, door.to] })).inside }); } catch (why) { trouble(told(why)); } } }, "Find the nodes behind it"), element("button", { type: "button", onclick: () => remove(false) }, "Delete")),
  ];
}

function ofMany() {
  const parts = [[choice.nodes, "node"], [choice.edges, "edge"], [choice.doors, "door"]].filter(([set]) => set.size).map(([set, word]) => `${set.size} ${word}${set.size === 1 ? "" : "s"}`);
  const kind = choice.nodes.size + choice.edges.size ? [field("many-kind", "Type of all", "", (typed) => typed && setKind(typed), { list: "kinds", maxlength: "100" })] : [];
  const area = choice.nodes.size ? [called([...choice.nodes])] : [];
  return [element("h2", {}, parts.join(", ")), ...kind, ...area, removal(choice.nodes.size > 0)];
}

function remove(join) {
  if (!choice.size) return;
  edit({ delete: { nodes: [...choice.nodes], edges: [...choice.edges].map(pairOf).filter(([a, b]) => !choice.nodes.has(a) && !choice.nodes.has(b)), doors: [...choice.doors], join } });
}

// ---- findings, way, proposal, notes

const subject = (finding) => { const [[kind, id]] = typeof finding.subject === "string" ? [[finding.subject, ""]] : Object.entries(finding.subject); return [kind, id]; };

function showFindings() {
  const count = (level) => findings.filter((one) => one.level === level).length, refused = count("refused");
  const refuse = refused ? ` (${refused} ${refused === 1 ? "refuses" : "refuse"} the location)` : "";
  $("findings-head").textContent = findings.length ? `Findings: ${findings.length}${refuse}` : "Findings: none";
  $("findings").replaceChildren(...findings.slice(0, SHOWN_FINDINGS).map((finding, index) => {
    const [kind, id] = subject(finding), name = kind === "whole" ? "" : `${kind} ${Array.isArray(id) ? id.join(" – ") : id}: `;
    const code = finding.code ? element("span", { class: "quiet" }, ` ${finding.code}`) : "";
    return element("li", {}, element("button", { type: "button", class: finding.level, "data-finding": String(index), onclick: () => goTo(index) }, element("b", {}, name), finding.text, code));
  }));
  if (findings.length > SHOWN_FINDINGS) $("findings").append(element("li", { class: "more" }, `and ${findings.length - SHOWN_FINDINGS} more`));
}

function goTo(index) {
  const finding = findings[index];
  if (!finding) return;
  const [kind, id] = subject(finding);
  choice.clear();
  if (kind === "node") choice.nodes.add(id);
  if (kind === "door") choice.doors.add(id);
  if (kind === "edge") { const edge = now.sketch.edges.find((one) => one.from === id[0] && one.to === id[1]); if (edge) choice.edges.add(edgeKey(edge)); }
  if (finding.at) lookAt(finding.at);
  say(finding.text);
  drawAll();
  showChosen();
}

function showWay() {
  $("way").hidden = !way;
  if (!way) return;
  if (way.none) { $("way-words").textContent = `${way.none}.`; $("walk").hidden = true; return; }
  const { nodes, length_m, least_m } = way.way, by = nodes.length ? nodes.join(" → ") : `No edges lead from ${way.from} to ${way.to}; over free floor`;
  const walked = way.walk.arrives ? `A person walks it in ${way.walk.secs.toFixed(1)} s.` : `A person gets stuck on it after ${way.walk.secs.toFixed(1)} s.`;
  $("way-words").textContent = `${by}: ${length_m.toFixed(1)} m, at least ${least_m.toFixed(2)} m from walls. ${walked}`;
  $("walk").hidden = false;
}

function showProposal() {
  $("proposal").hidden = !proposal;
  if (!proposal) return;
  const { nodes, edges, doors } = proposal.sketch;
  $("proposal-words").textContent = `The program found ${nodes.length} nodes, ${edges.length} edges and ${doors.length} doors: dashed on the map. Take all of it, or click the places that you want. What is drawn already stays.`;
  $("proposal-remarks").replaceChildren(...proposal.remarks.slice(0, 8).map((remark) => element("li", {}, remark.text)));
  $("accept-some").disabled = !proposal.chosen.size;
  $("accept-some").textContent = proposal.chosen.size ? `Take the ${proposal.chosen.size} chosen` : "Take the chosen";
}

function showNotes() {
  $("notes").hidden = !map.notes.length;
  $("notes").replaceChildren(...map.notes.map((note) => element("p", { class: "small" }, note)));
  if (map.notes.length) $("notes").append(element("button", { type: "button", onclick: () => { $("notes").hidden = true; } }, "Read"));
}

const KEYS = [["V N E D L W H", "tools: select, node, edge, door, elevator, way, move"], ["1 – 9", "type: of what is chosen, and of what is drawn next"], ["Arrow keys", "move what is chosen by 1 pixel, with Shift by 10; nothing chosen: move the cursor"], ["Enter", "do at the cursor what a click does"], [". and ,", "choose the next and the previous node, edge, door"], ["Delete", "delete; with Shift the neighbors of a node are joined"], ["Ctrl + Z, Ctrl + Shift + Z", "undo, redo"], ["Ctrl + A, Esc", "choose all; choose nothing, break off"], ["Ctrl + S", "save"], ["Wheel, + and –", "zoom"], ["Space and drag", "move the map"], ["F", "fit the map into the window"], ["Shift while drawing", "do not align with other nodes"], ["Alt while drawing", "hundredths of a pixel instead of whole ones"], ["Shift and click", "choose one more"]];

function showHelp() {
  const list = element("dl", {}, ...KEYS.flatMap(([key, words]) => [element("dt", {}, element("kbd", {}, key)), element("dd", {}, words)]));
  $("help").replaceChildren(list);
  $("help").hidden = !$("help").hidden;
  $("keys").setAttribute("aria-expanded", String(!$("help").hidden));
}
