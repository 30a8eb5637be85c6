"""An exported stage of USD in the hands of `usd-core`, beside the map and the table of the run.

Arguments: the stage, `map.yaml` of the location, and the table (t, id, x, y) of the run. Prints an object: validators that ran, what they
found, walls, cells whose middle is in a wall that should not be or the other way round, and how far everybody is from the table, m.
"""

import csv, json, math, sys
from pxr import Gf, Usd, UsdGeom, UsdValidation

path, yaml, table = sys.argv[1:]
stage = Usd.Stage.Open(path)
assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 1.0 and stage.GetDefaultPrim().GetName() == "World"
known = {"Xform", "PhysicsScene", "DistantLight", "Cube", "Capsule", "Cylinder", "BasisCurves"}
types = {prim.GetTypeName() for prim in stage.TraverseAll()}
assert types <= known, types - known

registry = UsdValidation.ValidationRegistry()
validators = registry.GetOrLoadAllValidators()
faults = [str(error.GetMessage()) for error in UsdValidation.ValidationContext(validators).Validate(stage)]

settings = dict(line.split(":", 1) for line in open(yaml).read().splitlines() if ":" in line)
resolution = float(settings["resolution"])
ox, oy, yaw = json.loads(settings["origin"])
raw = open(yaml.rsplit("/", 1)[0] + "/" + settings["image"].strip(), "rb").read()
head = raw.split(b"\n", 3)
width, height = map(int, head[1].split())
pixels = head[3]
in_map = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(0, 0, 1), math.degrees(yaw))) * Gf.Matrix4d().SetTranslate(Gf.Vec3d(ox, oy, 0))
map_from_world = in_map.GetInverse()

boxes = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
covered = bytearray(width * height)
walls = 0
for prim in stage.GetPrimAtPath("/World/walls").GetChildren():
    box = boxes.ComputeWorldBound(prim)
    box.Transform(map_from_world)
    reach = box.ComputeAlignedRange()
    low, high = reach.GetMin(), reach.GetMax()
    assert abs(low[2]) < 1e-3 and abs(high[2] - 2.5) < 1e-3
    edges = [value / resolution for value in (low[0], high[0], low[1], high[1])]
    assert max(abs(edge - round(edge)) for edge in edges) * resolution < 1e-3, edges
    left, right, below, above = map(round, edges)
    for row in range(height - above, height - below):
        for column in range(left, right):
            covered[row * width + column] += 1
    walls += 1
wrong = sum(1 for cell, count in zip(pixels, covered) if count != (cell == 0))

off, positions = 0.0, 0
agents = {prim.GetName(): UsdGeom.Xformable(prim) for prim in stage.GetPrimAtPath("/World/agents").GetChildren()}
for row in csv.DictReader(open(table)):
    code = Usd.TimeCode(round(float(row["t"]) * stage.GetTimeCodesPerSecond()))
    here = agents[row["id"]]
    seen = UsdGeom.Imageable(here.GetPrim()).ComputeVisibility(code) != "invisible"
    assert seen == (row["leaf"] != "absent"), (row["id"], row["t"])
    if seen:
        at = here.GetLocalTransformation(code).ExtractTranslation()
        off = max(off, math.dist((at[0], at[1]), (float(row["x"]), float(row["y"]))))
        positions += 1
print(json.dumps({"validators": len(validators), "faults": faults, "walls": walls, "wrong": wrong, "positions": positions, "off": off}))
