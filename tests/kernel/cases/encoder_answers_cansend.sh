# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# cansend is the CANopen master of an emulated encoder (CiA 406, node 0x20, 8192 steps): boot-up, SDO,
# network management, SYNC, refusals; what is meant for another node changes nothing.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
"$BINARY_DIR/tests/kernel/kernel_can_peer" "socketcan:$CAN" 1 600 encoder >peer.log 2>&1 &
peer=$!
expect_line dump ' 720#00$' 20

cansend "$CAN" 620#4001650000000000   # single-turn resolution
expect_line dump ' 5A0#4301650000200000$' 10
cansend "$CAN" 620#4004600000000000   # position: a quarter of 8192
expect_line dump ' 5A0#4304600000080000$' 10
cansend "$CAN" 620#2304600001000000   # which is read-only
expect_line dump ' 5A0#8004600002000106$' 10
cansend "$CAN" 620#4008100000000000   # its name, in segments
expect_line dump ' 5A0#410810001C000000$' 10
cansend "$CAN" 620#6000000000000000
expect_line dump ' 5A0#0053696E676C652D$' 10   # "Single-"

check_range "positions before the start" "$(count dump ' 1A0#')" 0 0
cansend "$CAN" 000#0121               # somebody else's
cansend "$CAN" 620#2B171000C8000000   # heartbeat each 200 ms, which then says the state
expect_line dump ' 720#7F$' 10
cansend "$CAN" 000#0120
expect_line dump ' 1A0#00080000$' 10
expect_line dump ' 720#05$' 10
check_range "answers to SYNC before it" "$(count dump ' 2A0#')" 0 0
cansend "$CAN" 080#
expect_line dump ' 2A0#00080000$' 10
cansend "$CAN" 000#0220
expect_line dump ' 720#04$' 10

kill "$peer" && wait "$peer"
kill "$recorder"
cat peer.log
