#!/usr/bin/env bash
# Runs a command in a cluster of Slurm that is there for it alone: two machines, both this one, on free ports of the loopback.
#
#   slurm.sh FOLDER COMMAND…       everything lies in FOLDER, an empty one; SLURM_CONF is set for the command; needs root
#
# `kill_node NAME` in the command's PATH ends all processes of a machine at once, as a power cut would.
set -euo pipefail

folder=$(cd "$1" && pwd)
shift
mkdir "$folder/state" "$folder/bin" "$folder/tmp"
read -r controller first second < <(python3 - <<'END'
import socket
taken = [socket.socket() for _ in range(3)]
for one in taken:
    one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in taken))
END
)
cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$controller
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
SchedulerParameters=sched_interval=2,batch_sched_delay=1
ReturnToService=2
# Short, so that a test notices whether a program is told or ended.
KillWait=2
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool-%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd-%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd-%n.log
NodeName=first NodeHostname=localhost NodeAddr=127.0.0.1 Port=$first CPUs=2 RealMemory=4000
NodeName=second NodeHostname=localhost NodeAddr=127.0.0.1 Port=$second CPUs=2 RealMemory=4000
PartitionName=all Nodes=first,second Default=YES MaxTime=10 State=UP
END
cat >"$folder/bin/kill_node" <<END
#!/usr/bin/env bash
# What belongs to the machine: its daemon and what has that one's log open, and what its jobs started.
for place in /proc/[0-9]*; do
  if find "\$place/fd" -lname "$folder/slurmd-\$1.log" 2>/dev/null | grep -q . ||
    { tr '\\0' '\\n' <"\$place/environ" | grep -qx "SLURMD_NODENAME=\$1" &&
      tr '\\0' '\\n' <"\$place/environ" | grep -qx "SLURM_CONF=$folder/slurm.conf"; } 2>/dev/null; then
    kill -9 "\${place#/proc/}" 2>/dev/null || true
  fi
done
[ "\${2:-}" = quietly ] || scontrol update NodeName="\$1" State=DOWN Reason=killed
END
chmod +x "$folder/bin/kill_node"
export SLURM_CONF=$folder/slurm.conf PATH=$folder/bin:/usr/sbin:$PATH TMPDIR=$folder/tmp

head -c 128 /dev/urandom >"$folder/munge.key"
chmod 600 "$folder/munge.key"
started=()
# shellcheck disable=SC2329 # the trap calls it
leave() {
  scancel --user=root 2>/dev/null || true
  for _ in $(seq 100); do [ -n "$(squeue --noheader 2>/dev/null)" ] || break; sleep 0.1; done
  for one in "${started[@]}"; do kill "$one" 2>/dev/null || true; done
  wait
  for node in first second; do kill_node "$node" quietly; done
}
trap leave EXIT
munged --foreground --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/munged.seed" >"$folder/munged.out" 2>&1 &
started+=($!)
for _ in $(seq 100); do [ -S "$folder/munge.socket" ] && break; sleep 0.1; done
slurmctld -D >"$folder/slurmctld.out" 2>&1 &
started+=($!)
for node in first second; do
  mkdir "$folder/spool-$node"
  slurmd -D -N "$node" >"$folder/slurmd-$node.out" 2>&1 &
  started+=($!)
done
for _ in $(seq 300); do
  [ "$(sinfo --noheader --Node --format %T 2>/dev/null | grep -cx idle)" = 2 ] && break
  sleep 0.1
done
[ "$(sinfo --noheader --Node --format %T | grep -cx idle)" = 2 ] || { echo "Slurm does not come up" >&2; cat "$folder"/*.out >&2; exit 1; }

code=0
"$@" || code=$?
exit "$code"
