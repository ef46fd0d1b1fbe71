# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# What candump sees of an emulated OpenIMU335RI: the claim first, then its three messages in turn,
# with values that a decoder written here from the document finds right.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x12345
enough() { [ "$(count dump ' 0CF02980#')" -ge 100 ]; }
wait_until 20 "100 slope messages" enough
kill "$peer" && wait "$peer"
kill "$recorder"
cat peer.log

first=$(head -n 1 dump)
echo "first frame: $first"
# Identity 0x12345, manufacturer 823, function 131, arbitrary address capable; little-endian.
[[ $first == *"18EEFF80#4523E16600830080" ]]

# Same number of each message: slope, angular rate, acceleration (priority 2).
slope=$(count dump ' 0CF02980#')
check_range "angular rate messages" "$(count dump ' 0CF02A80#')" $((slope - 1)) $((slope + 1))
check_range "acceleration messages" "$(count dump ' 08F02D80#')" $((slope - 1)) $((slope + 1))

# Nose up by 5 degrees and at rest, in the wire's units. Slope: 1/32768 deg from -250 deg.
line=$(grep ' 0CF02980#' dump | tail -n 1)
check_range "pitch, mdeg" $(($(field "$line" 0 3) * 1000 / 32768 - 250000)) 4900 5100
check_range "roll, mdeg" $(($(field "$line" 3 3) * 1000 / 32768 - 250000)) -100 100
# Rates: 1/128 deg/s from -250 deg/s.
line=$(grep ' 0CF02A80#' dump | tail -n 1)
for axis in 0 2 4; do
  check_range "rate at byte $axis, 1/128 deg/s" $(($(field "$line" $axis 2) - 32000)) 0 0
done
# Acceleration: 0.01 m/s2 from -320 m/s2; lateral, longitudinal, vertical. g cos 5 deg = 9.769.
line=$(grep ' 08F02D80#' dump | tail -n 1)
check_range "lateral, cm/s2" $(($(field "$line" 0 2) - 32000)) 0 0
longitudinal=$(($(field "$line" 2 2) - 32000))
check_range "longitudinal, cm/s2, either sign" ${longitudinal#-} 85 86
check_range "vertical, cm/s2" $(($(field "$line" 4 2) - 32000)) 976 977
