# shellcheck shell=bash
# Helpers of the test cases; sourced, after `set -euo pipefail`.

# Whatever a case has started in the background ends with it, failed or not.
# shellcheck disable=SC2046  # one word per process
trap 'kill $(jobs -p) 2>/dev/null || true' EXIT

# A descriptor that never has anything to read: `read` with a time-out waits without a process.
mkfifo nothing
exec {nothing}<>nothing
pause() { read -rt "$1" -u "$nothing" || true; }

# wait_until SECONDS DESCRIPTION COMMAND...: polls until the command succeeds. Fails with the
# description after six times SECONDS: the processor is emulated and shared with other tests.
wait_until() {
  local deadline=$((SECONDS + 6 * $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    if [ $SECONDS -gt "$deadline" ]; then
      echo "FAILED: waited in vain for: $what" >&2
      return 1
    fi
    pause 0.05
  done
}

# record FILE [FILTER...]: starts candump on $CAN into FILE in log format and returns when it
# listens. Its process id is in $recorder.
record() {
  local file=$1 before
  shift
  before=$(listeners)
  stdbuf -oL candump -L "$CAN${1:+,$1}" >"$file" &
  # shellcheck disable=SC2034  # for the caller
  recorder=$!
  wait_until 10 "candump to listen on $CAN" more_listeners_than "$before"
}
# Raw sockets that the kernel has for $CAN, over all its receive lists.
listeners() { cat /proc/net/can/rcvlist_* | grep -c " *$CAN .*raw" || true; }
more_listeners_than() { [ "$(listeners)" -gt "$1" ]; }

# listen_j1939 FILE: prints what the kernel's J1939 stack hears at address 0x20 into FILE; returns
# when the stack follows $CAN. Its process id is in $listener.
listen_j1939() {
  stdbuf -oL testj1939 -B -P -r "$CAN:0x20" >"$1" 2>&1 &
  # shellcheck disable=SC2034  # for the caller
  listener=$!
  wait_until 10 "the J1939 stack to follow $CAN" grep -q "$CAN .*j1939" /proc/net/can/rcvlist_*
}

# expect_line FILE PATTERN SECONDS: FILE has or will have a line that matches.
expect_line() {
  if wait_until "$3" "a line like '$2' in $1" grep -Eq "$2" "$1"; then
    echo "seen: $(grep -Em1 "$2" "$1")"
  else
    echo "$1 holds:"
    tail -n 20 "$1"
    return 1
  fi
}

# start_peer ADDRESS [SERIAL]: runs an emulated OpenIMU335RI (kernel_can_peer) and waits until it
# has claimed its address in FILE dump, which `record dump` fills. Its process id is in $peer.
start_peer() {
  "$BINARY_DIR/tests/kernel/kernel_can_peer" "$@" >peer.log 2>&1 &
  # shellcheck disable=SC2034  # for the caller
  peer=$!
  wait_until 20 "the address claim" grep -q ' 18EEFF8[0-9A-F]#' dump
}

# count FILE PATTERN
count() { grep -Ec "$2" "$1" || true; }

# field FRAME_LINE FIRST_BYTE BYTES: little-endian unsigned number out of a candump log line.
field() {
  local data=${1##*#} hex='' byte
  for ((byte = $2 + $3 - 1; byte >= $2; byte--)); do hex+=${data:byte*2:2}; done
  echo $((16#$hex))
}

# check_range DESCRIPTION VALUE LOWER UPPER
check_range() {
  echo "$1: $2 (allowed $3 to $4)"
  if [ "$2" -lt "$3" ] || [ "$2" -gt "$4" ]; then
    echo "FAILED: $1 is out of range"
    return 1
  fi
}
