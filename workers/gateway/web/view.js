// One map with one run on it: the floor as a picture, the crowd as points, everything else on a canvas above.
import { Camera, drawnAlike } from "./camera.js";
import { Points } from "./gl.js";
import { Labels, Walls } from "./labels.js";
import { BEAMS, NOTHING, THERE, place, pose } from "./wire.js";
import { CROWD, POINTS, SAYS, color, ink, plain, runUrl, word } from "./words.js";

const TRAIL_SECS = 4;
// Above this many agents only the robot and whoever is followed have a trail.
const TRAILS = 200;
const TRAIL_STEPS = 20;
// Nobody is smaller than a fingertip can see, px.
const LEAST_PX = 6, LEAST_CROWD_PX = 3, LEAST_ROBOT_PX = 7, LEAST_POINT_PX = 1.5;
const MOST_BUBBLES = 40, MOST_GAZES = 400;
const PICK_PX = 14;
const PERSON_M = 0.3;
// Smallest scale at which doors have their names, px per meter, and the largest number of doors that have them.
const DOOR_PX_PER_M = 24, MOST_DOORS = 60;
// The picture has jumped when its time differs by more than this from the one before, s, and by this many seconds of playback.
const JUMP_SECS = 0.3, JUMP_PLAYED = 0.5;
// More pixels than these cost time and show nothing more.
const MOST_RATIO = 2;

export class View {
  /** `changed` when the picture must be drawn anew; `picked(number)` with the agent that was pressed. */
  constructor(parent, changed, picked) {
    this.figure = word("figure", "", parent);
    this.map = word("div", "", this.figure, "map");
    this.floor = document.createElement("img");
    this.floor.alt = ""; this.floor.className = "floor"; this.floor.draggable = false;
    this.crowd = document.createElement("canvas"); this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.map.append(this.floor, this.crowd, this.canvas);
    this.caption = word("figcaption", "", this.figure);
    this.g = this.canvas.getContext("2d");
    this.labels = new Labels();
    this.floor.addEventListener("load", () => { this.labels.walls = Walls.of(this.floor, this.scene.place.box); changed(); });
    this.camera = new Camera(this.map, changed, (x, y) => this.pick(x, y, picked));
    this.points = undefined; this.people = []; this.renderer = "canvas"; this.followed = null;
    this.changed = changed;
  }

  load(scene) {
    this.scene = scene;
    const [, , w, h] = scene.place.box;
    this.floor.style.width = w + "px"; this.floor.style.height = h + "px";
    const source = runUrl(scene.run, "/floor.svg").href;
    if (this.floor.src !== source) this.floor.src = source;
    this.canvas.setAttribute("aria-label", `map with the run ${scene.run}, seen from above`);
    this.radius = new Map(scene.agents.map((a) => [a.number, a.radius_m]));
    this.names = new Map(scene.agents.map((a) => [a.number, a.id.replace(/^human_/, "h")]));
    this.area = false;
    if (!this.camera.place || !drawnAlike(this.camera.place, scene.place)) this.camera.load(scene.place);
  }

  /** Shows the part of the place that another map shows. */
  lookAs(other) {
    this.area = other.area;
    this.camera.copy(other.camera);
  }

  // Once the first frame is there the map shows where it happens.
  aim(frame) {
    if (this.area) return;
    this.area = true;
    if (frame.n > CROWD) return;
    const points = [...(this.scene.way || []), ...(this.scene.goal ? [this.scene.goal] : [])];
    for (let i = 0; i < frame.n; i++) if (frame.words[8 * i + 7] & THERE) points.push([frame.floats[4 * i], frame.floats[4 * i + 1]]);
    if (this.camera.around(points) && this.camera.mode === "whole") this.camera.show("area");
    this.camera.moved?.();
  }

  /** Draws a time of a run; `moment` is null while nothing is known. */
  draw(reel, moment, t, rate) {
    const { camera, g } = this, ratio = Math.min(MOST_RATIO, devicePixelRatio || 1);
    if (!this.scene || !camera.place) return;
    if (moment) this.aim(moment.a);
    if (moment && this.followed !== null) {
      const i = place(moment.a, this.followed, 0), at = i < 0 ? null : pose(moment.a, moment.b, moment.u, i);
      if (at) camera.center(at.x, at.y);
    }
    const w = Math.round(camera.w * ratio), h = Math.round(camera.h * ratio);
    if (this.canvas.width !== w || this.canvas.height !== h) {
      this.canvas.width = w; this.canvas.height = h;
      // Sized with the picture, not with the map: until the next picture all layers stay where they fit each other.
      for (const layer of [this.canvas, this.crowd]) { layer.style.width = camera.w + "px"; layer.style.height = camera.h + "px"; }
    }
    this.floor.style.transform = camera.floor();
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, camera.w, camera.h);
    this.drawWay(); this.drawDoors(reel, t);
    if (moment) { this.settle(moment, rate); this.drawAgents(reel, moment, ratio); }
    this.drawScale();
  }

  // After a jump in time words stand where that moment alone puts them: the same moment is the same picture.
  settle({ a, b, u }, rate) {
    const shown = b ? a.t + (b.t - a.t) * u : a.t;
    if (!(Math.abs(shown - this.shown) <= JUMP_SECS + JUMP_PLAYED * rate)) this.labels.forget();
    this.shown = shown;
  }

  drawAgents(reel, moment, ratio) {
    const { a, b, u } = moment, many = a.n > POINTS;
    if (many && this.points === undefined) this.points = Points.on(this.crowd);
    const points = many && this.points ? this.points : null;
    this.renderer = points ? "webgl" : "canvas";
    this.crowd.hidden = !points;
    const people = [];
    for (let i = 0; i < a.n; i++) {
      const w = 8 * i, flags = a.words[w + 7], number = a.words[w + 6];
      // Of a crowd only those have a shape on the canvas about whom there is something to say.
      if (points && number !== 0 && number !== this.followed && !(flags & 0x0f) && !(flags & 0x20)) continue;
      const p = pose(a, b, u, i);
      if (!p) continue;
      const r = this.radius.get(number) ?? PERSON_M;
      [p.x, p.y] = [this.camera.sx(p.x, p.y), this.camera.sy(p.x, p.y)]; p.yaw = this.camera.turn(p.yaw); p.guess = i;
      p.r = Math.max(this.camera.px(r), number === 0 ? LEAST_ROBOT_PX : many ? LEAST_POINT_PX : a.n > CROWD ? LEAST_CROWD_PX : LEAST_PX);
      people.push(p);
    }
    this.people = people;
    if (points) points.draw(moment, this.camera, 2 * Math.max(LEAST_POINT_PX, this.camera.px(PERSON_M)), ratio);
    const robot = people.find((p) => p.number === 0);
    this.drawTrails(reel, moment, people);
    if (robot) { this.drawScan(a); this.drawGazes(people, robot); }
    for (const p of [...people].reverse()) {
      if (p.x < -50 || p.y < -50 || p.x > this.camera.w + 50 || p.y > this.camera.h + 50) continue;
      if (p.number === this.followed) this.ring(p.x, p.y, p.r * 1.45 + 3, "#1f2328", 1.5, [4, 3]);
      if (p.number === 0) this.drawRobot(p);
      else if (!points) { if (many) this.dot(p); else this.drawPerson(p); }
      if (p.says && !points) this.ring(p.x, p.y, p.r * 1.7, "#e69f00", 3, []);
    }
    this.drawWords(people, a.n);
  }

  drawWords(people, n) {
    let bubbles = 0;
    const said = people.map((p) => {
      const says = p.says && bubbles < MOST_BUBBLES ? SAYS[p.says] || "" : "";
      if (says) bubbles++;
      const named = n <= CROWD || p.number === 0 || p.number === this.followed;
      return { number: p.number, x: p.x, y: p.y, r: p.r, said: says, name: named ? this.names.get(p.number) || "" : "", color: ink(p.number), must: p.number === 0 || p.number === this.followed };
    });
    this.labels.draw(this.g, n > POINTS ? said.filter((p) => p.said || p.name) : said, this.doorNames(), this.camera, performance.now());
  }

  // Doors whose names have room, each with the middle of its opening.
  doorNames() {
    const doors = this.scene.doors || [], { camera } = this;
    if (doors.length > MOST_DOORS || camera.px(1) < DOOR_PX_PER_M) return [];
    return doors.map(({ id, from, to }) => {
      const x = (from[0] + to[0]) / 2, y = (from[1] + to[1]) / 2;
      return { number: "door " + id, x: camera.sx(x, y), y: camera.sy(x, y), r: 5, name: plain(id) };
    });
  }

  ring(x, y, r, look, wide, dash) {
    const g = this.g;
    g.beginPath(); g.arc(x, y, r, 0, 7);
    g.strokeStyle = look; g.lineWidth = wide; g.setLineDash(dash); g.stroke(); g.setLineDash([]);
  }

  dot(p) {
    this.g.fillStyle = color(p.number);
    this.g.fillRect(p.x - p.r, p.y - p.r, 2 * p.r, 2 * p.r);
  }

  drawPerson({ x, y, r, yaw, number }) {
    const g = this.g, c = Math.cos(yaw), s = -Math.sin(yaw);
    const to = (along, across) => [x + r * (along * c - across * s), y + r * (along * s + across * c)];
    g.beginPath(); g.arc(x, y, r, 0, 7);
    g.fillStyle = color(number); g.fill();
    g.strokeStyle = "#fff"; g.lineWidth = r < 5 ? 0.8 : 1.5; g.stroke();
    if (r < 3.5) return;
    g.beginPath(); g.moveTo(...to(0.85, 0)); g.lineTo(...to(0.2, 0.4)); g.lineTo(...to(0.2, -0.4)); g.closePath();
    g.fillStyle = "#fff"; g.fill();
  }

  drawRobot({ x, y, r, yaw }) {
    const g = this.g;
    g.save();
    g.translate(x, y); g.rotate(-yaw);
    g.beginPath(); g.roundRect(-r, -r, 2 * r, 2 * r, r * 0.3);
    g.fillStyle = color(0); g.fill();
    g.strokeStyle = "#fff"; g.lineWidth = 1.5; g.stroke();
    g.beginPath(); g.moveTo(r * 0.75, 0); g.lineTo(-r * 0.45, r * 0.55); g.lineTo(-r * 0.2, 0); g.lineTo(-r * 0.45, -r * 0.55); g.closePath();
    g.fillStyle = "#fff"; g.fill();
    g.restore();
  }

  drawTrails(reel, moment, people) {
    const n = moment.a.n, g = this.g;
    const whose = n <= TRAILS ? people : people.filter((p) => p.number === 0 || p.number === this.followed);
    if (whose.length === 0) return;
    const all = reel.before(moment.t, TRAIL_SECS), every = Math.max(1, Math.ceil(all.length / (n > CROWD ? TRAIL_STEPS : 160)));
    // Counted from ticks, so that the same frames are left out in the next picture and the trail does not tremble.
    const frames = all.filter((f, i) => every === 1 || i === all.length - 1 || Math.round(f.t / reel.step / reel.base) % every === 0);
    g.lineJoin = "round"; g.lineCap = "round"; g.globalAlpha = 0.6;
    for (const p of whose) {
      g.beginPath();
      let pen = false;
      for (const f of frames) {
        const i = place(f, p.number, p.guess), there = i >= 0 && (f.words[8 * i + 7] & THERE);
        if (!there) { pen = false; continue; }
        const wx = f.floats[4 * i], wy = f.floats[4 * i + 1], x = this.camera.sx(wx, wy), y = this.camera.sy(wx, wy);
        if (pen) g.lineTo(x, y); else g.moveTo(x, y);
        pen = true;
      }
      if (pen) g.lineTo(p.x, p.y);
      g.strokeStyle = color(p.number); g.lineWidth = n > CROWD && p.number !== 0 ? 1.5 : 3;
      g.stroke();
    }
    g.globalAlpha = 1; g.lineCap = "butt";
  }

  // The beams end where the robot was in that very frame, so the points lie on the walls also while it turns.
  drawScan(frame) {
    if (!frame.scan) return;
    const i = place(frame, 0, 0), at = i < 0 ? null : pose(frame, null, 0, i);
    if (!at) return;
    const g = this.g;
    g.fillStyle = "#00619a"; g.globalAlpha = 0.75;
    for (let beam = 0; beam < BEAMS; beam++) {
      const range = frame.scan[beam];
      if (range === NOTHING) continue;
      const angle = at.yaw + beam * Math.PI / 180;
      const x = at.x + Math.cos(angle) * range / 1000, y = at.y + Math.sin(angle) * range / 1000;
      g.fillRect(this.camera.sx(x, y) - 1.25, this.camera.sy(x, y) - 1.25, 2.5, 2.5);
    }
    g.globalAlpha = 1;
  }

  drawGazes(people, robot) {
    const g = this.g;
    g.beginPath();
    let drawn = 0;
    for (const p of people) {
      if (!p.sees || drawn >= MOST_GAZES) continue;
      drawn++;
      g.moveTo(p.x, p.y); g.lineTo(robot.x, robot.y);
    }
    if (drawn === 0) return;
    g.strokeStyle = "#2b8cc4"; g.lineWidth = 1.2; g.globalAlpha = drawn > CROWD ? 0.3 : 0.8;
    g.stroke();
    g.globalAlpha = 1;
  }

  drawWay() {
    const { g, camera, scene } = this;
    if (scene.way && scene.way.length > 1) {
      g.beginPath();
      scene.way.forEach(([x, y], i) => { if (i) g.lineTo(camera.sx(x, y), camera.sy(x, y)); else g.moveTo(camera.sx(x, y), camera.sy(x, y)); });
      g.strokeStyle = "#0072B2"; g.lineWidth = 1.6; g.globalAlpha = 0.65; g.setLineDash([3, 5]); g.stroke(); g.setLineDash([]); g.globalAlpha = 1;
    }
    if (!scene.goal) return;
    const x = camera.sx(...scene.goal), y = camera.sy(...scene.goal);
    this.ring(x, y, 9, "#0072b2", 1.5, []);
    g.fillStyle = "#0072b2";
    g.beginPath(); g.rect(x - 3, y - 6, 1.8, 12); g.moveTo(x - 1.5, y - 6); g.lineTo(x + 6, y - 2.8); g.lineTo(x - 1.5, y + 0.5); g.fill();
  }

  drawDoors(reel, t) {
    const { g, camera } = this;
    for (const door of this.scene.doors || []) {
      const open = reel.open(door, t), part = open ? 0.14 : 0.5;
      const [x1, y1] = [camera.sx(...door.from), camera.sy(...door.from)], [x2, y2] = [camera.sx(...door.to), camera.sy(...door.to)];
      const dx = (x2 - x1) * part, dy = (y2 - y1) * part;
      g.beginPath(); g.moveTo(x1, y1); g.lineTo(x1 + dx, y1 + dy); g.moveTo(x2, y2); g.lineTo(x2 - dx, y2 - dy);
      g.strokeStyle = "#a8641c"; g.lineWidth = open ? 4 : 5; g.stroke();
    }
  }

  drawScale() {
    const { g, camera } = this;
    const meters = [0.5, 1, 2, 5, 10, 20, 50].find((m) => camera.px(m) >= 50) || 100, wide = camera.px(meters), x = 14, y = camera.h - 14;
    g.globalAlpha = 0.85; g.fillStyle = "#fff";
    g.beginPath(); g.roundRect(x - 6, y - 12, wide + 52, 20, 3); g.fill();
    g.globalAlpha = 1; g.strokeStyle = "#5b636e"; g.lineWidth = 2;
    g.beginPath(); g.moveTo(x, y - 4); g.lineTo(x, y + 4); g.moveTo(x, y); g.lineTo(x + wide, y); g.moveTo(x + wide, y - 4); g.lineTo(x + wide, y + 4); g.stroke();
    g.fillStyle = "#3b3f46"; g.font = '12px "Ubuntu","Segoe UI",Helvetica,Arial,sans-serif'; g.textAlign = "left";
    g.fillText(meters + " m", x + wide + 7, y + 4);
  }

  // The agent under a press, looked for among all records: of a crowd only a few have a shape of their own.
  pick(x, y, picked) {
    const m = this.moment;
    if (!m) return;
    let best = null, least = Infinity;
    for (let i = 0; i < m.a.n; i++) {
      if (!(m.a.words[8 * i + 7] & THERE)) continue;
      const wx = m.a.floats[4 * i], wy = m.a.floats[4 * i + 1], d = Math.hypot(this.camera.sx(wx, wy) - x, this.camera.sy(wx, wy) - y);
      if (d < least) { least = d; best = m.a.words[8 * i + 6]; }
    }
    const reach = Math.max(PICK_PX, this.camera.px(this.radius.get(best) ?? PERSON_M) * 1.3);
    if (best !== null && least <= reach) picked(best);
  }

  remove() { this.figure.remove(); }
}
