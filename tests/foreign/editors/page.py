"""The page of the map editor in Chromium, driven by playwright; prints one JSON line with what was seen there.

    python3 page.py CHROMIUM FOLDER WIDTHxHEIGHT ADDRESS GRAPH PLACE

Draws the nodes and edges of the file GRAPH, and the doors and the description of the JSON text PLACE, from empty with mouse and keyboard, undoes and redoes all of
it, looks at a way, and saves. Pictures go to FOLDER.
"""

import json, pathlib, sys  # noqa: E401

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(__file__).parent.parent))
from browser import play  # noqa: E402

chromium, folder, size, address, graph, place_told = sys.argv[1:7]
graph, told = json.loads(pathlib.Path(graph).read_text()), json.loads(place_told)
CUT = "button, h1, h2, textarea, input, select"
PLACE = "([x, y]) => { const box = $('stage').getBoundingClientRect(), [sx, sy] = toScreen([x, y]); return [box.left + sx, box.top + sy]; }"


def main(visit):
    page, found, until = visit.page, visit.found, visit.until

    def moment(name):
        until("() => !busy && document.body.dataset.checked === String(now.rev)")
        visit.moment(name)

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
    first = graph["nodes"][0]
    # Ten pixels at a time: what is found after the first step is not what is waited for.
    there = [first["id"], first["pos"][1] - 20]
    until("([id, y]) => !busy && document.body.dataset.checked === String(now.rev) && Math.abs(nodeOf(id).at[1] - y) < 0.01 && findings.length > 0", there)
    found["told"] = page.evaluate("[findings[0].code, document.querySelectorAll('.mark').length, document.querySelector('#findings button').textContent]")
    page.click("#findings button")
    moment("wall")
    page.focus("#stage")
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    until("() => !busy && document.body.dataset.checked === String(now.rev) && findings.length === 0")
    # The first node gets a name by which people call it, which stands on the map, and loses it again.
    page.fill("#area-name", "way in")
    page.press("#area-name", "Enter")
    until("() => !busy && areas().length === 1")
    found["names"] = page.evaluate("[areas()[0].name, document.querySelector('#layer-names text').textContent, document.querySelector('#names button').textContent]")
    moment("called")
    page.focus("#stage")
    page.keyboard.press("Control+z")
    until("() => !busy && document.body.dataset.checked === String(now.rev) && areas().length === 0")
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


play(main, chromium, folder, size, address, CUT)
