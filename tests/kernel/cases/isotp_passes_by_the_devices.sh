# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# Two programs exchange a long ISO-TP message on the interface that carries an emulated device: it
# arrives whole, the device goes on, and it has heard every segment as a frame of others.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x12345
seq 100 | xargs printf '%02X ' >message # 1 .. 100
isotprecv -s 321 -d 123 "$CAN" >received &
receiver=$!
wait_until 10 "the receiver" grep -q "$CAN .* 123 " /proc/net/can/rcvlist_sff
isotpsend -s 123 -d 321 "$CAN" <message
wait "$receiver"
[ "$(tr -d '\n' <received | sed 's/ *$//')" = "$(sed 's/ *$//' message)" ]
echo "100 bytes arrived unchanged"

# A first frame of 6 bytes and fourteen of 7 or less.
heard() { [ "$(count peer.log '^heard 00000123#')" = 15 ]; }
wait_until 10 "fifteen segments at the device" heard
check_range "flow control frames at the device" "$(count peer.log '^heard 00000321#30')" 1 1
seen=$(count dump ' 0CF02A80#')
more() { [ "$(count dump ' 0CF02A80#')" -gt "$seen" ]; }
wait_until 10 "messages after it" more
kill "$peer" && wait "$peer"
tail -n 1 peer.log
