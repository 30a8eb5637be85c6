#!/usr/bin/env bash
# What becomes of an array of eight shards in a cluster of slurm.sh: one is told that its time is up, a machine dies under others, one is
# killed and handed in again, one is canceled for good. In FOLDER, which is made; the words after it go to `socrates run`; the program
# is $SOCRATES. Says on its last line what it saw.
#
#   shards.sh FOLDER WORDS…
# shellcheck disable=SC2016 # what is waited for is evaluated later
set -euo pipefail

told='' lost='' killed=''
slurm=$(cd "$(dirname "$0")/../../../deploy/slurm" && pwd)
mkdir -p "$1"
cd "$1"
shift
small=(--cpus-per-task=1 --mem=100 --time=10)
export HELD_PROGRAM=$SOCRATES HELD=$PWD/held
SOCRATES=$(dirname "$slurm")/../tests/foreign/deploy/held.sh
mkdir "$HELD"

patience() { for _ in $(seq 3000); do ! eval "$1" || return 0; sleep 0.1; done; echo "in vain: $1" >&2; squeue >&2; tail -n 5 ./*.log >&2; return 1; }
# One of those that run on a machine and are held in the middle of their work, but for these.
running() {
  local one
  for one in $(squeue --noheader --array --jobs "$job" --states RUNNING --nodelist "$1" --format %K); do
    [[ " ${*:2} " != *" $one "* ]] && held "$one" && echo "$one" && return 0
  done
  return 1
}
held() { [ -e "$HELD/at-$1" ]; }
# Slurm waits two minutes before it begins a job anew; a test does not.
hasten() {
  local one
  for one in $(squeue --noheader --array --states PENDING --format '%i %r' | sed -n 's/ BeginTime$//p'); do
    scontrol update JobId="$one" StartTime=now || true
  done
}
# Right after a job has begun `scancel` waits and tries again, also where its signal has come; whether it has is what the log says.
cancel() { patience "timeout 3 scancel $* 2>/dev/null; grep -qs 'CANCEL.* AT' 'socrates-${*: -1}.log'"; }
ended() { hasten; [ -z "$(squeue --noheader --array --jobs "$1" 2>/dev/null)" ]; }
state() { scontrol show job "$1" | sed -n 's/.*JobState=\([A-Z]*\).*Restarts.*/\1/p; s/.*JobState=\([A-Z]*\).*/\1/p' | head -n 1; }

# A misspelt option of the file is refused.
sed 's/--requeue/--reqeue/' "$slurm/shards.sbatch" >misspelt.sbatch
misspelt=refused
! sbatch --parsable "${small[@]}" misspelt.sbatch "$@" 2>misspelt.err || misspelt=taken

job=$(sbatch --parsable "${small[@]}" "$slurm/shards.sbatch" "$@")
early=$(sbatch --parsable "${small[@]}" --dependency="afterany:$job" "$slurm/merge.sbatch" "socrates-$job" early)
patience '[ "$(squeue --noheader --array --jobs "$job" --states RUNNING | wc -l)" = 4 ]'
patience 'told=$(running first)'
cancel --signal=TERM "${job}_$told"
touch "$HELD/go-$told"
patience 'lost=$(running second)'
kill_node second
# One of those that are left is killed, as for its memory.
patience 'killed=$(running first "$told" "$lost")'
cancel --signal=KILL "${job}_$killed"
patience '[ -z "$(squeue --noheader --array --jobs "${job}_$killed" --states RUNNING,COMPLETING 2>/dev/null)" ]'
touch "$HELD/go-all"
patience 'ended "$job,$early"'
again=$(SOCRATES_SHARDS=$PWD/socrates-$job sbatch --parsable "${small[@]}" --array="$killed" "$slurm/shards.sbatch" "$@")
merge=$(sbatch --parsable "${small[@]}" --dependency="afterany:$again" "$slurm/merge.sbatch" "socrates-$job" library)
patience 'ended "$again,$merge"'
# What a person takes back stays taken back, although its program ends as one whose time is up.
HELD=$PWD/held-again
mkdir "$HELD"
other=$(sbatch --parsable "${small[@]}" --array=0-1 "$slurm/shards.sbatch" "$@")
patience 'held 0 && held 1'
cancel "${other}_0"
touch "$HELD/go-all"
patience 'ended "$other"'

restarts() { scontrol show job "$1" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | head -n 1; }
printf '{"misspelt":"%s","told":%s,"told_again":%s,"lost":%s,"lost_again":%s,"killed":%s,"early":"%s","merge":"%s","canceled":%s,"canceled_again":%s,"job":%s}\n' \
  "$misspelt" "$told" "$(restarts "${job}_$told")" "$lost" "$(restarts "${job}_$lost")" "$killed" "$(state "$early")" "$(state "$merge")" \
  "$([[ $(state "${other}_0") = CANCEL* ]] && echo true || echo false)" "$(restarts "${other}_0")" "$job"
