"""Says in one line which calls of a recording by strace the filter of a unit would refuse: syscalls.py UNIT RECORDING"""

import json
import re
import subprocess
import sys


def calls(group):
    """The names of a group of systemd, with those of the groups in it."""
    said = subprocess.run(["systemd-analyze", "syscall-filter", group], capture_output=True, text=True, check=True).stdout
    names = set()
    for line in (line.strip() for line in said.splitlines()[1:]):
        if line.startswith("@"):
            names |= calls(line)
        elif line and not line.startswith("#"):
            names.add(line)
    return names


allowed, refused = calls("@default"), set()
for line in open(sys.argv[1], encoding="utf-8"):
    if line.startswith("SystemCallFilter="):
        value = line.split("=", 1)[1].strip()
        for group in value.lstrip("~").split():
            (refused if value.startswith("~") else allowed).update(calls(group))
# `1234  openat(…` and `1234  <... openat resumed>`: the beginning of each call is enough.
used = set(re.findall(r"^\d+\s+([a-z_0-9]+)\(", open(sys.argv[2], encoding="utf-8", errors="replace").read(), re.MULTILINE))
# strace names what it reads of a thread that is killed as it enters a call: a number beyond all that the kernel has.
NUMBERS = 1024
used = {name for name in used if not (name.startswith("syscall_0x") and int(name[8:], 16) >= NUMBERS)}
print(json.dumps({"used": len(used), "refused": sorted(used - (allowed - refused))}))
