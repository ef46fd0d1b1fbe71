# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# What happens to the client's controller is seen on vcan as it would be on a real interface: as
# error frames, that programs get which asked for them, and nobody else.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
stdbuf -oL candump -L "$CAN,0:0,#FFFFFFFF" >with_errors &
wait_until 10 "the error filter" grep -q "$CAN .*raw" /proc/net/can/rcvlist_err
start_peer "socketcan:$CAN" 0x12345
expect_error() { # expect_error WHAT PATTERN
  kill -USR1 "$peer"
  expect_line with_errors "$2" 10
  echo "that was: $1"
}
# Raw: the texts of candump 2020.11 do not know the class "counters".
expect_error "no acknowledgement" ' 2000002[08A-F]*#|20000[02]A[08]#'
expect_error "warning" ' 20000[02]04#0008.{8}60'
expect_error "passive" ' 20000[02]04#0020.{8}80'
expect_error "bus-off" ' 20000[02]4[04]#'
expect_error "restarted" ' 20000[0-3][0-9A-F]{2}#00[4]0|20000[13]0[04]#'
check_range "error frames among the frames" "$(count dump ' 2000')" 0 0
kill "$peer" && wait "$peer"
