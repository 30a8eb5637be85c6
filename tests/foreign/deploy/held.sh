#!/usr/bin/env bash
# Runs the program $HELD_PROGRAM. A shard stands still as soon as it has something to show, and says so by the file at-NUMBER in the folder
# $HELD, until go-NUMBER or go-all is there: what strikes it in between strikes it in the middle of its work, however fast the machine.
set -euo pipefail

out='' number=''
words=("$@")
for ((at = 0; at < ${#words[@]}; at++)); do
  case ${words[at]} in
    --out) out=${words[at + 1]} ;;
    --shard) number=${words[at + 1]%/*} ;;
  esac
done
[ -n "$number" ] || exec "$HELD_PROGRAM" "$@"

let_go() { [ -e "$HELD/go-$number" ] || [ -e "$HELD/go-all" ]; }
# A signal for the program reaches this too, which waits on.
trap : TERM
moment() { sleep 0.05 || true; }
"$HELD_PROGRAM" "$@" &
child=$!
until let_go || compgen -G "$out/*[0-9]" >/dev/null || ! kill -0 "$child" 2>/dev/null; do moment; done
if ! let_go && kill -STOP "$child" 2>/dev/null; then
  touch "$HELD/at-$number"
  until let_go; do moment; done
  kill -CONT "$child"
fi
code=0
wait "$child" || code=$?
# A wait ends early by a signal.
while kill -0 "$child" 2>/dev/null; do
  code=0
  wait "$child" || code=$?
done
exit "$code"
