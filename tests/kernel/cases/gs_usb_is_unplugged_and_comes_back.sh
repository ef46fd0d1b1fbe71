# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The adapter is pulled out while frames flow: the interface vanishes under its readers and senders.
# Put back and attached again, it works again. Twice, once detached by the client.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

need_gs_usb
start_adapter 33240
interface_gone() { ! gs_usb_interface; }
use() {
  attach_adapter 33240
  ip link set "$CAN" type can bitrate 250000
  ip link set "$CAN" up
  record "$1"
  expect_line "$1" ' 0CF02A80#' 20
}

use first
cangen "$CAN" -g 0 -p 100 -I 700 >cangen.log 2>&1 &
sender=$!
expect_line first ' 700#' 20
kill -USR1 "$peer"
wait_until 20 "the interface to go" interface_gone
expect_line peer.log '^unplugged' 5
wait "$sender" || true
kill "$recorder" 2>/dev/null || true
"$USBIP" --tcp-port 33240 list -r 127.0.0.1 >listed 2>&1 || true
if grep -q '1d50:606f' listed; then
  cat listed
  echo "FAILED: an unplugged device is listed"
  exit 1
fi

kill -USR1 "$peer"
expect_line peer.log '^plugged' 5
use second
kill "$recorder" 2>/dev/null || true
port=$(awk '$1 == "hs" && $3 == "006" {print $2; exit}' /sys/devices/platform/vhci_hcd.0/status)
"$USBIP" detach -p "$((10#$port))"
wait_until 20 "the interface to go" interface_gone
use third
kill "$recorder" 2>/dev/null || true
end_adapter
check_range "frames handed over and never settled" \
  "$(($(counted from_host) - $(counted echoed)))" 0 13
