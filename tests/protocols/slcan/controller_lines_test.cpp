#include "protocols/slcan/slcan.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::slcan {
namespace {

using can::BusError;
using can::ControllerReport;
using can::ErrorState;

std::string written(const std::optional<Reply>& reply) {
  if (!reply) {
    return "none";
  }
  const Text text = write_reply(*reply);
  return {text.span().begin(), text.span().end() - 1};
}

TEST(ControllerLines, StatesWithBothCounters) {
  ControllerReport report;
  EXPECT_EQ(written(state_line(report)), "none");
  report.state_changed = true;
  EXPECT_EQ(written(state_line(report)), "sa000000");
  report.state = ErrorState::bus_off;
  report.transmit_errors = 256;
  report.receive_errors = 7;
  EXPECT_EQ(written(state_line(report)), "sb007256");
}

TEST(ControllerLines, EveryErrorHasItsLetterAndComesBack) {
  const std::vector<std::pair<BusError, std::string>> letters{
      {BusError::acknowledgement, "e1a"}, {BusError::crc, "e1c"}, {BusError::form, "e1f"},
      {BusError::stuff, "e1s"},           {BusError::bit, "e1B"}, {BusError::none, "none"}};
  for (const auto& [error, text] : letters) {
    ControllerReport report;
    report.error = error;
    const auto line = error_line(report);
    EXPECT_EQ(written(line), text);
    if (line) {
      EXPECT_EQ(report_of(*line).error, error);
    }
  }
}

TEST(ControllerLines, DominantBitAndOverflows) {
  ControllerReport report;
  report.error = BusError::bit;
  report.dominant = true;
  report.transmitting = true;
  report.transmit_overflow = true;
  EXPECT_EQ(written(error_line(report)), "e2bO");
  EXPECT_EQ(report_of(*error_line(report)), report);
  report = {};
  report.receive_overflow = true;
  EXPECT_EQ(written(error_line(report)), "e1o");
  EXPECT_EQ(report_of(*error_line(report)), report);
}

}  // namespace
}  // namespace rigwire::protocols::slcan
