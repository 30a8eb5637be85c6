"""The page of the map editor in Chromium, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS GRAPH PLACE

Draws the nodes and edges of the file GRAPH, and the doors and the description of the JSON text PLACE, from empty with mouse and keyboard, undoes and redoes all of
it, looks at a way, and saves. Pictures go to FOLDER.
"""

import json, pathlib, sys  # noqa: E401

from playwright.sync_api import sync_playwright

# Longest time to wait for anything; a guard, never a measure.
GUARD_MS = 120_000
chromium, folder, size, address, graph, place_told = sys.argv[1:7]
width, height = map(int, size.split("x"))
graph, told = json.loads(pathlib.Path(graph).read_text()), json.loads(place_told)
found = {"console": [], "policy": [], "strangers": []}

PROBE = """() => ({ wide: document.documentElement.scrollWidth, inner: innerWidth, tall: document.documentElement.scrollHeight, high: innerHeight,
  cut: [...document.querySelectorAll("button, h1, h2, textarea, input, select")].filter((n) => n.offsetParent && (n.getBoundingClientRect().right > innerWidth + 1 || n.getBoundingClientRect().left < -1)).map((n) => n.id || n.textContent.slice(0, 20)),
  odd: (document.body.innerText.match(/.{0,30}(undefined|NaN|\\[object).{0,10}/g) || []) })"""
PLACE = "([x, y]) => { const box = $('stage').getBoundingClientRect(), [sx, sy] = toScreen([x, y]); return [box.left + sx, box.top + sy]; }"


def main(page):
    def until(script, arg=None):
        page.wait_for_function(script, arg=arg, timeout=GUARD_MS)

    def moment(name):
        until("() => !busy && document.body.dataset.checked === String(now.rev)")
        page.screenshot(path=str(pathlib.Path(folder) / f"{size}-{name}.png"))
        found[name] = page.evaluate(PROBE)

    def place(spot):
        return page.evaluate(PLACE, spot)

    def fill(field, text):
        page.fill(f"#{field}", text)
        page.dispatch_event(f"#{field}", "change")

    def drag(start, end):
        page.mouse.move(*place(start))
        page.mouse.down()
        page.mouse.move(*place([(start[0] + end[0]) / 2, (start[1] + end[1]) / 2]))
        page.mouse.move(*place(end))
        page.mouse.up()

    page.goto(address)
    until("() => now !== null && tiles.size > 0 && [...tiles.values()].every(Boolean)")
    moment("empty")
    page.keyboard.press("n")
    for count, node in enumerate(graph["nodes"]):
        fill("kind", node["type"])
        page.keyboard.down("Shift")
        page.mouse.click(*place(node["pos"]))
        page.keyboard.up("Shift")
        until("(count) => !busy && now.sketch.nodes.length === count", count + 1)
        page.fill("#node-id", node["id"])
        page.press("#node-id", "Enter")
        until("(id) => !busy && nodeOf(id) !== undefined", node["id"])
    moment("nodes")
    places = {node["id"]: node["pos"] for node in graph["nodes"]}
    page.focus("#stage")
    page.keyboard.press("e")
    for count, edge in enumerate(graph["links"]):
        fill("edge-kind", edge["type"])
        drag(places[edge["source"]], places[edge["target"]])
        until("(count) => !busy && now.sketch.edges.length === count", count + 1)
    page.focus("#stage")
    page.keyboard.press("d")
    for count, door in enumerate(told["doors"]):
        # The first is drawn from wall to wall, the others are found where they are pointed at.
        if count == 0:
            drag(door["from"], door["to"])
        else:
            page.mouse.click(*place([(door["from"][0] + door["to"][0]) / 2, door["from"][1]]))
        until("(count) => !busy && now.sketch.doors.length === count", count + 1)
        page.fill("#door-id", door["id"])
        page.press("#door-id", "Enter")
        until("(id) => !busy && now.sketch.doors.some((door) => door.id === id)", door["id"])
    page.fill("#description", told["description"])
    page.focus("#stage")
    until("(text) => !busy && now.sketch.description === text", told["description"])
    moment("drawn")
    found["findings"] = page.evaluate("findings.map((one) => one.text)")
    whole, steps = page.evaluate("[JSON.stringify(now.sketch), now.undo]")
    for _ in range(steps):
        page.keyboard.press("Control+z")
    until("() => !busy && now.undo === 0")
    found["undone"] = page.evaluate("[now.sketch.nodes.length, now.sketch.edges.length, now.sketch.doors.length]")
    for _ in range(steps):
        page.keyboard.press("Control+Shift+z")
    until("() => !busy && now.redo === 0")
    found["redone"] = page.evaluate("JSON.stringify(now.sketch)") == whole
    found["steps"] = steps
    # A node into a wall, by keys alone: a finding beside it, and back again.
    page.keyboard.press("v")
    page.keyboard.press("Escape")
    page.keyboard.press(".")
    for _ in range(2):
        page.keyboard.press("Shift+ArrowUp")
    until("() => !busy && document.body.dataset.checked === String(now.rev) && findings.length > 0")
    found["told"] = page.evaluate("[findings[0].code, document.querySelectorAll('.mark').length, document.querySelector('#findings button').textContent]")
    page.click("#findings button")
    moment("wall")
    page.focus("#stage")
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    until("() => !busy && document.body.dataset.checked === String(now.rev) && findings.length === 0")
    page.keyboard.press("Escape")
    page.keyboard.press("f")
    page.keyboard.press("w")
    page.mouse.click(*place(graph["nodes"][0]["pos"]))
    page.mouse.click(*place(graph["nodes"][-1]["pos"]))
    until("() => walking !== null && !$('way').hidden")
    found["walked"] = page.evaluate("[way.way.nodes.length, way.walk.arrives]")
    moment("way")
    page.keyboard.press("Control+s")
    until("() => !busy && !now.dirty")
    found["stand"] = page.evaluate("$('stand').textContent")
    page.click("#propose")
    until("() => proposal !== null")
    page.keyboard.press("?")
    moment("proposed")
    page.keyboard.press("?")
    moment("saved")


with sync_playwright() as playwright:
    browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
    context = browser.new_context(viewport={"width": width, "height": height}, device_scale_factor=1)
    context.add_init_script("""window.__policy = []; addEventListener("securitypolicyviolation", (e) => window.__policy.push(e.violatedDirective + " " + e.blockedURI));""")
    page = context.new_page()
    page.set_default_timeout(GUARD_MS)
    page.on("dialog", lambda dialog: dialog.accept())
    page.on("console", lambda said: said.type in ("error", "warning") and found["console"].append(said.text[:200]))
    page.on("pageerror", lambda error: found["console"].append("page: " + str(error)[:200]))
    own = address.split("/")[2]
    page.on("request", lambda request: request.url.split("/")[2:3] != [own] and not request.url.startswith("data:") and found["strangers"].append(request.url[:80]))
    failed = None
    try:
        main(page)
        found["policy"] = page.evaluate("window.__policy")
    except Exception as why:  # noqa: BLE001
        failed = f"{type(why).__name__}: {why}"[:600]
        page.screenshot(path=str(pathlib.Path(folder) / f"{size}-failed.png"))
    browser.close()
print(json.dumps({"failed": failed, **found}))
sys.exit(1 if failed else 0)
