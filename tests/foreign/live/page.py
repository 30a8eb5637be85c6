"""The page of the gateway in Chromium, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT live|kept|waits|killed ADDRESS [GATEWAY_PID]

Pictures go to FOLDER. `killed` ends the process of that id with SIGKILL while the page looks at the live run.
"""

import hashlib, json, os, pathlib, signal, sys  # noqa: E401

from playwright.sync_api import sync_playwright

# Longest time to wait for anything; a guard, never a measure.
GUARD_MS = 120_000
chromium, folder, size, kind, address = sys.argv[1:6]
width, height = map(int, size.split("x"))
found = {"console": [], "asked": [], "failed_requests": [], "errors": [], "policy": [], "strangers": []}

PROBE = """() => ({ ...window.socrates, badge: document.getElementById("badge").textContent, clock: document.getElementById("clock").textContent,
  verdict: document.getElementById("verdict").textContent, caption: document.getElementById("caption").textContent, title: document.title,
  slider: Number(document.getElementById("time").value), slider_max: Number(document.getElementById("time").max),
  recording: document.getElementById("recording").hidden ? null : document.getElementById("recording").href,
  wide: document.documentElement.scrollWidth, inner: innerWidth,
  cut: [...document.querySelectorAll("button, select, h1, h2, output, label, #caption")].filter((n) => n.offsetParent && (n.getBoundingClientRect().right > innerWidth + 1 || n.getBoundingClientRect().left < -1)).map((n) => n.id || n.textContent.slice(0, 20)),
  odd: (document.body.innerText.match(/.{0,30}(undefined|NaN|null|\\[object).{0,10}/g) || []), notice: document.querySelector("#maps .notice:not([hidden])")?.textContent ?? null,
  events: document.querySelectorAll("#events li").length, clauses: document.querySelectorAll("#clauses li").length,
  map: (({ width, height }) => [width, height])(document.getElementById("maps").getBoundingClientRect()) })"""


def main(page):
    def seen():
        return page.evaluate(PROBE)

    def until(script, arg=None):
        page.wait_for_function(script, arg=arg, timeout=GUARD_MS)

    def picture(name=None):
        """Digest of what is drawn on the map; the whole page is kept as a picture where it has a name."""
        if name:
            page.screenshot(path=str(pathlib.Path(folder) / f"{kind}-{size}-{name}.png"))
        drawn = page.evaluate("""() => [...document.querySelectorAll("#maps canvas")].map((canvas) => canvas.toDataURL())""")
        assert drawn and all(len(one) > 2000 for one in drawn[:1]), "there is nothing on the map"
        return hashlib.sha256("".join(drawn).encode()).hexdigest()

    def go(t):
        """Sets the slider to a time and waits until the picture of it stands."""
        page.evaluate("""(t) => { const s = document.getElementById("time"); s.value = t; s.dispatchEvent(new Event("input")); }""", t)
        until("(t) => Math.abs(window.socrates.time_s - t) < 0.011", t)
        before = None
        for _ in range(40):  # what is fetched from the past comes a moment later
            now = picture()
            if now == before:
                return now
            before = now
            page.wait_for_timeout(150)
        return before

    page.goto(address)
    if kind == "waits":
        until("""() => document.getElementById("badge").textContent !== "" """)
        asked = len(found["asked"])
        while len(found["asked"]) < asked + 3:  # it asks again every second: that must not fill the console
            page.wait_for_timeout(50)
        found["seen"] = seen()
        picture("waits")
        return
    until("() => window.socrates && window.socrates.drawn > 20 && window.socrates.agents > 0")
    if kind == "kept":
        found["begin"] = seen()
        until("() => window.socrates.time_s > 1.5")
        found["playing"] = seen()
        picture("playing")
        page.keyboard.press("End")
        end = seen()["slider_max"]
        found["picture_end"] = go(end)
        picture("end")
        found["end"] = seen()
        found["picture_past"] = go(1.0)
        picture("past")
        found["past"] = seen()
        go(end)
        found["picture_past_again"] = go(1.0)
        return
    until("() => window.socrates.live && window.socrates.time_s > 3 && window.socrates.frames >= 20 && window.socrates.acked >= 20")
    found["live"] = seen()
    picture("live")
    if kind == "killed":
        os.kill(int(sys.argv[6]), signal.SIGKILL)
        until("() => !window.socrates.live")
        picture("gone")
        found["gone"] = seen()
        until("(n) => window.socrates.live && window.socrates.frames > n + 20", found["gone"]["frames"])
        found["back"] = seen()
        return
    found["picture_past"] = go(1.0)
    picture("past")
    found["past"] = seen()
    page.keyboard.press("l")
    until("() => window.socrates.live")
    found["again"] = seen()
    until("""() => document.getElementById("badge").textContent.includes("ended")""")
    picture("over")
    found["over"] = seen()
    until("""() => !document.getElementById("recording").hidden && !document.getElementById("verdict").textContent.includes("not yet")""")
    picture("ended")
    found["ended"] = seen()
    drawn = found["ended"]["drawn"]
    found["picture_end"] = go(found["ended"]["slider_max"])
    found["picture_past_again"] = go(1.0)
    picture("past-again")
    found["stays"] = seen()
    found["drawn_after_the_end"] = found["stays"]["drawn"] - drawn


with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
    context = browser.new_context(viewport={"width": width, "height": height}, device_scale_factor=1)
    context.add_init_script("""window.__policy = []; addEventListener("securitypolicyviolation", (e) => window.__policy.push(e.violatedDirective + " " + e.blockedURI));""")
    page = context.new_page()
    page.on("console", lambda said: said.type in ("error", "warning") and found["console"].append(said.text[:200]))
    page.on("pageerror", lambda error: found["console"].append("page: " + str(error)[:200]))
    page.on("requestfailed", lambda request: found["failed_requests"].append([request.url[-60:], str(request.failure)[:60]]))
    own = address.split("/")[2]
    page.on("request", lambda request: request.url.split("/")[2:3] != [own] and not request.url.startswith("data:") and found["strangers"].append(request.url[:80]))
    page.on("request", lambda request: kind == "waits" and request.url.endswith("/runs") and found["asked"].append("/runs"))
    failed = None
    try:
        main(page)
    except Exception as why:  # noqa: BLE001
        failed = f"{type(why).__name__}: {why}"[:600]
        try:
            page.screenshot(path=str(pathlib.Path(folder) / f"{kind}-{size}-failed.png"))
            found["last"] = page.evaluate(PROBE)
        except Exception as again:  # noqa: BLE001
            failed += f"; {again}"[:200]
    try:
        found["policy"] = page.evaluate("window.__policy")
        found["errors"] = page.evaluate("window.socrates ? window.socrates.errors : ['no window.socrates']")
    except Exception as why:  # noqa: BLE001
        found["errors"] = [str(why)[:200]]
    browser.close()
print(json.dumps({"failed": failed, **found}))
sys.exit(1 if failed else 0)
