# shellcheck shell=bash
# Helpers of the test cases; sourced, after `set -euo pipefail`.

# wait_until SECONDS DESCRIPTION COMMAND...: polls until the command succeeds; fails with the
# description when it has not within the time.
wait_until() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    if [ $SECONDS -gt "$deadline" ]; then
      echo "FAILED: waited in vain for: $what" >&2
      return 1
    fi
    sleep 0.05
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
