// A crowd as points of the graphics card: one draw call, from the 16-byte records as they came. The card mixes two frames.
import { THERE, SEES, GESTURE } from "./wire.js";
import { humans } from "./words.js";

// Buffers of the last frames stay on the card: at most two of them are drawn, the others serve small steps back.
const BUFFERS = 4;

const VERTEX = `#version 300 es
layout(location=0) in vec2 at0; layout(location=1) in float turn0; layout(location=2) in uvec2 who0;
layout(location=3) in vec2 at1; layout(location=4) in float turn1; layout(location=5) in uvec2 who1;
uniform mat3x2 place; uniform float turned; uniform vec2 size; uniform float mixed, body, zoom; uniform vec3 colors[8];
out vec3 tint; out vec2 heading; out float rim; flat out uint flags;
void main() {
  flags = who0.y;
  float u = (who1.y & ${THERE}u) != 0u ? mixed : 0.0;
  vec2 p = place * vec3(mix(at0, at1, u), 1.0);
  bool there = (flags & ${THERE}u) != 0u && who0.x != 0u;
  gl_Position = there ? vec4(p / size * 2.0 - 1.0, 0.0, 1.0) * vec4(1.0, -1.0, 1.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  bool marked = (flags & ${GESTURE}u) != 0u;
  rim = marked ? 1.7 : 1.0;
  gl_PointSize = max(2.0, body * rim * zoom);
  tint = colors[(who0.x + 7u) % 8u];
  float d = turn1 - turn0;
  float a = (turn0 + (d - 2.0 * floor(d / 2.0 + 0.5)) * u) * 3.14159265 - turned;
  heading = vec2(cos(a), -sin(a));
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 tint; in vec2 heading; in float rim; flat in uint flags;
uniform float body;
out vec4 color;
void main() {
  vec2 p = (gl_PointCoord * 2.0 - 1.0) * rim;
  float r = length(p), soft = 2.0 / max(body, 2.0);
  if (r > rim) discard;
  vec3 c = tint;
  // A heading mark needs some pixels; smaller bodies stay plain.
  if (body > 9.0) {
    float along = dot(p, heading), across = abs(dot(p, vec2(-heading.y, heading.x)));
    if (along > 0.2 && along < 0.85 && across < (0.85 - along) * 0.62) c = vec3(1.0);
    if (r > 1.0 - 1.5 * soft && r <= 1.0) c = vec3(1.0);
  }
  if ((flags & ${SEES}u) != 0u && r > 0.72 && r <= 1.0) c = vec3(0.337, 0.706, 0.914);
  if (r > 1.0) { if (r < rim - 2.5 * soft) discard; c = vec3(0.902, 0.624, 0.0); }
  color = vec4(c, 1.0) * (1.0 - smoothstep(rim - soft, rim, r) * 0.6);
}`;

function shader(gl, kind, text) {
  const s = gl.createShader(kind);
  gl.shaderSource(s, text);
  gl.compileShader(s);
  if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error("the graphics card refuses a program: " + gl.getShaderInfoLog(s));
  return s;
}

export class Points {
  /** Answers null where the browser has no WebGL 2: the canvas then draws dots itself. */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, premultipliedAlpha: true, powerPreference: "high-performance" });
    return gl ? new Points(canvas, gl) : null;
  }

  constructor(canvas, gl) {
    this.canvas = canvas; this.gl = gl;
    canvas.addEventListener("webglcontextlost", (e) => { e.preventDefault(); this.lost = true; });
    canvas.addEventListener("webglcontextrestored", () => { this.lost = false; this.prepare(); });
    this.prepare();
  }

  prepare() {
    const gl = this.gl, program = gl.createProgram();
    gl.attachShader(program, shader(gl, gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, shader(gl, gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("the graphics card refuses a program: " + gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.at = Object.fromEntries(["place", "turned", "size", "mixed", "body", "zoom", "colors"].map((name) => [name, gl.getUniformLocation(program, name)]));
    gl.uniform3fv(this.at.colors, humans());
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (let i = 0; i < 6; i++) gl.enableVertexAttribArray(i);
    this.held = [];
    this.pair = [null, null, false];
  }

  // The buffer of a frame, sent to the card once.
  buffer(frame) {
    const gl = this.gl, i = this.held.findIndex((h) => h.frame === frame);
    if (i >= 0) { const [found] = this.held.splice(i, 1); this.held.push(found); return found.buffer; }
    const spare = this.held.length >= BUFFERS ? this.held.shift() : { buffer: gl.createBuffer() };
    spare.frame = frame;
    gl.bindBuffer(gl.ARRAY_BUFFER, spare.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, frame.records, gl.DYNAMIC_DRAW);
    this.held.push(spare);
    return spare.buffer;
  }

  // Two frames can be mixed by the card where the same agents stand at the same places.
  alike(a, b) {
    if (this.pair[0] === a && this.pair[1] === b) return this.pair[2];
    let same = a.n === b.n;
    for (let i = 6; same && i < a.words.length; i += 8) same = a.words[i] === b.words[i];
    this.pair = [a, b, same];
    return same;
  }

  point(first, buffer) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.vertexAttribPointer(first, 2, gl.FLOAT, false, 16, 0);
    gl.vertexAttribPointer(first + 1, 1, gl.SHORT, true, 16, 8);
    gl.vertexAttribIPointer(first + 2, 2, gl.UNSIGNED_SHORT, 16, 12);
  }

  clear() {
    if (this.lost) return;
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT);
  }

  /** Draws everybody but the robot. `body_px` is the diameter of a person on the map, `ratio` px of the card per px of the page. */
  draw(moment, camera, body_px, ratio) {
    if (this.lost) return;
    const gl = this.gl, w = Math.round(camera.w * ratio), h = Math.round(camera.h * ratio);
    if (this.canvas.width !== w || this.canvas.height !== h) { this.canvas.width = w; this.canvas.height = h; }
    gl.viewport(0, 0, w, h);
    this.clear();
    const { a, b } = moment, mixed = b && this.alike(a, b);
    const first = this.buffer(a), second = mixed ? this.buffer(b) : first;
    this.point(0, first);
    this.point(3, second);
    gl.uniformMatrix3x2fv(this.at.place, false, camera.matrix());
    gl.uniform1f(this.at.turned, -camera.turn(0));
    gl.uniform2f(this.at.size, camera.w, camera.h);
    gl.uniform1f(this.at.mixed, mixed ? moment.u : 0);
    gl.uniform1f(this.at.body, body_px * ratio);
    gl.uniform1f(this.at.zoom, 1);
    gl.drawArrays(gl.POINTS, 0, a.n);
  }
}
