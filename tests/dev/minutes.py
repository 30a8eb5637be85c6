#!/usr/bin/env python3
"""Where the minutes of the gate went, from what its last run left in the target folder.

    tests/dev/minutes.py [TARGET]     default: $CARGO_TARGET_DIR, else `target`

Prints the steps of each ring, the build by crate (dependencies, own crates, test programs; seconds of one core), the test programs by
seconds of their tests, and the thirty slowest tests of each ring. `./gate` writes the files; tests need `cargo nextest` to be timed.
"""

import collections
import glob
import json
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

SLOWEST = 30
CRATES = 25


def table(title, rows, limit=None):
    """Prints rows of (seconds, name), largest first, with their sum."""
    rows = sorted(rows, reverse=True)
    print(f"\n{title}: {sum(seconds for seconds, _ in rows):.0f} s in {len(rows)}")
    for seconds, name in rows[:limit]:
        print(f"  {seconds:8.1f} s  {name}")


def steps(target):
    for file in sorted(target.glob("gate/steps-*.tsv")):
        rows = [line.split("\t") for line in file.read_text().splitlines()]
        table(f"steps of the ring `{file.stem[6:]}`", [(float(seconds), name) for name, seconds in rows])


def build(target):
    """Units of the largest build that `cargo --timings` wrote down: a build in which most was fresh says little."""
    reports = glob.glob(str(target / "cargo-timings/cargo-timing-*.html"))
    if not reports:
        print("\nno report of `cargo --timings`")
        return
    report = max(reports, key=os.path.getsize)
    text = pathlib.Path(report).read_text()
    units = json.loads(re.search(r"const UNIT_DATA = (\[.*?\]);\n", text, re.S).group(1))
    wall = max(unit["start"] + unit["duration"] for unit in units)
    print(f"\nbuild ({os.path.basename(report)}): {wall:.0f} s until its end, {len(units)} units")
    kinds = collections.defaultdict(lambda: collections.Counter())
    for unit in units:
        own = unit["name"].startswith("socrates")
        program = unit["target"].strip()
        is_test = "test" in program or "example" in program or "bench" in program
        kind = "test programs and examples" if is_test else "own crates" if own else "dependencies"
        kinds[kind][f"{unit['name']} {program}".strip()] += unit["duration"]
    for kind, crates in sorted(kinds.items()):
        table(kind, [(seconds, name) for name, seconds in crates.items()], CRATES)


def tests(target):
    for file in sorted(target.glob("gate/tests-*.xml")):
        ring = file.stem[6:]
        suites = xml.etree.ElementTree.parse(file).getroot()
        cases = [
            (float(case.get("time")), f"{suite.get('name')} {case.get('name')}")
            for suite in suites.iter("testsuite")
            for case in suite.iter("testcase")
        ]
        programs = collections.Counter()
        for seconds, name in cases:
            programs[name.split(" ")[0]] += seconds
        print(f"\ntests of the ring `{ring}`: {float(suites.get('time')):.0f} s until their end")
        table("test programs, seconds of their tests", [(seconds, name) for name, seconds in programs.items()], CRATES)
        table(f"tests, the {SLOWEST} slowest", cases, SLOWEST)


def main():
    target = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else os.environ.get("CARGO_TARGET_DIR", "target"))
    if not target.is_dir():
        sys.exit(f"`{target}` is no folder; run `./gate` first, or name the target folder")
    steps(target)
    build(target)
    tests(target)


if __name__ == "__main__":
    main()
