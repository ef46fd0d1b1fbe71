# shellcheck shell=bash
# Helpers of the cases with a USB to CAN adapter; sourced after common.sh.

USBIP=$(PATH=$PATH:/usr/sbin:/sbin command -v usbip)

# need_gs_usb: loads the modules where the kernel has them and they are not built into the image.
need_gs_usb() {
  modprobe -q -a vhci-hcd gs_usb 2>/dev/null || true
  [ -d /sys/devices/platform/vhci_hcd.0 ] || {
    echo "FAILED: this kernel has no vhci-hcd"
    return 1
  }
}

# start_adapter PORT: serves the bus with the emulated adapter; its process id is in $peer.
start_adapter() {
  "$BINARY_DIR/tests/kernel/kernel_gs_usb_peer" "$1" >peer.log 2>&1 &
  # shellcheck disable=SC2034  # for the caller
  peer=$!
  wait_until 10 "the USB/IP server" grep -q '^serving 1-1' peer.log
}

# attach_adapter PORT: the kernel takes the adapter; sets CAN to the interface that it makes.
attach_adapter() {
  "$USBIP" --tcp-port "$1" attach -r 127.0.0.1 -b 1-1
  wait_until 20 "the CAN interface" gs_usb_interface
  CAN=$(gs_usb_interface)
}
# The interface whose driver is gs_usb.
gs_usb_interface() {
  local device
  for device in /sys/class/net/*; do
    if [ "$(basename "$(readlink -f "$device/device/driver" 2>/dev/null)")" = gs_usb ]; then
      basename "$device"
      return
    fi
  done
  return 1
}

# end_adapter: ends the peer and prints what it counted.
end_adapter() {
  kill "$peer" && wait "$peer"
  tail -n 1 peer.log
}
# counted NAME: a number of the peer's last line.
counted() { tail -n 1 peer.log | grep -oE "(^| )$1 [0-9]+" | grep -oE '[0-9]+'; }
