# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# Where there is no vcan, the bus is a serial-line adapter on a pty: the kernel's own slcan driver,
# attached by slcand, makes a CAN interface of it that works in both directions.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

"$BINARY_DIR/tests/kernel/kernel_can_peer" "slcan:$WORK/adapter" 0x12345 >peer.log 2>&1 &
peer=$!
wait_until 10 "the pty" test -e "$WORK/adapter"
CAN=slcan_test
attach() { # slcand takes paths from /dev
  slcand -F -o -s5 "..$WORK/adapter" $CAN >>slcand.log 2>&1 &
  attached=$!
  wait_until 10 "the interface" ip link show $CAN
  ip link set $CAN up
}
interface_gone() { ! ip link show $CAN; }

attach
record dump
expect_line dump ' 0CF02A80#' 20
expect_line dump ' 08F02D80#' 20

cansend "$CAN" 18EA80F9#00EE00
expect_line dump ' 18EEFF80#4523E16600830080' 20
expect_line peer.log '^heard 18EA80F9#00EE00' 10

# Detached, the adapter goes on; attached again, frames flow again.
kill "$recorder" "$attached"
wait_until 10 "the interface to go" interface_gone
attach
record dump_again
expect_line dump_again ' 0CF02A80#' 20
kill "$recorder" "$attached"
kill "$peer" && wait "$peer"
tail -n 2 peer.log
