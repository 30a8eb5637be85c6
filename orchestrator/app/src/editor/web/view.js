// The picture: the map as tiles on a canvas, and what is drawn over it as SVG.
const SVG = "http://www.w3.org/2000/svg";
const COLORS = { corridor: "#48627c", narrow_passage: "#8a5f00", intersection: "#0072b2", blind_corner: "#c51b7d", doorway: "#a8641c", elevator: "#7a3ea8", elevator_lobby: "#a874c8", room: "#00795c", open_area: "#4d9221", exit: "#d55e00", plain: "#1f2328" };
const NODE_R = 6, LABELS_FROM = 1.6, TILES_KEPT = 160;
const view = { x: 0, y: 0, scale: 1 };
const tiles = new Map();
let dragged = new Map(), layers = {}, shapes = { nodes: new Map(), edges: [] }, walking = null;

// What is chosen.
const choice = {
  nodes: new Set(), edges: new Set(), doors: new Set(),
  clear() { this.nodes.clear(); this.edges.clear(); this.doors.clear(); },
  get size() { return this.nodes.size + this.edges.size + this.doors.size; },
  // Forgets what is no longer there.
  keep() {
    const sketch = now.sketch, nodes = new Set(sketch.nodes.map((n) => n.id)), edges = new Set(sketch.edges.map(edgeKey)), doors = new Set(sketch.doors.map((d) => d.id));
    for (const [mine, there] of [[this.nodes, nodes], [this.edges, edges], [this.doors, doors]]) for (const id of mine) if (!there.has(id)) mine.delete(id);
  },
};
const edgeKey = (edge) => JSON.stringify([edge.from, edge.to]);
const pairOf = (key) => JSON.parse(key);

function made(kind, attributes, parent) {
  const node = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (parent) parent.append(node);
  return node;
}

const toScreen = ([x, y]) => [(x - view.x) * view.scale, (y - view.y) * view.scale];
const toImage = ([x, y]) => [x / view.scale + view.x, y / view.scale + view.y];
const stageSize = () => [$("stage").clientWidth, $("stage").clientHeight];
const at = (node) => dragged.get(node.id) || node.at;
// Names of areas, of which a file without any says nothing.
const areas = () => now.sketch.names || [];
const nodeOf = (id) => now.sketch.nodes.find((node) => node.id === id);
const colorOf = (kind) => COLORS[now.classes[kind]] || COLORS.plain;

// Meters of the map frame at a place of the image.
function meters([x, y]) {
  const [ox, oy, yaw] = map.origin, along = x * map.resolution_m, up = (map.height - y) * map.resolution_m;
  return [ox + along * Math.cos(yaw) - up * Math.sin(yaw), oy + along * Math.sin(yaw) + up * Math.cos(yaw)];
}

function fit() {
  const [w, h] = stageSize(), [left, top, right, bottom] = map.seen;
  view.scale = Math.min((w - 24) / (right - left), (h - 60) / (bottom - top), 64);
  view.x = (left + right) / 2 - w / 2 / view.scale;
  view.y = (top + bottom) / 2 - (h - 30) / 2 / view.scale;
  redraw();
}

// Zooms by a factor; the place under a point of the stage stays there.
function zoomBy(factor, [x, y]) {
  const [ix, iy] = toImage([x, y]), [w, h] = stageSize();
  const least = Math.min(w / map.width, h / map.height) / 4;
  view.scale = Math.max(least, Math.min(64, view.scale * factor));
  view.x = ix - x / view.scale;
  view.y = iy - y / view.scale;
  redraw();
}

// Brings a place of the image into sight, not nearer than it is.
function lookAt([x, y]) {
  const [w, h] = stageSize();
  view.scale = Math.max(view.scale, Math.min(4, 40 * Math.min(w / map.width, h / map.height)));
  view.x = x - w / 2 / view.scale;
  view.y = y - h / 2 / view.scale;
  redraw();
}

let asked = false;
function redraw() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => { asked = false; drawTiles(); drawAll(); });
}

// ---- tiles

function drawTiles() {
  const canvas = $("tiles"), [w, h] = stageSize(), ratio = devicePixelRatio || 1;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
  const paper = canvas.getContext("2d");
  paper.setTransform(ratio, 0, 0, ratio, 0, 0);
  paper.clearRect(0, 0, w, h);
  const level = Math.max(0, Math.min(map.levels - 1, Math.floor(-Math.log2(view.scale * ratio))));
  // What is coarser is shown until the finer tile is there.
  paint(paper, map.levels - 1, w, h);
  if (level !== map.levels - 1) paint(paper, level, w, h);
}

function paint(paper, level, w, h) {
  const side = map.tile_px * 2 ** level, [left, top] = toImage([0, 0]), [right, bottom] = toImage([w, h]);
  paper.imageSmoothingEnabled = view.scale * 2 ** level < 1;
  for (let row = Math.max(0, Math.floor(top / side)); row * side < Math.min(bottom, map.height); row += 1) {
    for (let column = Math.max(0, Math.floor(left / side)); column * side < Math.min(right, map.width); column += 1) {
      const image = tileOf(level, column, row);
      if (!image) continue;
      const [x, y] = toScreen([column * side, row * side]), [ex, ey] = toScreen([column * side + image.width * 2 ** level, row * side + image.height * 2 ** level]);
      paper.drawImage(image, x, y, ex - x, ey - y);
    }
  }
}

function tileOf(level, column, row) {
  const key = `${level}/${column}/${row}`;
  if (tiles.has(key)) { const image = tiles.get(key); tiles.delete(key); tiles.set(key, image); return image; }
  tiles.set(key, null);
  for (const old of tiles.keys()) { if (tiles.size <= TILES_KEPT) break; tiles.get(old)?.close(); tiles.delete(old); }
  fetch(`/tile/${key}`, { headers: { authorization: `Bearer ${token}` } })
    .then((answer) => { if (!answer.ok) throw new Error(`tile ${key}: status ${answer.status}`); return answer.blob(); })
    .then(createImageBitmap)
    .then((image) => { tiles.set(key, image); redraw(); })
    .catch((why) => { tiles.delete(key); trouble(told(why)); });
  return null;
}

// ---- what is drawn

function drawAll() {
  if (!now) return;
  const svg = $("drawn");
  if (!layers.edges) for (const name of ["proposal", "way", "edges", "doors", "nodes", "names", "marks", "person", "rubber"]) layers[name] = made("g", { id: `layer-${name}` }, svg);
  drawEdges();
  drawDoors();
  drawNodes();
  drawNames();
  drawMarks();
  drawWay();
  drawProposal();
  drawPerson();
  $("zoom").textContent = view.scale >= 1 ? `${view.scale.toFixed(1)} px a cell` : `1 : ${(1 / view.scale).toFixed(1)}`;
}

function line(parent, kind, a, b, more = {}) {
  const [x1, y1] = toScreen(a), [x2, y2] = toScreen(b);
  return made("line", { class: kind, x1, y1, x2, y2, ...more }, parent);
}

function drawEdges() {
  layers.edges.replaceChildren();
  shapes.edges = [];
  const places = new Map(now.sketch.nodes.map((node) => [node.id, at(node)]));
  for (const edge of now.sketch.edges) {
    const key = edgeKey(edge), a = places.get(edge.from), b = places.get(edge.to);
    const shown = line(layers.edges, choice.edges.has(key) ? "edge chosen" : "edge", a, b);
    const hit = line(layers.edges, "edge hit", a, b, { "data-edge": key });
    made("title", {}, hit).textContent = `${edge.from} – ${edge.to}: ${edge.kind}`;
    shapes.edges.push({ edge, lines: [shown, hit] });
  }
}

function drawDoors() {
  layers.doors.replaceChildren();
  for (const door of now.sketch.doors) {
    const [from, to] = dragged.get(`door ${door.id}`) || [door.from, door.to];
    line(layers.doors, `door ${door.kind}${choice.doors.has(door.id) ? " chosen" : ""}`, from, to);
    const hit = line(layers.doors, "door hit", from, to, { "data-door": door.id });
    made("title", {}, hit).textContent = `door ${door.id}`;
  }
}

function drawNodes() {
  layers.nodes.replaceChildren();
  shapes.nodes.clear();
  const labels = view.scale >= LABELS_FROM || now.sketch.nodes.length < 60;
  for (const node of now.sketch.nodes) {
    const [x, y] = toScreen(at(node)), isChosen = choice.nodes.has(node.id);
    const dot = made("circle", { class: isChosen ? "node chosen" : "node", cx: x, cy: y, r: NODE_R, fill: colorOf(node.kind), "data-node": node.id, role: "img", "aria-label": `${node.id}, ${node.kind}` }, layers.nodes);
    made("title", {}, dot).textContent = `${node.id}: ${node.kind}`;
    const label = labels || isChosen ? made("text", { class: "label", x: x + 8, y: y - 6 }, layers.nodes) : null;
    if (label) label.textContent = node.id;
    shapes.nodes.set(node.id, { dot, label });
  }
}

// The name of an area stands below its first node, the one to go to.
function drawNames() {
  layers.names.replaceChildren();
  for (const area of areas()) {
    const node = nodeOf(area.nodes[0]);
    if (!node) continue;
    const [x, y] = toScreen(at(node));
    made("text", { class: "label area", x, y: y + 20 }, layers.names).textContent = area.name;
  }
}

// Puts what is dragged where it is, and leaves everything else: a frame of a drag costs as much as what moves.
function shift() {
  const set = (shape, places) => Object.entries(places).forEach(([name, value]) => shape.setAttribute(name, value));
  for (const [id, spot] of dragged) {
    const shape = shapes.nodes.get(id), [x, y] = toScreen(spot);
    if (!shape) continue;
    set(shape.dot, { cx: x, cy: y });
    if (shape.label) set(shape.label, { x: x + 8, y: y - 6 });
  }
  for (const { edge, lines } of shapes.edges) {
    for (const [end, x, y] of [[edge.from, "x1", "y1"], [edge.to, "x2", "y2"]]) {
      const spot = dragged.get(end);
      if (spot) for (const one of lines) { const [px, py] = toScreen(spot); set(one, { [x]: px, [y]: py }); }
    }
  }
}

function drawMarks() {
  layers.marks?.replaceChildren();
  const taken = new Map();
  findings.forEach((finding, index) => {
    if (!finding.at || !layers.marks) return;
    // Several at one place stand beside each other.
    const key = finding.at.map(Math.round).join(), nth = taken.get(key) || 0;
    taken.set(key, nth + 1);
    const [x, y] = toScreen(finding.at), mark = made("g", { class: `mark ${finding.level}`, transform: `translate(${x + 10 + nth * 17},${y + 13})`, "data-finding": index }, layers.marks);
    made("path", { d: "M0,-9 L9,7 L-9,7 Z" }, mark);
    made("text", { y: 5 }, mark).textContent = finding.level === "advised" ? "i" : "!";
    made("title", {}, mark).textContent = finding.text;
  });
}

function drawWay() {
  layers.way?.replaceChildren();
  if (!layers.way || !way || !way.points) return;
  made("polyline", { class: way.way.nodes.length ? "way" : "way free", points: way.points.map((p) => toScreen(p).join()).join(" ") }, layers.way);
}

function drawPerson() {
  layers.person?.replaceChildren();
  if (!walking) return;
  const [x, y] = toScreen(walking.at);
  made("circle", { class: "person", cx: x, cy: y, r: Math.max(5, 0.28 / map.resolution_m * view.scale) }, layers.person);
}

// Somebody walks the way, four times as fast as in life.
function startWalk() {
  if (!way || !way.walk) return;
  const { places, every_s } = way.walk, began = performance.now();
  walking = { at: places[0], of: way };
  const step = (time) => {
    if (!walking || walking.of !== way) { walking = null; drawPerson(); return; }
    const place = Math.max(0, (time - began) / 1000 * 4 / every_s), index = Math.min(Math.floor(place), places.length - 1), next = places[Math.min(index + 1, places.length - 1)], share = Math.min(1, place - index);
    walking.at = [places[index][0] + (next[0] - places[index][0]) * share, places[index][1] + (next[1] - places[index][1]) * share];
    drawPerson();
    if (index < places.length - 1) requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function drawProposal() {
  layers.proposal?.replaceChildren();
  if (!proposal || !layers.proposal) return;
  const places = new Map(proposal.sketch.nodes.map((node) => [node.id, node.at]));
  for (const edge of proposal.sketch.edges) line(layers.proposal, "proposed-edge", places.get(edge.from), places.get(edge.to));
  for (const door of proposal.sketch.doors) line(layers.proposal, "proposed-door", door.from, door.to);
  for (const node of proposal.sketch.nodes) {
    const [cx, cy] = toScreen(node.at), dot = made("circle", { class: proposal.chosen.has(node.id) ? "proposed chosen" : "proposed", cx, cy, r: NODE_R + 1, "data-proposed": node.id }, layers.proposal);
    made("title", {}, dot).textContent = `proposed: ${node.kind}`;
  }
}
