# shellcheck shell=bash source=tests/kernel/common.sh
# candump sees what cansend sends: 11-bit, 29-bit, empty and remote frames, in order and unchanged.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

record dump
sent=(123#DEADBEEF 18EAFF80#00EE00 7FF# 0CF02A80#007D007D007D3F00 321#R)
for frame in "${sent[@]}"; do cansend "$CAN" "$frame"; done
expect_line dump "321#R" 5
kill "$recorder"

awk '{print $3}' dump >seen
printf '%s\n' "${sent[@]}" >expected
diff -u expected seen
echo "${#sent[@]} frames passed unchanged"
