# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The kernel's J1939 stack takes the emulated device for a node: it learns the claimed NAME, so that
# a program can send to the NAME alone, and it hands the device's messages to a J1939 socket.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

name=0x8000830066E12345
record dump
# A J1939 socket has to be open for the stack to follow claims on the interface.
listen_j1939 heard
start_peer "socketcan:$CAN" 0x12345

# The stack holds a claim for 250 ms before it believes it; ask until it does. (j1939cat 2020.11
# fails after sending, on the kernel's longer error notifications; the bus tells what it sent.)
printf '\x00\xEE\x00' >request
ask() {
  timeout 2 j1939cat -i request "$CAN:0x20" "$CAN:,0xEA00,$1" >ask.log 2>&1 || true
  grep -q ' 18EA8020#00EE00' dump
}
wait_until 20 "a request that the kernel addressed by NAME" ask $name
expect_line dump ' 18EA8020#00EE00' 1
answered() { sed -n '/ 18EA8020#/,$p' dump | grep -q ' 18EEFF80#4523E16600830080'; }
wait_until 10 "the device's answer to it" answered
echo "the device answered with its claim"

# A NAME that nobody has claimed has no address.
timeout 2 j1939cat -i request "$CAN:0x20" "$CAN:,0xEA00,0x8000830066E12346" >unknown.log 2>&1 || true
grep -q 'Cannot assign requested address' unknown.log
echo "an unclaimed NAME is refused: $(cat unknown.log)"

# testj1939 prints "SOURCE PGN: number bytes".
expect_line heard '^80 0f02a' 10
expect_line heard '^80 0f02d' 10
expect_line heard '^80 0f029' 10
kill "$peer" && wait "$peer"
kill "$listener" "$recorder"
