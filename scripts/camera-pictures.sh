#!/usr/bin/env bash
# Draws the pictures of cameras in docs/pictures with `rigwire picture`: no wire is opened, and the
# same tree draws the same bytes.
#
#   scripts/camera-pictures.sh [OUT_DIRECTORY]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-docs/pictures}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

camera=devices.front_camera
# Colour, 528 x 352 pixels over the width of a 1/1.8 inch sensor, 16 rays each.
view() {
  printf -- '--set\n%s\n' \
    "$camera.sensor.image_sensor={colour: true, width: 528, height: 352, pixel_pitch: 13 um, saturation_capacity: 90000, full_well: 100000}" \
    "$camera.sensor.lens={focal_length: $1, f_number: 4}" "$camera.sensor.samples=16" \
    "$camera.sensor.threads=$(nproc)"
}
# picture NAME RIG [OPTION …]
picture() {
  local name=$1 rig=$2
  shift 2
  build/rigwire picture "$rig" -o "$out/$name.png" "$@"
}

# The excavator from some metres away: the camera of its undercarriage stands beside it.
mapfile -t wide < <(view "5 mm")
beside=(--set "$camera.mount={link: undercarriage, position: [-11 m, -7 m, 2.2 m], rotation: {pitch: 2 deg, yaw: 28 deg}}"
  --set "$camera.sees_own_link=true")
picture camera_pit excavator_vision "${wide[@]}" "${beside[@]}" \
  --set start=2026-06-01T11:30:00Z
picture camera_pit_evening excavator_vision "${wide[@]}" "${beside[@]}" \
  --set start=2026-06-01T18:40:00Z
