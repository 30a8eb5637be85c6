// The line to the gateway for one run: scene, events, standing and frames come in, acknowledgements go out. It mends itself.
import { frameAt } from "./wire.js";
import { NO_TOKEN, runUrl, runs, sentence } from "./words.js";

const PROTOCOL = "socrates.live.v1";
const FIRST_PAUSE_MS = 500, LONGEST_PAUSE_MS = 5000;
// A run that is not there yet is asked for this often.
const WAIT_MS = 1000;
const FULL_HZ = 20, HIDDEN_HZ = 1;

export class Line {
  /**
   * `to` has what happens with each message: `frame(frame)`, `text(message)`, `state("waiting"|"open"|"gone", detail)`, `fault(error)`.
   * `hz` is how often frames are asked for while the page can be seen.
   */
  constructor(run, to, hz = FULL_HZ) {
    this.run = run; this.to = to; this.hz = hz; this.socket = null; this.pause = FIRST_PAUSE_MS; this.timer = 0; this.closed = false; this.waited = ""; this.finished = false;
    this.due = []; this.acked = 0;
    this.seen = () => this.rate();
    document.addEventListener("visibilitychange", this.seen);
  }

  async start() {
    clearTimeout(this.timer);
    if (this.closed) return;
    try {
      // A run that was not there is looked for in the list: asking for its scene again and again would fill the console with faults.
      if (this.waited && !(await runs()).some((known) => known.run === this.run)) { this.to.state("waiting", this.waited); this.later(WAIT_MS); return; }
      const answer = await fetch(runUrl(this.run, "/scene"), { cache: "no-store" });
      if (answer.status === 404) {
        const why = await answer.json().catch(() => ({}));
        this.waited = [why.error, why.hint].filter(Boolean).map(sentence).join(". ") || "It is asked for every second";
        this.to.state("waiting", this.waited);
        this.later(WAIT_MS);
        return;
      }
      if (answer.status === 401) { this.to.state("waiting", NO_TOKEN); this.later(WAIT_MS); return; }
      if (!answer.ok) throw new Error(`scene: ${answer.status}`);
      const scene = await answer.json();
      if (this.closed) return;
      this.to.text({ op: "scene", scene });
      this.open();
    } catch (fault) {
      this.gone(fault instanceof SyntaxError ? fault : null);
    }
  }

  later(ms) {
    clearTimeout(this.timer);
    if (!this.closed) this.timer = setTimeout(() => this.start(), ms);
  }

  gone(fault) {
    if (this.closed) return;
    if (fault) this.to.fault(fault);
    this.to.state("gone", this.pause);
    this.later(this.pause);
    this.pause = Math.min(LONGEST_PAUSE_MS, this.pause * 2);
  }

  open() {
    const address = runUrl(this.run, "/ws");
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(address, PROTOCOL);
    socket.binaryType = "arraybuffer";
    this.socket = socket; this.due = [];
    socket.addEventListener("open", () => { this.pause = FIRST_PAUSE_MS; this.rate(); this.to.state("open"); });
    socket.addEventListener("message", (e) => {
      if (socket !== this.socket) return;
      if (typeof e.data === "string") this.words(e.data); else this.bytes(e.data);
    });
    socket.addEventListener("close", () => {
      if (socket !== this.socket) return;
      this.socket = null;
      // After the end nothing more comes: that the gateway hangs up then is no fault.
      if (!this.finished) this.gone(null);
    });
  }

  words(data) {
    let message;
    try { message = JSON.parse(data); } catch (fault) { this.to.fault(fault); return; }
    this.to.text(message);
  }

  bytes(data) {
    let frame;
    try { frame = frameAt(data, 0); } catch (fault) { this.to.fault(fault); return; }
    this.due.push(frame.seq);
    this.to.frame(frame);
    // A hidden page draws nothing, and without acknowledgements the gateway would take it for frozen.
    if (document.hidden) this.drawn();
  }

  /** Tells the gateway that all frames up to now are on the screen: only then it sends the next. */
  drawn() {
    if (this.due.length === 0) return;
    const due = this.due;
    this.due = [];
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return;
    for (const seq of due) {
      const message = new DataView(new ArrayBuffer(4));
      message.setUint32(0, seq, true);
      this.socket.send(message.buffer);
      this.acked++;
    }
  }

  rate() {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return;
    this.socket.send(JSON.stringify({ op: "rate", hz: document.hidden ? HIDDEN_HZ : this.hz }));
    if (document.hidden) this.drawn();
  }

  close() {
    this.closed = true;
    clearTimeout(this.timer);
    document.removeEventListener("visibilitychange", this.seen);
    if (this.socket) this.socket.close();
    this.socket = null;
  }
}
