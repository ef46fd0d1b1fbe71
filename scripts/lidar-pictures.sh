#!/usr/bin/env bash
# Draws the clouds of docs/pictures: runs the rigs in real time and looks at their packets. Nothing
# else may run on the rigs' wires meanwhile.
#
#   scripts/lidar-pictures.sh [OUT_DIRECTORY]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-docs/pictures}

# cloud NAME RIG SKIP FIELD_PROGRAM EYE LOOK [--set …]: what the lidar of RIG sees after SKIP
# revolutions, from EYE towards LOOK (ahead, left, up in metres)
cloud() {
  local name=$1 rig=$2 skip=$3 program=$4 eye=$5 look=$6
  shift 6
  build/rigwire run "configs/rigs/$rig.yaml" --duration $((skip / 10 + 5))s --status none "$@" &
  sleep 2
  [ -z "$program" ] || timeout $((skip / 10 + 2)) $program >/dev/null 2>&1 &
  # shellcheck disable=SC2086 # three numbers each
  scripts/picture-lidar.py --view cloud --timeout 60 --skip "$skip" --eye $eye --look $look \
    "$out/$name.png"
  wait
}

behind="-14 0 9"
ahead="12 0 -2"
cloud forest forest_lidar 20 "" "$behind" "$ahead"
cloud forest_rain forest_lidar 20 "" "$behind" "$ahead" \
  --set 'scene.weather.course=[{rain: 50 mm/h}]'
cloud pit excavator_pit 20 "" "$behind" "$ahead"
# Looks back at the dust behind the wheels, from a lidar over the rear axle; path_follow needs none.
cloud forest_dust unimog_forest 160 \
  "build/path_follow --path configs/paths/forest_track.csv --antenna 3.2,0" "8 0 5" "-10 0 -2" \
  --set 'scene.weather.course=[{dryness: 10, wind: 1 m/s}]' \
  --set 'devices.lidar.mount.position=[-0.3 m, 0 m, 2.6 m]' --set devices.lidar.sensor.sub_rays=5
