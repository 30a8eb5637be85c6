// Where names and gestures are written: off walls, bodies and other words, inside the picture, and where they were before unless another
// place is much better. A name for which there is no room is left out.

// Places around somebody, the best first: above, below, beside, the corners, and those again a little apart.
const AROUND = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1]];
const APART = [0, 14, 30];
// Words that may be left out stay near: farther away nobody knows whose they are.
const NEAR_RINGS = 2;
const NAME_PX = 16, BUBBLE_PX = 24, DOOR_PX = 14;
const FONT = '"Ubuntu","Segoe UI",Helvetica,Arial,sans-serif';
const BOLD = "600 13px " + FONT, SAYS = "700 13px " + FONT, SMALL = "11px " + FONT;
const DOOR_INK = "#6b3f0f";
// Px² of covered area that another place must save before words move there: less would make them tremble. A ring farther out costs as much as
// `RING_PX2` of covered area, and words come back from it for less than they move around for.
const LOYAL_PX2 = 150, RING_PX2 = 80, BACK_PX2 = 40;
// A name goes when more than this share of its best place is covered, and comes back when less than that is: in between it stays as it is.
const FULL = 0.3, FREE = 0.1;
// Words that have moved, gone or come back stay so for this long, ms: in a knot of people they would jump about.
const STAY_MS = 1200;
// Longest side of the picture in which walls are looked up, px, and brightness below which a dot of it is wall (0 to 255).
const WALLS_PX = 1200, DARK = 110;

const shared = (a, b) => Math.max(0, Math.min(a[0] + a[2], b[0] + b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[1] + a[3], b[1] + b[3]) - Math.max(a[1], b[1]));

/** The walls of a floor, for one question: how much wall lies in a rectangle. Each answer costs four look-ups. */
export class Walls {
  /** Walls of the drawing of a floor; null where the browser does not let a script look at pictures. */
  static of(image, [left, top, width, height]) {
    const scale = Math.min(1, WALLS_PX / Math.max(width, height, 1)), w = Math.max(1, Math.ceil(width * scale)), h = Math.max(1, Math.ceil(height * scale));
    const canvas = document.createElement("canvas");
    canvas.width = w; canvas.height = h;
    let dots;
    try {
      const g = canvas.getContext("2d", { willReadFrequently: true });
      g.fillStyle = "#fff"; g.fillRect(0, 0, w, h);
      g.drawImage(image, 0, 0, w, h);
      dots = g.getImageData(0, 0, w, h).data;
    } catch { return null; }
    return new Walls(dots, w, h, left, top, scale);
  }

  constructor(dots, w, h, left, top, scale) {
    Object.assign(this, { w, h, left, top, scale });
    // Entry (x, y) is the number of dark dots above and left of it.
    this.sums = new Int32Array((w + 1) * (h + 1));
    for (let y = 0; y < h; y++) {
      let row = 0;
      for (let x = 0; x < w; x++) {
        const i = 4 * (y * w + x);
        if (dots[i] + dots[i + 1] + dots[i + 2] < 3 * DARK) row++;
        this.sums[(y + 1) * (w + 1) + x + 1] = this.sums[y * (w + 1) + x + 1] + row;
      }
    }
  }

  /** Share of wall, 0 to 1, in a rectangle of the drawing. */
  share(left, top, right, bottom) {
    const clip = (v, most) => Math.max(0, Math.min(most, Math.round(v)));
    const x0 = clip((left - this.left) * this.scale, this.w), x1 = clip((right - this.left) * this.scale, this.w);
    const y0 = clip((top - this.top) * this.scale, this.h), y1 = clip((bottom - this.top) * this.scale, this.h);
    if (x1 <= x0 || y1 <= y0) return 0;
    const { sums } = this, row = this.w + 1;
    return (sums[y1 * row + x1] - sums[y0 * row + x1] - sums[y1 * row + x0] + sums[y0 * row + x0]) / ((x1 - x0) * (y1 - y0));
  }
}

export class Labels {
  constructor() { this.spots = new Map(); this.gone = new Set(); this.moved = new Map(); this.widths = new Map(); this.walls = null; }

  /** Forgets where words were. */
  forget() { this.spots.clear(); this.gone.clear(); this.moved.clear(); }

  width(g, font, text) {
    const key = font + text;
    let wide = this.widths.get(key);
    if (wide === undefined) {
      if (this.widths.size > 500) this.widths.clear();
      g.font = font;
      wide = g.measureText(text).width;
      this.widths.set(key, wide);
    }
    return wide;
  }

  // Px² of wall under a rectangle of the map.
  wall([x, y, w, h], camera) {
    if (!this.walls) return 0;
    return this.walls.share(...camera.drawn(x, y), ...camera.drawn(x + w, y + h)) * w * h;
  }

  loyal(before, order) {
    if (before === undefined || order === before) return 0;
    return Math.floor(order / AROUND.length) < Math.floor(before / AROUND.length) ? BACK_PX2 : LOYAL_PX2;
  }

  /** The best rectangle of this size for words about somebody; null where there is no room and they `may` be left out. */
  place({ number, x, y }, rim, w, h, may, around) {
    const { bodies, taken, camera, frame, stamp } = around, before = this.spots.get(number), reach_px = rim + 2 + APART[APART.length - 1] + Math.max(w, h);
    // Only those near by can be in the way.
    const near = bodies.filter((body) => Math.abs(body[0] + body[2] / 2 - x) < reach_px + body[2] / 2 && Math.abs(body[1] + body[3] / 2 - y) < reach_px + body[3] / 2);
    const rings = may ? NEAR_RINGS : APART.length, stays = before < rings * AROUND.length && stamp - (this.moved.get(number) ?? -Infinity) < STAY_MS;
    let best = null, least = Infinity, spot = 0, covered = 0;
    APART.slice(0, rings).forEach((apart, ring) => AROUND.forEach(([across, down], side) => {
      const reach = (rim + 2 + apart) * (across && down ? 0.7 : 1), order = ring * AROUND.length + side;
      if (stays && order !== before) return;
      const box = [x + across * (reach + w / 2) - w / 2, y + down * (reach + h / 2) - h / 2, w, h];
      const outside = w * h - shared(box, frame);
      let words = 0, others = 0;
      for (const other of taken) words += shared(box, other);
      for (const body of near) others += shared(box, body) * (body.number === number ? 1 : 3);
      const cost = 20 * outside + 3 * words + others + 1.5 * this.wall(box, camera) + side * 1.5 + ring * RING_PX2 + this.loyal(before, order);
      if (cost < least - 1e-9) { least = cost; best = box; spot = order; covered = words + others / 3 + outside; }
    }));
    const was = this.gone.has(number), gone = may && (was && stays ? true : covered / (w * h) > (was ? FREE : FULL));
    if (before !== undefined && (spot !== before || gone !== was)) this.moved.set(number, stamp);
    this.spots.set(number, spot);
    if (gone) { this.gone.add(number); return null; }
    this.gone.delete(number);
    taken.push(best);
    return best;
  }

  /**
   * Writes the words of everybody: `people` have px `x`, `y`, `r`, and `name`, `color`, `said`, each of which may be empty, and `must` where the
   * name may not be left out. `doors` have px `x`, `y`, `r` and `name`. `stamp` is the time of the picture, ms.
   */
  draw(g, people, doors, camera, stamp) {
    const { w, h } = camera, bodies = people.map((p) => Object.assign([p.x - p.r, p.y - p.r, 2 * p.r, 2 * p.r], { number: p.number }));
    const around = { bodies, taken: [], camera, stamp, frame: [2, 2, w - 4, h - 4] };
    const seen = (p) => p.x > -20 && p.y > -20 && p.x < w + 20 && p.y < h + 20;
    g.textAlign = "center"; g.textBaseline = "alphabetic"; g.lineJoin = "round";
    // Words that may not be left out come first: the others give way.
    for (const must of [true, false]) {
      for (const p of people) if ((p.name || p.said) && must === Boolean(p.must || p.said) && seen(p)) this.person(g, p, must, around);
    }
    for (const door of doors) if (seen(door)) this.door(g, door, around);
  }

  person(g, p, must, around) {
    const wide = p.name ? this.width(g, BOLD, p.name) + 4 : 0, says = p.said ? this.width(g, SAYS, p.said) + 14 : 0;
    const box = this.place(p, p.said ? p.r * 1.7 : p.r, Math.max(wide, says), (p.name ? NAME_PX : 0) + (p.said ? BUBBLE_PX : 0), !must, around);
    if (!box) return;
    const [left, top, across, high] = box, middle = left + across / 2, below = top + high / 2 > p.y;
    if (p.said) {
      const edge = below ? top + high - 23 : top + 1;
      g.beginPath(); g.roundRect(middle - says / 2, edge, says, 22, 5);
      g.fillStyle = "#fff4d6"; g.fill();
      g.strokeStyle = "#b07a00"; g.lineWidth = 1; g.stroke();
      g.font = SAYS; g.fillStyle = "#1f2328";
      g.fillText(p.said, middle, edge + 16);
    }
    if (p.name) this.write(g, p.name, middle, below ? top + 13 : top + high - 3, BOLD, p.color, 5);
  }

  door(g, door, around) {
    const box = this.place(door, door.r, this.width(g, SMALL, door.name) + 4, DOOR_PX, true, around);
    if (box) this.write(g, door.name, box[0] + box[2] / 2, box[1] + 11, SMALL, DOOR_INK, 4);
  }

  write(g, text, x, y, font, look, halo) {
    g.font = font; g.strokeStyle = "#fff"; g.lineWidth = halo;
    g.strokeText(text, x, y);
    g.fillStyle = look;
    g.fillText(text, x, y);
  }
}
