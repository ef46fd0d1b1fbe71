#!/usr/bin/env bash
# Configures a preset of CMakePresets.json if it is not yet, and builds it.
#
#   scripts/build.sh PRESET [TARGET...]
#
# `release` and `check` share the folder build/ and all objects in it: `check` adds the tests, and
# they stay. A terminal shows one line that moves, a log a line each ten per cent.
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
without_tests() { # whether ninja knows only the programs of the folder
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
# A group of sources takes up to 3 GB: no more jobs than memory allows.
jobs=$(nproc)
memory_gb=$(awk '/MemAvailable/ {print int($2 / 1000000)}' /proc/meminfo)
if [ $((memory_gb / 3)) -lt "$jobs" ]; then jobs=$((memory_gb / 3)); fi
if [ "$jobs" -lt 1 ]; then jobs=1; fi

# What is to come, of a folder in which nothing was built yet. A step takes about 8 s of a processor.
if [ ! -e "$directory/.ninja_log" ]; then
  ninja -C "$directory" --quiet build.ninja
  steps=$(ninja -C "$directory" -t commands "$@" | wc -l)
  echo "Building in $steps steps, $jobs at a time: about $(((steps * 8 / jobs + 59) / 60)) min," \
    "less where the compiler's cache has some of them"
fi
if [ -t 1 ]; then
  NINJA_STATUS='building %f of %t  ' ninja -C "$directory" -j "$jobs" "$@"
  exit
fi
# Ninja's own lines are marked, so that all others (warnings, errors) pass.
NINJA_STATUS=$'\x01%f %t ' ninja -C "$directory" -j "$jobs" "$@" 2>&1 | awk '
  /^\001/ {
    done = substr($1, 2)
    if ($2 > 9 && int(10 * done / $2) > tenth) {
      tenth = int(10 * done / $2)
      sub(/^[^ ]+ [^ ]+ /, "")
      printf "building, %d %%: %s\n", 10 * tenth, $0
      fflush()
    }
    next
  }
  /^ninja: (no work to do|Entering directory)/ { next }
  { print; fflush() }'
