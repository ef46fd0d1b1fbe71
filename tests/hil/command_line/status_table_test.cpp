#include "hil/command_line/status_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

RigStatus status_at(SimTime now, std::uint64_t frames) {
  RigStatus status;
  status.now = now;
  status.wall_s = to_seconds(now) * 2.0;
  DeviceStatus lidar;
  lidar.name = "lidar";
  lidar.wire = "udp 127.0.0.1:2368";
  lidar.frames = frames;
  lidar.bytes = frames * 1206;
  lidar.nominal_rate_hz = 1808.4;
  lidar.lateness_p50 = 12us;
  lidar.lateness_p99 = 345us;
  lidar.lateness_max = 6789us;
  status.devices.push_back(lidar);
  status.machine = {12.34};
  return status;
}

TEST(StatusTable, ShowsRatesBetweenTheTwoStatuses) {
  const std::string table = draw_status_table(
      status_at(kStart + 1s, 1808), status_at(kStart + 3s, 1808 + 3616), {{"swing", "deg"}}, false);
  EXPECT_THAT(table, HasSubstr("real-time factor 0.50"));
  EXPECT_THAT(table, HasSubstr("1808.0"));
  EXPECT_THAT(table, HasSubstr("2.18 MB/s"));
  EXPECT_THAT(table, HasSubstr("12/345/6789"));
  EXPECT_THAT(table, HasSubstr("swing 12.3 deg"));
  EXPECT_THAT(table, HasSubstr("none"));
  EXPECT_THAT(table, Not(HasSubstr("\x1b")));
}

TEST(StatusTable, MarksDropsAndARateThatIsOff) {
  RigStatus now = status_at(kStart + 3s, 100);
  now.devices[0].dropped = 7;
  now.devices[0].since_client_activity = 1500ms;
  const std::string table = draw_status_table(status_at(kStart + 1s, 0), now, {}, true);
  EXPECT_THAT(table, HasSubstr("\x1b[31m     7"));
  EXPECT_THAT(table, HasSubstr("\x1b[33m"));
  EXPECT_THAT(table, HasSubstr("1.5 s ago"));
}

TEST(StatusTable, TheFirstStatusHasNothingToCompareWith) {
  const std::string table = draw_status_table({}, status_at(kStart, 0), {}, false);
  EXPECT_THAT(table, HasSubstr("0.0"));
  EXPECT_THAT(table, Not(HasSubstr("nan")));
  EXPECT_THAT(table, Not(HasSubstr("inf")));
}

TEST(StatusTable, ADeviceThatOnlyAnswersIsNeverOffItsRate) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.devices[0].nominal_rate_hz = 0.0;
  const std::string table = draw_status_table(status_at(kStart + 1s, 0), now, {}, true);
  EXPECT_THAT(table, HasSubstr("on demand"));
  EXPECT_THAT(table, Not(HasSubstr("\x1b[33m")));
}

}  // namespace
}  // namespace rigwire::hil
