# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# can-utils' address claiming daemon, on the kernel's J1939, wants the gateway's address: with a
# higher NAME it has to take another one, with a lower NAME the gateway gives up.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
"$BINARY_DIR/tests/kernel/kernel_j1939_peer" "$CAN" 0x80 0x12345 >peer.log 2>&1 &
peer=$!
expect_line dump ' 18EEFF80#4523010000860020' 20 # NAME 2000860000012345

# It asks who is there, so it knows that 0x80 is taken by a lower NAME.
j1939acd -r 128-136 -c higher.cache 8000830066e12345 "$CAN" >higher.log 2>&1 &
higher=$!
expect_line dump ' 18EA..FE#00EE00' 20
expect_line dump ' 18EEFF8[1-8]#4523E16600830080' 20
kill "$higher"
[ "$(count dump ' 18EEFFFE#4523010000860020')" = 0 ]

# The gateway loses to NAME 0000000000000042: "cannot claim", and silence.
j1939acd -r 128-128 -a 128 -c lower.cache 42 "$CAN" >lower.log 2>&1 &
lower=$!
expect_line dump ' 18EEFF80#4200000000000000' 20
expect_line dump ' 18EEFFFE#4523010000860020' 20
frames=$(count dump '^.* 0CF00480#')
pause 0.5
check_range "engine messages after the loss" $(($(count dump '^.* 0CF00480#') - frames)) 0 0
kill "$lower" && wait "$lower" || true

kill "$peer" && wait "$peer" || true
cat peer.log
kill "$recorder"
