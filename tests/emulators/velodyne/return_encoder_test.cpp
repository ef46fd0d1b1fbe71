// Channels against the rounding of the C library, one echo at a time and with branches.
#include "emulators/velodyne/return_encoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Scale {
  VelodyneReflectivity setting;
  float diffuse_top;
  float retro_bottom;
};
constexpr Scale kScales[] = {{VelodyneReflectivity::to_100, 100.0F, 101.0F},
                             {VelodyneReflectivity::to_110, 110.0F, 111.0F},
                             {VelodyneReflectivity::full, 255.0F, 255.0F}};

std::uint32_t expected_byte(const Scale& scale, float reflectivity) {
  if (!(reflectivity > 0.0F)) {
    return 0;
  }
  const float retro_span = 255.0F - scale.retro_bottom;
  const float byte = reflectivity <= 1.0F ? reflectivity * scale.diffuse_top
                                          : (reflectivity - 1.0F) * retro_span + scale.retro_bottom;
  return static_cast<std::uint32_t>(std::lround(std::min(byte, 255.0F)));
}

std::uint32_t expected_word(const Scale& scale, VelodyneRangeWindow window, float unit_mm,
                            const LidarReturn& echo) {
  if (!(echo.range_m >= static_cast<float>(window.minimum_m) &&
        echo.range_m <= static_cast<float>(window.maximum_m))) {
    return 0;
  }
  const auto counts = static_cast<std::uint32_t>(std::lround(echo.range_m * (1000.0F / unit_mm)));
  return std::max(counts, 1U) | expected_byte(scale, echo.reflectivity) << 16U;
}

/// Edges, halves of counts, and what lies between, in whole banks.
std::vector<BankReturns> echoes_of(VelodyneRangeWindow window, float unit_mm) {
  const auto minimum_m = static_cast<float>(window.minimum_m);
  const auto maximum_m = static_cast<float>(window.maximum_m);
  std::vector<float> ranges_m{0.0F,      -0.0F,
                              -5.0F,     kNan,
                              kInfinity, -kInfinity,
                              1e-30F,    1e30F,
                              minimum_m, std::nextafter(minimum_m, 0.0F),
                              maximum_m, std::nextafter(maximum_m, kInfinity)};
  std::vector<float> reflectivities{
      0.0F, -0.0F, -1.0F, kNan, 1.0F, 2.0F, 9.0F, std::nextafter(1.0F, 2.0F), 1e30F};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0.0F, 1.0F);
  while (ranges_m.size() < 32U * 4001U) {
    const auto count = static_cast<float>(random() % 65535U);
    ranges_m.push_back((count + 0.5F) * unit_mm * 1e-3F);
    ranges_m.push_back(minimum_m + share(random) * (maximum_m - minimum_m));
  }
  for (int byte = 0; byte < 255; ++byte) {
    reflectivities.push_back((static_cast<float>(byte) + 0.5F) / 100.0F);
    reflectivities.push_back(2.0F * share(random));
  }
  std::vector<BankReturns> banks(ranges_m.size() / kBankLasers);
  for (std::size_t i = 0; i < banks.size() * kBankLasers; ++i) {
    banks[i / kBankLasers][i % kBankLasers] = {ranges_m[i],
                                               reflectivities[i * 7 % reflectivities.size()]};
  }
  return banks;
}

EncodedReturns encoded_by(const ReturnEncoder& encoder, const LidarFiring& bank,
                          const BankReturns& echoes) {
  std::array<EncodedReturns, 1> encoded{};
  encoder.encode(bank, std::array{&echoes}, encoded);
  return encoded[0];
}

TEST(VelodyneReturnEncoder, RoundsHalvesUpAndKeepsToTheWindow) {
  for (const char* name : {"HDL-32E", "VLP-32C"}) {
    const velodyne::Model& model = *velodyne::find_model(std::string_view(name));
    const auto unit_mm = static_cast<float>(model.distance_unit_mm);
    for (const VelodyneRangeWindow window :
         {VelodyneRangeWindow{0.0, 65.535 * unit_mm - 0.0005}, VelodyneRangeWindow{1.0, 70.0}}) {
      const std::vector<BankReturns> banks = echoes_of(window, unit_mm);
      for (const Scale& scale : kScales) {
        const ReturnEncoder encoder(model, window, scale.setting);
        for (const BankReturns& echoes : banks) {
          const EncodedReturns encoded = encoded_by(encoder, {}, echoes);
          for (std::size_t i = 0; i < kBankLasers; ++i) {
            ASSERT_EQ(encoded[i], expected_word(scale, window, unit_mm, echoes[i]))
                << name << ": " << echoes[i].range_m << " m, " << echoes[i].reflectivity;
          }
        }
      }
    }
  }
}

TEST(VelodyneReturnEncoder, TheFarthestCountIsSentAndNothingBeyond) {
  const velodyne::Model& model = *velodyne::find_model("HDL-32E");
  const ReturnEncoder encoder(model, {1.0, 131.07}, VelodyneReflectivity::model);
  BankReturns echoes{};
  echoes[0] = {131.07F, 1.0F};
  echoes[1] = {std::nextafter(131.07F, 200.0F), 1.0F};
  const EncodedReturns encoded = encoded_by(encoder, {}, echoes);
  EXPECT_EQ(encoded[0], 65535U | 100U << 16U);
  EXPECT_EQ(encoded[1], 0U);
}

class RawReturnEncoder : public testing::Test {
 protected:
  const velodyne::Model& model = *velodyne::find_model("HDL-64E S2");
  const velodyne::Hdl64eCalibration calibration = [&] {
    velodyne::Hdl64eCalibration various = velodyne::nominal_calibration(model);
    for (std::size_t n = 0; n < various.lasers.size(); n += 2) {
      velodyne::Hdl64eLaser& laser = various.lasers[n];
      laser.dist_correction_m = n % 3 == 0 ? -0.5 : 1.3;
      laser.dist_correction_x_m = 1.1;
      laser.dist_correction_y_m = 1.5;
      laser.focal_distance_m = static_cast<double>(n % 5) * 5.0;
      laser.focal_slope = 0.1 * static_cast<double>(n % 12);
    }
    return various;
  }();
};

TEST_F(RawReturnEncoder, RoundsRawDistancesAndIntensitiesAsTheLibraryDoes) {
  const VelodyneRangeWindow window{0.9, 131.0};
  const ReturnEncoder encoder(model, window, VelodyneReflectivity::to_100, calibration);
  const RawRanges raw_ranges(calibration, model.lasers);
  LidarFiring bank;
  bank.rotor_rate_radps = 62.8;
  RawRanges::Beams beams;
  for (const BankReturns& echoes : echoes_of(window, 2.0F)) {
    bank.rotor_azimuth_rad = std::fmod(bank.rotor_azimuth_rad + 0.37, 6.28);
    bank.first_laser = kBankLasers - bank.first_laser;
    raw_ranges.aim(bank.rotor_azimuth_rad, bank.rotor_rate_radps, bank.first_laser, beams);
    const EncodedReturns encoded = encoded_by(encoder, bank, echoes);
    for (std::size_t i = 0; i < kBankLasers; ++i) {
      const double raw = raw_ranges.counts(beams, i, static_cast<double>(echoes[i].range_m));
      std::uint32_t expected = expected_word(kScales[0], window, 2.0F, echoes[i]);
      if (expected != 0) {
        const auto intensity = static_cast<double>(expected >> 16U);
        expected = raw >= 0.5 && raw < 65535.5
                       ? static_cast<std::uint32_t>(std::lround(raw)) |
                             static_cast<std::uint32_t>(velodyne::raw_intensity(
                                 calibration.lasers[bank.first_laser + i], intensity, raw))
                                 << 16U
                       : 0;
      }
      ASSERT_EQ(encoded[i], expected) << "laser " << bank.first_laser + i << ", "
                                      << echoes[i].range_m << " m, " << echoes[i].reflectivity;
    }
  }
}

TEST_F(RawReturnEncoder, AnIntensityJustBelowAHalfIsRoundedDown) {
  const RawRanges raw_ranges(velodyne::nominal_calibration(model), model.lasers);
  for (int whole = 0; whole < 255; ++whole) {
    const double half = whole + 0.5;
    EXPECT_EQ(raw_ranges.intensity(3, std::nextafter(half, 0.0), 1000.0), whole);
    EXPECT_EQ(raw_ranges.intensity(3, half, 1000.0), whole + 1);
  }
  EXPECT_EQ(raw_ranges.intensity(3, -7.0, 1000.0), 0);
}

}  // namespace
}  // namespace rigwire::emulators
