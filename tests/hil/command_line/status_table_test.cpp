#include "hil/command_line/status_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/command_line/text_table.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::ResultOf;

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

std::string drawn(const RigStatus& before, const RigStatus& now,
                  const std::vector<StateQuantity>& machine = {}, const TableLook& look = {}) {
  std::string text;
  for (const std::string& line : draw_status_table(before, now, machine, look)) {
    text += line + "\n";
  }
  return text;
}

TEST(StatusTable, ShowsRatesBetweenTheTwoStatuses) {
  const std::string table =
      drawn(status_at(kStart + 1s, 1808), status_at(kStart + 3s, 1808 + 3616), {{"swing", "deg"}});
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
  const std::string table = drawn(status_at(kStart + 1s, 0), now, {}, {.colour = true});
  EXPECT_THAT(table, HasSubstr("\x1b[31m7\x1b[0m"));
  EXPECT_THAT(table, HasSubstr("\x1b[33m"));
  EXPECT_THAT(table, HasSubstr("1.5 s ago"));
}

TEST(StatusTable, TheFirstStatusHasNothingToCompareWith) {
  const std::string table = drawn({}, status_at(kStart, 0));
  EXPECT_THAT(table, HasSubstr("0.0"));
  EXPECT_THAT(table, Not(HasSubstr("nan")));
  EXPECT_THAT(table, Not(HasSubstr("inf")));
}

TEST(StatusTable, ADeviceThatOnlyAnswersIsNeverOffItsRate) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.devices[0].nominal_rate_hz = 0.0;
  const std::string table = drawn(status_at(kStart + 1s, 0), now, {}, {.colour = true});
  EXPECT_THAT(table, HasSubstr("on demand"));
  EXPECT_THAT(table, Not(HasSubstr("\x1b[33m")));
}

TEST(StatusTable, NoLineIsWiderThanTheWindow) {
  RigStatus now = status_at(kStart + 3s, 5432);
  now.devices[0].wire = "udp 127.0.0.1:2368 and 8308; http 127.0.0.1:8080, as configured";
  now.devices[0].last_request = {kStart + 2s, "POST /cgi/setting"};
  now.faults.push_back({"lidar", "lost", kStart + 1s, kStart + 10s});
  for (const std::size_t columns : {10U, 40U, 60U, 80U, 100U, 147U, 183U}) {
    EXPECT_THAT(draw_status_table({}, now, {{"swing", "deg"}}, {.columns = columns}),
                Each(ResultOf(display_width, testing::Le(columns))));
  }
}

TEST(StatusTable, ANarrowWindowKeepsDeviceWireRateAndDrops) {
  const std::string table =
      drawn({}, status_at(kStart + 3s, 5432), {{"swing", "deg"}}, {.columns = 60});
  for (const char* kept : {"lidar", "udp 127.0.0.1:2368", "1810.7", "drops"}) {
    EXPECT_THAT(table, HasSubstr(kept));
  }
  EXPECT_THAT(table, Not(HasSubstr("12/345/6789")));
}

TEST(StatusTable, ColumnsAreAsWideAsNames) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.devices[0].name = "lidar_on_the_left_front_post";
  const auto lines = draw_status_table({}, now, {}, {});
  EXPECT_EQ(lines[1].find("wire"), lines[2].find("udp"));
}

TEST(StatusTable, ALowWindowSaysHowMuchIsMissing) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.devices.resize(12, now.devices[0]);
  const auto lines = draw_status_table({}, now, {}, {.lines = 6});
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines.back(), "+10 more");  // nine devices and the machine
}

TEST(StatusTable, TellsWhichFaultsActAndWhatAClientAskedLast) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.faults.push_back({"bus can", "wrong_rate imu_boom", kStart + 1s, kStart + 10s});
  now.devices[0].since_client_activity = 500ms;
  now.devices[0].last_request = {kStart + 2s, "POST /cgi/setting"};
  const std::string table = drawn({}, now);
  EXPECT_THAT(table, HasSubstr("fault: bus can wrong_rate imu_boom, until 10.000 s\n"));
  EXPECT_THAT(table, HasSubstr("0.5 s ago, POST /cgi/setting"));
}

TEST(StatusTable, NothingInItCanSteerATerminal) {
  RigStatus now = status_at(kStart + 3s, 0);
  now.devices[0].name = "lidar\x1b[2J";
  now.devices[0].wire =
      "pty /tmp/\x9b"
      "31m";
  now.devices[0].last_request = {kStart, "GET /\x1b]0;title\a"};
  now.faults.push_back({"gnss\r", "outage", kStart, kStart + 10s});
  const std::string table = drawn({}, now);
  EXPECT_THAT(table, Each(testing::AnyOf('\n', testing::Ge(' '))));
  EXPECT_THAT(table, HasSubstr("lidar\\u001b[2J"));
}

}  // namespace
}  // namespace rigwire::hil
