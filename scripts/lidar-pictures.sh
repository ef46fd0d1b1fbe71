#!/usr/bin/env bash
# Draws the lidar pictures of docs/pictures: runs the rigs in real time and looks at their packets.
#
#   scripts/lidar-pictures.sh [OUT_DIRECTORY]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-docs/pictures}
wires=$(mktemp -d)
trap 'rm -rf "$wires"' EXIT

# picture NAME RIG SKIP [--set …]: what the lidar of RIG sees after SKIP revolutions
picture() {
  local name=$1 rig=$2 skip=$3
  shift 3
  build/rigwire run "$rig" --duration $((skip / 10 + 4))s --status none \
    --set "devices.gnss.path=$wires/gnss" --set "buses.can.path=$wires/can" "$@" &
  scripts/picture-lidar.py --view cloud --timeout 60 --skip "$skip" "$out/$name.png"
  wait
}

rain='scene.weather.rain.rate'
picture forest configs/rigs/forest_lidar.yaml 10
picture forest_rain configs/rigs/forest_lidar.yaml 10 --set "$rain=40"
picture pit configs/rigs/excavator_pit.yaml 10
picture pit_dust configs/rigs/excavator_pit.yaml 10
