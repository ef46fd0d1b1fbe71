# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# `rigwire conform j1939` against the kernel's own J1939: transport is the kernel's, the address
# can-utils' j1939acd's. What deviates is the kernel's, read by a person (docs/conformance.md), and
# nothing else does. Cases that judge this machine's pace are left out.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

name=80002100f5601234 # may take any address
record dump
python3=/usr/bin/python3 # Debian's, which knows J1939 sockets
j1939acd -r 128-136 -c node.cache $name "$CAN" >claims.log 2>&1 &
$python3 "$(dirname "${BASH_SOURCE[0]}")/../kernel_j1939_node.py" "$CAN" $name >node.log 2>&1 &
expect_line dump ' 18FEF180#FF0019FFFFFFFFFF' 60 # it speaks, so it has an address

cat >node.yaml <<PROFILE
address: 128
periodic: [65265 every 100 ms]
requested: [65265, 65259]
patience: 1 s
PROFILE
status=0
"$BINARY_DIR/rigwire" conform j1939 "can:$CAN" --profile node.yaml --writes --moves "can:$CAN" \
  j1939/5.2 j1939/5.4.2 j1939/5.4.4 j1939/5.10.3 j1939/5.10.2.4 j1939-71/CCVS1/2 j1939-71/CCVS1/3 \
  j1939-81 >result || status=$?
cat result
[ "$status" = 0 ] || [ "$status" = 5 ]

# Kernels up to some of 2026 (6.1 among them) cannot be held, and mind to be asked twice.
deviates='j1939/5\.10\.3/[345] '
[ "$(grep -E '^(fail|lenient|error) ' result | grep -Evc "$deviates" || true)" = 0 ]
check_range "cases that pass" "$(count result '^pass ')" 23 26
expect_line result '^ +by a commanded address' 0

kill "$recorder"
