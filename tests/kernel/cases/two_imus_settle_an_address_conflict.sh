# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# Two emulated devices prefer the same address on one interface: the lower NAME keeps it, the other
# moves to the next one, and both go on sending under their own.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x200
higher=$peer
wait_until 10 "data of the first device" grep -q ' 0CF02A80#' dump
start_peer "socketcan:$CAN" 0x100
lower=$peer
expect_line dump ' 18EEFF80#0001E06600830080' 20 # the lower NAME claims 80
expect_line dump ' 18EEFF81#0002E06600830080' 20 # the higher one moves on
expect_line dump ' 0CF02A81#' 20
first=$(count dump ' 0CF02A80#')
second=$(count dump ' 0CF02A81#')
both() {
  [ "$(count dump ' 0CF02A80#')" -ge $((first + 20)) ] &&
    [ "$(count dump ' 0CF02A81#')" -ge $((second + 20)) ]
}
wait_until 10 "data under both addresses" both
kill "$lower" "$higher"
wait "$lower" "$higher"
kill "$recorder"
