#!/usr/bin/env bash
# clang-tidy over the named sources, as the preset tidy compiles them: each alone.
#
#   scripts/tidy.sh FILE...
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p build-tidy
cmake --preset tidy >build-tidy/configure.log 2>&1 || {
  cat build-tidy/configure.log >&2
  exit 1
}
compiled=()
for file in "$@"; do
  if grep -qF "\"file\": \"$PWD/$file\"" build-tidy/compile_commands.json; then compiled+=("$file"); fi
done
if [ ${#compiled[@]} = 0 ]; then
  echo "tidy: none of the named files is in build-tidy/compile_commands.json" >&2
  exit 1
fi
# The compile commands are GCC's: options that clang does not know are not its business here.
printf '%s\0' "${compiled[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p build-tidy \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument \
    2> >(grep -v 'warnings\? generated' >&2)
echo "${#compiled[@]} files are tidy, found in $SECONDS s"
