# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# What candump sees of an emulated Xsens MTi-600: six 11-bit messages in their order, with values that
# a decoder written here from the document finds right.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
"$BINARY_DIR/tests/kernel/kernel_can_peer" "socketcan:$CAN" 1 600 mti >peer.log 2>&1 &
peer=$!
enough() { [ "$(count dump ' 034#')" -ge 200 ]; }
wait_until 20 "200 acceleration messages" enough
kill "$peer" && wait "$peer"
kill "$recorder"
cat peer.log

# signed FRAME_LINE FIRST_BYTE: big-endian 16 bits.
signed() {
  local data=${1##*#} value
  value=$((16#${data:$2*2:4}))
  echo $((value < 32768 ? value : value - 65536))
}
order=$(head -n 12 dump | tail -n 6 | sed 's/.* \([0-9A-F]*\)#.*/\1/' | tr '\n' ' ')
echo "order: $order"
[ "$order" = "005 006 011 021 032 034 " ]
# Nose up by 5 degrees and at rest; 1/256 m/s2 and 1/512 rad/s. g sin 5 = 0.8547, g cos 5 = 9.7693.
line=$(grep ' 034#' dump | tail -n 1)
check_range "acceleration x, 1/256 m/s2" "$(signed "$line" 0)" 219 219
check_range "acceleration y, 1/256 m/s2" "$(signed "$line" 2)" 0 0
check_range "acceleration z, 1/256 m/s2" "$(signed "$line" 4)" 2501 2501
line=$(grep ' 032#' dump | tail -n 1)
check_range "rate z, 1/512 rad/s" "$(signed "$line" 4)" 0 0
# Nose up is a negative turn about y: sin 2.5 degrees * 32767 = 1429.
line=$(grep ' 021#' dump | tail -n 1)
check_range "quaternion y" "$(signed "$line" 4)" -1434 -1424
# Sample times, 10 ms apart.
grep ' 005#' dump | tail -n 2 | sed 's/.*#//' >times
mapfile -t times <times
check_range "ticks of 100 us between two samples" $((16#${times[1]} - 16#${times[0]})) 99 101
