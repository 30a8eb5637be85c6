"""What strangers try on the gateway of a run that goes on; prints one JSON line with what each of them was answered.

    python3 attacks.py HOST:PORT RUN [GATEWAY_PID]       without a token
    python3 attacks.py HOST:PORT RUN --token TOKEN       what a gateway with a token answers with and without it

PyPI `websockets` and curl attack; after every attempt `/runs` is asked, and must be answered.
"""

import json, os, resource, socket, subprocess, sys, time  # noqa: E401
import base64
import urllib.request

from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

OURS, FOX = "socrates.live.v1", "foxglove.sdk.v1"
# Longest time to wait for anything; a guard, never a measure.
GUARD_S = 90
ADDRESS, RUN = sys.argv[1:3]
HOST, PORT = ADDRESS.rsplit(":", 1)


def get(path, headers=None):
    """Status, body of a request of curl, which sends the path as it is."""
    args = ["curl", "-s", "--path-as-is", "-m", "20", "-o", "-", "-w", "\n%{http_code}"]
    for header in headers or []:
        args += ["-H", header]
    done = subprocess.run([*args, f"http://{ADDRESS}{path}"], capture_output=True)
    body, _, status = done.stdout.rpartition(b"\n")
    return int(status or 0), body.decode("utf-8", "replace")


def ws(path=f"/run/{RUN}/ws", protocols=(OURS,), **more):
    """The status that an upgrade is answered with, and its subprotocol."""
    try:
        with connect(f"ws://{ADDRESS}{path}", subprotocols=list(protocols) or None, max_size=None, open_timeout=20, **more) as socket_:
            return 101, socket_.subprotocol
    except InvalidStatus as refused:
        return refused.response.status_code, refused.response.body.decode("utf-8", "replace")


def runs(headers=None):
    """Whether the gateway answers, and how the run stands."""
    begun = time.monotonic()
    while True:
        try:
            request = urllib.request.Request(f"http://{ADDRESS}/runs", headers=headers or {})
            with urllib.request.urlopen(request, timeout=5) as answer:
                states = {run["run"]: run["state"] for run in json.load(answer)["runs"]}
                return {"state": states.get(RUN), "after_s": round(time.monotonic() - begun, 2)}
        except OSError as why:
            if time.monotonic() - begun > GUARD_S:
                return {"state": None, "failed": str(why)}


def raw(first):
    """A connection that sent these bytes and then says nothing."""
    line = socket.create_connection((HOST, int(PORT)))
    line.sendall(first)
    return line


def hung_up(line, read=None):
    """Seconds until the other end hung up; none where it does not."""
    begun = time.monotonic()
    line.settimeout(1.0)
    while time.monotonic() - begun < GUARD_S:
        try:
            if not line.recv(1 << 20):
                return round(time.monotonic() - begun, 1)
        except TimeoutError:
            continue
        except OSError:
            return round(time.monotonic() - begun, 1)
    return None


def handshake(path, protocol):
    key = base64.b64encode(os.urandom(16)).decode()
    return (f"GET {path} HTTP/1.1\r\nHost: {ADDRESS}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Protocol: {protocol}\r\n\r\n").encode()


def closed_by(send, protocol=OURS, path=f"/run/{RUN}/ws"):
    """The code with which a socket is closed that sends this."""
    with connect(f"ws://{ADDRESS}{path}", subprotocols=[protocol], max_size=None, open_timeout=20) as line:
        try:
            send(line)
            begun = time.monotonic()
            while time.monotonic() - begun < GUARD_S:
                line.recv(timeout=GUARD_S)
        except ConnectionClosed as closed:
            return closed.rcvd.code if closed.rcvd else 1006
    return None


def memory_mib():
    pid = next((arg for arg in sys.argv[3:] if arg.isdigit()), None)
    if pid is None:
        return None
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) // 1024 for line in file if line.startswith("VmRSS"))


def crowd(count):
    """That many sockets at once: how many of them were served, and what is left when they are gone."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, count + 100)), hard))
    lines, refused = [], 0
    for _ in range(count):
        try:
            lines.append(raw(handshake("/", FOX)))
        except OSError:
            refused += 1
    served = 0
    for line in lines:
        line.settimeout(10)
        try:
            served += line.recv(12).startswith(b"HTTP/1.1 101")
        except OSError:
            pass
    for line in lines:
        line.close()
    return {"asked": count, "opened": len(lines), "served": served, "not_opened": refused}


PATHS = [
    "/run/../../../../etc/passwd", "/run/%2e%2e%2f%2e%2e%2fetc%2fpasswd/scene", "/assets/../../../etc/passwd",
    "/assets/..%2f..%2f..%2fetc%2fpasswd", "/assets/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/run/%00/scene", f"/run/{RUN}%00/scene",
    f"/run/{RUN}%2f..%2f..%2fdetails/scene", f"/run/{RUN}/../../../etc/passwd", "/run/file:%2f%2f%2fetc%2fpasswd/recording.mcap",
    "/run/..%5c..%5cetc/scene", "/" + "a" * 7000, f"/run/{'x' * 5000}/scene", f"/run/{RUN}/recording.mcap/../../../details/manifest.json",
    "/.socrates/endpoint", f"/run/{RUN}/frames?from=-1", f"/run/{RUN}/frames?from=99999999999999999999", f"/run/{RUN}/frames?every=x",
]


def strangers():
    found = {}
    half = raw(handshake(f"/run/{RUN}/ws", OURS) + b"\x82\xfe\x0f\xff" + b"\0" * 100)
    half_fox = raw(handshake("/", FOX) + b"\x81\xff\0\0\0\0\0\0\xff\xff" + b"\0" * 50)
    head = raw(b"GET /runs HTTP/1.1\r\nHost: ")
    begun = time.monotonic()

    def after(name, value):
        found[name] = {"found": value, "runs": runs()}

    after("origin_http", get("/runs", ["Origin: https://evil.example"])[0])
    after("origin_null", get("/runs", ["Origin: null"])[0])
    after("origin_page", ws(origin="https://evil.example")[0])
    after("origin_fox", ws("/", [FOX], origin="http://localhost:3000")[0])
    after("host", get("/runs", ["Host: evil.example"])[0])
    after("host_page", get(f"/run/{RUN}", [f"Host: evil.example:{PORT}"])[0])
    after("host_like_ours", get("/runs", ["Host: 127.0.0.1.evil.example"])[0])
    after("protocol_wrong", ws(protocols=["mqtt"])[0])
    after("protocol_none", ws(protocols=[])[0])
    after("protocol_fox_wrong", ws("/", ["foxglove.sdk.v2"])[0])
    after("own", ws(origin=f"http://{ADDRESS}")[0])
    after("own_fox", ws("/", [FOX])[0])
    before = memory_mib()
    after("big_page", closed_by(lambda line: line.send(b"\0" * 100_000_000)))
    after("big_fox", closed_by(lambda line: line.send("x" * 100_000_000), FOX, "/"))
    after("words", closed_by(lambda line: line.send('{"op":"pause"}')))
    after("flood", closed_by(lambda line: [line.send(b"\0\0\0\0") for _ in range(20_000)]))
    after("flood_fox", closed_by(lambda line: [line.send("{") for _ in range(20_000)], FOX, "/"))
    found["grown_mib"] = None if before is None else memory_mib() - before
    after("head_of_100_kb", get("/runs", ["X-Long: " + "x" * 100_000])[0])
    after("posts", [int(subprocess.run(["curl", "-s", "-m", "20", "-o", "/dev/null", "-w", "%{http_code}", "-X", how, f"http://{ADDRESS}/run/{RUN}/scene"],
                                       capture_output=True, text=True).stdout) for how in ("POST", "PUT", "DELETE", "PATCH")])
    tricks = {path[:60]: get(path) for path in PATHS}
    after("paths", {path: status for path, (status, _) in tricks.items()})
    found["leaks"] = [path for path, (_, body) in tricks.items() if "root:" in body or "unixsock" in body or "recording_hash" in body]
    after("crowd", crowd(2_000))
    found["grown_by_crowd_mib"] = None if before is None else memory_mib() - before
    found["slow"] = {}
    for name, line in [("head", head), ("half", half), ("half_fox", half_fox)]:
        found["slow"][name] = hung_up(line) is not None
        found["slow"][name + "_by_s"] = round(time.monotonic() - begun, 1)
    after("slow_ends", True)
    return found


def token():
    word = sys.argv[sys.argv.index("--token") + 1]
    bearer = {"Authorization": f"Bearer {word}"}
    answers = {
        "none": get("/runs")[0], "wrong": get("/runs", ["Authorization: Bearer " + "0" * len(word)])[0],
        "query": get(f"/runs?token={word}")[0], "page": get(f"/run/{RUN}")[0], "right": get("/runs", [f"Authorization: Bearer {word}"])[0],
        "floor": get(f"/run/{RUN}/floor.svg")[0], "scene": get(f"/run/{RUN}/scene")[0], "frames": get(f"/run/{RUN}/frames?from=0&to=1")[0],
        "recording": get(f"/run/{RUN}/recording.mcap")[0],
        "ws_none": ws()[0], "ws_right": ws(protocols=[OURS, f"soc.token.{word}"]), "ws_wrong": ws(protocols=[OURS, "soc.token." + "0" * len(word)])[0],
        "fox_none": ws("/", [FOX])[0], "fox_right": ws("/", [FOX, f"soc.token.{word}"]), "fox_bearer": ws("/", [FOX], additional_headers=bearer),
    }
    return {"answers": answers, "runs": runs(bearer)}


print(json.dumps(token() if "--token" in sys.argv else strangers()))
