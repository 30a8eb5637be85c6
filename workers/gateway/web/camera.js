// What part of a place a map shows, and how hands move it: wheel, drag, pinch, click. Units are those of the floor's drawing.
// This is the only file that knows how world, drawing and map belong together; every layer asks it.

// Nobody wants to see less than this share of the place's size, or more pixels per meter than this.
const LEAST_SHARE = 0.5, MOST_PX_PER_M = 400;
const WHEEL = 0.0015;
// A press that moves less than this is a click, px.
const STILL_PX = 6;
const MARGIN_M = 2, LEAST_M = 8;

/**
 * Where a place lies in its drawing. The axes of the world may be turned against those of the drawing by `yaw`, rad, counter-clockwise: a map
 * whose origin is turned is drawn along its own rows. `origin` is the upper left corner of the drawing, m along the axes of the drawing.
 */
class Ground {
  constructor({ px_per_m, origin, yaw }) {
    this.px_per_m = px_per_m; this.yaw = Number.isFinite(yaw) ? yaw : 0;
    this.left = origin[0] * px_per_m; this.top = origin[1] * px_per_m;
    // Drawing units of a meter along each axis of the world.
    this.c = Math.cos(this.yaw) * px_per_m; this.s = Math.sin(this.yaw) * px_per_m;
  }
  ux(x, y) { return this.c * x + this.s * y - this.left; }
  uy(x, y) { return this.top + this.s * x - this.c * y; }
}

/** Whether two places are drawn alike, so that the same part of both can be shown. */
export const drawnAlike = (a, b) => a.px_per_m === b.px_per_m && a.box.join() === b.box.join() && a.origin.join() === b.origin.join() && (a.yaw || 0) === (b.yaw || 0);

export class Camera {
  /** `changed` after each move; `picked(x, y)` with a click in px of the map. Hands that move it also call `moved`, and dragging `dragged`. */
  constructor(node, changed, picked) {
    this.node = node; this.changed = changed; this.picked = picked;
    this.x = 0; this.y = 0; this.k = 1; this.w = 1; this.h = 1; this.place = null; this.area = null; this.mode = "whole";
    this.fingers = new Map();
    new ResizeObserver(() => this.resize()).observe(node);
    node.addEventListener("wheel", (e) => {
      e.preventDefault();
      const [x, y] = this.spot(e);
      this.zoom(Math.exp(-e.deltaY * (e.deltaMode === 1 ? 16 : 1) * WHEEL), x, y);
    }, { passive: false });
    node.addEventListener("pointerdown", (e) => this.down(e));
    node.addEventListener("pointermove", (e) => this.move(e));
    for (const end of ["pointerup", "pointercancel"]) node.addEventListener(end, (e) => this.up(e));
  }

  load(place) {
    this.place = place; this.ground = new Ground(place); this.area = null; this.mode = "whole";
    this.resize();
  }
  /** World to px of the map. */
  sx(x, y) { return (this.ground.ux(x, y) - this.x) * this.k; }
  sy(x, y) { return (this.ground.uy(x, y) - this.y) * this.k; }
  /** Angle in the world to an angle on the map, counter-clockwise from the right. */
  turn(yaw) { return yaw - this.ground.yaw; }
  /** World to px of the map as six numbers a to f, as of CSS: x' = a x + c y + e, y' = b x + d y + f. */
  matrix() {
    const { c, s } = this.ground, k = this.k;
    return [c * k, s * k, s * k, -c * k, this.sx(0, 0), this.sy(0, 0)];
  }
  /** Px of the map to drawing units. */
  drawn(x, y) { return [this.x + x / this.k, this.y + y / this.k]; }
  /** Where the drawing itself lies on the map, as a transform of CSS. */
  floor() {
    const [bx, by] = this.place.box;
    return `translate(${(bx - this.x) * this.k}px, ${(by - this.y) * this.k}px) scale(${this.k})`;
  }
  /** Px on the map of a length in m. */
  px(m) { return m * this.place.px_per_m * this.k; }

  spot(e) { const box = this.node.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; }

  resize() {
    const w = this.node.clientWidth, h = this.node.clientHeight;
    if (w < 1 || h < 1) return;
    const cx = this.x + this.w / 2 / this.k, cy = this.y + this.h / 2 / this.k;
    this.w = w; this.h = h;
    if (!this.place) return;
    if (this.mode === "whole") this.fit(this.place.box);
    else if (this.mode === "area" && this.area) this.fit(this.area);
    else { this.x = cx - w / 2 / this.k; this.y = cy - h / 2 / this.k; }
    this.changed();
  }

  least() { const [, , w, h] = this.place.box; return LEAST_SHARE * Math.min(this.w / w, this.h / h); }
  most() { return Math.max(MOST_PX_PER_M / this.place.px_per_m, this.least() * 4); }

  fit([x, y, w, h]) {
    this.k = Math.min(this.w / Math.max(w, 1e-6), this.h / Math.max(h, 1e-6), this.most());
    this.x = x + w / 2 - this.w / 2 / this.k;
    this.y = y + h / 2 - this.h / 2 / this.k;
  }

  /** The part of the place around these points of the world, with room to move; false if that is nearly everything. */
  around(points) {
    if (!this.place || points.length === 0) return false;
    const p = this.place.px_per_m, [bx, by, bw, bh] = this.place.box;
    const xs = points.map(([x, y]) => this.ground.ux(x, y)), ys = points.map(([x, y]) => this.ground.uy(x, y));
    const mx = (Math.min(...xs) + Math.max(...xs)) / 2, my = (Math.min(...ys) + Math.max(...ys)) / 2;
    const w = Math.max(Math.max(...xs) - Math.min(...xs) + 2 * MARGIN_M * p, LEAST_M * p), h = Math.max(Math.max(...ys) - Math.min(...ys) + 2 * MARGIN_M * p, LEAST_M * p);
    const x0 = Math.max(bx, mx - w / 2), y0 = Math.max(by, my - h / 2), x1 = Math.min(bx + bw, mx + w / 2), y1 = Math.min(by + bh, my + h / 2);
    if (!(x1 > x0 && y1 > y0) || Math.max((x1 - x0) / bw, (y1 - y0) / bh) > 0.85) return false;
    this.area = [x0, y0, x1 - x0, y1 - y0];
    return true;
  }

  show(mode) { this.mode = mode; this.resize(); this.moved?.(); }

  copy({ area, mode, x, y, k, w, h }) {
    this.area = area; this.mode = mode; this.k = k;
    this.x = x + (w - this.w) / 2 / k; this.y = y + (h - this.h) / 2 / k;
    this.resize();
  }

  zoom(by, x = this.w / 2, y = this.h / 2) {
    if (!this.place) return;
    const k = Math.max(this.least(), Math.min(this.most(), this.k * by));
    this.x += x / this.k - x / k;
    this.y += y / this.k - y / k;
    this.k = k;
    this.mode = "free";
    this.changed();
    this.moved?.();
  }

  /** Moves what is seen by these shares of the map's width and height. */
  pan(across, down) {
    if (!this.place) return;
    this.x += across * this.w / this.k; this.y += down * this.h / this.k;
    this.mode = "free";
    this.changed();
    this.moved?.();
  }

  /** Puts a point of the world into the middle. */
  center(x, y) {
    if (this.mode !== "free") {
      // Following somebody over the whole map would follow nothing: go near enough to see them.
      if (this.mode === "whole") this.k = Math.max(this.k, Math.min(this.most(), Math.min(this.w, this.h) / (14 * this.place.px_per_m)));
      this.mode = "free";
    }
    this.x = this.ground.ux(x, y) - this.w / 2 / this.k;
    this.y = this.ground.uy(x, y) - this.h / 2 / this.k;
  }

  down(e) {
    if (e.button !== 0 || (e.target.closest && e.target.closest("button, a, select"))) return;
    this.node.setPointerCapture(e.pointerId);
    const [x, y] = this.spot(e);
    this.fingers.set(e.pointerId, { x, y });
    this.path = this.fingers.size > 1 ? STILL_PX : 0;
  }

  move(e) {
    const finger = this.fingers.get(e.pointerId);
    if (!finger || !this.place) return;
    const [x, y] = this.spot(e), dx = x - finger.x, dy = y - finger.y;
    this.path += Math.hypot(dx, dy);
    if (this.path < STILL_PX) { finger.x = x; finger.y = y; return; }
    const other = [...this.fingers].find(([id]) => id !== e.pointerId);
    if (other) {
      const [, o] = other, was = Math.hypot(finger.x - o.x, finger.y - o.y), is = Math.hypot(x - o.x, y - o.y);
      if (was > 1 && is > 1) this.zoom(is / was, o.x, o.y);
    } else {
      this.x -= dx / this.k; this.y -= dy / this.k;
      this.mode = "free";
      this.dragged?.();
    }
    finger.x = x; finger.y = y;
    this.changed();
    this.moved?.();
  }

  up(e) {
    const finger = this.fingers.get(e.pointerId);
    this.fingers.delete(e.pointerId);
    if (finger && e.type === "pointerup" && this.path < STILL_PX && this.fingers.size === 0) this.picked(finger.x, finger.y);
  }
}
