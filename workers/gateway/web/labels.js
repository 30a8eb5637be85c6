// Where names and gestures are written: off bodies and other words, inside the picture, and where they were before unless another place is
// much better.

// Places around somebody, the best first: above, below, beside, the corners, and those again a little apart.
const AROUND = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1]];
const APART = [0, 14, 30];
const NAME_PX = 16, BUBBLE_PX = 24;
const FONT = '"Ubuntu","Segoe UI",Helvetica,Arial,sans-serif';
const BOLD = "600 13px " + FONT, SAYS = "700 13px " + FONT;

const shared = (a, b) => Math.max(0, Math.min(a[0] + a[2], b[0] + b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[1] + a[3], b[1] + b[3]) - Math.max(a[1], b[1]));

export class Labels {
  constructor() { this.spots = new Map(); this.widths = new Map(); }

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

  place(number, x, y, rim, w, h, bodies, taken, frame) {
    const before = this.spots.get(number) || 0;
    let best = null, least = Infinity, spot = 0;
    APART.forEach((apart, ring) => AROUND.forEach(([across, down], side) => {
      const reach = (rim + 2 + apart) * (across && down ? 0.7 : 1), order = ring * AROUND.length + side;
      const box = [x + across * (reach + w / 2) - w / 2, y + down * (reach + h / 2) - h / 2, w, h];
      let cost = 20 * (w * h - shared(box, frame)) + order * 1.5 + (order === before ? 0 : 40);
      for (const body of bodies) cost += shared(box, body) * (body.number === number ? 1 : 3);
      for (const other of taken) cost += 3 * shared(box, other);
      if (cost < least - 1e-9) { least = cost; best = box; spot = order; }
    }));
    this.spots.set(number, spot);
    taken.push(best);
    return best;
  }

  /** Writes the words of everybody: `people` have px `x`, `y`, `r`, and `name`, `color`, `said`, each of which may be empty. */
  draw(g, people, w, h) {
    const frame = [2, 2, w - 4, h - 4], taken = [];
    const bodies = people.map((p) => Object.assign([p.x - p.r, p.y - p.r, 2 * p.r, 2 * p.r], { number: p.number }));
    g.textAlign = "center"; g.textBaseline = "alphabetic"; g.lineJoin = "round";
    for (const p of people) {
      if (!p.name && !p.said) continue;
      if (p.x < -20 || p.y < -20 || p.x > w + 20 || p.y > h + 20) continue;
      const wide = p.name ? this.width(g, BOLD, p.name) + 4 : 0, says = p.said ? this.width(g, SAYS, p.said) + 14 : 0;
      const [left, top, across, high] = this.place(p.number, p.x, p.y, p.said ? p.r * 1.7 : p.r, Math.max(wide, says), (p.name ? NAME_PX : 0) + (p.said ? BUBBLE_PX : 0), bodies, taken, frame);
      const middle = left + across / 2, below = top + high / 2 > p.y;
      if (p.said) {
        const edge = below ? top + high - 23 : top + 1;
        g.beginPath(); g.roundRect(middle - says / 2, edge, says, 22, 5);
        g.fillStyle = "#fff4d6"; g.fill();
        g.strokeStyle = "#b07a00"; g.lineWidth = 1; g.stroke();
        g.font = SAYS; g.fillStyle = "#1f2328";
        g.fillText(p.said, middle, edge + 16);
      }
      if (p.name) {
        const line = below ? top + 13 : top + high - 3;
        g.font = BOLD; g.strokeStyle = "#fff"; g.lineWidth = 4;
        g.strokeText(p.name, middle, line);
        g.fillStyle = p.color;
        g.fillText(p.name, middle, line);
      }
    }
  }
}
