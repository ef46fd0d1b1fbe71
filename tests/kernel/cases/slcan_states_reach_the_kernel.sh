# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The kernel's slcan driver opens our adapter by itself (bit rate set by ip), and follows what the
# adapter tells of its controller: error frames, warning, passive, bus-off. Closing and opening makes
# it well again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

"$BINARY_DIR/tests/kernel/kernel_can_peer" "slcan:$WORK/adapter" 0x12345 >peer.log 2>&1 &
peer=$!
wait_until 10 "the pty" test -e "$WORK/adapter"
CAN=slcan_test
slcand -F "..$WORK/adapter" $CAN >slcand.log 2>&1 & # neither -o nor -s: the kernel sends C, S5, O
wait_until 10 "the interface" ip link show $CAN
ip link set $CAN type can bitrate 250000
ip link set $CAN up
record dump "0:0,#FFFFFFFF" # error frames too
expect_line dump ' 0CF02A80#' 20
shows() { ip -details -statistics link show $CAN | grep -q "$1"; }
shows 'bitrate 250000'
shows 'state ERROR-ACTIVE'

worsen() { # worsen WHAT_IP_SHOWS
  kill -USR1 "$peer"
  wait_until 10 "$1" shows "$1"
  echo "ip shows: $1"
}
kill -USR1 "$peer"
# Error on the bus, protocol, no acknowledgement; in the acknowledge slot.
expect_line dump ' 200000A8#000000190*$' 10
worsen 'state ERROR-WARNING'
worsen 'state ERROR-PASSIVE'
worsen 'state BUS-OFF'
wait_until 10 "no carrier" shows NO-CARRIER
# One change each, and one error of the transmitter (re-started, bus-errors, arbit-lost,
# error-warn, error-pass, bus-off).
ip -details -statistics link show $CAN | grep -A1 're-started' | tail -n 1 | tee changes
read -r _ _ _ warnings passives offs _ <changes
[ "$warnings $passives $offs" = "1 1 1" ]
# As error frames: classes controller and bus-off, with counters.
expect_line dump ' 20000204#0008.{8}60' 10
expect_line dump ' 20000204#0020.{8}80' 10
expect_line dump ' 20000[02]40#' 10

ip link set $CAN down
ip link set $CAN up
wait_until 10 "a new start" shows 'state ERROR-ACTIVE'
record dump_again # candump ends with its interface
expect_line dump_again ' 0CF02A80#' 10
kill "$peer" && wait "$peer"
tail -n 1 peer.log
