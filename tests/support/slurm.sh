#!/usr/bin/env bash
# A Slurm of one's own on loopback, for tests: no systemd, no cgroups, as any user.
#   slurm.sh up DIR NODES         starts it; then SLURM_CONF=DIR/slurm.conf is its configuration
#   slurm.sh kill-node DIR NAME   as if the machine were gone: its slurmd and the pids in
#                                 DIR/tasks/NAME, which jobs write there, get a SIGKILL. Slurm finds
#                                 out by itself, in 17 s
#   slurm.sh down DIR             ends by pid what `up` has started
set -euo pipefail

conf_of() {
  local dir=$1 nodes=$2 port=$3 host user i
  host=$(hostname -s)
  user=$(id -un)
  cat <<CONF
ClusterName=foucault
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$dir/munge.sock,cred_expire=10
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool-%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd-%n.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd-%n.log
MailProg=/bin/true
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core,CR_LLN
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=8
MessageTimeout=5
MpiDefault=none
SchedulerParameters=sched_interval=2,bf_interval=2
CONF
  for i in $(seq "$nodes"); do
    echo "NodeName=n$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + i)) CPUs=4"
  done
  echo "PartitionName=all Nodes=n[1-$nodes] Default=YES MaxTime=INFINITE State=UP"
}

# start NAME COMMAND...: in the background; its pid goes into DIR/pids/NAME
start() {
  local name=$1
  shift
  "$@" >"$dir/$name.out" 2>&1 </dev/null &
  echo $! >"$dir/pids/$name"
}

wait_for() {
  local i
  for i in $(seq 150); do
    "$@" >/dev/null 2>&1 && return
    sleep 0.1
  done
  echo "slurm.sh: waited in vain for: $*" >&2
  down
  exit 1
}

all_idle() { [[ "$(sinfo --noheader --format=%t)" == idle ]]; }

up() {
  local nodes=$1 i
  mkdir -p "$dir/state" "$dir/pids" "$dir/tasks"
  (umask 077 && head -c 1024 /dev/urandom >"$dir/munge.key")
  start munged munged --foreground --force --socket="$dir/munge.sock" --key-file="$dir/munge.key" \
    --log-file="$dir/munged.log" --pid-file="$dir/munged.pid" --seed-file="$dir/munged.seed"
  wait_for test -S "$dir/munge.sock"
  conf_of "$dir" "$nodes" $((20000 + RANDOM % 20000)) >"$dir/slurm.conf"
  echo "CgroupPlugin=cgroup/v1" >"$dir/cgroup.conf" # unused; looked for, it is missing in a chroot
  start slurmctld slurmctld -D
  for i in $(seq "$nodes"); do start "n$i" slurmd -D -N "n$i"; done
  wait_for all_idle
}

kill_node() {
  local name=$1 pid
  for pid in $(cat "$dir/pids/$name" "$dir/tasks/$name"); do
    kill -KILL "$pid" 2>/dev/null || true
  done
  rm -f "$dir/pids/$name"
}

down() {
  scancel --user="$(id -un)" 2>/dev/null || true
  local file
  for file in "$dir"/pids/*; do kill "$(cat "$file")" 2>/dev/null || true; done
}

verb=$1
dir=$(realpath -m "$2")
export SLURM_CONF=$dir/slurm.conf
case $verb in
  up) up "$3" ;;
  kill-node) kill_node "$3" ;;
  down) down ;;
  *) exit 2 ;;
esac
