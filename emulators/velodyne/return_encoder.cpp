#include "emulators/velodyne/return_encoder.h"

#include <algorithm>
#include <cstddef>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

VelodyneReflectivity scale_of(const velodyne::Model& model) {
  if (model.status_channel) {
    return VelodyneReflectivity::full;
  }
  return model.lasers.size() == kMaxLasers ? VelodyneReflectivity::to_110
                                           : VelodyneReflectivity::to_100;
}

}  // namespace

ReturnEncoder::ReturnEncoder(const velodyne::Model& model, VelodyneRangeWindow window,
                             VelodyneReflectivity scale,
                             const std::optional<velodyne::Hdl64eCalibration>& calibration)
    : calibration_(calibration),
      minimum_m_(static_cast<float>(window.minimum_m)),
      maximum_m_(static_cast<float>(window.maximum_m)),
      counts_per_metre_(1000.0F / static_cast<float>(model.distance_unit_mm)) {
  if (calibration_) {
    raw_ranges_.emplace(*calibration_, model.lasers);
  }
  switch (scale == VelodyneReflectivity::model ? scale_of(model) : scale) {
    case VelodyneReflectivity::to_110:
      diffuse_top_ = 110.0F;
      retro_bottom_ = 111.0F;
      break;
    case VelodyneReflectivity::full:
      diffuse_top_ = 255.0F;
      retro_bottom_ = 255.0F;
      break;
    case VelodyneReflectivity::to_100:
    case VelodyneReflectivity::model:
      break;
  }
  retro_span_ = 255.0F - retro_bottom_;
}

void ReturnEncoder::scale(const BankReturns& echoes, EncodedReturns& encoded) const {
  // Copies, because the compiler cannot know that the results do not overwrite the members.
  const float minimum_m = minimum_m_;
  const float maximum_m = maximum_m_;
  const float counts_per_metre = counts_per_metre_;
  const float diffuse_top = diffuse_top_;
  const float retro_bottom = retro_bottom_;
  const float retro_span = retro_span_;
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    const float range_m = echoes[i].range_m;
    const float reflectivity = echoes[i].reflectivity;
    const bool seen = (range_m >= minimum_m) & (range_m <= maximum_m);
    const float counts = seen ? std::max(range_m * counts_per_metre + 0.5F, 1.0F) : 0.0F;

    const float diffuse = reflectivity * diffuse_top;
    const float retro = (reflectivity - 1.0F) * retro_span + retro_bottom;
    const float byte = reflectivity <= 1.0F ? diffuse : retro;
    const bool lit = seen & (reflectivity > 0.0F);
    const float shown = lit ? std::min(byte, 255.0F) + 0.5F : 0.0F;
    encoded[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(counts)) |
                 static_cast<std::uint32_t>(static_cast<std::int32_t>(shown)) << 16U;
  }
}

void ReturnEncoder::take_back_corrections(const LidarFiring& bank, const BankReturns& echoes,
                                          EncodedReturns& encoded) const {
  constexpr double kFarthestCount = 65535.0;
  const RawRanges::Rotor rotor(bank.rotor_azimuth_rad, bank.rotor_rate_radps);
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    if (encoded[i] == 0) {
      continue;
    }
    const velodyne::Hdl64eLaser& laser = calibration_->lasers[bank.first_laser + i];
    const double raw = raw_ranges_->counts(rotor, bank.first_laser + i, echoes[i].range_m);
    if (!(raw >= 0.5 && raw < kFarthestCount + 0.5)) {
      encoded[i] = 0;
      continue;
    }
    const auto intensity = static_cast<double>(encoded[i] >> 16U);
    encoded[i] = static_cast<std::uint32_t>(raw + 0.5) |
                 static_cast<std::uint32_t>(velodyne::raw_intensity(laser, intensity, raw)) << 16U;
  }
}

}  // namespace rigwire::emulators
