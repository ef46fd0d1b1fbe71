# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# A Unimog with its vehicle gateway on vcan0, in real time, commanded by cansend alone: the parking
# brake opens, a gear goes in, the engine takes torque, and the wheels turn.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
configs=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../../configs" && pwd)
cat >rig.yaml <<RIG   # without a lidar: an emulated processor is too slow for its rays
scene: {include: $configs/scenes/road_site.yaml}
machine: {include: $configs/machines/unimog_u5023.yaml}
buses: {can: {interface: $CAN}}
devices:
  vehicle: {type: vehicle-gateway, bus: can, source_address: 0x27, wheelbase: 3.85 m}
RIG
"$BINARY_DIR/rigwire" run rig.yaml --status none --set "scene.terrain.cell=4 m" >rig.log 2>&1 &
rig=$!
expect_line dump ' 18EEFF27#' 60                  # claims its address
expect_line dump ' 08FE6E27#0000000000000000' 20  # wheels stand (HRW)

keep_commanding() { # engine torque 40 % (TSC1), first gear (TC1), parking brake open
  while sleep 0.03; do
    cansend "$CAN" 0C000027#CEFFFFA5FFFFFFFF
    cansend "$CAN" 0C010027#FFFF7EFFFFFFFFFF
    cansend "$CAN" 18EF0027#FCFFFFFFFFFFFFFF
  done
}
keep_commanding &
turning() { grep -Eq ' 08FE6E27#[0-9A-F]{2}0[1-9A-F]' dump; } # above 1 km/h
wait_until 60 "the wheels to turn" turning
echo "seen: $(grep -Em1 ' 08FE6E27#[0-9A-F]{2}0[1-9A-F]' dump)"

kill "$rig" && wait "$rig" || true
tail -n 4 rig.log
