# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# cansend reaches the emulated device: requests are answered, to it and to everybody; requests for
# somebody else, with a wrong length, or for nothing known are not.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
start_peer "socketcan:$CAN" 0x12345
claims() { count dump ' 18EEFF80#4523E16600830080'; }
claims_reach() { [ "$(claims)" -ge "$1" ]; }
before=$(claims)
echo "claims at start-up: $before"

cansend "$CAN" 18EA80F9#00EE00
wait_until 10 "the claim on a request to the device" claims_reach $((before + 1))
cansend "$CAN" 18EAFFF9#00EE00
wait_until 10 "the claim on a request to everybody" claims_reach $((before + 2))

cansend "$CAN" 18EA81F9#00EE00   # to another address
cansend "$CAN" 18EA80F9#00EE     # two bytes
cansend "$CAN" 123#00EE00        # not J1939
cansend "$CAN" 18EA80F9#DAFE00   # software version: the last, so its answer ends the wait
expect_line dump ' [0-9A-F]{2}FEDA80#0101000000' 10
check_range "claims after all" "$(claims)" $((before + 2)) $((before + 2))

kill "$peer" && wait "$peer"
kill "$recorder"
tail -n 8 peer.log
