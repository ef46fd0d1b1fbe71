// tshark, with a dissector that shares no table with us, reads from our packets what was put in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "emulators/velodyne/velodyne_lidar.h"
#include "velodyne_capture.h"

namespace rigwire::emulators {
namespace {

using testing::HasSubstr;

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return "cannot run " + command;
  }
  std::array<char, 4096> piece{};
  while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) {
    text += piece.data();
  }
  const int status = pclose(pipe);
  return status == 0 ? text : "exit status " + std::to_string(status) + "\n" + text;
}

/// A range that tells firing and laser apart; some shots have no echo.
float range_of(std::int64_t firing, std::size_t laser) {
  return (firing + static_cast<std::int64_t>(laser)) % 7 == 0
             ? 0.0F
             : 2.0F + 0.0531F * static_cast<float>(firing % 900) +
                   1.37F * static_cast<float>(laser);
}

struct VelodyneWireCase {
  const char* model;
  const char* product;
  int firings_per_block;
};

void PrintTo(const VelodyneWireCase& c, std::ostream* out) {
  *out << c.model;
}

class VelodyneConformance : public testing::TestWithParam<VelodyneWireCase> {};

TEST_P(VelodyneConformance, IndependentDissectorReadsTheTruth) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_velodyne_" + std::to_string(getpid()) + ".pcap");
  const Calendar calendar(parse_utc("2026-06-01T08:59:59.20Z"));
  UdpCapture capture(file);
  CaptureOutput data(capture, 2368);
  CaptureOutput position(capture, 8308);
  VelodyneSettings settings;
  settings.model = GetParam().model;
  settings.saved.rotor_rpm = 1200.0;
  VelodyneLidar lidar(settings, calendar, data, position);
  GnssSample fix;
  fix.fix = GnssFix::three_d;
  fix.latitude_deg = -33.25;
  fix.longitude_deg = 151.125;
  lidar.observe_fix(fix);
  constexpr std::int64_t kPackets = 120;
  const std::size_t lasers = lidar.pattern().lasers.size();
  const std::int64_t firings = 12 * GetParam().firings_per_block;  // in a packet
  const std::int64_t period_ns = lidar.pattern().firing_period.count();
  const double rate_degps = 1200.0 / 60.0 * 360.0;
  for (std::int64_t i = 0; i < firings * kPackets; ++i) {
    LidarFiring firing;
    firing.time = lidar.sample_plan().first + i * lidar.sample_plan().period;
    firing.rotor_azimuth_rad =
        std::fmod(rate_degps * to_seconds(firing.time), 360.0) * std::numbers::pi / 180.0;
    for (std::size_t j = 0; j < lasers; ++j) {
      firing.strongest[j] = {range_of(i, j), 0.01F * static_cast<float>(j * 3)};
    }
    lidar.update(firing);
  }
  capture.close();
  ASSERT_EQ(data.sent, kPackets);
  ASSERT_GT(position.sent, 5);

  const std::string script = std::string(RIGWIRE_SOURCE_DIR) + "/tests/conformance/velodyne.lua";
  const std::string tshark = "tshark -n -X lua_script:" + script + " -r " + file.string();
  const std::string complaints =
      output_of(tshark +
                " -Y 'velodyne.complaint or velodyne_position.complaint or _ws.malformed or "
                "_ws.lua.error' 2>&1 | grep -v 'Running as user' || true");
  EXPECT_EQ(complaints, "");
  std::istringstream points(
      output_of(tshark + " -Y velodyne -T fields -E aggregator=';' -e velodyne.timestamp -e "
                         "velodyne.mode -e velodyne.product -e velodyne.point 2>/dev/null"));
  std::string line;
  std::int64_t packet = 0;
  std::int64_t compared = 0;
  double worst_range = 0.0;
  double worst_azimuth = 0.0;
  while (std::getline(points, line)) {
    std::istringstream columns(line);
    long long stamp_us = 0;
    std::string mode;
    std::string product;
    columns >> stamp_us >> mode >> product;
    EXPECT_EQ(mode, "0x37");
    EXPECT_EQ(product, GetParam().product);
    const std::int64_t first_ns = (1 + packet * firings) * period_ns;
    EXPECT_EQ(stamp_us, (3599200000000 + first_ns) % 3600000000000 / 1000);
    std::string point;
    std::int64_t in_packet = 0;
    while (std::getline(columns >> std::ws, point, ';')) {
      std::istringstream values(point);
      std::int64_t block = 0;
      std::size_t place = 0;
      double range = 0.0;
      double azimuth = 0.0;
      double elevation = 0.0;
      double offset_us = 0.0;
      unsigned reflectivity = 0;
      values >> block >> place >> range >> azimuth >> elevation >> offset_us >> reflectivity;
      ASSERT_FALSE(values.fail()) << point;
      const std::size_t laser = place % lasers;
      const std::int64_t firing =
          block * GetParam().firings_per_block + static_cast<std::int64_t>(place / lasers);
      const double time_s = 1e-9 * static_cast<double>(first_ns) + 1e-6 * offset_us;
      double azimuth_error = azimuth - std::fmod(rate_degps * time_s, 360.0);
      azimuth_error -= 360.0 * std::round(azimuth_error / 360.0);
      worst_range =
          std::max(worst_range, std::abs(range - range_of(packet * firings + firing, laser)));
      worst_azimuth = std::max(worst_azimuth, std::abs(azimuth_error));
      ASSERT_NEAR(elevation, lidar.pattern().lasers[laser].elevation_rad * 180.0 / std::numbers::pi,
                  0.004);
      ASSERT_NEAR(offset_us * 1e3,
                  static_cast<double>((firing * lidar.pattern().firing_period +
                                       lidar.pattern().lasers[laser].time_offset)
                                          .count()),
                  0.5);
      ASSERT_EQ(reflectivity, laser * 3);
      ++in_packet;
    }
    compared += in_packet;
    ++packet;
  }
  std::int64_t expected = 0;
  for (std::int64_t i = 0; i < firings * kPackets; ++i) {
    for (std::size_t j = 0; j < lasers; ++j) {
      expected += range_of(i, j) >= 1.0F ? 1 : 0;
    }
  }
  EXPECT_EQ(packet, kPackets);
  EXPECT_EQ(compared, expected);
  EXPECT_LE(worst_range, 0.001 + 1e-4) << "half a distance unit";
  EXPECT_LE(worst_azimuth, 0.0151) << "rounding of the field, and of both ends of the step";

  const std::string sentences =
      output_of(tshark +
                " -Y velodyne_position -T fields -e velodyne_position.pulse -e "
                "velodyne_position.sentence 2>/dev/null");
  EXPECT_THAT(sentences,
              HasSubstr("2\tGPRMC,085959,A,3315.0000,S,15107.5000,E,000.0,000.0,010626,000.0,E,A"));
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Models, VelodyneConformance,
                         testing::Values(VelodyneWireCase{"HDL-32E", "0x21", 1},
                                         VelodyneWireCase{"VLP-16", "0x22", 2},
                                         VelodyneWireCase{"Puck Hi-Res", "0x24", 2}),
                         [](const auto& test) {
                           std::string name = test.param.model;
                           std::erase_if(name,
                                         [](unsigned char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

}  // namespace
}  // namespace rigwire::emulators
