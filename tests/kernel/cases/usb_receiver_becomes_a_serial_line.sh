# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# A u-blox receiver exported by USB/IP: the kernel makes /dev/ttyACM0 of it, its descriptors and the
# way the line is set pass, gpsd gets a fix, and it can be pulled out and put back.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../usb.sh"

start_usb_peer kernel_usb_peer 3251
usbip --tcp-port 3251 list -r 127.0.0.1 | tee list
grep -q '1-1: .*1546:01a7' list
grep -q '1-2: .*1209:0001' list

attach 3251 1-1
wait_until 20 "the serial line" test -c /dev/ttyACM0
if attach 3251 1-1; then
  echo "FAILED: two clients have one device"
  exit 1
fi

lsusb -v -d 1546:01a7 >descriptors 2>lsusb.err
for line in 'bcdUSB +1.10' 'bcdDevice +1.00' 'iManufacturer +1 u-blox AG - www.u-blox.com' \
  'iProduct +2 u-blox 7 - GPS/GNSS Receiver' 'iSerial +0' 'wTotalLength +0x003e' \
  'bmAttributes +0xc0' 'MaxPower +100mA' 'bNumInterfaces +2' 'bEndpointAddress +0x83 +EP 3 IN' \
  'bEndpointAddress +0x82 +EP 2 IN' 'bEndpointAddress +0x01 +EP 1 OUT' 'bDataInterface +1'; do
  expect_line descriptors "$line" 0
done

stty -F /dev/ttyACM0 raw -echo 57600 parenb cstopb
expect_line peer.log 'line .* 57600 8E2' 10
stty -F /dev/ttyACM0 raw -echo 115200 -parenb -cstopb
exec 3</dev/ttyACM0
expect_line peer.log 'line present 1 dtr 1 rts 1 115200 8N1' 10
timeout 20 head -n 12 <&3 >nmea
expect_line nmea '^.GPRMC,[0-9.]+,A,4925\.' 0
exec 3<&-
wait_until 10 "the receiver to see the line closed" last_line_is 'line present 0 dtr 0'

# -b: else gpsd leaves the receiver in its binary mode.
gpsd -b -N -n -S 2951 /dev/ttyACM0 >gpsd.log 2>&1 &
gpsd=$!
wait_until 20 "gpsd to listen" grep -q ':0B87 ' /proc/net/tcp
gpspipe -w -n 60 127.0.0.1:2951 >reports &
expect_line reports '"class":"TPV".*"mode":3.*"lat":49\.4' 60
kill $gpsd
wait $gpsd || true

pull_or_put_back
wait_until 20 "the serial line to vanish" test ! -e /dev/ttyACM0
if attach 3251 1-1 2>/dev/null; then
  echo "FAILED: a device that is not there was attached"
  exit 1
fi
pull_or_put_back
attach 3251 1-1
wait_until 20 "the serial line to come back" some_serial_line
line=$(some_serial_line)
stty -F "$line" raw -echo
timeout 20 head -n 12 <"$line" >again
expect_line again '^.GPGGA,' 0

stop_usb_peer
