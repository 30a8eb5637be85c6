// A viewer of others, npm's @foxglove/ws-protocol, on a live run or a kept one; prints one JSON line with what it saw.
//
//   node fox.mjs NODE_MODULES live|kept WS_ADDRESS [FRAMES]
import { createRequire } from "node:module";
import path from "node:path";

const [modules, kind, address, frames] = process.argv.slice(2);
const need = createRequire(path.join(path.resolve(modules), "here.js"));
const { FoxgloveClient } = need("@foxglove/ws-protocol");
const { WebSocket } = need("ws");
const protobuf = need("protobufjs");
const { FileDescriptorSet } = need("protobufjs/ext/descriptor");

// Longest time to wait for anything; a guard, never a measure.
const GUARD_MS = 60_000;

const socket = new WebSocket(address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
const client = new FoxgloveClient({ ws: socket });
const seen = { info: null, protocol: null, channels: [], counts: {}, statuses: [], errors: [], times: [], tf: [], states: [] };
const types = new Map(), topics = new Map(), waits = new Set();

const told = () => { for (const wait of [...waits]) if (wait.ready()) { waits.delete(wait); clearTimeout(wait.timer); wait.done(); } };
/** Waits until something holds. */
const until = (what, ready) => new Promise((done, fail) => {
  const wait = { ready, done, timer: setTimeout(() => fail(new Error(`waited in vain for ${what}: ${JSON.stringify({ ...seen, tf: seen.tf.length, times: seen.times.length, channels: seen.channels.length })}`)), GUARD_MS) };
  waits.add(wait);
  told();
});

// Opcodes that this client does not know come as errors; here is what they were.
const known = socket.onmessage;
socket.onmessage = (event) => {
  const view = event.data instanceof ArrayBuffer ? new DataView(event.data) : null;
  if (view && view.getUint8(0) === 5) {
    const length = view.getUint32(15, true), request = Buffer.from(event.data, 19, length).toString();
    seen.states.push({ status: view.getUint8(1), t: Number(view.getBigUint64(2, true)) / 1e9, speed: view.getFloat32(10, true), jumped: view.getUint8(14) === 1, request });
  } else known(event);
  told();
};

/** A channel with its schema, read as the library that wrote it reads it. */
function parsed(channel) {
  const told = { id: channel.id, topic: channel.topic, encoding: channel.encoding, schema: channel.schemaName, fields: 0 };
  if (channel.encoding === "protobuf") {
    const root = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(Buffer.from(channel.schema, "base64")));
    const type = root.lookupType(channel.schemaName);
    types.set(channel.topic, type);
    told.fields = type.fieldsArray.length;
  } else told.fields = Object.keys(JSON.parse(channel.schema).properties ?? {}).length;
  return told;
}

client.on("error", (error) => { seen.errors.push(error.message); told(); });
client.on("open", () => { seen.protocol = socket.protocol; });
client.on("serverInfo", (info) => { seen.info = info; told(); });
client.on("status", (status) => { seen.statuses.push({ level: status.level, message: status.message, id: status.id }); told(); });
client.on("time", (time) => { seen.times.push(Number(time.timestamp) / 1e9); told(); });
client.on("advertise", (channels) => {
  for (const channel of channels) {
    seen.channels.push(parsed(channel));
    topics.set(client.subscribe(channel.id), channel.topic);
  }
  told();
});
client.on("message", (message) => {
  const topic = topics.get(message.subscriptionId), type = types.get(topic);
  seen.counts[topic] = (seen.counts[topic] ?? 0) + 1;
  if (type) {
    const value = type.decode(new Uint8Array(message.data.buffer, message.data.byteOffset, message.data.byteLength));
    if (topic === "/tf") {
      const robot = value.transforms.find((one) => one.child_frame_id === "robot");
      if (robot) seen.tf.push([Number(message.timestamp) / 1e9, robot.translation.x, robot.translation.y]);
    }
  }
  told();
});

/** A request to play or to stand, perhaps from another time on. */
function control(play, speed, seek_s, request) {
  const name = Buffer.from(request), bytes = Buffer.alloc(19 + name.length);
  bytes.writeUInt8(3, 0);
  bytes.writeUInt8(play ? 0 : 1, 1);
  bytes.writeFloatLE(speed, 2);
  bytes.writeUInt8(seek_s === null ? 0 : 1, 6);
  bytes.writeBigUInt64LE(BigInt(Math.round((seek_s ?? 0) * 1e9)), 7);
  bytes.writeUInt32LE(name.length, 15);
  name.copy(bytes, 19);
  socket.send(bytes);
}
const answered = (request) => until(`the answer to ${request}`, () => seen.states.some((state) => state.request === request));
const answer = (request) => seen.states.find((state) => state.request === request);

/** Tries to publish a command of the robot. */
async function publish() {
  const before = seen.statuses.length;
  const id = client.advertise({ topic: "/cmd_vel", encoding: "json", schemaName: "geometry_msgs/Twist" });
  client.sendMessage(id, Buffer.from('{"linear":{"x":9}}'));
  await until("two refusals", () => seen.statuses.length >= before + 2);
}

async function kept() {
  const found = {};
  control(true, 4, 0, "plays");
  await answered("plays");
  await until("two simulated seconds", () => seen.tf.some(([t]) => t >= 2 && t < 10));
  control(false, 4, null, "stands");
  await answered("stands");
  found.stood_at = answer("stands").t;
  // A frame that was on its way before the answer may still come; after a publication is refused nothing may.
  await publish();
  const last = seen.tf.length;
  client.getParameters([], "later");
  await until("a third refusal", () => seen.statuses.length >= 3);
  found.frames_while_standing = seen.tf.length - last;
  found.last_before = seen.tf.at(-1);
  control(false, 1, 1, "jumps");
  await answered("jumps");
  await until("the frame of the jump", () => seen.tf.length > last);
  found.after_jump = seen.tf.at(-1);
  found.jumped = answer("jumps");
  const stood = seen.tf.length;
  control(true, 10, null, "on");
  await until("the end", () => seen.states.some((state) => state.status === 3));
  found.frames_to_the_end = seen.tf.length - stood;
  found.end = seen.states.at(-1);
  return found;
}

let found = {}, failed = null;
try {
  await until("serverInfo and channels", () => seen.info && seen.channels.length > 0);
  if (kind === "live") {
    await publish();
    await until(`${frames} frames`, () => seen.tf.length >= Number(frames));
  } else found = await kept();
} catch (why) { failed = String(why.message ?? why); }
// A goodbye that is answered; otherwise the code is 1006.
let closed = false;
client.on("close", (event) => { closed = event.wasClean && event.code !== 1006; told(); });
const gone = new Promise((done) => client.on("close", done));
client.close();
await gone;
console.log(JSON.stringify({ failed, closed, ...seen, states: seen.states.length, times: seen.times.length, time_first: seen.times[0], time_last: seen.times.at(-1), ...found }));
process.exit(failed ? 1 : 0);
