"use strict";
// What every page needs: small words for building it, and the player of a run. One time in seconds drives all views.
const player = (() => {
  const NS = "http://www.w3.org/2000/svg";
  const SAYS = ["", "WAIT", "PROCEED", "ACKNOWLEDGED", "EXCUSE ME", "FOLLOW ME"];
  // Above this many agents names would hide the crowd and whole trails would slow it down.
  const CROWD = 24;
  const TRAIL_SECS = 4;
  const WALL = "#3b3f46";
  // Where a name may stand around somebody, the best first: above, below, beside, the corners, and those again a little apart.
  const AROUND = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1]];
  const APART = [0, 14, 30];
  const plain = (text) => text.replace(/_/g, " ");
  const secs = (t) => t.toFixed(1) + " s";
  const make = (tag, attrs, parent) => {
    const node = document.createElementNS(NS, tag);
    for (const key in attrs) node.setAttribute(key, attrs[key]);
    if (parent) parent.appendChild(node);
    return node;
  };
  const word = (tag, text, parent, look) => {
    const node = document.createElement(tag);
    if (look) node.className = look;
    node.textContent = text;
    if (parent) parent.appendChild(node);
    return node;
  };
  // Puts a text in which `names` are set as code into a node; a sign that has no second one stays as it is.
  const put = (node, text) => {
    const parts = text.split("`");
    node.textContent = "";
    if (parts.length % 2 === 0) { node.textContent = text; return node; }
    parts.forEach((part, i) => { if (part) node.appendChild(i % 2 ? word("code", part) : document.createTextNode(part)); });
    return node;
  };
  const words = (tag, text, parent, look) => put(word(tag, "", parent, look), text);
  const seconds = (run) => Math.max(0, ...run.agents.map((a) => a.track.length / 4 - 1)) / run.hz;
  // Where somebody is between two samples: x, y, heading, gesture; null who is not there. Tracks are x y in tenths, heading in hundredths.
  function state(track, at) {
    const n = track.length / 4;
    if (!n) return null;
    const i = Math.max(0, Math.min(Math.floor(at + 1e-6), n - 1)), j = Math.min(i + 1, n - 1), u = Math.max(0, Math.min(at - i, 1));
    const a = i * 4, b = j * 4;
    // Who comes or goes is there or not: nothing is in between.
    if (track[a + 3] < 0) return null;
    if (track[b + 3] < 0) return [track[a] / 10, track[a + 1] / 10, track[a + 2] / 100, track[a + 3]];
    let turn = (track[b + 2] - track[a + 2]) / 100;
    turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
    return [(track[a] + (track[b] - track[a]) * u) / 10, (track[a + 1] + (track[b + 1] - track[a + 1]) * u) / 10, track[a + 2] / 100 + turn * u, track[a + 3]];
  }

  // The walls of a place as boxes: the floor is drawn of them.
  function boxes(place) {
    const floor = document.getElementById("floor-" + place.index), paths = floor ? [...floor.querySelectorAll("path")] : [];
    const path = paths.find((p) => p.getAttribute("fill") === WALL);
    return path ? [...path.getAttribute("d").matchAll(/M([-\d.]+) ([-\d.]+)h([-\d.]+)v([-\d.]+)/g)].map((m) => m.slice(1, 5).map(Number)) : [];
  }
  const shared = (a, b) => Math.max(0, Math.min(a[0] + a[2], b[0] + b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[1] + a[3], b[1] + b[3]) - Math.max(a[1], b[1]));

  // One map with one run on it. `box` is what it shows, in the drawing units of the place.
  class View {
    constructor(svg, place) {
      this.svg = svg; this.place = place; this.run = null; this.shapes = []; this.doors = []; this.walls = boxes(place); this.near = [];
      svg.textContent = "";
      svg.setAttribute("role", "img");
      make("use", { href: "#floor-" + place.index }, svg);
      this.trails = make("g", {}, svg); this.people = make("g", {}, svg); this.bar = make("g", {}, svg);
    }
    load(run) {
      this.run = run; this.trails.textContent = ""; this.people.textContent = "";
      this.svg.setAttribute("aria-label", "map with the run " + run.name + ", seen from above");
      if (run.way) make("polyline", { points: run.way, fill: "none", stroke: "#0072B2", "stroke-width": 1.6, "stroke-dasharray": "3 5", opacity: 0.65, "vector-effect": "non-scaling-stroke" }, this.trails);
      this.doors = run.doors.map((d) => ({ ...d, node: make("path", { stroke: "#a8641c", "vector-effect": "non-scaling-stroke", fill: "none" }, this.trails) }));
      this.crowd = run.agents.length > CROWD;
      this.shapes = [...run.agents].reverse().map((agent) => {
        const robot = agent.number === 0, r = agent.radius;
        const trail = make("polyline", { fill: "none", stroke: agent.color, "stroke-width": this.crowd && !robot ? 1.5 : 3, opacity: 0.6, "stroke-linejoin": "round", "vector-effect": "non-scaling-stroke" }, this.trails);
        const group = make("g", {}, this.people);
        make("title", {}, group).textContent = agent.name + (agent.role === agent.name ? "" : ", " + agent.role);
        const ring = make("circle", { r: r * 1.7, fill: "none", stroke: "#e69f00", "vector-effect": "non-scaling-stroke", "stroke-width": 3 }, group);
        const turned = make("g", {}, group);
        if (robot) {
          make("rect", { x: -r, y: -r, width: 2 * r, height: 2 * r, rx: r * 0.3, fill: agent.color, stroke: "#fff", "stroke-width": 1.5, "vector-effect": "non-scaling-stroke" }, turned);
          make("path", { d: `M${r * 0.75} 0L${-r * 0.45} ${r * 0.55}L${-r * 0.2} 0L${-r * 0.45} ${-r * 0.55}z`, fill: "#fff" }, turned);
        } else {
          make("circle", { r, fill: agent.color, stroke: "#fff", "stroke-width": 1.5, "vector-effect": "non-scaling-stroke" }, turned);
          make("path", { d: `M${r * 0.85} 0L${r * 0.2} ${r * 0.4}L${r * 0.2} ${-r * 0.4}z`, fill: "#fff" }, turned);
        }
        const name = make("text", { "text-anchor": "middle", "font-weight": 600, fill: agent.words, stroke: "#fff", "paint-order": "stroke", "stroke-linejoin": "round" }, group);
        name.textContent = this.crowd && !robot ? "" : agent.name.replace("human_", "h");
        const bubble = make("rect", { fill: "#fff4d6", stroke: "#b07a00", "vector-effect": "non-scaling-stroke" }, group);
        const says = make("text", { "text-anchor": "middle", "font-weight": 700, fill: "#1f2328" }, group);
        return { agent, trail, group, ring, turned, name, bubble, says };
      });
    }
    // Everything that depends on the size of the window.
    lay(box) {
      this.box = box;
      this.svg.setAttribute("viewBox", box.join(" "));
      const shown = this.svg.getBoundingClientRect();
      const k = Math.max(box[2] / Math.max(shown.width, 1), box[3] / Math.max(shown.height, 1));
      this.k = k;
      for (const s of this.shapes) {
        // Nobody is smaller than a fingertip can see.
        s.grow = Math.max(1, (this.crowd ? 3 : 6) * k / s.agent.radius);
        s.ring.setAttribute("r", s.agent.radius * 1.7 * s.grow);
        s.name.setAttribute("font-size", 14 * k); s.name.setAttribute("stroke-width", 4 * k); s.says.setAttribute("font-size", 14 * k);
        s.wide = s.name.textContent ? s.name.getComputedTextLength() + 4 * k : 0;
        s.spot = 0;
      }
      this.near = this.walls.filter((wall) => shared(wall, box) > 0);
      const bar = this.bar; bar.textContent = "";
      const meters = [0.5, 1, 2, 5, 10, 20, 50].find((m) => m * this.place.px_per_m / k >= 50) || 100;
      const x = box[0] + 14 * k, y = box[1] + box[3] - 14 * k, w = meters * this.place.px_per_m;
      make("rect", { x: x - 6 * k, y: y - 12 * k, width: w + 52 * k, height: 20 * k, fill: "#fff", opacity: 0.85, rx: 3 * k }, bar);
      make("path", { d: `M${x} ${y - 4 * k}v${8 * k}M${x} ${y}h${w}M${x + w} ${y - 4 * k}v${8 * k}`, stroke: "#5b636e", "stroke-width": 2 * k, fill: "none" }, bar);
      make("text", { x: x + w + 7 * k, y: y + 4 * k, "font-size": 12 * k, fill: "#3b3f46" }, bar).textContent = meters + " m";
    }
    // The box for the words of somebody: off walls, bodies and other words, inside the picture, and where it was before unless
    // another place is much better.
    label(s, [x, y], rim, [w, h], bodies, taken, index) {
      const k = this.k, places = [];
      for (const apart of APART) for (const [across, down] of AROUND) {
        const both = across && down ? 0.7 : 1, reach = (rim + (2 + apart) * k) * both;
        places.push([x + across * (reach + w / 2) - w / 2, y + down * (reach + h / 2) - h / 2, w, h]);
      }
      const cost = (box, order) => {
        const hidden = bodies.reduce((sum, body, i) => sum + shared(box, body) * (i === index ? 1 : 3), 0) + taken.reduce((sum, other) => sum + 3 * shared(box, other), 0);
        const dark = this.near.reduce((sum, wall) => sum + shared(box, wall), 0), outside = w * h - shared(box, this.box);
        return hidden + 2 * dark + 20 * outside + (order * 1.5 + (order === s.spot ? 0 : 40)) * k * k;
      };
      let best = 0, least = Infinity;
      places.forEach((box, order) => { const c = cost(box, order); if (c < least - 1e-9) { least = c; best = order; } });
      s.spot = best;
      taken.push(places[best]);
      return places[best];
    }
    show(now) {
      if (!this.run || !this.box) return;
      const hz = this.run.hz, at = now * hz, k = this.k, places = this.shapes.map((s) => state(s.agent.track, at)), taken = [];
      const bodies = places.map((p, i) => { const r = p ? this.shapes[i].agent.radius * this.shapes[i].grow : 0; return p ? [p[0] - r, p[1] - r, 2 * r, 2 * r] : [0, 0, 0, 0]; });
      this.shapes.forEach((s, index) => {
        const track = s.agent.track, p = places[index];
        s.group.setAttribute("visibility", p ? "visible" : "hidden");
        if (!p) { s.trail.setAttribute("points", ""); return; }
        const [x, y, yaw, code] = p, r = s.agent.radius * s.grow, said = SAYS[code] || "";
        s.group.setAttribute("transform", `translate(${x} ${y})`);
        s.turned.setAttribute("transform", `rotate(${-yaw * 180 / Math.PI}) scale(${s.grow})`);
        s.ring.setAttribute("opacity", said ? 1 : 0);
        const rim = said ? r * 1.7 : r;
        s.says.textContent = said;
        s.bubble.setAttribute("opacity", said ? 1 : 0);
        if (s.wide || said) {
          const w = said ? s.says.getComputedTextLength() + 14 * k : 0, label = this.label(s, [x, y], rim, [Math.max(s.wide, w), (s.wide ? 16 * k : 0) + (said ? 24 * k : 0)], bodies, taken, index);
          const [left, top, wide, high] = label, below = top + high / 2 > y, middle = left + wide / 2 - x;
          s.name.setAttribute("x", middle); s.says.setAttribute("x", middle);
          s.name.setAttribute("y", (below ? top + 13 * k : top + high - 3 * k) - y);
          if (said) {
            const edge = (below ? top + high - 23 * k : top + k) - y;
            s.says.setAttribute("y", edge + 16 * k);
            for (const [key, value] of Object.entries({ x: middle - w / 2, y: edge, width: w, height: 22 * k, rx: 5 * k })) s.bubble.setAttribute(key, value);
          }
        }
        const last = Math.min(Math.floor(at + 1e-6), track.length / 4 - 1);
        const first = this.crowd && s.agent.number !== 0 ? Math.max(0, last - Math.round(TRAIL_SECS * hz)) : 0;
        let points = "";
        for (let i = first; i <= last; i++) points = track[i * 4 + 3] < 0 ? "" : points + track[i * 4] / 10 + "," + track[i * 4 + 1] / 10 + " ";
        s.trail.setAttribute("points", points + x + "," + y);
      });
      for (const d of this.doors) {
        let open = false;
        for (const [t, is] of d.times) if (t <= now + 1e-6) open = is;
        const [x1, y1, x2, y2] = d.line, part = open ? 0.14 : 0.5, dx = (x2 - x1) * part, dy = (y2 - y1) * part;
        d.node.setAttribute("d", `M${x1} ${y1}l${dx} ${dy}M${x2} ${y2}l${-dx} ${-dy}`);
        d.node.setAttribute("stroke-width", open ? 4 : 5);
      }
    }
  }

  // Runs the time: `show(seconds)` is called for every picture, `state(playing)` whenever it starts or stops.
  class Clock {
    constructor(show, state) {
      this.now = 0; this.end = 0; this.rate = 1; this.playing = false; this.show = show; this.state = state;
      let last = 0;
      const tick = (stamp) => {
        if (this.playing) {
          this.set(this.now + Math.min(stamp - last, 100) / 1000 * this.rate);
          if (this.now >= this.end) this.play(false);
        }
        last = stamp;
        requestAnimationFrame(tick);
      };
      requestAnimationFrame((stamp) => { last = stamp; tick(stamp); });
    }
    set(t) { this.now = Math.max(0, Math.min(t, this.end)); this.show(this.now); }
    play(on) { this.playing = on; this.state(on); }
    toggle() {
      if (!this.playing && this.now >= this.end - 1e-6) this.set(0);
      this.play(!this.playing);
    }
  }

  // Keys that no field wants: `act` gives what each one does, by name.
  function keys(act) {
    addEventListener("keydown", (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      const tag = e.target.tagName, typing = tag === "TEXTAREA" || tag === "SELECT" || (tag === "INPUT" && !/^(range|button|radio)$/.test(e.target.type));
      if (typing || (e.key === " " && /^(BUTTON|SUMMARY|A)$/.test(tag)) || (e.key === "Enter")) return;
      const does = act[(e.shiftKey && e.key.startsWith("Arrow") ? "Shift" : "") + e.key];
      if (does) { does(); e.preventDefault(); }
    });
    // After a click the keys belong to the player again.
    addEventListener("click", (e) => { if (e.detail > 0 && e.target.closest("button") && document.activeElement) document.activeElement.blur(); });
  }
  // The controls of a page with one clock: play, time and speed, of which 0 is "all in 10 s". `show` draws a moment, `more` are keys of
  // the page's own.
  function controls(show, more) {
    const at = (id) => document.getElementById(id);
    const clock = new Clock((now) => {
      at("time").value = now; at("clock").textContent = secs(now); at("time").setAttribute("aria-valuetext", secs(now));
      show(now);
    }, (on) => { at("play").textContent = on ? "❚❚" : "▶"; at("play").setAttribute("aria-label", on ? "pause" : "play"); });
    const go = (t) => { clock.play(false); clock.set(t); };
    const pace = () => { const speed = Number(at("speed").value); clock.rate = speed === 0 ? Math.max(clock.end / 10, 1) : speed; };
    at("play").addEventListener("click", () => clock.toggle());
    at("speed").addEventListener("change", pace);
    at("time").addEventListener("input", (e) => go(Number(e.target.value)));
    keys({ " ": () => clock.toggle(), ArrowRight: () => go(clock.now + 0.5), ArrowLeft: () => go(clock.now - 0.5), Home: () => go(0), End: () => go(clock.end), ...more });
    // A run of this many seconds is what is played from now on.
    const until = (end) => { clock.end = end; at("time").max = end; pace(); };
    return { clock, go, until };
  }
  return { SAYS, View, Clock, controls, keys, make, word, words, put, plain, secs, seconds };
})();
