// What pointer and keys do.
const SNAP_PX = 12, ALIGN_PX = 4, MOVES_FROM_PX = 4;
let drag = null, lastPlace = null, cursor = null, held = false, asking = false;

const placeIn = (event) => { const box = $("stage").getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
const near = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

// The node under a place of the stage.
function nodeNear(place, within = SNAP_PX) {
  let best = null, least = within;
  for (const node of now.sketch.nodes) {
    const apart = near(toScreen(at(node)), place);
    if (apart <= least) { best = node; least = apart; }
  }
  return best;
}

// Whole pixels, with Alt hundredths; in line with another node where that is near, unless Shift is held.
function snapped(spot, event, besides = new Set()) {
  const grain = event.altKey ? 100 : 1;
  let [x, y] = spot.map((value) => Math.round(value * grain) / grain);
  const guides = [];
  if (!event.shiftKey) {
    const within = ALIGN_PX / view.scale;
    for (const [axis, set] of [[0, (value) => { x = value; }], [1, (value) => { y = value; }]]) {
      let best = null;
      for (const node of now.sketch.nodes) {
        const apart = Math.abs(node.at[axis] - spot[axis]);
        if (!besides.has(node.id) && apart <= within && (!best || apart < best.apart)) best = { apart, node };
      }
      if (best) { set(best.node.at[axis]); guides.push(best.node.at); }
    }
  }
  return { spot: [x, y], guides };
}

function rubber(draw) {
  layers.rubber.replaceChildren();
  draw(layers.rubber);
  if (cursor) {
    const [x, y] = toScreen(cursor);
    made("path", { class: "cursor", d: `M${x - 12},${y} H${x + 12} M${x},${y - 12} V${y + 12}` }, layers.rubber);
  }
}

function cancel() {
  drag = null;
  dragged.clear();
  if (layers.rubber) { rubber(() => {}); drawAll(); }
}

// Asks whether a line is free, one question at a time.
async function askLine(from, to) {
  if (asking || !drag) return;
  asking = true;
  const mine = drag;
  try {
    const found = await ask("/line", { from, to });
    if (drag === mine) { mine.free = found.clear && found.least_m >= 0.3; $("hint").textContent = found.clear ? `${found.length_m.toFixed(2)} m, ${found.least_m.toFixed(2)} m to the nearest wall${mine.free ? "" : ": a robot of 0.3 m radius does not fit"}` : `${found.length_m.toFixed(2)} m, through a wall`; showDrag(); }
  } catch (why) { trouble(told(why)); }
  asking = false;
}

function showDrag() {
  if (!drag) return;
  rubber((layer) => {
    for (const guide of drag.guides || []) { const [x1, y1] = toScreen(guide), [x2, y2] = toScreen(drag.to); made("line", { class: "guide", x1, y1, x2, y2 }, layer); }
    if (drag.kind === "edge" || drag.kind === "door") line(layer, drag.kind === "edge" && drag.free === false ? "rubber bad" : "rubber", drag.from, drag.to);
    if (drag.kind === "box") { const [a, b] = [toScreen(drag.from), toScreen(drag.to)]; made("rect", { class: "box", x: Math.min(a[0], b[0]), y: Math.min(a[1], b[1]), width: Math.abs(a[0] - b[0]), height: Math.abs(a[1] - b[1]) }, layer); }
  });
}

function edgeKind(a, b) {
  return $("edge-kind").value.trim() || kindByEnds(a, b);
}

// The type of a way between two kinds of places.
function kindByEnds(a, b) {
  const classes = [a, b].map((kind) => now.classes[kind] || map.classes[kind]);
  if (classes.includes("elevator")) return classes.every((one) => one === "elevator") ? a : "ELEVATOR DOORWAY";
  if (classes.includes("doorway")) return "DOORWAY";
  for (const same of ["room", "open_area", "elevator_lobby", "narrow_passage"]) if (classes.every((one) => one === same)) return a;
  return "CORRIDOR";
}

const typed = () => $("kind").value.trim() || "CORRIDOR";

function freeName() {
  const taken = new Set(now.sketch.nodes.map((node) => node.id));
  let number = 1;
  while (taken.has(`n${number}`)) number += 1;
  return `n${number}`;
}

function choose(kind, id, more) {
  if (!more) choice.clear();
  if (more && choice[kind].has(id)) choice[kind].delete(id); else choice[kind].add(id);
  drawAll();
  showChosen();
}

// An edge that ends on free floor: a node is made there.
function edgeToFloor(start, at) {
  const id = freeName();
  choice.clear();
  choice.nodes.add(id);
  return edit({ several: [{ add_node: { id, kind: typed(), at } }, { add_edge: { from: start.id, to: id, kind: edgeKind(start.kind, typed()) } }] });
}

// What a click does with the present tool: at a place of the image, on what is there.
async function act(spot, event, on = {}) {
  const node = on.node || nodeNear(toScreen(spot));
  if (tool === "way") {
    if (!node) return say("Click a node.");
    if (!way || way.to) { way = { from: node.id }; choose("nodes", node.id); return say(`From ${node.id}: click the node where the way ends.`); }
    return askWay(way.from, node.id, true);
  }
  if (now.read_only) return trouble("This editor only looks: nothing is changed.");
  if (tool === "node") {
    if (node) return choose("nodes", node.id, event.shiftKey);
    const id = freeName(), place = snapped(spot, event).spot;
    const what = on.edge ? { split_edge: { edge: pairOf(on.edge), id, kind: typed(), at: place } } : { add_node: { id, kind: typed(), at: place } };
    choice.clear();
    choice.nodes.add(id);
    return edit(what);
  }
  if (tool === "elevator") return change("/elevator", { at: spot });
  if (tool === "door") {
    try { return addDoor(await ask("/opening", { near: spot })); } catch (why) { return trouble(told(why)); }
  }
  if (tool === "edge") {
    if (!node && !held) return say("An edge begins at a node.");
    if (!node) {
      const start = nodeOf(held);
      held = false;
      return start ? edgeToFloor(start, snapped(spot, event).spot) : null;
    }
    if (!held || held === node.id) { held = node.id; choose("nodes", node.id); return say(`From ${node.id}: click the node where the edge ends.`); }
    const from = nodeOf(held);
    held = false;
    return from ? edit({ add_edge: { from: from.id, to: node.id, kind: edgeKind(from.kind, node.kind) } }) : null;
  }
  if (node) return choose("nodes", node.id, event.shiftKey);
  if (on.door) return choose("doors", on.door, event.shiftKey);
  if (on.edge) return choose("edges", on.edge, event.shiftKey);
  choice.clear();
  drawAll();
  showChosen();
  return null;
}

function addDoor({ from, to, inside, id }) {
  choice.clear();
  choice.doors.add(id);
  return edit({ add_door: { id, kind: "room", from, to, opens: { near: 1.2 }, hold_s: 8, inside } });
}

function begin(event) {
  $("stage").focus({ preventScroll: true });
  const place = placeIn(event), spot = toImage(place), target = event.target;
  const on = { node: nodeNear(place), edge: target.dataset?.edge, door: target.dataset?.door };
  if (target.closest?.(".mark")) { goTo(Number(target.closest(".mark").dataset.finding)); event.preventDefault(); return; }
  if (target.dataset?.proposed && tool !== "pan") { const id = target.dataset.proposed; if (!proposal.chosen.delete(id)) proposal.chosen.add(id); drawProposal(); showProposal(); return; }
  $("stage").setPointerCapture(event.pointerId);
  cursor = null;
  if (event.button === 1 || tool === "pan" || $("stage").classList.contains("panning")) { drag = { kind: "pan", place, x: view.x, y: view.y }; return; }
  if (event.button !== 0) return;
  drag = { kind: "click", place, from: spot, to: spot, on, event };
}

// A press that moves becomes what the tool draws.
function become(event) {
  const { on, from } = drag;
  if (tool === "select" || (tool === "node" && on.node)) {
    if (now.read_only && (on.node || on.door)) return;
    if (on.node) { if (!choice.nodes.has(on.node.id)) choose("nodes", on.node.id, event.shiftKey); drag = { ...drag, kind: "move", lead: on.node.at }; }
    else if (on.door) { if (!choice.doors.has(on.door)) choose("doors", on.door, event.shiftKey); const door = now.sketch.doors.find((one) => one.id === on.door); const ends = [door.from, door.to].map((end) => near(toScreen(end), drag.place)); drag = { ...drag, kind: "move-door", door, end: Math.min(...ends) > SNAP_PX ? null : ends.indexOf(Math.min(...ends)) }; }
    else if (tool === "select") drag = { ...drag, kind: "box" };
  } else if (now.read_only) return;
  else if (tool === "edge" && on.node) drag = { ...drag, kind: "edge", from: on.node.at, start: on.node };
  else if (tool === "door") drag = { ...drag, kind: "door", from: snapped(from, event).spot };
}

function moved(event) {
  const place = placeIn(event), spot = toImage(place);
  lastPlace = spot;
  showWhere(spot);
  if (!drag) return;
  if (drag.kind === "pan") { view.x = drag.x - (place[0] - drag.place[0]) / view.scale; view.y = drag.y - (place[1] - drag.place[1]) / view.scale; redraw(); return; }
  if (drag.kind === "click") { if (near(place, drag.place) < MOVES_FROM_PX) return; become(event); }
  drag.to = spot;
  drag.guides = [];
  if (drag.kind === "move") {
    const wished = [drag.lead[0] + spot[0] - drag.from[0], drag.lead[1] + spot[1] - drag.from[1]], to = snapped(wished, event, choice.nodes), by = [to.spot[0] - drag.lead[0], to.spot[1] - drag.lead[1]];
    for (const id of choice.nodes) { const node = nodeOf(id); dragged.set(id, [node.at[0] + by[0], node.at[1] + by[1]]); }
    drag.to = to.spot;
    drag.guides = to.guides;
    shift();
  } else if (drag.kind === "move-door") {
    const by = [Math.round(spot[0] - drag.from[0]), Math.round(spot[1] - drag.from[1])], ends = [drag.door.from, drag.door.to].map((end, index) => (drag.end === null || drag.end === index ? [end[0] + by[0], end[1] + by[1]] : end));
    dragged.set(`door ${drag.door.id}`, ends);
    drawDoors();
  } else if (drag.kind === "edge") {
    const target = nodeNear(place);
    const to = target && target.id !== drag.start.id ? { spot: target.at, guides: [] } : snapped(spot, event);
    drag.to = to.spot;
    drag.guides = to.guides;
    drag.target = target && target.id !== drag.start.id ? target : null;
    askLine(drag.from, drag.to);
  } else if (drag.kind === "door") drag.to = snapped(spot, event).spot;
  showDrag();
}

async function ended(event) {
  const done = drag;
  if (!done) return;
  drag = null;
  rubber(() => {});
  if (done.kind === "click") { await act(done.from, done.event, done.on); return; }
  if (done.kind === "box") {
    if (!event.shiftKey) choice.clear();
    const [x0, x1] = [done.from[0], done.to[0]].sort((a, b) => a - b), [y0, y1] = [done.from[1], done.to[1]].sort((a, b) => a - b), inside = ([x, y]) => x >= x0 && x <= x1 && y >= y0 && y <= y1;
    for (const node of now.sketch.nodes) if (inside(node.at)) choice.nodes.add(node.id);
    for (const edge of now.sketch.edges) if (choice.nodes.has(edge.from) && choice.nodes.has(edge.to)) choice.edges.add(edgeKey(edge));
    for (const door of now.sketch.doors) if (inside(door.from) && inside(door.to)) choice.doors.add(door.id);
    drawAll();
    showChosen();
  } else if (done.kind === "move") {
    const nodes = [...choice.nodes].filter((id) => dragged.has(id)).map((id) => [id, dragged.get(id)]);
    if (nodes.length) await edit({ move_nodes: { nodes } });
    dragged.clear();
    drawAll();
  } else if (done.kind === "move-door") {
    const [from, to] = dragged.get(`door ${done.door.id}`) || [done.door.from, done.door.to];
    await edit({ change_door: { id: done.door.id, door: { ...done.door, from, to } } });
    dragged.clear();
    drawAll();
  } else if (done.kind === "edge") {
    if (done.target) await edit({ add_edge: { from: done.start.id, to: done.target.id, kind: edgeKind(done.start.kind, done.target.kind) } });
    else await edgeToFloor(done.start, done.to);
  } else if (done.kind === "door") {
    try { await addDoor(await ask("/opening", { on: [done.from, done.to] })); } catch (why) { trouble(told(why)); }
  }
}

function showWhere([x, y]) {
  const [mx, my] = meters([x, y]);
  $("where").textContent = `(${x.toFixed(1)}, ${y.toFixed(1)}) px · (${mx.toFixed(2)}, ${my.toFixed(2)}) m`;
}

// ---- keys

// The edit that gives nodes and edges another type. Edges that have their type by their ends have it by the new ones.
function retyped(nodes, edges, kind) {
  const changed = new Set(nodes), keys = new Set(edges.map((pair) => JSON.stringify(pair))), parts = [{ retype: { nodes, edges, kind } }];
  for (const edge of now.sketch.edges) {
    if (keys.has(edgeKey(edge)) || !(changed.has(edge.from) || changed.has(edge.to))) continue;
    const [from, to] = [edge.from, edge.to].map((id) => nodeOf(id).kind), of = (id, old) => (changed.has(id) ? kind : old);
    const next = kindByEnds(of(edge.from, from), of(edge.to, to));
    if (edge.kind === kindByEnds(from, to) && next !== edge.kind) parts.push({ retype: { nodes: [], edges: [[edge.from, edge.to]], kind: next } });
  }
  return parts.length === 1 ? parts[0] : { several: parts };
}

// The edit that takes these nodes and doors elsewhere; those that are gone by then are left out.
function shifted(nodes, doors, by) {
  const moves = [], placed = nodes.map(nodeOf).filter(Boolean).map(({ id, at }) => [id, by(at)]);
  if (placed.length) moves.push({ move_nodes: { nodes: placed } });
  for (const door of now.sketch.doors.filter(({ id }) => doors.includes(id))) moves.push({ change_door: { id: door.id, door: { ...door, from: by(door.from), to: by(door.to) } } });
  return moves.length === 1 ? moves[0] : { several: moves };
}

function arrow(dx, dy) {
  if (choice.size && !now.read_only && tool === "select") {
    // Chosen now, placed when its turn comes: keys that follow each other fast all count.
    const nodes = [...choice.nodes], doors = [...choice.doors], by = ([x, y]) => [x + dx, y + dy];
    if (nodes.length + doors.length) edit(() => shifted(nodes, doors, by));
    return;
  }
  const [w, h] = stageSize();
  const [x, y] = cursor || lastPlace || toImage([w / 2, h / 2]);
  cursor = [Math.max(0, Math.min(map.width, Math.round(x) + dx)), Math.max(0, Math.min(map.height, Math.round(y) + dy))];
  const [sx, sy] = toScreen(cursor);
  if (sx < 0 || sy < 0 || sx > w || sy > h - 30) lookAt(cursor);
  showWhere(cursor);
  rubber(() => {});
}

// Chooses the next thing in the order of the files: nodes, edges, doors.
function step(by) {
  const { nodes, edges, doors } = now.sketch;
  const all = [...nodes.map((node) => ["nodes", node.id, node.at, `${node.id}, ${node.kind}`]), ...edges.map((edge) => { const [a, b] = [nodeOf(edge.from).at, nodeOf(edge.to).at]; return ["edges", edgeKey(edge), [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], `edge ${edge.from} – ${edge.to}, ${edge.kind}`]; }), ...doors.map((door) => ["doors", door.id, [(door.from[0] + door.to[0]) / 2, (door.from[1] + door.to[1]) / 2], `door ${door.id}`])];
  if (!all.length) return;
  const place = all.findIndex(([kind, id]) => choice[kind].has(id));
  const [kind, id, spot, words] = all[(place + by + all.length + (place < 0 && by < 0 ? 1 : 0)) % all.length];
  choose(kind, id);
  const [x, y] = toScreen(spot), [w, h] = stageSize();
  if (x < 0 || y < 0 || x > w || y > h - 30) lookAt(spot);
  say(words);
}

function enter(event) {
  if (!cursor) return;
  const place = toScreen(cursor), under = now.sketch.edges.find((edge) => { const [a, b] = [nodeOf(edge.from).at, nodeOf(edge.to).at].map(toScreen), along = [b[0] - a[0], b[1] - a[1]], share = Math.max(0, Math.min(1, ((place[0] - a[0]) * along[0] + (place[1] - a[1]) * along[1]) / (along[0] ** 2 + along[1] ** 2 || 1))); return near(place, [a[0] + along[0] * share, a[1] + along[1] * share]) < 7; });
  const as = { shiftKey: event.shiftKey, altKey: event.altKey };
  act(cursor, tool === "node" ? { ...as, shiftKey: true } : as, { edge: under && edgeKey(under) });
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function pressed(event) {
  const inField = event.target.matches("input, textarea, select"), command = event.ctrlKey || event.metaKey, key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (command && key === "s") { event.preventDefault(); if (inField) event.target.blur(); if (!now.read_only) save(false); return; }
  if (inField) { if (key === "Escape") $("stage").focus(); return; }
  if (command) {
    const does = { z: () => change(event.shiftKey ? "/redo" : "/undo"), y: () => change("/redo"), a: () => { for (const node of now.sketch.nodes) choice.nodes.add(node.id); for (const edge of now.sketch.edges) choice.edges.add(edgeKey(edge)); for (const door of now.sketch.doors) choice.doors.add(door.id); drawAll(); showChosen(); } }[key];
    if (does) { event.preventDefault(); does(); }
    return;
  }
  const onStage = event.target === $("stage") || event.target === document.body || event.target.closest?.("#stage");
  if (ARROWS[key] && onStage) { event.preventDefault(); const far = event.shiftKey ? 10 : 1; arrow(...ARROWS[key].map((one) => one * far)); return; }
  if (key === " " && onStage) { event.preventDefault(); $("stage").classList.add("panning"); return; }
  if (key === "Enter" && onStage) { event.preventDefault(); enter(event); return; }
  const chosen = TOOLS.find(([, , letter]) => letter.toLowerCase() === key);
  const [w, h] = stageSize(), middle = [w / 2, h / 2];
  if (chosen) setTool(chosen[0]);
  else if (/^[1-9]$/.test(key)) setKind(map.kinds[Number(key) - 1]);
  else if (key === "Delete" || key === "Backspace") { event.preventDefault(); remove(event.shiftKey); }
  else if (key === "Escape") { held = false; cursor = null; choice.clear(); cancel(); showChosen(); if (!$("help").hidden) showHelp(); }
  else if (key === "f") fit();
  else if (key === "+" || key === "=") zoomBy(1.25, middle);
  else if (key === "-" || key === "–") zoomBy(0.8, middle);
  else if (key === ".") step(1);
  else if (key === ",") step(-1);
  else if (key === "?") showHelp();
}

async function open() {
  try {
    map = await ask("/map");
    now = await ask("/state");
  } catch (why) {
    trouble(told(why));
    return;
  }
  $("name").textContent = map.name;
  $("name").title = `kept in ${map.folder}`;
  $("kind").value = map.kinds[0];
  const stage = $("stage");
  stage.addEventListener("pointerdown", begin);
  stage.addEventListener("pointermove", moved);
  stage.addEventListener("pointerup", ended);
  stage.addEventListener("pointercancel", cancel);
  stage.addEventListener("wheel", (event) => { event.preventDefault(); zoomBy(1.0016 ** -event.deltaY, placeIn(event)); }, { passive: false });
  addEventListener("keydown", pressed);
  addEventListener("keyup", (event) => { if (event.key === " ") stage.classList.remove("panning"); });
  addEventListener("beforeunload", (event) => { if (now.dirty) event.preventDefault(); });
  new ResizeObserver(redraw).observe(stage);
  $("bar").addEventListener("pointerdown", (event) => event.stopPropagation());
  $("help").addEventListener("pointerdown", (event) => event.stopPropagation());
  for (const [id, does] of [["undo", () => change("/undo")], ["redo", () => change("/redo")], ["save", () => save(false)], ["propose", proposeAll], ["keys", showHelp], ["fit", fit], ["keep-mine", () => save(true)], ["take-theirs", () => { $("conflict").hidden = true; change("/theirs"); }], ["not-now", () => { $("conflict").hidden = true; }], ["walk", startWalk], ["close-way", () => { way = null; drawWay(); showWay(); }], ["accept-all", () => takeProposed(null)], ["accept-some", () => takeProposed([...proposal.chosen])], ["close-proposal", () => { proposal = null; drawProposal(); showProposal(); }]]) $(id).addEventListener("click", does);
  $("kind").addEventListener("change", () => showTools());
  $("description").addEventListener("change", () => edit({ describe: { text: $("description").value } }));
  setTool("select");
  fit();
  showNotes();
  take(now);
}

async function takeProposed(nodes) {
  const state = await change("/accept", { nodes });
  if (state && nodes === null) proposal = null;
  if (proposal) proposal.chosen.clear();
  drawProposal();
  showProposal();
}

open();
