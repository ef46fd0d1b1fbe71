# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# canbusload's exact count of the bits that an OpenIMU335RI puts on a bus of 250 kbit/s: three
# messages at 100 Hz, 17.1 %.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x12345 60
stdbuf -oL canbusload "$CAN@250000" -e >load &
# Whole seconds, the first of them possibly cut: "vcan0@250000  frames  bits  data bits  percent".
seconds() { [ "$(count load "^ *$CAN@250000 +2?[0-9]{2} ")" -ge 8 ]; }
wait_until 30 "eight seconds of canbusload" seconds
grep "$CAN@" load | tail -n +3 | head -n 5 | tee chosen
# Frames are late on an emulated processor, so that seconds differ: the mean of five.
bits=$(awk '{sum += $3} END {print int(sum / NR)}' chosen)
frames=$(awk '{sum += $2} END {print int(sum / NR)}' chosen)
check_range "frames per second" "$frames" 290 310
check_range "load, 0.01 %" $((bits * 100 * 100 / 250000)) 1660 1760
# The bits of a frame, whatever the frames are late: 144 slope, 143 rate, 141 acceleration and their
# like with other values.
check_range "bits per frame" $((bits / frames)) 139 146
kill "$peer" && wait "$peer"
