# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# A whole rig with `wire: auto` on a kernel without its vcan but with vhci-hcd: it attaches the
# adapter of its bus by itself, and the client finds a canX on which the Unimog speaks and answers.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../gs_usb.sh"

need_gs_usb
# Without a lidar: an emulated processor casts rays slower than real time.
cat >rig.yaml <<RIG
name: Unimog without a lidar
machine: {include: $BINARY_DIR/../configs/machines/unimog_u5023.yaml, on_ground: true}
buses:
  can: {wire: auto, interface: no_such_can, bitrate: 250000}
usb: {port: 33250}
devices:
  imu: {type: openimu335ri, bus: can, source_address: 0x80, serial: 1, mount: {link: body}}
  vehicle: {type: vehicle-gateway, bus: can, serial: 2}
RIG
"$BINARY_DIR/rigwire" run rig.yaml --duration 5min --status none --report report.json >rig.log 2>&1 &
rig=$!
wait_until 60 "the CAN interface" gs_usb_interface
CAN=$(gs_usb_interface)
ip link set "$CAN" type can bitrate 250000
ip link set "$CAN" up
record dump
expect_line dump ' 0CF02980#' 30
expect_line dump ' 18FEF100#' 30
cansend "$CAN" 18EA00F9#00EE00
expect_line dump ' 18EEFF00#' 20
ip -details -statistics link show "$CAN" | grep -o 'state ERROR-ACTIVE'
kill "$recorder"
kill -INT "$rig"
wait "$rig" || [ $? = 130 ]
expect_line report.json '"wire": "gs_usb on usb 127.0.0.1:33250 1-1"' 0
