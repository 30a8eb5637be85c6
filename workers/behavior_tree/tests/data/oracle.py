#!/usr/bin/env python3
"""Trees of our own and how BehaviorTree.CPP ticks them, worked out apart from the Rust code.

The rules are those of BehaviorTree.CPP (https://github.com/BehaviorTree/BehaviorTree.CPP, MIT), version 3.8.8 by `tickRoot()` and
version 4.10.0 by `tickExactlyOnce()`, as its documentation and observed runs of it tell them. Nothing of its source is used here,
nor of ours. Control nodes and decorators without blackboards, scripts and skipped children: those are tested elsewhere.

    python3 oracle.py              # Python 3.8 or newer, no packages; writes v3/ and v4/ beside itself
    python3 oracle.py check DIR    # holds recorded runs in the same format against these rules; DIR/v3 and DIR/v4
"""
import json
import os
import random
import sys
import xml.etree.ElementTree as xml

IDLE, RUNNING, SUCCESS, FAILURE = "IDLE", "RUNNING", "SUCCESS", "FAILURE"
LEAVES = ("ScriptAction", "ScriptCond")


class Skip(Exception):
    """A tree with a node that these rules leave out."""


class Node:
    def __init__(self, element, run):
        self.kind, self.name, self.ports, self.run = element.tag, element.get("name"), element.attrib, run
        self.status, self.index, self.count = IDLE, 0, 0
        self.done = {}
        if set(self.ports) - {"name", *PORTS.get(self.kind, ())}:
            raise Skip(f"{self.kind} with {sorted(self.ports)}")
        run.nodes.append(self)
        self.children = [Node(child, run) for child in element]
        if self.kind not in LEAVES and self.kind not in KINDS:
            raise Skip(self.kind)

    def number(self, port):
        return int(self.ports[port])

    def tick(self):
        """The outcome; the status is set to it."""
        if self.kind in LEAVES:
            self.status = self.run.outcomes.get(self.name, SUCCESS)
            self.run.event("TICK", self.name, self.status)
            return self.status
        self.status = RUNNING
        self.status = KINDS[self.kind](self)
        if self.kind in DECORATORS and self.children[0].status in (SUCCESS, FAILURE):
            self.children[0].status = IDLE
        return self.status

    def reset(self):
        """Halts what runs and puts it to rest. What does not run keeps its children and counters."""
        if self.status == RUNNING:
            self.halt()
        self.status = IDLE

    def reset_children(self, first=0):
        for child in self.children[first:]:
            child.reset()

    def halt(self):
        if self.kind in LEAVES:
            self.run.event("HALT", self.name, "")
            return
        self.reset_children()
        self.count = 0
        self.done = {}
        if self.kind != "SequenceWithMemory":
            self.index = 0


def in_order(stops, goes_on):
    def tick(node):
        while node.index < len(node.children):
            told = node.children[node.index].tick()
            if told == RUNNING:
                return RUNNING
            if told == stops:
                node.reset_children()
                node.index = 0
                return stops
            node.index += 1
        node.reset_children()
        node.index = 0
        return goes_on
    return tick


def with_memory(node):
    while node.index < len(node.children):
        child = node.children[node.index]
        rested = child.status == IDLE
        told = child.tick()
        if told == RUNNING:
            return RUNNING
        if told == FAILURE:
            node.reset_children(node.index)
            return FAILURE
        node.index += 1
        if node.run.version == 4 and rested and node.index < len(node.children):
            return RUNNING
    node.reset_children()
    node.index = 0
    return SUCCESS


def reactive(stops, goes_on):
    def tick(node):
        for child in node.children:
            told = child.tick()
            if told == RUNNING:
                for other in node.children:
                    if other is not child:
                        other.reset()
                return RUNNING
            if told == stops:
                node.reset_children()
                return stops
        node.reset_children()
        return goes_on
    return tick


def parallel(node):
    kids = len(node.children)
    names = ("success_threshold", "failure_threshold") if node.run.version == 3 else ("success_count", "failure_count")
    needs, fails = (wanted if wanted >= 0 else kids + wanted + 1 for wanted in map(node.number, names))
    for place, child in enumerate(node.children):
        if place not in node.done:
            told = child.tick()
            if told != RUNNING:
                node.done[place] = told
        # Version 3 counts the children up to here, version 4 all that have finished so far.
        seen = [told for at, told in node.done.items() if node.run.version == 4 or at <= place]
        good, bad = seen.count(SUCCESS), seen.count(FAILURE)
        end = SUCCESS if good >= needs else FAILURE if bad >= fails or kids - bad < needs else None
        if end:
            node.done = {}
            node.reset_children()
            return end
    return RUNNING


def if_then_else(node):
    if node.index == 0:
        told = node.children[0].tick()
        if told == RUNNING:
            return RUNNING
        if told == FAILURE and len(node.children) == 2:
            return FAILURE
        node.index = 1 if told == SUCCESS else 2
    told = node.children[node.index].tick()
    if told == RUNNING:
        return RUNNING
    node.reset_children()
    node.index = 0
    return told


def while_do_else(node):
    told = node.children[0].tick()
    if told == RUNNING:
        return RUNNING
    chosen, other = (1, 2) if told == SUCCESS else (2, 1)
    if other < len(node.children):
        node.children[other].reset()
    if chosen >= len(node.children):
        node.reset_children()
        return FAILURE
    told = node.children[chosen].tick()
    if told == RUNNING:
        return RUNNING
    node.reset_children()
    return told


def decorated(answers):
    def tick(node):
        told = node.children[0].tick()
        if told == RUNNING:
            return RUNNING
        node.children[0].reset()
        return answers[told]
    return tick


def again(counts, ends, port):
    """Ticks the child again as long as it gives `counts`, up to a number of times."""
    def tick(node):
        child, most = node.children[0], node.number(port)
        while most < 0 or node.count < most:
            rested = child.status == IDLE
            told = child.tick()
            if told == RUNNING:
                return RUNNING
            child.reset()
            if told == ends:
                node.count = 0
                return ends
            node.count += 1
            if node.run.version == 4 and rested and (most < 0 or node.count < most):
                return RUNNING
        node.count = 0
        return counts
    return tick


def keep_running(node):
    told = node.children[0].tick()
    if told == RUNNING:
        return RUNNING
    node.children[0].reset()
    return RUNNING if told == SUCCESS else FAILURE


KINDS = {
    "Sequence": in_order(FAILURE, SUCCESS), "Fallback": in_order(SUCCESS, FAILURE),
    "SequenceStar": with_memory, "SequenceWithMemory": with_memory,
    "ReactiveSequence": reactive(FAILURE, SUCCESS), "ReactiveFallback": reactive(SUCCESS, FAILURE),
    "Parallel": parallel, "IfThenElse": if_then_else, "WhileDoElse": while_do_else,
    "Inverter": decorated({SUCCESS: FAILURE, FAILURE: SUCCESS}),
    "ForceSuccess": decorated({SUCCESS: SUCCESS, FAILURE: SUCCESS}),
    "ForceFailure": decorated({SUCCESS: FAILURE, FAILURE: FAILURE}),
    "Repeat": again(SUCCESS, FAILURE, "num_cycles"), "RetryUntilSuccessful": again(FAILURE, SUCCESS, "num_attempts"),
    "KeepRunningUntilFailure": keep_running,
}
DECORATORS = ("Inverter", "ForceSuccess", "ForceFailure", "Repeat", "RetryUntilSuccessful", "KeepRunningUntilFailure")
PORTS = {
    "Parallel": ("success_threshold", "failure_threshold", "success_count", "failure_count"),
    "Repeat": ("num_cycles",), "RetryUntilSuccessful": ("num_attempts",),
}


class Run:
    """One tree through one script."""

    def __init__(self, text, script, version):
        root = xml.fromstring(text)
        trees = root.findall("BehaviorTree")
        if len(trees) != 1:
            raise Skip("more than one tree")
        self.version, self.nodes, self.outcomes, self.now = version, [], {}, 0
        self.trace, self.events = ["tick,name,status"], ["tick,event,name,status"]
        tree = Node(trees[0][0], self)
        for self.now, ticked in enumerate(script["ticks"]):
            self.outcomes.update(ticked)
            told = tree.tick()
            if told != RUNNING:
                tree.status = IDLE
            self.event("RETURN", tree.name, told)
            self.trace += [f"{self.now},{node.name},{node.status}" for node in self.nodes]

    def event(self, what, name, status):
        self.events.append(f"{self.now},{what},{name},{status}")

    def tables(self):
        return "\n".join(self.trace) + "\n", "\n".join(self.events) + "\n"


def grown(draw, version):
    """A random tree as XML, with the names of its leaves."""
    leaves, number = {}, [0]
    control = ["Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "Parallel", "IfThenElse", "WhileDoElse"]
    control += ["SequenceStar" if version == 3 else "SequenceWithMemory"]

    def named(kind, children="", **ports):
        number[0] += 1
        ports = "".join(f' {port}="{value}"' for port, value in ports.items())
        return f'<{kind} name="{kind[:3].lower()}{number[0]}"{ports}>{children}</{kind}>'

    def leaf(kinds=LEAVES):
        kind = draw.choice(kinds)
        name = f"{'a' if kind == 'ScriptAction' else 'c'}{len(leaves) + 1}"
        leaves[name] = kind
        return f'<{kind} name="{name}"/>'

    def node(depth):
        if depth == 0 or draw.random() < 0.25:
            return leaf()
        if draw.random() < 0.3:
            kind = draw.choice(DECORATORS)
            ports = {PORTS[kind][0]: draw.choice([2, 3])} if kind in PORTS else {}
            return named(kind, node(depth - 1), **ports)
        kind = draw.choice(control)
        if kind in ("IfThenElse", "WhileDoElse"):
            branches = draw.choice([2, 3]) if kind == "IfThenElse" or version == 4 else 3
            return named(kind, leaf(("ScriptCond",)) + "".join(node(depth - 1) for _ in range(branches)[1:]))
        kids = draw.choice([2, 3, 3])
        ports = {}
        if kind == "Parallel":
            names = PORTS["Parallel"][:2] if version == 3 else PORTS["Parallel"][2:]
            ports = {names[0]: draw.choice([1, 2, -1]), names[1]: draw.choice([1, 2])}
        return named(kind, "".join(node(depth - 1) for _ in range(kids)), **ports)

    tree = named(draw.choice(control[:4]), node(3) + node(2))
    mark = "" if version == 3 else ' BTCPP_format="4"'
    return f'<root{mark} main_tree_to_execute="Main"><BehaviorTree ID="Main">{tree}</BehaviorTree></root>\n', leaves


def scripted(draw, leaves, ticks=24):
    """For every tick, what changes of the outcomes of the leaves."""
    told = []
    for _ in range(ticks):
        some = [name for name in leaves if draw.random() < 0.35]
        told.append({
            name: draw.choice([SUCCESS, FAILURE] if leaves[name] == "ScriptCond" else [SUCCESS, FAILURE, RUNNING, RUNNING])
            for name in some
        })
    return {"ticks": told}


def write(here):
    for version in (3, 4):
        folder = os.path.join(here, f"v{version}")
        os.makedirs(folder, exist_ok=True)
        draw, number = random.Random(f"trees of version {version}"), 0
        while number < 12:
            text, leaves = grown(draw, version)
            if not 6 <= len(leaves) <= 14:
                continue
            script = scripted(draw, leaves)
            trace, events = Run(text, script, version).tables()
            number += 1
            lines = ",\n".join(json.dumps(tick) for tick in script["ticks"])
            for ending, content in [
                ("xml", text), ("script.json", '{"ticks":[\n' + lines + "\n]}\n"), ("trace.csv", trace), ("events.csv", events),
            ]:
                with open(os.path.join(folder, f"tree_{number:02}.{ending}"), "w") as file:
                    file.write(content)


def check(folder):
    for version in (3, 4):
        good, bad, left = 0, [], 0
        base = os.path.join(folder, f"v{version}")
        for name in sorted(name[:-4] for name in os.listdir(base) if name.endswith(".xml")):
            def read(ending):
                with open(os.path.join(base, f"{name}.{ending}")) as file:
                    return file.read()
            try:
                found = Run(read("xml"), json.loads(read("script.json")), version).tables()
            except Skip:
                left += 1
                continue
            if found == (read("trace.csv"), read("events.csv")):
                good += 1
            else:
                bad.append(name)
        print(f"version {version}: {good} cases equal, {len(bad)} different {bad}, {left} left out")


if __name__ == "__main__":
    if sys.argv[1:2] == ["check"]:
        check(sys.argv[2])
    else:
        write(os.path.dirname(os.path.abspath(__file__)))
