# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The operator's levers exported by USB/IP: an input device with seven axes and sixteen buttons,
# whose events follow the levers.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../usb.sh"

start_usb_peer kernel_usb_peer 3252
attach 3252 1-2
event_of_levers() {
  local name
  for name in /sys/class/input/event*/device/name; do
    if grep -q 'Excavator operator levers' "$name"; then
      name=${name#/sys/class/input/}
      echo "/dev/input/${name%%/*}"
      return 0
    fi
  done
  return 1
}
wait_until 20 "the input device" event_of_levers
device=$(event_of_levers)
wait_until 10 "$device" test -c "$device"
stdbuf -oL evtest "$device" >events &
reader=$!
expect_line events 'Testing \.\.\.' 20 # all that it can do is listed
for axis in ABS_X ABS_Y ABS_Z ABS_RX ABS_RY ABS_RZ ABS_THROTTLE; do
  expect_line events "Event code .*\\($axis\\)" 0
done
expect_line events 'Event code 288 \(BTN_TRIGGER\)' 0
check_range "buttons" "$(count events 'Event code .*\(BTN_|Event code 30[0-9]')" 16 16
expect_line events 'type 3 \(EV_ABS\), code 0 \(ABS_X\), value 32[0-9]{3}' 20
expect_line events 'type 3 \(EV_ABS\), code 0 \(ABS_X\), value -32[0-9]{3}' 20
expect_line events 'type 1 \(EV_KEY\), code 288 \(BTN_TRIGGER\), value 1' 20
expect_line events 'type 1 \(EV_KEY\), code 288 \(BTN_TRIGGER\), value 0' 20
kill "$reader"

lsusb -v -d 1209:0001 >descriptors 2>lsusb.err
expect_line descriptors 'bInterfaceClass +3' 0
expect_line descriptors 'bcdHID +1.11' 0
expect_line descriptors 'wDescriptorLength +53' 0

detach_all
wait_until 20 "the input device to vanish" test ! -e "$device"
stop_usb_peer
