#!/usr/bin/env bash
# Do two builds of rigwire send the same bytes? Runs every rig of configs/rigs/ and tests/hil/streams/
# with both under the free clock, on wires of its own, and compares each device's stream. Then shows
# what differs in the texts that they print: descriptions, plans, configurations.
#
#   scripts/compare-streams.sh [--duration 20s] [--rigs PATTERN] OLD NEW
#
#   OLD, NEW    programs, or build folders with a program `rigwire`
#   --duration  simulated time of each run
#   --rigs      only rigs whose path matches this regular expression
#
# Both read the files of the tree in which this script stands; a rig that OLD cannot read is read
# from the tree around OLD's build folder, where there is one. No client is attached: what a device
# only answers, on Modbus or USB for example, is not compared. Exit code: 0 equal, 1 streams differ,
# 2 usage; a difference of texts alone is no failure.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
usage() {
  sed -n '2,/^set -euo/p' "${BASH_SOURCE[0]}" | sed '$d; s/^# \{0,1\}//'
}
refuse() {
  echo "compare-streams.sh: $1 (--help)" >&2
  exit 2
}

duration=20s
pattern=.
programs=()
while [ $# -gt 0 ]; do
  case $1 in
    --help | -h)
      usage
      exit 0
      ;;
    --duration | --rigs)
      [ $# -ge 2 ] || refuse "$1 wants a value"
      if [ "$1" = --duration ]; then duration=$2; else pattern=$2; fi
      shift
      ;;
    -*) refuse "unknown option $1" ;;
    *) programs+=("$1") ;;
  esac
  shift
done
[ ${#programs[@]} = 2 ] || refuse "two builds are wanted, found ${#programs[@]}"

program_of() { # program_of FOLDER_OR_PROGRAM: its absolute path
  local path=$1
  if [ -d "$path" ]; then path=$path/rigwire; fi
  [ -x "$path" ] || refuse "no program at $path"
  realpath "$path"
}
old=$(program_of "${programs[0]}")
new=$(program_of "${programs[1]}")

cd "$root"
mapfile -t rigs < <(printf '%s\n' configs/rigs/*.yaml tests/hil/streams/*.yaml | grep -E -e "$pattern")
[ ${#rigs[@]} -gt 0 ] || refuse "no rig matches $pattern"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# private_wires CONFIGURATION FOLDER: for a printed configuration, the settings (KEY.PATH=VALUE, one
# per line) that take its wires away from what else runs on the machine.
private_wires() {
  python3 - "$1" "$2" <<'PYTHON'
import re
import socket
import sys

configuration, folder = sys.argv[1:]
used = set()


def free_port():
    """One that is free for TCP and UDP, and was not given out before."""
    while True:
        with socket.socket() as tcp, socket.socket(type=socket.SOCK_DGRAM) as udp:
            tcp.bind(("127.0.0.1", 0))
            port = tcp.getsockname()[1]
            try:
                udp.bind(("127.0.0.1", port))
            except OSError:
                continue
        if port not in used:
            used.add(port)
            return port


keys = []
with open(configuration, encoding="utf-8") as lines:
    for line in lines:
        match = re.match(r"( *)([A-Za-z0-9_-]+): *([^#]*)", line)
        if not match:
            continue
        keys[len(match[1]) // 2:] = [match[2]]
        key, value = ".".join(keys), match[3].strip().strip('"')
        if keys[0] not in ("buses", "modbus", "usb", "devices") or not value:
            continue
        if keys[0] == "buses" and keys[-1] == "wire" and value in ("auto", "socketcan"):
            print(f"{key}=slcan")
        elif keys[-1] == "path":
            print(f"{key}={folder}/{key}")
        elif re.fullmatch(r"(.*_)?port", keys[-1]) and value != "0":
            print(f"{key}={free_port()}")
PYTHON
}

# compare_reports OLD NEW: one line, and for each difference another; 1 when there is one.
compare_reports() {
  python3 - "$1" "$2" <<'PYTHON'
import json
import sys

reports = []
for path in sys.argv[1:]:
    with open(path, encoding="utf-8") as file:
        reports.append(json.load(file))
old, new = reports
differences = [(key, old[key], new[key]) for key in ("config_hash", "sim_s", "fault")
               if old[key] != new[key]]
for name in sorted(old["devices"].keys() | new["devices"].keys()):
    devices = [report["devices"].get(name) for report in reports]
    if None in devices:
        differences.append((name, *("there" if device else "not there" for device in devices)))
        continue
    for key in ("frames", "bytes", "dropped", "stream_hash"):
        values = [device[key] for device in devices]
        if values[0] != values[1]:
            differences.append((f"{name} {key}", *values))
frames = sum(device["frames"] for device in new["devices"].values())
print(f"{'DIFFERENT' if differences else 'equal'}: {len(new['devices'])} devices, {frames} frames, "
      f"configuration {new['config_hash']}")
for what, before, after in differences:
    print(f"  {what}: {before} -> {after}")
sys.exit(1 if differences else 0)
PYTHON
}

# run_one PROGRAM RIG REPORT SETTING...: its output in REPORT.log
run_one() {
  local program=$1 rig=$2 report=$3 setting sets=()
  shift 3
  for setting in "$@"; do sets+=(--set "$setting"); done
  timeout 1800 "$program" run "$rig" --clock free --duration "$duration" --status none \
    --report "$report" "${sets[@]}" >"$report.log" 2>&1 </dev/null
}

old_tree=$(dirname "$(dirname "$old")")
old_rig() { # old_rig RIG: the file that OLD is to read
  if ! "$old" check "$1" >/dev/null 2>&1 && [ -e "$old_tree/$1" ]; then
    echo "$old_tree/$1"
  else
    echo "$1"
  fi
}

differing=0
for rig in "${rigs[@]}"; do
  wires=$work/$(basename "$rig" .yaml)
  mkdir -p "$wires"
  if ! "$new" check "$rig" --print >"$wires/configuration" 2>"$wires/problems"; then
    echo "$rig: DIFFERENT: NEW cannot read it"
    sed 's/^/  /' "$wires/problems"
    differing=$((differing + 1))
    continue
  fi
  mapfile -t settings < <(private_wires "$wires/configuration" "$wires")
  read_by_old=$(old_rig "$rig")
  note=
  if [ "$read_by_old" != "$rig" ]; then note=" (OLD reads its own)"; fi
  failed=
  run_one "$old" "$read_by_old" "$wires/old.json" "${settings[@]}" || failed=old
  run_one "$new" "$rig" "$wires/new.json" "${settings[@]}" || failed=new
  if [ -n "$failed" ]; then
    echo "$rig: DIFFERENT: ${failed^^} does not run$note"
    tail -n 5 "$wires/$failed.json.log" | sed 's/^/  /'
    differing=$((differing + 1))
  elif verdict=$(compare_reports "$wires/old.json" "$wires/new.json"); then
    echo "$rig: $verdict$note"
  else
    echo "$rig: $verdict$note"
    differing=$((differing + 1))
  fi
done

# What both print of devices, machines and rigs.
types() { # types PROGRAM: of devices, and the topologies of machines
  "$1" list devices | cut -d' ' -f1
  sed -n 's/^type: *\([a-z_]*\).*/\1/p' configs/machines/*.yaml | sort -u
}
texts() { # texts PROGRAM FILE
  local program=$1 type rig
  while read -r type; do
    echo "== describe $type"
    "$program" describe "$type" 2>&1 || true
  done < <({ types "$old" && types "$new"; } | awk '!seen[$0]++') >"$2"
  for rig in "${rigs[@]}"; do
    if [ "$program" = "$old" ]; then rig=$(old_rig "$rig"); fi
    echo "== run $rig --dry-run"
    "$program" run "$rig" --dry-run 2>&1 || true
    echo "== check $rig --print"
    "$program" check "$rig" --print 2>&1 || true
  done >>"$2"
}
texts "$old" "$work/old.txt"
texts "$new" "$work/new.txt"
if diff -u --label OLD --label NEW "$work/old.txt" "$work/new.txt"; then
  echo "texts: equal"
else
  echo "texts: different, see above"
fi
echo "${#rigs[@]} rigs, $differing with different streams"
[ $differing = 0 ]
