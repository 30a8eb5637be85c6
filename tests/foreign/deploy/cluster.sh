#!/usr/bin/env bash
# What becomes of an orchestrator and its workers in a cluster of slurm.sh: they come up on both machines, one machine dies, the job is told
# to end, and another one goes on with its store. In FOLDER, which is made; the program is $SOCRATES. Says on its last line what it saw.
#
#   cluster.sh FOLDER
# shellcheck disable=SC2016 # what is waited for is evaluated later
set -euo pipefail

slurm=$(cd "$(dirname "$0")/../../../deploy/slurm" && pwd)
mkdir -p "$1"
cd "$1"
small=(--cpus-per-task=1 --mem=100 --time=5)

patience() { for _ in $(seq 3000); do ! eval "$1" || return 0; sleep 0.1; done; echo "in vain: $1" >&2; squeue >&2; tail -n 20 ./*.log >&2; return 1; }
up() { [ -s "$1/endpoint" ] && [ "$(grep -cs '^worker on [a-z]* of' "socrates-$2.log")" = "$3" ]; }
# Right after a job has begun `scancel` waits and tries again; that it has come is seen by what the job does.
leave() {
  patience "timeout 3 scancel --batch --signal=TERM $1 2>/dev/null; [ ! -e '$folder/endpoint' ]"
  patience "! squeue --noheader --jobs $1 2>/dev/null | grep -q ."
}
state() { scontrol show job "$1" | sed -n 's/.*JobState=\([A-Z]*\).*/\1/p'; }

job=$(sbatch --parsable "${small[@]}" "$slurm/cluster.sbatch")
folder=$PWD/socrates-$job
patience 'up "$folder" "$job" 2'
kill_node second
patience '[ "$(sinfo --noheader --nodes second --format %T)" = down ]'
alive=$(squeue --noheader --jobs "$job" --format %T)
leave "$job"
again=$(SOCRATES_FOLDER=$folder sbatch --parsable "${small[@]}" --nodes=1 "$slurm/cluster.sbatch")
patience 'up "$folder" "$again" 1'
leave "$again"

left() { grep -c "left" "socrates-$1.log" || true; }
printf '{"alive":"%s","ended":"%s","workers_left":%s,"again":"%s","workers_left_again":%s,"endpoint":%s,"store":"%s"}\n' \
  "$alive" "$(state "$job")" "$(left "$job")" "$(state "$again")" "$(left "$again")" "$([ -e "$folder/endpoint" ] && echo true || echo false)" \
  "$(paste -sd, "$folder/store/said")"
