# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The whole excavator rig with `wire: auto` on a kernel that has vcan0: it takes that instead of
# slcan, all four IMUs claim their addresses and send their messages, and the report names the wire.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
# Free-running: an emulated processor needs longer than real time to cast the lidar's rays.
"$BINARY_DIR/rigwire" run excavator_pit --clock free --duration 200ms --status none \
  --set devices.gnss.path="$PWD/gnss" --set "scene.terrain.cell=2 m" --report report.json
grep -q "\"wire\": \"$CAN\"" report.json
expect_line dump ' 08F02D83#' 5
kill "$recorder"

# One line per address: claims, slopes, angular rates, accelerations. 100 Hz for 200 ms less the claim.
awk '{
  id = substr($3, 1, 8); address = substr(id, 7)
  if (id ~ /^18EEFF/) claims[address]++
  if (id ~ /^0CF029/) slopes[address]++
  if (id ~ /^0CF02A/) rates[address]++
  if (id ~ /^08F02D/) forces[address]++
}
END {
  for (n = 80; n <= 83; n++) {
    printf "%d: %d claims, %d slopes, %d rates, %d accelerations\n", n, claims[n], slopes[n], rates[n], forces[n]
    if (claims[n] < 1 || slopes[n] < 16 || slopes[n] > 20 || rates[n] < 16 || rates[n] > 20 ||
        forces[n] < 16 || forces[n] > 20) wrong = 1
  }
  exit wrong
}' dump
