"""Exported tables of Parquet in the hands of `pyarrow`, beside the table of the run.

Arguments: folder of the tables, and the table (t, id, x, y) of the run. Prints an object: how many positions were compared, and the
largest distance, m.
"""

import csv, glob, json, math, sys
import pyarrow.parquet

folder, table = sys.argv[1:]
(tracks,), (agents,) = glob.glob(f"{folder}/*_tracks.parquet"), glob.glob(f"{folder}/*_agents.parquet")
names = {row["agent"]: row["name"] for row in pyarrow.parquet.read_table(agents).to_pylist()}
rows = pyarrow.parquet.read_table(tracks)
assert [str(field.type) for field in rows.schema] == ["int64", "double", "int64"] + ["double"] * 6 + ["string"] * 2, rows.schema
found = {}
for row in rows.to_pylist():
    assert abs(row["t_s"] - row["tick"] * 0.01) < 1e-9
    found[(row["tick"], names[row["agent"]])] = (row["x_m"], row["y_m"])
run = {}
for row in csv.DictReader(open(table)):
    if row["leaf"] != "absent":
        run[(round(float(row["t"]) * 100), row["id"])] = (float(row["x"]), float(row["y"]))
seen = {key: at for key, at in found.items() if key[0] % 10 == 0}
assert set(seen) == set(run), sorted(set(seen) ^ set(run))[:5]
print(json.dumps({"positions": len(seen), "off": max(math.dist(at, run[key]) for key, at in seen.items())}))
