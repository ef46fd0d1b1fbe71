#!/usr/bin/env bash
# Configures a preset of CMakePresets.json if it is not yet, and builds it.
#
#   scripts/build.sh PRESET [TARGET...]
#
# `release` and `check` share the folder build/: once `check` has added the tests to it, they stay.
# That first `check` builds again what `release` built, since only it has the compiler's warnings.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=$1
shift
case $preset in
  release | check) directory=build ;;
  *) directory=build-$preset ;;
esac

# Ninja configures again by itself when a CMake file has changed. A cache of another source
# directory (a copied or moved clone) cannot be used.
if [ -e "$directory/CMakeCache.txt" ] &&
  ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$directory/CMakeCache.txt"; then
  echo "$directory was made for another place; configuring it anew"
  rm -rf "$directory/CMakeCache.txt" "$directory/CMakeFiles" "$directory/build.ninja"
fi
without_tests() { # whether what ninja knows of the folder are the programs alone
  [ ! -e "$directory/tests/CTestTestfile.cmake" ] ||
    ! grep -qx 'RIGWIRE_TESTS:BOOL=ON' "$directory/CMakeCache.txt"
}
if [ ! -e "$directory/build.ninja" ] || { [ "$preset" = check ] && without_tests; }; then
  mkdir -p "$directory"
  if ! cmake --preset "$preset" >"$directory/configure.log" 2>&1; then
    cat "$directory/configure.log" >&2
    exit 1
  fi
fi
# Embree- and Eigen-heavy sources take about 1.5 GB each: no more jobs than memory allows.
jobs=$(nproc)
memory_gb=$(awk '/MemAvailable/ {print int($2 / 1000000)}' /proc/meminfo)
if [ $((memory_gb * 2 / 3)) -lt "$jobs" ]; then jobs=$((memory_gb * 2 / 3)); fi
if [ "$jobs" -lt 1 ]; then jobs=1; fi
# Progress for a person at a terminal; only warnings and errors in a log.
if [ -t 1 ]; then
  NINJA_STATUS='building %f of %t  ' ninja -C "$directory" -j "$jobs" "$@"
else
  ninja --quiet -C "$directory" -j "$jobs" "$@" | { grep -v '^ninja: no work to do' || true; }
fi
