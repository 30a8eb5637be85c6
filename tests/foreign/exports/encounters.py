"""How many encounters of the runs a kit of HuNavSim plays again, by our reader of agents files.

    python tests/foreign/exports/encounters.py target/ci/socrates OUT

OUT is the folder of figures.py. The robot replays its run; an encounter counts where robot and person come within 2 m of each other
within 3 m of its node, and is counted for the kits where it did so in the run.
"""

import csv, json, math, pathlib, subprocess, sys

PROFILES = {"hunav-1.0": "hunav-1.0", "hunav-1.1": "hunav-1.1", "hunav-2.0": "hunav-2.0", "hunav-fork": "socrates-fork", "native": "native"}
APART_M, FROM_NODE_M = 2.0, 3.0


def tracks(path):
    """Places by agent and tenth of a second."""
    found = {}
    for row in csv.DictReader(open(path)):
        if row["leaf"] != "absent":
            found.setdefault(row["id"], {})[round(float(row["t"]) * 10)] = (float(row["x"]), float(row["y"]))
    return found


def meets(robot, person, node):
    both = robot.keys() & person.keys()
    return any(math.dist(robot[t], person[t]) <= APART_M and min(math.dist(robot[t], node), math.dist(person[t], node)) <= FROM_NODE_M for t in both)


def main():
    socrates, out = (pathlib.Path(arg).resolve() for arg in sys.argv[1:3])
    counts = {profile: [0, 0, []] for profile in ["run", *PROFILES]}
    for bundle in sorted((out / "bundles").iterdir()):
        details = bundle / "details"
        nodes = {node["id"]: node["at"] for node in json.loads((details / "location.json").read_text())["graph"]["nodes"]}
        encounters = json.loads((details / "paths.json").read_text())["encounters"]
        run = tracks(bundle / "agents.csv")
        robot = out / "robot.csv"
        rows = [f"{t / 10},0,{x},{y}" for t, (x, y) in sorted(run["robot"].items())]
        robot.write_text("t,id,x,y\n" + "\n".join(rows) + "\n")
        length = max(run["robot"]) / 10
        played = {"run": run}
        for form, profile in PROFILES.items():
            kit = out / "out" / bundle.name / (form if form != "native" else "hunav-2.0")
            agents = next((kit / "config").glob("*_agents.yaml"))
            folder = out / "played" / f"{bundle.name}-{form}"
            args = [socrates, "simulate", agents, "--map", kit / "maps/map.yaml", "--profile", profile, "--duration", f"{length:.2f}",
                    "--tracks", robot, "--out", folder]
            if (kit / "behavior_trees").is_dir():
                args += ["--trees", kit / "behavior_trees"]
            made = subprocess.run([str(arg) for arg in args], capture_output=True, text=True, stdin=subprocess.DEVNULL)
            if made.returncode:
                print(f"{bundle.name} {form}: {made.stderr.strip()[:300]}", file=sys.stderr)
                played[form] = None
                continue
            played[form] = tracks(folder / "agents.csv")
        for one in encounters:
            if one["human"] not in run or not meets(run["robot"], run[one["human"]], nodes[one["node"]]):
                # What did not happen in the run cannot be played again.
                counts["run"][0] += 1
                counts["run"][2].append(f"{bundle.name} {one['human']}")
                continue
            for form, found in played.items():
                counts[form][0] += 1
                is_met = bool(found) and one["human"] in found and meets(run["robot"], found[one["human"]], nodes[one["node"]])
                counts[form][1] += is_met
                if not is_met:
                    counts[form][2].append(f"{bundle.name} {one['human']}")
    for form, (of, met, missed) in counts.items():
        print(f"{form}: {met} of {of} ({100 * met / max(of, 1):.1f} %); missed: {', '.join(missed) or 'none'}")


if __name__ == "__main__":
    main()
