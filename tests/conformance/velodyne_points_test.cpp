// A decoder written from the manuals in Python (velodyne_points.py), which shares no table with us,
// reads from packets of every model and return mode what was put into them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <tuple>

#include "tests/conformance/velodyne_capture.h"
#include "tests/conformance/velodyne_stream.h"

namespace rigwire {
namespace {

using namespace protocols::velodyne;

struct Case {
  const char* model;
  ReturnMode mode;
  StatusFormat format = StatusFormat::s2;
};

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

double wrapped(double value, double turn) {
  return value - turn * std::round(value / turn);
}

/// Packet, firing, laser, echo.
using Key = std::tuple<std::size_t, std::size_t, std::size_t, std::string>;

std::map<Key, TrueReturn> by_key(const std::vector<TrueReturn>& truth) {
  std::map<Key, TrueReturn> result;
  for (const TrueReturn& one : truth) {
    const std::string echo = one.both ? "both" : one.echo == BlockEcho::last ? "last" : "strongest";
    result[{one.packet, one.firing, one.laser, echo}] = one;
  }
  return result;
}

class VelodynePoints : public testing::TestWithParam<Case> {};

TEST_P(VelodynePoints, IndependentDecoderReadsTheTruth) {
  const Model& model = *find_model(GetParam().model);
  const ReturnMode mode = GetParam().mode;
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_points_" + std::to_string(getpid()) + ".pcap");
  UdpCapture capture(file);
  VelodyneStream stream(model, mode, GetParam().format);
  std::vector<TrueReturn> truth;
  // An HDL-64E needs a round of its status channel; most of those packets are left empty.
  const std::size_t packets = model.status_channel ? kStatusPeriod + kStatusCycle : 40;
  for (std::size_t i = 0; i < packets; ++i) {
    const DataPacket packet = stream.next(truth, i >= 40);
    std::array<std::uint8_t, kDataPacketSize> bytes{};
    encode(packet, bytes);
    capture.add(static_cast<std::int64_t>(i) * packet_period_ns(model, mode) / 1000, 2368, bytes,
                model.source_port);
  }
  capture.close();
  std::map<Key, TrueReturn> expected = by_key(truth);
  ASSERT_GT(expected.size(), 40U * 100U);

  std::istringstream lines(output_of("/usr/bin/python3 " + std::string(RIGWIRE_SOURCE_DIR) +
                                     "/tests/conformance/velodyne_points.py " + file.string() +
                                     " 2>&1"));
  double worst_range = 0.0;
  double worst_azimuth = 0.0;
  double worst_time = 0.0;
  double worst_place = 0.0;
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream values(line);
    std::size_t packet = 0;
    std::size_t firing = 0;
    std::size_t laser = 0;
    std::string echo;
    double time_us = 0.0;
    double azimuth = 0.0;
    double elevation = 0.0;
    double range = 0.0;
    double reflectivity = 0.0;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    values >> packet >> firing >> laser >> echo >> time_us >> azimuth >> elevation >> range >>
        reflectivity >> x >> y >> z;
    ASSERT_FALSE(values.fail()) << line;
    const auto found = expected.find({packet, firing, laser, echo});
    ASSERT_NE(found, expected.end()) << line;
    const TrueReturn& truly = found->second;
    const Laser& looks = stream.lasers()[laser];
    const double degree = std::numbers::pi / 180.0;
    // As the first packets of a VLS-128 with two returns: nothing tells the rotor's speed yet.
    const bool speed_unknown = firings_per_packet(model, mode) == 1 && packet == 0;
    if (!speed_unknown) {
      worst_azimuth =
          std::max(worst_azimuth, std::abs(wrapped(azimuth - truly.azimuth_deg, 360.0)));
      const double b = truly.azimuth_deg * degree;
      const double w = looks.elevation_deg * degree;
      const double h = looks.horizontal_offset_mm * 1e-3;
      const double true_x = range * std::cos(w) * std::cos(b) - h * std::sin(b);
      const double true_y = -range * std::cos(w) * std::sin(b) - h * std::cos(b);
      const double true_z = range * std::sin(w) + looks.vertical_offset_mm * 1e-3;
      worst_place = std::max(worst_place, std::hypot(x - true_x, y - true_y, z - true_z));
    }
    worst_range = std::max(worst_range, std::abs(range - truly.range_m));
    worst_time = std::max(
        worst_time, std::abs(wrapped(time_us - VelodyneStream::kStart_us - truly.time_us, 3.6e9)));
    ASSERT_NEAR(elevation, looks.elevation_deg, model.status_channel ? 1e-4 : 0.0011) << line;
    ASSERT_NEAR(reflectivity, truly.reflectivity, model.status_channel ? 0.51 : 1e-9) << line;
    expected.erase(found);
  }
  EXPECT_TRUE(expected.empty()) << expected.size() << " returns are missing";
  EXPECT_LE(worst_range, 0.5e-3 * model.distance_unit_mm * 1.01) << "half a unit";
  EXPECT_LE(worst_azimuth, 0.005);
  EXPECT_LE(worst_time, 1.0) << "microseconds, of which the stamp's rounding";
  // Points of an HDL-64E leave their beam by the difference of the near corrections in x and y.
  EXPECT_LE(worst_place, model.status_channel ? 0.04 : 1.5e-4);
  std::filesystem::remove(file);
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.model;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  name += info.param.mode == ReturnMode::dual   ? "Dual"
          : info.param.mode == ReturnMode::last ? "Last"
                                                : "Strongest";
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    EveryModel, VelodynePoints,
    testing::Values(Case{"HDL-32E", ReturnMode::strongest}, Case{"HDL-32E", ReturnMode::last},
                    Case{"HDL-32E", ReturnMode::dual}, Case{"VLP-16", ReturnMode::strongest},
                    Case{"VLP-16", ReturnMode::dual}, Case{"Puck Hi-Res", ReturnMode::last},
                    Case{"Puck Hi-Res", ReturnMode::dual}, Case{"VLP-32C", ReturnMode::strongest},
                    Case{"VLP-32C", ReturnMode::dual}, Case{"HDL-64E S2", ReturnMode::strongest},
                    Case{"HDL-64E S3", ReturnMode::strongest, StatusFormat::s3},
                    Case{"HDL-64E S3", ReturnMode::dual, StatusFormat::s3},
                    Case{"VLS-128", ReturnMode::strongest}, Case{"VLS-128", ReturnMode::dual}),
    name_of);

}  // namespace
}  // namespace rigwire
