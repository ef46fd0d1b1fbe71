// The emulated device's own packets, read by the decoder that was written from the manuals.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "emulators/device.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "velodyne_capture.h"
#include "velodyne_comparison.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::BlockEcho;
using velodyne::ReturnMode;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kHour_us = 3.6e9;
constexpr double kStart_us = kHour_us - 20'000.0;  ///< 20 ms before an hour of the calendar.
constexpr double kStepPerFiring_deg = 0.2;         ///< Whole counts: the azimuth field is exact.
constexpr std::int64_t kPacketsWithReturns = 40;

struct Case {
  const char* model;
  ReturnMode mode;
};

/// What the laser sees, as a bank's three echoes and as the returns that a client is to read.
class KnownScene {
 public:
  KnownScene(const velodyne::Model& model, ReturnMode mode)
      : mode_(mode),
        brightest_(model.status_channel         ? 255.0
                   : model.lasers.size() == 128 ? 110.0
                                                : 100.0) {}

  void fill(LidarFiring& bank, std::size_t firing, std::size_t lasers) const {
    bank.several = true;
    for (std::size_t i = 0; i < std::min(lasers - bank.first_laser, kBankLasers); ++i) {
      const std::size_t laser = bank.first_laser + i;
      const auto seen = VelodyneStream::echoes(firing, laser);
      const LidarReturn near{static_cast<float>(seen.near_m), reflectance(laser)};
      const LidarReturn far{static_cast<float>(seen.far_m), reflectance(laser) + 0.1F};
      const bool two = seen.far_m > 0.0;
      bank.strongest[i] = two && seen.far_is_stronger ? far : near;
      bank.second[i] = two ? (seen.far_is_stronger ? near : far) : LidarReturn{};
      bank.last[i] = two ? far : near;
    }
  }

  /// Appends the returns of one laser; `shot` holds what is common to them.
  void expect(TrueReturn shot, std::size_t firing, std::vector<TrueReturn>& truth) const {
    const auto seen = VelodyneStream::echoes(firing, shot.laser);
    if (seen.near_m == 0.0) {
      return;
    }
    const bool two = seen.far_m > 0.0;
    const auto add = [&](BlockEcho echo, bool far) {
      shot.echo = echo;
      shot.range_m = far ? seen.far_m : seen.near_m;
      shot.reflectivity =
          static_cast<double>(reflectance(shot.laser) + (far ? 0.1F : 0.0F)) * brightest_;
      truth.push_back(shot);
    };
    if (mode_ != ReturnMode::dual) {
      const bool last = mode_ == ReturnMode::last;
      add(last ? BlockEcho::last : BlockEcho::strongest, two && (last || seen.far_is_stronger));
    } else if (!two) {
      shot.both = true;
      add(BlockEcho::last, false);
    } else {
      add(BlockEcho::last, true);
      add(BlockEcho::strongest, false);  // itself, or the second where the last is the strongest
    }
  }

 private:
  static float reflectance(std::size_t laser) {
    return 0.1F + 0.01F * static_cast<float>(laser % 80);
  }

  ReturnMode mode_;
  double brightest_;
};

std::vector<velodyne::Laser> lasers_of(const LidarPattern& pattern) {
  std::vector<velodyne::Laser> lasers;
  for (const LaserGeometry& laser : pattern.lasers) {
    lasers.push_back({.elevation_deg = laser.elevation_rad / kDegree,
                      .azimuth_offset_deg = laser.azimuth_offset_rad / kDegree,
                      .vertical_offset_mm = laser.vertical_offset_m * 1e3,
                      .horizontal_offset_mm = laser.horizontal_offset_m * 1e3,
                      .time_offset_ns = static_cast<std::int32_t>(laser.time_offset.count())});
  }
  return lasers;
}

void PrintTo(const Case& c, std::ostream* out) {
  *out << velodyne_test_name(c.model, c.mode);
}

class VelodyneDevice : public testing::TestWithParam<Case> {};

TEST_P(VelodyneDevice, IndependentDecoderReadsWhatTheHeadSaw) {
  const velodyne::Model& model = *velodyne::find_model(GetParam().model);
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_device_" + std::to_string(getpid()) + ".pcap");
  const Calendar calendar(parse_utc("2026-06-01T08:59:59.98Z"));
  UdpCapture capture(file);
  CaptureOutput data(capture, 2368);
  NullByteOutput position;
  VelodyneSettings settings;
  settings.model = model.name;
  settings.saved.return_mode = GetParam().mode;
  VelodyneLidar lidar(settings, calendar, data, position);
  const std::vector<velodyne::Laser> lasers = lasers_of(lidar.pattern());
  const KnownScene scene(model, GetParam().mode);
  const Duration period = lidar.sample_plan().period;
  const double step_radps = kStepPerFiring_deg * kDegree / to_seconds(period);

  const std::size_t per_packet = firings_per_packet(model, GetParam().mode);
  // An HDL-64E tells its calibration in one round of its status channel.
  const std::size_t packets = model.status_channel
                                  ? velodyne::kStatusPeriod + velodyne::kStatusCycle
                                  : static_cast<std::size_t>(kPacketsWithReturns);
  std::vector<TrueReturn> truth;
  for (std::size_t firing = 0; firing < packets * per_packet; ++firing) {
    const SimTime time = lidar.sample_plan().first + static_cast<std::int64_t>(firing) * period;
    const double rotor_deg =
        std::fmod(359.0 + kStepPerFiring_deg * static_cast<double>(firing), 360.0);
    const bool sees = firing < kPacketsWithReturns * per_packet;
    for (std::size_t b = 0; b < lidar.pattern().banks(); ++b) {
      LidarFiring bank;
      bank.time = time;
      bank.rotor_azimuth_rad = rotor_deg * kDegree;
      bank.rotor_rate_radps = step_radps;
      bank.first_laser = b * kBankLasers;
      if (sees) {
        scene.fill(bank, firing, lasers.size());
      }
      lidar.update(bank);
    }
    for (std::size_t i = 0; i < lasers.size() && sees; ++i) {
      const Duration after = Duration{lasers[i].time_offset_ns};
      TrueReturn shot;
      shot.packet = firing / per_packet;
      shot.firing = firing % per_packet;
      shot.laser = i;
      shot.time_us = to_seconds(time + after) * 1e6;
      shot.azimuth_deg =
          rotor_deg + step_radps * to_seconds(after) / kDegree + lasers[i].azimuth_offset_deg;
      scene.expect(shot, firing, truth);
    }
  }
  capture.close();
  ASSERT_EQ(data.sent, static_cast<std::int64_t>(packets));

  const DecodedDifference worst =
      VelodyneComparison(truth, lasers, kStart_us, per_packet == 1).run(file);
  EXPECT_EQ(worst.unexpected, "");
  EXPECT_EQ(worst.missing, 0U);
  EXPECT_EQ(worst.compared, truth.size());
  EXPECT_LE(worst.range_m, 0.5e-3 * model.distance_unit_mm * 1.02) << "half a unit";
  EXPECT_LE(worst.azimuth_deg, 0.005);
  EXPECT_LE(worst.elevation_deg, model.status_channel ? 0.0051 : 0.0011);
  EXPECT_LE(worst.time_us, 1.0) << "of which the stamp's rounding";
  EXPECT_LE(worst.reflectivity, 0.51);
  // 0.005 degrees of a calibration that the status channel rounds are 6 mm at 68 m.
  EXPECT_LE(worst.place_m, model.status_channel ? 0.006 : 1.5e-4);
  std::filesystem::remove(file);
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return velodyne_test_name(info.param.model, info.param.mode);
}

INSTANTIATE_TEST_SUITE_P(
    EveryModel, VelodyneDevice,
    testing::Values(Case{"HDL-32E", ReturnMode::strongest}, Case{"HDL-32E", ReturnMode::dual},
                    Case{"VLP-16", ReturnMode::last}, Case{"VLP-16", ReturnMode::dual},
                    Case{"Puck Hi-Res", ReturnMode::strongest},
                    Case{"Puck Hi-Res", ReturnMode::dual}, Case{"VLP-32C", ReturnMode::strongest},
                    Case{"VLP-32C", ReturnMode::dual}, Case{"HDL-64E S2", ReturnMode::strongest},
                    Case{"HDL-64E S3", ReturnMode::last}, Case{"HDL-64E S3", ReturnMode::dual},
                    Case{"VLS-128", ReturnMode::last}, Case{"VLS-128", ReturnMode::dual}),
    name_of);

}  // namespace
}  // namespace rigwire::emulators
