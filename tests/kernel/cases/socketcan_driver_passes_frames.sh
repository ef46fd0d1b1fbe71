# shellcheck shell=bash source=tests/kernel/common.sh disable=SC2154
# The tests of our SocketCAN endpoint that need an interface: elsewhere they are skipped.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

"$BINARY_DIR/tests/drivers/drivers_tests" --gtest_filter='OnVcan.*' | tee result
grep -q '\[  PASSED  \] [1-9]' result
if grep -q 'SKIPPED' result; then
  echo "FAILED: skipped although $CAN is there"
  exit 1
fi
