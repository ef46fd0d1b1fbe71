#!/usr/bin/env bash
# Prints what each package of a list of packages.txt adds to those above it, in MB (10^6 bytes) to
# download and installed, and their sums. The figures beside the list [build] come from here.
#
#   scripts/package-costs.sh ROOT [LIST]
#
#   ROOT  a bare Debian bookworm: debootstrap --variant=minbase bookworm ROOT, with apt-get update and
#         apt-get upgrade run in it. Nothing is installed there.
#   LIST  build (the default) or test
#
# Needs root, for chroot.
set -euo pipefail

if [ $# -lt 1 ] || [ $# -gt 2 ] || [ ! -e "$1/etc/debian_version" ]; then
  sed -n '2,/^set -euo/p' "${BASH_SOURCE[0]}" | sed '$d; s/^# \{0,1\}//' >&2
  exit 2
fi
root=$1 list=${2:-build}
mapfile -t packages < <("$(dirname "${BASH_SOURCE[0]}")/install-packages.sh" --print "$list")
[ ${#packages[@]} -gt 0 ]

# sizes_of PACKAGE...: bytes to download, and bytes installed, of these and all that they bring.
sizes_of() {
  local installs
  mapfile -t installs < <(LC_ALL=C chroot "$root" apt-get install --no-install-recommends \
    --simulate -qq "$@" | sed -n 's/^Inst \([^ ]*\) (\([^ ]*\) .*/\1=\2/p')
  chroot "$root" apt-cache show --no-all-versions "${installs[@]}" |
    awk '/^Size:/ {download += $2} /^Installed-Size:/ {installed += $2}
      END {printf "%d %d\n", download, installed * 1024}'
}

for ((i = 1; i <= ${#packages[@]}; ++i)); do
  echo "${packages[i - 1]} $(sizes_of "${packages[@]:0:i}")"
done | awk 'BEGIN {printf "%-24s %9s %10s\n", "MB", "download", "installed"}
  {printf "%-24s %9.1f %10.1f\n", $1, ($2 - download) / 1e6, ($3 - installed) / 1e6
   download = $2; installed = $3}
  END {printf "%-24s %9.0f %10.0f\n", "all", download / 1e6, installed / 1e6}'
