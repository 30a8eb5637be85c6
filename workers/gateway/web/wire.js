// Frames as the gateway sends them: a header of 32 bytes, 16 bytes for every agent, perhaps a scan. All numbers are little endian.

const MAGIC = 0x4353, VERSION = 1, HEAD = 32, RECORD = 16;
/** Beams of a scan, one a degree; beam 0 looks straight ahead, the others follow counter-clockwise. */
export const BEAMS = 360;
/** Range of a beam that hit nothing. */
export const NOTHING = 65535;
const SCAN = 1;

/** Flags of a record. */
export const GESTURE = 0x0f, THERE = 0x10, SEES = 0x20;
/** Leaf of an agent that has none. */
export const NO_LEAF = 255;

/** Bytes of a frame with this many agents and a scan. */
export const frameBytes = (n) => HEAD + RECORD * n + BEAMS * 2;

/**
 * The frame that begins at this byte, as views into the buffer; `next` is the byte after it.
 * Float 4i and 4i+1 are x and y in m; word 8i+4 the heading, 8i+5 the speed in mm/s, 8i+6 the agent, 8i+7 the flags.
 */
export function frameAt(buffer, from) {
  if (buffer.byteLength < from + HEAD) throw new Error(`a frame at byte ${from} is cut off: ${buffer.byteLength} bytes`);
  const head = new DataView(buffer, from, HEAD);
  if (head.getUint16(0, true) !== MAGIC || head.getUint8(2) !== VERSION || head.getUint8(3) !== RECORD) {
    throw new Error(`no frame of version ${VERSION} at byte ${from}: another gateway? Load the page again`);
  }
  const n = head.getUint32(16, true), scanned = (head.getUint32(28, true) & SCAN) !== 0;
  const records = from + HEAD, end = records + n * RECORD, next = end + (scanned ? BEAMS * 2 : 0);
  if (buffer.byteLength < next) throw new Error(`a frame of ${n} agents at byte ${from} is cut off: ${buffer.byteLength} bytes`);
  return {
    tick: Number(head.getBigUint64(4, true)), seq: head.getUint32(12, true), n, t: head.getFloat64(20, true),
    records: new Uint8Array(buffer, records, n * RECORD),
    floats: new Float32Array(buffer, records, n * 4),
    turns: new Int16Array(buffer, records, n * 8),
    words: new Uint16Array(buffer, records, n * 8),
    scan: scanned ? new Uint16Array(buffer, end, BEAMS) : null,
    bytes: next - from, next,
  };
}

/** All frames of an answer of `/frames`. */
export function framesOf(buffer) {
  const frames = [];
  for (let from = 0; from < buffer.byteLength; from = frames[frames.length - 1].next) frames.push(frameAt(buffer, from));
  return frames;
}

/** Index of an agent in a frame, -1 if it has none; agents nearly always keep their places, so the place of before is tried first. */
export function place(frame, number, guess) {
  const { words, n } = frame;
  if (guess < n && words[8 * guess + 6] === number) return guess;
  for (let i = 0; i < n; i++) if (words[8 * i + 6] === number) return i;
  return -1;
}

const heading = (frame, i) => frame.turns[8 * i + 4] * (Math.PI / 32768);

/**
 * The agent at place `i` of frame `a`, `u` of the way (0 to 1) towards frame `b`; null if it is not there. People come and go at once:
 * nothing is in between.
 */
export function pose(a, b, u, i) {
  const w = 8 * i, flags = a.words[w + 7];
  if (!(flags & THERE)) return null;
  const number = a.words[w + 6];
  const at = { number, x: a.floats[4 * i], y: a.floats[4 * i + 1], yaw: heading(a, i), speed: a.words[w + 5] / 1000, says: flags & GESTURE, sees: (flags & SEES) !== 0, leaf: flags >> 8 };
  const j = b && u > 0 ? place(b, number, i) : -1;
  if (j < 0 || !(b.words[8 * j + 7] & THERE)) return at;
  let turn = heading(b, j) - at.yaw;
  turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
  at.x += (b.floats[4 * j] - at.x) * u;
  at.y += (b.floats[4 * j + 1] - at.y) * u;
  at.yaw += turn * u;
  return at;
}
