#!/usr/bin/env bash
# Draws the pictures of cameras in docs/pictures with `rigwire picture`: no wire is opened, and the
# same tree draws the same bytes.
#
#   scripts/camera-pictures.sh [OUT_DIRECTORY [NAME …]]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-docs/pictures}
only=" ${*:2} "
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
rigwire=${RIGWIRE:-build/rigwire}

# picture NAME RIG [OPTION …]
picture() {
  local name=$1
  shift
  case $only in
    "  " | *" $name "*) "$rigwire" picture "$@" -o "$out/$name.png" ;;
  esac
}

# A colour sensor of 528 x 352 pixels and a lens of 72 degrees across, four rays per pixel.
colour="{colour: true, width: 528, height: 352, pixel_pitch: 9 um, saturation_capacity: 60000, full_well: 70000}"
eye() { # CAMERA: its options, by lines
  printf -- '--set\n%s\n' "$1.image_sensor=$colour" "$1.lens={focal_length: 3.3 mm, f_number: 4}" \
    "$1.samples=4" "$1.threads=2"
}

# A camera on a mast in the pit, the excavator in front of it.
cat >"$work/pit.yaml" <<YAML
include: $PWD/configs/rigs/excavator_pit.yaml
devices:
  eye:
    type: gige-camera
    rate: 10 Hz
    exposure_auto: true
    sees_own_link: true
    mount:
      link: undercarriage
      position: [-11 m, -7 m, 2.2 m]
      rotation: {pitch: 2 deg, yaw: 28 deg}
YAML
mapfile -t options < <(eye devices.eye.sensor)
picture camera_pit "$work/pit.yaml" "${options[@]}" --set start=2026-06-01T12:30:00Z
picture camera_pit_evening "$work/pit.yaml" "${options[@]}" --set start=2026-06-01T18:25:00Z

# A mesh with a texture: the haul truck's side.
picture camera_truck "$work/pit.yaml" "${options[@]}" --set start=2026-06-01T12:30:00Z \
  --set 'devices.eye.mount={link: undercarriage, position: [-6.5 m, 0.5 m, 2.6 m], rotation: {yaw: 56 deg, pitch: 4 deg}}'

# The Unimog's own camera in the forest of leaves, in fog.
cat >"$work/forest.yaml" <<YAML
include: $PWD/configs/rigs/unimog_vision.yaml
scene:
  include: $PWD/configs/scenes/forest.yaml
  trees: []
  soil_regions: []
  daylight: {cloud_cover: 1}
  weather: {course: [{fog_visibility: 70 m}]}
YAML
mapfile -t options < <(eye devices.front_camera.sensor)
picture camera_forest_fog "$work/forest.yaml" --device front_camera "${options[@]}"

# Back from the Unimog's roof at the dust that it raises.
picture camera_dust unimog_vision --device front_camera "${options[@]}" --at 8s --travel 40km/h \
  \
  --set 'scene.weather.course=[{dryness: 10, wind: 1 m/s}]' \
  --set 'devices.front_camera.mount={link: body, position: [0 m, 0 m, 2.9 m], rotation: {yaw: 180 deg, pitch: 6 deg}}'

# The stereo camera over the working face: what it sees, what it matches, what is true.
for layer in image disparity depth; do
  picture "camera_stereo_$layer" excavator_vision --device stereo --layer "$layer" \
    --set start=2026-06-01T13:00:00Z --set devices.stereo.mount.rotation.pitch=6deg \
    --set devices.stereo.sensor.auto_exposure.target=20%
done

# All round from the mast over the cabin.
picture camera_panorama excavator_vision --device surround --set start=2026-06-01T13:00:00Z \
  --set devices.surround.sensor.image_sensor.colour=true \
  --set devices.surround.sensor.auto_exposure.target=20%
