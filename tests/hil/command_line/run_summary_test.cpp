#include "hil/command_line/status_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

RunReport example() {
  RunReport report;
  report.outcome.reached = kStart + 20s;
  report.outcome.wall_s = 20.5;
  report.outcome.slips = 2;
  report.outcome.slipped = 500ms;
  DeviceReport gnss;
  gnss.name = "gnss";
  gnss.frames = 140;
  gnss.statistics.bytes = 11460;
  gnss.statistics.dropped = 3;
  gnss.statistics.lateness.record(100us);
  gnss.last_request = ClientRequest{kStart + 2500ms, "UBX CFG 0x08"};
  report.devices.push_back(gnss);
  report.devices.push_back({"imu", "slcan /tmp/can", 2000, {}, {}, {}});
  report.faults.push_back({"gnss", "jamming", kStart + 5s, kStart + 10s});
  report.faults.push_back({"bus can", "short", kStart + 15s, kStart + 30s});
  return report;
}

TEST(RunSummary, tells_each_devices_frames_drops_worst_lateness_and_last_request) {
  const auto lines = draw_summary(example(), false);
  EXPECT_EQ(lines[0], "ran 20.000 s in 20.500 s, real-time factor 0.98");
  EXPECT_EQ(lines[1], "clock slips: 2, 0.500 s together");
  EXPECT_THAT(lines, Contains("device  frames  bytes  drops  latest us  client asked last"));
  EXPECT_THAT(lines, Contains("gnss       140  11460      3        100  UBX CFG 0x08 at 2.500 s"));
  EXPECT_THAT(lines, Contains("imu       2000      0      0          0  nothing"));
}

TEST(RunSummary, tells_the_faults_that_acted_with_their_windows) {
  const auto lines = draw_summary(example(), false);
  EXPECT_THAT(lines, Contains("fault acted: gnss jamming, 5.000 .. 10.000 s"));
  EXPECT_THAT(lines, Contains("fault acted: bus can short, 15.000 .. 20.000 s, to the end "
                              "of the run"));
}

TEST(RunSummary, what_clients_sent_cannot_steer_a_terminal) {
  RunReport report = example();
  report.devices[0].last_request = ClientRequest{kStart, "GET /\x1b[2J"};
  EXPECT_THAT(draw_summary(report, false), Each(Not(HasSubstr("\x1b"))));
}

}  // namespace
}  // namespace rigwire::hil
