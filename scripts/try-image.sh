#!/usr/bin/env bash
# Builds the image of packaging/Containerfile from a Debian package of Rigwire and uses it: a rig, and
# a run of a campaign as an ordinary user. The base is made of Debian's archive, without a registry of
# images. Needs root, mmdebstrap and buildah; leaves the image as localhost/rigwire:trial.
#
#   scripts/try-image.sh PACKAGE.deb
set -euo pipefail

package=$(realpath -e "$1")
source=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
context=$(mktemp -d /tmp/rigwire-image-XXXXXX)
trap 'rm -rf "$context"' EXIT
# Neither overlays nor namespaces, which not every host permits.
export STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot
base=$(sed -n 's/^FROM //p' "$source/packaging/Containerfile")

if [ -z "$(buildah images --quiet "$base" 2>/dev/null)" ]; then
  mmdebstrap --quiet --variant=minbase bookworm "$context/base.tar"
  fresh=$(buildah from scratch)
  buildah add --quiet "$fresh" "$context/base.tar" / >/dev/null
  buildah commit --quiet --rm "$fresh" "docker.io/library/$base" >/dev/null
  rm "$context/base.tar"
fi
cp "$package" "$context"
buildah build --pull-never --quiet -f "$source/packaging/Containerfile" -t rigwire:trial "$context"

container=$(buildah from --pull-never localhost/rigwire:trial)
trap 'rm -rf "$context"; buildah rm "$container" >/dev/null' EXIT
inside() {
  buildah run --user rigwire "$container" -- "$@"
}
[ "$(inside id -un)" = rigwire ]
inside rigwire run excavator_pit --clock free --duration 1s --status none --report /tmp/report.json
inside grep -q '"sim_s": 1.0' /tmp/report.json
inside rigwire campaign run forest_drive --index 17 -o /tmp/drives
inside rigwire campaign collect /tmp/drives | grep -q '199 missing'
echo "the image works: $(buildah images --format '{{.Size}}' localhost/rigwire:trial)"
