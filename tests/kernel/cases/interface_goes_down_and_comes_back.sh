# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# An interface that goes down, and one that is removed and made anew, interrupt the device's
# messages and no more; while it is away the program waits instead of turning in circles.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

flows() { # flows FILE: messages arrive there
  record "$1"
  expect_line "$1" ' 0CF02A80#' 20
  kill "$recorder"
}
ticks() { awk '{print $14 + $15}' "/proc/$peer/stat"; } # of 10 ms

record dump
start_peer "socketcan:$CAN" 0x12345 60
kill "$recorder"
flows before

before=$(ticks)
ip link set "$CAN" down
sleep 1
ip link set "$CAN" up
flows after_down

ip link del dev "$CAN"
away=$(ticks)
sleep 2
# In circles it would be 200; the emulated processor is slow, and slower beside others.
check_range "10 ms of work in 2 s without an interface" $(($(ticks) - away)) 0 160
ip link add dev "$CAN" type vcan
ip link set "$CAN" up
flows after_removal
echo "work in all: $(($(ticks) - before)) x 10 ms"
kill "$peer" && wait "$peer"
tail -n 1 peer.log
