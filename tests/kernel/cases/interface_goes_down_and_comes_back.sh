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
# Times that the device's program has waited for something. A program that turns in circles has not.
waits() { awk '/^voluntary_ctxt_switches/ {print $2}' "/proc/$peer/status"; }
waits_reach() { [ "$(waits)" -ge "$1" ]; }

record dump
start_peer "socketcan:$CAN" 0x12345
kill "$recorder"
flows before

ip link set "$CAN" down
wait_until 20 "the program to wait while the interface is down" waits_reach $(($(waits) + 50))
ip link set "$CAN" up
flows after_down

ip link del dev "$CAN"
wait_until 20 "the program to wait without an interface" waits_reach $(($(waits) + 50))
ip link add dev "$CAN" type vcan
ip link set "$CAN" up
flows after_removal
kill "$peer" && wait "$peer"
tail -n 1 peer.log
