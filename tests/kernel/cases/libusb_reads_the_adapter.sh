# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The same adapter through libusb: taken from the kernel's driver, configured and read by a program,
# given back; and passed on to a second attachment, where the driver makes a canX of it again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

host=$BINARY_DIR/tests/kernel/kernel_usb_host
need_gs_usb
start_adapter 33240
attach_adapter 33240
"$host" list | tee listed
expect_line listed '1d50:606f bytewerk / candleLight USB to CAN adapter / [0-9A-F]{24} permitted' 0

timeout 60 "$host" read 1d50:606f | tee read
expect_line read '^channels 1 software 2 hardware 1$' 0
expect_line read '^clock 48000000' 0
expect_line read '^received [0-9]+ frames and an echo$' 0
if "$host" read 1d50:606f:NOBODY 2>refused; then
  echo "FAILED: another serial number was opened"
  exit 1
fi
cat refused

# The kernel's driver has it again.
wait_until 20 "the CAN interface" gs_usb_interface

# Passed on: the first attachment is held by libusb, the second is the kernel's.
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
