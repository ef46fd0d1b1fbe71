#!/usr/bin/env bash
# Installs what is missing of the lists of packages.txt that are named. Says nothing and takes no
# rights when nothing is.
#
#   scripts/install-packages.sh LIST...            for example: build test
#   scripts/install-packages.sh --print LIST...    prints the lists' packages, installs nothing
#
# Some packages bring a daemon (gpsd). Whether it starts on installation is decided by the
# machine's own policy; so that this script starts none, it installs with a policy of its own that
# forbids it where the machine has no policy, and takes it away again afterwards. A gpsd that was
# not there before is also left disabled: the tests start their own on their own ports.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# packages_of LIST: what stands under [LIST].
packages_of() {
  sed 's/#.*//; s/[[:space:]]//g; /^$/d' "$root/packages.txt" |
    awk -v list="[$1]" '/^\[/ {inside = $0 == list; next} inside'
}

print=no
if [ "${1:-}" = --print ]; then
  print=yes
  shift
fi
if [ $# = 0 ]; then
  echo "install-packages: no list, allowed: $(sed -n 's/^\[\(.*\)\].*/\1/p' "$root/packages.txt" | xargs)" >&2
  exit 2
fi
wanted=()
for list in "$@"; do
  mapfile -t of_list < <(packages_of "$list")
  if [ ${#of_list[@]} = 0 ]; then
    echo "install-packages: packages.txt has no list '$list'" >&2
    exit 2
  fi
  wanted+=("${of_list[@]}")
done
if [ $print = yes ]; then
  printf '%s\n' "${wanted[@]}"
  exit 0
fi
# Whatever is installed, and what that provides: a nodejs from elsewhere has its own npm. Of packages that
# it never saw dpkg-query says nothing when it is asked for all.
installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}, ${Provides}\n' |
  sed -n 's/^installed //p' | tr ',' '\n' | sed 's/(.*//; s/[[:space:]]//g')
missing=()
for package in "${wanted[@]}"; do
  grep -qxF "$package" <<<"$installed" || missing+=("$package")
done
if [ ${#missing[@]} = 0 ]; then exit 0; fi

# shellcheck disable=SC1091  # a file of the system
system=$(. /etc/os-release 2>/dev/null && echo "${ID:-unknown} ${VERSION_ID:-}") || system=unknown
if [ "$system" != "debian 12" ]; then
  echo "This is ${system}; the package list is made for Debian 12 (bookworm)." >&2
  echo "Install the equivalents of these yourself, or run in a debian:12 container:" >&2
  echo "  ${missing[*]}" >&2
  exit 3
fi

as_root=()
if [ "$(id -u)" != 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "These packages are missing, and there is neither root nor sudo to install them:" >&2
    echo "  ${missing[*]}" >&2
    echo "As root: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 3
  fi
  as_root=(sudo)
fi

echo "Installing ${#missing[@]} packages: ${missing[*]}"
policy=/usr/sbin/policy-rc.d
policy_is_ours=no
remove_policy() {
  if [ $policy_is_ours = yes ]; then "${as_root[@]}" rm -f "$policy"; fi
}
trap remove_policy EXIT
if [ ! -e "$policy" ]; then
  policy_is_ours=yes
  # 101: action forbidden by policy (invoke-rc.d).
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$policy" >/dev/null
  "${as_root[@]}" chmod 755 "$policy"
fi
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0
  -o DPkg::Lock::Timeout=300)
"${apt[@]}" update
# What is to come: with what these packages need.
"${apt[@]}" --assume-no install --no-install-recommends "${missing[@]}" 2>/dev/null |
  grep -E '^(Need to get|After this operation)|newly installed' || true
"${apt[@]}" install --no-install-recommends "${missing[@]}"

if [[ " ${missing[*]} " == *" gpsd "* ]] && [ -d /run/systemd/system ]; then
  "${as_root[@]}" systemctl disable --now gpsd.socket gpsd.service >/dev/null 2>&1 || true
fi
