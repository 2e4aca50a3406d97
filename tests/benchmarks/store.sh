#!/usr/bin/env bash
# Measures what the store is for, with the built program, in a temporary folder:
#   store.sh workers FOUCAULT [COUNT [LOGS]]   workers (8) on one store against one process on all
#                                       cores: runs computed twice, wall time over that of the
#                                       process. Four runs a log (48), of a second each
#   store.sh kills FOUCAULT [COUNT]     the only worker killed at random moments (50), within the
#                                       third of the time that it takes: whether the result is that
#                                       of a process nobody killed, runs done twice
set -euo pipefail

verb=$1
foucault=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

outages=(--set outages.first_s=60 --set outages.length_s=10 --set outages.period_s=20
  --set 'outages.shifts_s=[0,10]' --set calibrate.noise=off)

# make_logs COUNT SECONDS
make_logs() {
  local seed
  for seed in $(seq "$1"); do
    "$foucault" simulate --quiet --duration "$2" --seed "$seed" --set scenario.rest_s=15 \
      --set scenario.imu_rate_hz=50 --out "$(printf 'log%02d.rawlog' "$seed")"
  done
}

# In the place of the shell, so that a signal reaches it.
exec_evaluate() {
  exec "$foucault" evaluate log*.rawlog --methods ekf,refined "${outages[@]}" --no-report "$@"
}

evaluate() { (exec_evaluate "$@"); }

# Wall time of a command, and CPU time with that of its children.
seconds() { (TIMEFORMAT='%R s (CPU %U s)' && time "$@" >/dev/null) 2>&1; }

work() {
  local i pids=()
  for i in $(seq "$1"); do
    evaluate --store runs --out all --jobs 1 --shard "$i/$1" >"worker$i.txt" &
    pids+=($!)
  done
  for i in "${pids[@]}"; do wait "$i"; done
}

workers() {
  local count=$1 logs=$2 all=$((4 * $2)) alone together computed
  make_logs "$logs" 300
  alone=$(seconds evaluate --out alone)
  together=$(seconds work "$count")
  computed=$(cat worker*.txt | sed -n 's/.* \([0-9]*\) runs computed.*/\1/p' | paste -sd+ | bc)
  evaluate --store runs --out all --no-compute >/dev/null
  cmp alone/drift.csv all/drift.csv
  echo "$count workers: $((computed - all)) of $all runs twice, $together; one process $alone"
}

# What a record is told apart by: computed again, it is another file.
records() {
  [[ ! -d runs ]] || find runs -type f -name '*[0-9a-f]' -printf '%f %i\n' | sort
}

kills() {
  local count=$1 i pid begin whole twice=0
  make_logs 4 300
  begin=$EPOCHREALTIME
  evaluate --out alone --jobs 1 >/dev/null
  whole=$(echo "$EPOCHREALTIME - $begin" | bc)
  RANDOM=42
  : >before.txt
  for i in $(seq "$count"); do
    exec_evaluate --store runs --out all --jobs 1 >/dev/null &
    pid=$!
    sleep "$(echo "scale=3; $whole / 3 * $RANDOM / 32768" | bc)"
    kill -KILL "$pid" 2>/dev/null || true
    wait "$pid" 2>/dev/null || true
    records >after.txt
    twice=$((twice + $(comm -23 before.txt after.txt | wc -l)))
    mv after.txt before.txt
  done
  echo "$count kills, $(wc -l <before.txt) records, $twice of them written again"
  evaluate --store runs --out all --jobs 1 | grep -a '^store' || true
  cmp alone/drift.csv all/drift.csv && echo "the result is the same"
}

case $verb in
  workers) workers "${3:-8}" "${4:-48}" ;;
  kills) kills "${3:-50}" ;;
  *) exit 2 ;;
esac
