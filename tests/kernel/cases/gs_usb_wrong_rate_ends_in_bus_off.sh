# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# An interface at another bit rate than its bus goes off the bus when it sends; `ip` shows it. The
# adapter's firmware comes back by itself; at the right rate everything is well again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

need_gs_usb
start_adapter 33240
attach_adapter 33240
ip link set "$CAN" type can bitrate 500000
ip link set "$CAN" up
stdbuf -oL candump -L "$CAN,0:0,#FFFFFFFF" >errors &
recorder=$!
wait_until 10 "candump to listen" more_listeners_than 0
timeout 10 cangen "$CAN" -g 20 -n 20 -i -I 100 -L 8 || true

# Bus-off is class 0x40, a restart class 0x100, each alone or beside the error (0x80) that led to it.
expect_line errors ' 20000[0-9A-F][4-7C-F][0-9A-F]#' 20
expect_line errors ' 20000[13][0-9A-F]{2}#' 20
ip -details -statistics link show "$CAN" | tee link
bus_offs=$(grep -A1 're-started' link | tail -n 1 | awk '{print $6}')
check_range "times off the bus" "$bus_offs" 1 1000
kill "$recorder"

# Linux 6.1 leaves the recovery to the adapter: its driver cannot restart it.
if ip link set "$CAN" type can restart 2>restart; then
  echo "restarted by hand"
else
  cat restart
fi

ip link set "$CAN" down
ip link set "$CAN" type can bitrate 250000
ip link set "$CAN" up
record dump
expect_line dump ' 0CF02980#' 20
cansend "$CAN" 18EA80F9#00EE00
expect_line dump ' 18EEFF80#' 20
ip -details link show "$CAN" >link_after
expect_line link_after 'state ERROR-ACTIVE' 0
kill "$recorder"
end_adapter
check_range "restarts" "$(counted restarts)" 1 1000
