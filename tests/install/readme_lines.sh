#!/usr/bin/env bash
# The lines of README.md as they stand, one after another, as one pastes them: all but those that
# install and the demo, which has a test of its own. What they import is a simulated trip in tables.
#   readme_lines.sh README.md PREFIX EXAMPLES
set -euo pipefail
readme="$1" prefix="$2" examples="$3"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$examples/tables_of_a_trip" 300
sed -i '1i time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z' imu.csv
sed -i '1i time,latitude,longitude,height,sigma_north,sigma_east,sigma_down' gnss.csv

lines="$(awk '/^```/ { on = $0 == "```sh"; next } on' "$readme" |
  grep -v -e '^apps/install.sh' -e '^foucault demo' || true)"
[[ "$(grep -c '^foucault ' <<<"$lines" || true)" -ge 8 ]] || {
  echo "README.md has hardly any lines to paste" >&2
  exit 1
}
PATH="$prefix/bin:$PATH" bash -euxo pipefail -c "$lines"
for result in drive/report/index.html drive-outages/drift.csv noise/learned.yaml both; do
  [[ -e "$result" ]] || {
    echo "no $result" >&2
    exit 1
  }
done
