# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The adapter as libusb passes it on: one attachment is held by a program, which exports it anew; the
# kernel's driver makes a canX of the second attachment.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

host=$BINARY_DIR/tests/kernel/kernel_usb_host
need_gs_usb
start_adapter 33240
attach_adapter 33240
"$host" serve 1d50:606f 33241 >serve.log 2>&1 &
server=$!
wait_until 20 "the second server" grep -q '^serving 1-1' serve.log
interface_gone() { ! gs_usb_interface; }
wait_until 20 "the driver to let go" interface_gone
attach_adapter 33241
ip link set "$CAN" type can bitrate 250000
ip link set "$CAN" up
record dump
expect_line dump ' 0CF02980#' 30
cansend "$CAN" 18EA80F9#00EE00
expect_line dump ' 18EEFF80#' 30
kill "$recorder"
ip link set "$CAN" down
kill "$server" && wait "$server" || true
end_adapter
