#!/usr/bin/env bash
# What the loop of a developer costs: rows of the table in CONTRIBUTING.md, one for each ring, a column
# for each commit. CPU is user and system time of all processes, which can be compared between a quiet
# machine and a busy one; wall is the clock's.
#
#   scripts/time-rings.sh [RING,...] [COMMIT...]     first,edits,quick,check of HEAD
#
#   first   build of rigwire and dig_cycle in a fresh clone, without the compiler's cache
#   edits   behind it, the same build after an edit of one header of hil/devices, sim/scene, fields
#   quick   ./check --quick where everything is built
#   check   ./check where everything is built
#   ci      .ci/run in a fresh clone, with the compiler's cache as it is; compared with the parent of
#           the commit
#
# A ring is timed for each commit before the next ring is. Clones are made below TMPDIR (/tmp) and
# removed at the end. The packages of `./check` must be installed.
# shellcheck disable=SC2016  # names of rings are Markdown
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
known=(first edits quick check ci)
rings=first,edits,quick,check
if [ $# -gt 0 ]; then
  case $1 in
    --help | -h)
      sed -n '2,/^# shellcheck/p' "$0" | sed '$d; s/^# \{0,1\}//'
      exit 0
      ;;
  esac
  rings=$1
  shift
fi
IFS=, read -r -a rings <<<"$rings"
for ring in "${rings[@]}"; do
  if [[ " ${known[*]} " != *" $ring "* ]]; then
    echo "time-rings: no ring '$ring', allowed: ${known[*]}" >&2
    exit 2
  fi
done
commits=()
for commit in "${@:-HEAD}"; do
  commits+=("$(git -C "$here" rev-parse --verify --short=8 "$commit^{commit}")")
done

work=$(mktemp -d "${TMPDIR:-/tmp}/rigwire-rings.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
for commit in "${commits[@]}"; do
  git clone --quiet "$here" "$work/$commit"
  git -C "$work/$commit" checkout --quiet --detach "$commit"
done

build() { scripts/build.sh release rigwire dig_cycle; }
edit() { # edit HEADER: a line more, so that no cache knows it
  echo "// Edited at $(date +%s%N)." >>"$1"
  build
}
header_of() { # header_of FOLDER: the one that most files of the product include
  git ls-files "$1/*.h" | while read -r file; do
    echo "$(git grep -lF "\"$file\"" -- '*.cpp' '*.h' ':!tests' | wc -l) $file"
  done | sort -k1,1nr -k2 | awk 'NR == 1 {print $2}'
}
row() { # row NAME COMMAND...: times the command in each commit's clone
  local name=$1 line
  shift
  line="| $name |"
  for commit in "${commits[@]}"; do
    local TIMEFORMAT='%U %S %R' times status=0
    times=$( (
      cd "$work/$commit"
      time "$@" >"$work/$commit.log" 2>&1
    ) 2>&1) || status=$?
    if [ $status != 0 ]; then
      tail -20 "$work/$commit.log" >&2
      echo "time-rings: $name of $commit ended with $status" >&2
    fi
    line+=" $(awk '{printf "%.0f s CPU, %.0f s wall", $1 + $2, $3}' <<<"$(tail -1 <<<"$times")")"
    if [ $status != 0 ]; then line+=" (failed)"; fi
    line+=" |"
  done
  echo "$line"
}
echo "| ring |$(printf ' %s |' "${commits[@]}")"
echo "| --- |$(printf ' --- |%.0s' "${commits[@]}")"
prepared=no
prepare() {
  [ $prepared = no ] || return 0
  for commit in "${commits[@]}"; do (cd "$work/$commit" && scripts/build.sh check >/dev/null); done
  prepared=yes
}
for ring in "${rings[@]}"; do
  case $ring in
    first)
      export CCACHE_DISABLE=1
      for commit in "${commits[@]}"; do rm -rf "$work/$commit/build"; done
      row "first build" build
      unset CCACHE_DISABLE
      ;;
    edits)
      for commit in "${commits[@]}"; do (cd "$work/$commit" && build >/dev/null); done
      export CCACHE_DISABLE=1
      for folder in hil/devices sim/scene fields; do
        header=$(cd "$work/${commits[0]}" && header_of "$folder")
        row "build after an edit of \`$header\`" edit "$header"
      done
      unset CCACHE_DISABLE
      for commit in "${commits[@]}"; do git -C "$work/$commit" checkout --quiet .; done
      ;;
    quick)
      prepare
      row '`./check --quick`, built' ./check --quick
      ;;
    check)
      prepare
      row '`./check`, built' ./check
      ;;
    ci)
      for commit in "${commits[@]}"; do rm -rf "$work/$commit"/build*; done
      row '`.ci/run`, fresh clone' .ci/run 'HEAD^'
      ;;
  esac
done
