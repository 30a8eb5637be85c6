"""Every format over the shipped requests and the canonical cards, each in the hands of what others wrote: a table of what was accepted.

    python tests/foreign/exports/figures.py target/ci/socrates OUT [--cards] [--parquet PROGRAM] [--sdf-reader PROGRAM]

Run it with a Python that has jupedsim-scenarios, pedpy, trajnetplusplustools, rosbags, mcap-ros2-support, usd-core and pyarrow. Bundles
that lie in OUT already are taken as they are. `--parquet` is a program that was built with this feature, `--sdf-reader` a reader of worlds.
"""

import argparse, collections, json, pathlib, subprocess, sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
# Formats that a program beside this one reads, and the largest distance from the run, m.
TRACKS = {"trajnet": 0.0072, "eth-ucy": 0.0001, "pedpy": 0.0001, "jupedsim-2": 0.0001}


def run(*args, at=None):
    return subprocess.run([str(arg) for arg in args], cwd=at, stdin=subprocess.DEVNULL, capture_output=True, text=True)


def bundles(options):
    """The bundles, made where they are not there; each with its name."""
    requests = {}
    for path in sorted(ROOT.glob("maps/*/scenarios/*.toml")):
        requests[f"{path.parents[1].name}-{path.stem}"] = path.read_text()
    if options.cards:
        for card in json.loads(run(options.socrates, "--format", "json", "scenarios", "list").stdout)["scenarios"]:
            if card["letter"] and card["locations"]:
                place = card["locations"][0]
                requests[f"card-{card['letter']}"] = (
                    f'location = "{place}"\nsocial_context = ""\ntask = "Deliver mail"\n[expect]\npattern = "{card["id"]}"\n'
                )
    for name, text in requests.items():
        bundle = options.out / "bundles" / name
        if not bundle.is_dir():
            request = options.out / f"{name}.toml"
            request.write_text(text)
            made = run(options.socrates, "run", request, "--out", bundle)
            if made.returncode not in (0, 3):
                print(f"no bundle of {name}: {made.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
                continue
        yield name, bundle


def read(script, *args, at=None):
    """What a program beside this one says, or its last line of complaint."""
    out = run(sys.executable, HERE / script, *args, at=at)
    return (json.loads(out.stdout), None) if out.returncode == 0 else (None, out.stderr.strip().splitlines()[-1])


class Table:
    def __init__(self):
        self.rows = collections.defaultdict(lambda: {"accepted": 0, "of": 0, "off_m": 0.0, "why": []})

    def add(self, form, name, ok, off_m=0.0, why=None):
        row = self.rows[form]
        row["of"] += 1
        row["accepted"] += bool(ok)
        row["off_m"] = max(row["off_m"], off_m)
        if not ok:
            row["why"].append(f"{name}: {why}")


def check(options, name, bundle, out, table):
    csv = bundle / "agents.csv"
    found, why = read("tracks.py", out, csv)
    for form, most_m in TRACKS.items():
        off_m = found[form]["off"] if found else 0.0
        table.add(form, name, found and off_m <= most_m, off_m, why or f"off by {off_m} m")
    found, why = read("bags.py", out / "rosbag2-5/bag", csv)
    table.add("rosbag2-5", name, found and found["off"] <= 1e-4 and found["messages"] == found["others"], found["off"] if found else 0.0, why or found)
    (stage,) = (out / "usda-1.0").glob("*.usda")
    found, why = read("stages.py", stage, out / "sdf-1.6/map/map.yaml", csv)
    table.add("usda-1.0", name, found and not found["faults"] and not found["wrong"] and found["off"] <= 0.0011, found["off"] if found else 0.0, why or found)
    if options.parquet:
        made = run(options.parquet, "export", bundle, "--to", "parquet", "--out", out / "parquet")
        found, why = read("tables.py", out / "parquet", csv) if made.returncode == 0 else (None, made.stderr)
        table.add("parquet", name, found and found["off"] <= 1e-4, found["off"] if found else 0.0, why or found)
    if options.sdf_reader:
        for form in ["sdf-1.6", "hunav-1.0", "hunav-1.1", "hunav-2.0", "hunav-fork"]:
            (world,) = (out / form).rglob("*.world")
            said = run(options.sdf_reader, world)
            table.add(f"{form} (world)", name, said.stdout.startswith("world "), why=said.stdout + said.stderr)
    said = run(sys.executable, "run.py", at=out / "jupedsim-scenarios-0.7")
    bad = [person for person in json.loads(said.stdout)["tracks"] if not person["ok"]] if said.stdout else said.stderr[-300:]
    table.add("jupedsim-scenarios-0.7", name, said.returncode == 0, why=bad)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("socrates", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("out", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--cards", action="store_true", help="the 25 canonical cards as well")
    parser.add_argument("--parquet", type=pathlib.Path)
    parser.add_argument("--sdf-reader", type=pathlib.Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    formats = [row["name"] for row in json.loads(run(options.socrates, "--format", "json", "export", "--formats").stdout)]
    table, written = Table(), collections.Counter()
    for name, bundle in bundles(options):
        out = options.out / "out" / name
        for form in formats:
            made = run(options.socrates, "export", bundle, "--to", form, "--out", out / form)
            written[form] += made.returncode == 0
            if made.returncode:
                print(f"{name} as {form}: {made.stderr.strip()}", file=sys.stderr)
        check(options, name, bundle, out, table)
        print(f"{name} read", file=sys.stderr)
    print("| format | written | accepted | largest distance, mm |\n|---|---|---|---|")
    for form in formats:
        row = table.rows.pop(form, None)
        told = f"{row['accepted']} of {row['of']} | {row['off_m'] * 1000:.2f}" if row else "no reader | –"
        print(f"| `{form}` | {written[form]} | {told} |")
        for why in row["why"] if row else []:
            print(f"{form}: {why}", file=sys.stderr)
    for form, row in table.rows.items():
        print(f"| {form} | {row['of']} | {row['accepted']} of {row['of']} | {row['off_m'] * 1000:.2f} |")
        for why in row["why"]:
            print(f"{form}: {why}", file=sys.stderr)


main()
