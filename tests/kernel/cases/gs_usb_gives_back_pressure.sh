# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# A program that floods the interface gets no further than the bus: the driver keeps ten frames in
# flight, the queue is full, and what was accepted arrives on the bus, all of it and in order.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

need_gs_usb
start_adapter 33240
attach_adapter 33240
ip link set "$CAN" type can bitrate 250000
ip link set "$CAN" up

# The sender's own frames come back when they were on the wire, with the device's time.
stdbuf -oL candump -H -L "$CAN,700:7FF" >flood &
recorder=$!
wait_until 10 "candump to listen" more_listeners_than 0
frames=300
timeout 60 cangen "$CAN" -g 0 -p 100 -n $frames -I 700 -L 8 -D i
all_back() { [ "$(wc -l <flood)" -ge $frames ]; }
wait_until 30 "all frames" all_back

# The order on the wire is that of the stamps: a kernel with two processors may hand frames to a socket
# in another one, when its thread for the adapter changes the processor.
sort -s -k1,1 flood >by_stamp
for ((i = 0; i < frames; i++)); do printf '%02X%02X000000000000\n' $((i % 256)) $((i / 256)); done >sent
cut -d'#' -f2 by_stamp >arrived
diff sent arrived
# Consecutive frames are at least a frame's length apart: 111 bits without a stuff bit, 444 us (the
# stamp is whole microseconds).
awk '{gsub(/[()]/, "", $1)
      if (NR > 1 && $1 * 1e6 - last < 443) {
        early++
        print "too close behind " before ": " $0
      }
      last = $1 * 1e6; before = $0}
     END {print "frames", NR, "closer than the wire allows", early + 0
          exit early > 0}' by_stamp
kill "$recorder"

# Without patience the kernel says that its queue is full.
set +e
timeout 60 cangen "$CAN" -g 0 -n 1000 -I 701 -L 8 >impatient 2>&1
set -e
expect_line impatient 'No buffer space available' 0

ip -details -statistics link show "$CAN" >link
expect_line link 'state ERROR-ACTIVE' 0
# The queue is in order: when a last frame has been on the wire, all before it have.
stdbuf -oL candump -L "$CAN,702:7FF" >last_frame &
recorder=$!
wait_until 10 "candump to listen" more_listeners_than 0
wait_until 20 "room in the queue" cansend "$CAN" 702#
expect_line last_frame ' 702#' 20
kill "$recorder"
end_adapter
check_range "frames abandoned" "$(counted abandoned)" 0 0
check_range "frames handed over and not returned" "$(($(counted from_host) - $(counted echoed)))" 0 0
