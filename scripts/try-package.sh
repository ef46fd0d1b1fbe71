#!/usr/bin/env bash
# Installs a Debian package of Rigwire into a root of its own and uses it from there. What it depends
# on is this machine's: a version that is missing here is an error.
#
#   scripts/try-package.sh PACKAGE.deb
set -euo pipefail

package=$(realpath -e "$1")
root=$(mktemp -d /tmp/rigwire-package-XXXXXX)
trap 'rm -rf "$root"' EXIT

fail() {
  echo "FAILED: $*"
  exit 1
}

# Each dependency by name and least version: "libfmt9 (>= 9.1.0+ds1)".
dpkg-deb --field "$package" Depends | tr ',' '\n' | while read -r name version; do
  installed=$(dpkg-query --show --showformat='${Version}' "$name" 2>/dev/null) ||
    fail "it needs $name, which is not installed"
  if [ -n "$version" ]; then
    read -r relation wanted <<<"$(tr -d '()' <<<"$version")"
    dpkg --compare-versions "$installed" "$relation" "$wanted" ||
      fail "it needs $name $version, installed is $installed"
  fi
done

mkdir -p "$root/var/lib/dpkg/updates" "$root/var/lib/dpkg/info"
touch "$root/var/lib/dpkg/status"
dpkg --root="$root" --force-depends --force-not-root --force-script-chrootless --log=/dev/null \
  --install "$package" >"$root/dpkg.txt" 2>&1 || {
  cat "$root/dpkg.txt"
  fail "dpkg does not install it"
}
[ "$(dpkg --root="$root" --verify rigwire)" = "" ] || fail "files differ from their sums"

cd "$root" # away from any source tree
rigwire=$root/usr/bin/rigwire
"$rigwire" list rigs --json | grep -q "\"$root/usr/share/rigwire/configs/rigs/excavator_pit.yaml\"" ||
  fail "rigwire does not take its own rigs"
"$rigwire" check excavator_pit
"$rigwire" run excavator_pit --clock free --duration 1s --isolated "$root/run" --status none
grep -q '"sim_s": 1.0' "$root/run/report.json" || fail "the run left no report"
[ "$("$rigwire" campaign expand forest_drive | wc -l)" = 201 ] || fail "the campaign has other runs"
[ -x "$root/usr/libexec/rigwire/path_follow" ] || fail "there is no field program"

complaints=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings --local-file \
  "$root/usr/share/man/man1/rigwire.1.gz" 2>&1 >"$root/page.txt")
[ -z "$complaints" ] || fail "the manual page: $complaints"
for word in 'rigwire campaign' '--isolated' 'Exit codes'; do
  grep -q -e "$word" "$root/page.txt" || fail "the manual page does not tell of $word"
done
if command -v systemd-analyze >/dev/null; then
  mkdir "$root/units"
  sed "s|/usr/bin/rigwire|$rigwire|" "$root/usr/lib/systemd/user/rigwire@.service" \
    >"$root/units/rigwire@excavator_pit.service"
  said=$(XDG_RUNTIME_DIR=$root systemd-analyze --user --man=no verify \
    "$root/units/rigwire@excavator_pit.service" 2>&1) && [ -z "$said" ] || fail "the unit: $said"
fi
if command -v lintian >/dev/null; then
  # There is no changelog of Debian's, and no address to write to.
  lintian --fail-on error --suppress-tags no-changelog,bogus-mail-host --allow-root "$package" ||
    fail "lintian finds errors"
fi
echo "$(basename "$package"): installed, $(du -sm "$root/usr" | cut -f1) MB, and used"
