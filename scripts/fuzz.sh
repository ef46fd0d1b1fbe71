#!/usr/bin/env bash
# Runs every fuzz target of build-fuzz for FUZZ_SECONDS (60), two at a time, starting from the
# inputs under tests/fuzz/corpus/<name>/. What libFuzzer finds grows in build-fuzz/corpus/<name>/; a
# crash is left in build-fuzz/crashes/ and belongs, once understood, in tests/fuzz/corpus/<name>/
# under the name of the defect.
#
#   scripts/fuzz.sh [FILTER]
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
filter=${1:-}
seconds=${FUZZ_SECONDS:-60}
mkdir -p build-fuzz/crashes build-fuzz/fuzz-logs

fuzz_one() { # fuzz_one PROGRAM SECONDS
  local name grown log status=0
  name=$(basename "$1" _fuzz)
  grown=build-fuzz/corpus/$name
  log=build-fuzz/fuzz-logs/$name.log
  mkdir -p "$grown"
  local seeds=()
  if [ -d "tests/fuzz/corpus/$name" ]; then seeds=("tests/fuzz/corpus/$name"); fi
  "$1" -max_total_time="$2" -max_len=4096 -timeout=5 -rss_limit_mb=1024 -print_final_stats=1 \
    -artifact_prefix="build-fuzz/crashes/$name-" "$grown" "${seeds[@]}" >"$log" 2>&1 || status=$?
  if [ $status = 0 ]; then
    awk -v name="$name" '/stat::number_of_executed_units/ {units = $2}
      / cov: / {for (i = 1; i < NF; i++) if ($i == "cov:") coverage = $(i + 1)}
      END {printf "%-32s %10d inputs, coverage %d\n", name, units, coverage}' "$log"
  else
    echo "$name FAILED (exit status $status):"
    tail -n 40 "$log"
  fi
  return $status
}
export -f fuzz_one

mapfile -t programs < <(find build-fuzz/tests/fuzz -maxdepth 1 -name '*_fuzz' -type f -executable |
  grep -e "${filter:-.}" | sort)
if [ ${#programs[@]} = 0 ]; then
  echo "fuzz: no target matches '${filter}'" >&2
  exit 1
fi
printf '%s\0' "${programs[@]}" |
  xargs -0 -P 2 -I '{}' bash -c 'fuzz_one "$@" || exit 1' fuzz_one '{}' "$seconds"
echo "${#programs[@]} fuzz targets ran ${seconds} s each and found nothing"
