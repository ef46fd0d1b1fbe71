# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# canbusload's exact count of the bits that an OpenIMU335RI puts on a bus of 250 kbit/s: three
# messages at 100 Hz, 17.1 %.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x12345
stdbuf -oL canbusload "$CAN@250000" -e >load &
# Whole seconds, the first of them possibly cut: "vcan0@250000  frames  bits  data bits  percent".
seconds() { [ "$(count load "^ *$CAN@250000 +[23][0-9]{2} ")" -ge 5 ]; }
wait_until 30 "five seconds of canbusload" seconds
grep "$CAN@" load | tail -n +3 | head -n 3 | tee chosen
bits=$(awk '{sum += $3} END {print sum}' chosen)
frames=$(awk '{sum += $2} END {print sum}' chosen)
check_range "frames per second" $((frames / 3)) 250 350
# On an emulated processor seconds differ; a frame's bits do not, and a device sends 300 a second.
check_range "load, 0.01 %" $((bits * 300 * 10000 / frames / 250000)) 1690 1730
kill "$peer" && wait "$peer"
