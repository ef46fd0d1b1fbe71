# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The emulated adapter, attached by USB/IP, is a canX of the kernel's own driver gs_usb: with bit
# timing, the device's time stamps, and an echo when the frame has been on the wire.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

need_gs_usb
start_adapter 33240
attach_adapter 33240
lsusb -d 1d50:606f
ip link set "$CAN" type can bitrate 250000
ip link set "$CAN" up
ip -details -statistics link show "$CAN" | tee link
expect_line link 'bitrate 250000' 0
expect_line link 'state ERROR-ACTIVE' 0
expect_line link 'gs_usb' 0
expect_line link 'clock 48000000' 0

# Both inertial units, over the wire.
record dump
expect_line dump ' 0CF02980#' 20
expect_line dump ' 0CF02981#' 20

# Time stamps of the device: the frames of one unit are a multiple of 10 ms apart in simulated time
# (some may be lost on a slow guest), whatever the guest's own clock does.
timeout 20 candump -H -L "$CAN,0CF02A80:1FFFFFFF" -n 20 >stamped
awk '{gsub(/[()]/, "", $1)
      if (NR > 1) {d = ($1 - last) * 1e3; off = d - 10 * int(d / 10 + 0.5); if (off * off > 1) bad++}
      last = $1} END {print "device time stamps out of step:", bad + 0; exit bad > 0}' stamped

# A request reaches the unit; the sender hears its own frame when it was sent (with -H it carries
# the device's time stamp, too).
cansend "$CAN" 18EA80F9#00EE00
expect_line dump ' 18EEFF80#' 20
expect_line dump ' 18EA80F9#00EE00' 20
ip -details -statistics link show "$CAN" >link_after
expect_line link_after 'state ERROR-ACTIVE' 0
kill "$recorder"
end_adapter
check_range "frames sent by the kernel" "$(counted echoed)" 1 1
