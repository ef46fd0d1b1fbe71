# shellcheck shell=bash source=tests/kernel/common.sh
# Helpers of the USB cases; sourced after common.sh. What a case attaches is detached when it ends.

# start_usb_peer PROGRAM PORT [ARG...]: exports devices on 127.0.0.1:PORT. Its process id is in
# $usb_peer, its output in peer.log.
start_usb_peer() {
  modprobe -q -a vhci-hcd cdc-acm usbhid hid-generic evdev joydev 2>/dev/null || true
  ip link set lo up
  wait_until 5 "the host controller vhci_hcd" test -d /sys/devices/platform/vhci_hcd.0
  "$BINARY_DIR/tests/kernel/$1" "${@:2}" >peer.log 2>&1 &
  usb_peer=$!
  wait_until 20 "the USB/IP server" grep -q serving peer.log
}

# attach PORT BUS_ID
attach() { usbip --tcp-port "$1" attach -r 127.0.0.1 -b "$2"; }

# Every port that is in use.
detach_all() {
  local port
  usbip port 2>/dev/null | sed -n 's/^Port \([0-9]*\):.*/\1/p' | while read -r port; do
    usbip detach -p "$port" >/dev/null 2>&1 || true
  done
}

# Tells the peer to unplug its first device, or to plug it in again, and waits until it has.
pull_or_put_back() {
  local before
  before=$(count peer.log '^(un)?plugged')
  kill -USR1 "$usb_peer"
  wait_until 10 "the peer to act" more_plug_messages_than "$before"
}
more_plug_messages_than() { [ "$(count peer.log '^(un)?plugged')" -gt "$1" ]; }

# last_line_is PATTERN: the newest line setting in peer.log.
last_line_is() { grep '^line ' peer.log | tail -n 1 | grep -Eq "$1"; }

# The first serial line on USB.
some_serial_line() {
  local line
  for line in /dev/ttyACM*; do
    if [ -c "$line" ]; then echo "$line" && return 0; fi
  done
  return 1
}

stop_usb_peer() {
  detach_all
  kill "$usb_peer" && wait "$usb_peer"
  tail -n 2 peer.log
}
