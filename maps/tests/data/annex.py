"""Makes the location `annex`: the style of published locations, with an extra key in map.yaml and an origin off the center.

    python3 annex.py        # writes annex/map.yaml, annex/map.pgm and annex/scene_graph.json beside this file

A hall of 24 m by 16 m at 0.2 m per pixel, walled all round, with two blocks of racks: two long aisles, three short ones.
A node is at origin + (x, 16 m - y) of its pixel; so `a1`, at 2.6 m and 2.4 m from the lower left corner, is at (-0.4, -10.0).
"""

import json
import pathlib

STEP, WIDTH, HEIGHT = 0.2, 120, 80
RACKS = [(5.0, 4.6, 10.4, 11.4), (13.6, 4.6, 19.0, 11.4)]
COLUMNS, ROWS = [2.6, 5.8, 9.0, 12.0, 15.0, 18.2, 21.4], [2.4, 6.2, 9.8, 13.6]
SHORT = [0, 3, 6]  # columns with an aisle between the long ones

folder = pathlib.Path(__file__).parent / "annex"
folder.mkdir(exist_ok=True)


def free(column, row):
    x, y = (column + 0.5) * STEP, (HEIGHT - row - 0.5) * STEP
    if not (0.4 < x < 23.6 and 0.4 < y < 15.6):
        return False
    return not any(left < x < right and low < y < high for left, low, right, high in RACKS)


pixels = bytes(254 if free(column, row) else 0 for row in range(HEIGHT) for column in range(WIDTH))
(folder / "map.pgm").write_bytes(f"P5\n# made by annex.py\n{WIDTH} {HEIGHT}\n255\n".encode() + pixels)
(folder / "map.yaml").write_text(
    "image: map.pgm\nresolution: 0.2\norigin:\n  - -3.0\n  - -12.4\n  - 0.0\n"
    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\ntype: indoor\n"
)

nodes, links = [], []
name = lambda column, row: f"{'abcd'[row]}{column + 1}"
for row, y in enumerate(ROWS):
    for column, x in enumerate(COLUMNS):
        long = row in (0, 3)
        if not long and column not in SHORT:
            continue
        corner = long and column in (0, 6)
        kind = "BLIND CORNER" if corner else "INTERSECTION" if long and column == 3 else "SIMPLE NODE"
        nodes.append({"type": kind, "pos": [round(x / STEP), round((16.0 - y) / STEP)], "id": name(column, row)})
        if long and column > 0:
            links.append({"type": "AISLE", "source": name(column - 1, row), "target": name(column, row)})
        if column in SHORT and row > 0:
            links.append({"type": "PASSAGEWAY", "source": name(column, row - 1), "target": name(column, row)})
graph = {"directed": False, "multigraph": False, "graph": {}, "nodes": nodes, "links": links}
(folder / "scene_graph.json").write_text(json.dumps(graph, indent=2) + "\n")
