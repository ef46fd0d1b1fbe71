# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The same adapter through libusb: taken from the kernel's driver, configured and read by a program,
# and given back.
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
end_adapter
