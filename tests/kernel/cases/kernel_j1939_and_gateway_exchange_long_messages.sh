# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The kernel's J1939 stack and the vehicle gateway pass long messages both ways: three trouble codes
# by broadcast, the gateway's identification by request and clear to send, a message to it; and a
# partner that never clears to send is given up.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
listen_j1939 heard
"$BINARY_DIR/tests/kernel/kernel_j1939_peer" "$CAN" 0x27 0x12345 >peer.log 2>&1 &
peer=$!
expect_line dump ' 18EEFF27#4523010000860020' 20

# Three requests that are never repeated: three codes (TSC1, XBR, guidance fall silent).
cansend "$CAN" 0C0027F9#CEFFFFA5FFFFFFFF
cansend "$CAN" 0C0427F9#7F6DE0FFFFFFFFFF
cansend "$CAN" 0CAD27F9#807DFDFFFFFFFFFF
expect_line dump ' 1CECFF27#200E0002FFCAFE00' 20 # announced: 14 bytes, 2 packets, DM1
# testj1939 prints "SOURCE PGN: bytes", eight in a line: red stop and amber lamp; SPN 695, 2920 and
# 5237, FMI 9.
expect_line heard '^27 0feca: 14 ff b7 02 09 01 68 0b$' 20
expect_line heard '^00008 +09 01 75 14 09 01$' 5

# ECU identification to the kernel's address alone: "*74565**tractor ECU*Rigwire**".
cansend "$CAN" 18EA2720#C5FD00
expect_line dump ' 1CEC2027#101D0005FFC5FD00' 10 # 29 bytes, 5 packets
expect_line dump ' 1CEC2720#11' 10               # the kernel clears to send
expect_line dump ' 1CEC2720#131D0005FFC5FD00' 10 # and has it all
expect_line heard '^27 0fdc5: 2a 37 34 35 36 35 2a 2a$' 10

# A message to the gateway.
head -c 20 /dev/zero | tr '\0' 'R' >message
timeout 5 j1939cat -i message "$CAN:0x21" "$CAN:0x27,0xEF00" >send.log 2>&1 || cat send.log
expect_line dump ' 1[8C]EC2721#10140003[0-9A-F]{2}00EF00' 10
expect_line dump ' 1CEC2127#110301FFFF00EF00' 10 # all three packets at once
expect_line dump ' 1CEC2127#13140003FF00EF00' 10 # end of message

# Nobody is at 0x55: the gateway waits 1.25 s for its clear to send, and aborts with "timeout".
cansend "$CAN" 18EA2755#C5FD00
expect_line dump ' 1CEC5527#101D0005FFC5FD00' 10
expect_line dump ' 1CEC5527#FF03FFFFFFC5FD00' 10

kill "$peer" && wait "$peer" || true
cat peer.log
kill "$listener" "$recorder"
