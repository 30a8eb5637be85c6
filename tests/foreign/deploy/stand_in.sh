#!/usr/bin/env bash
# Plays the program for what a batch system does with it: verbs and exit codes alone. A scenario is a file that takes a moment; what is
# there is not made again; SIGTERM ends it with 75 after two moments more than Slurm would wait for `srun`.
set -euo pipefail

verb=$1
shift
out='' shard=0/1 variants=1 dir='' words=() connect=''
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --shard) shard=$2; shift 2 ;;
    --variants) variants=$2; shift 2 ;;
    --dir) dir=$2; shift 2 ;;
    --connect) connect=$2; shift 2 ;;
    --seed | --require | --listen | --keys | --slots | --host) shift 2 ;;
    --force) shift ;;
    *) words+=("$1"); shift ;;
  esac
done
# The signal reaches this too, which is no failure of the program.
moment() { sleep 0.2 || true; }

case "$verb ${words[0]:-}" in
  "run "*)
    stopped=
    trap 'stopped=yes' TERM
    mkdir -p "$out"
    for ((one = ${shard%/*}; one < variants; one += ${shard#*/})); do
      [ ! -e "$out/scenario-$one" ] || continue
      moment
      echo "${words[*]} $one" >"$out/scenario-$one"
      if [ -n "$stopped" ]; then
        for _ in $(seq 20); do moment; done
        echo "told to stop, $one is the last"
        exit 75
      fi
    done
    echo "$shard" >"$out/library.json"
    ;;
  "library merge")
    mkdir -p "$out"
    for part in "${words[@]:1}"; do
      [ -e "$part/library.json" ] || { echo "$part is not finished" >&2; exit 2; }
      cp "$part"/scenario-* "$out/"
    done
    ;;
  "cluster keys") mkdir -p "${words[1]}/client" "${words[1]}/worker" "${words[1]}/orchestrator" ;;
  "cluster up")
    trap 'echo "orchestrator left" >>"$dir/said"; exit 0' TERM
    mkdir -p "$dir"
    echo "orchestrator on $SLURMD_NODENAME" >>"$dir/said"
    while :; do moment; done
    ;;
  "cluster work")
    trap 'echo "worker on $SLURMD_NODENAME left $connect"; exit 0' TERM
    echo "worker on $SLURMD_NODENAME of $connect"
    while :; do moment; done
    ;;
  "status "*) ;;
  *) echo "the stand-in knows no $verb ${words[*]}" >&2; exit 2 ;;
esac
