#include "emulators/velodyne/return_encoder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sim/samples/wide_vectors.h"

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
    : minimum_m_(static_cast<float>(window.minimum_m)),
      maximum_m_(static_cast<float>(window.maximum_m)),
      counts_per_metre_(1000.0F / static_cast<float>(model.distance_unit_mm)) {
  if (calibration) {
    raw_ranges_.emplace(*calibration, model.lasers);
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

void ReturnEncoder::encode(const LidarFiring& bank, std::span<const BankReturns* const> echoes,
                           std::span<EncodedReturns> encoded) const {
  for (std::size_t k = 0; k < echoes.size(); ++k) {
    scale(*echoes[k], encoded[k]);
  }
  if (raw_ranges_) {
    RawRanges::Beams beams;
    raw_ranges_->aim(bank.rotor_azimuth_rad, bank.rotor_rate_radps, bank.first_laser, beams);
    for (std::size_t k = 0; k < echoes.size(); ++k) {
      take_back_corrections(beams, *echoes[k], encoded[k]);
    }
  }
}

RIGWIRE_WIDE_VECTORS
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
    // Range to counts, at least 1 for what is seen.
    const float rounded = range_m * counts_per_metre + 0.5F;
    const float counts = choose(seen, choose(rounded > 1.0F, rounded, 1.0F), 0.0F);

    // Diffuse targets fill the lower part of the byte, retro-reflectors the rest, both linearly.
    const float diffuse = reflectivity * diffuse_top;
    const float retro = (reflectivity - 1.0F) * retro_span + retro_bottom;
    const float byte = choose(reflectivity <= 1.0F, diffuse, retro);
    const bool lit = seen & (reflectivity > 0.0F);
    const float shown = choose(lit, choose(byte < 255.0F, byte, 255.0F) + 0.5F, 0.0F);
    encoded[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(counts)) |
                 static_cast<std::uint32_t>(static_cast<std::int32_t>(shown)) << 16U;
  }
}

RIGWIRE_WIDE_VECTORS
void ReturnEncoder::take_back_corrections(const RawRanges::Beams& beams, const BankReturns& echoes,
                                          EncodedReturns& encoded) const {
  constexpr double kFarthestCount = 65535.0;
  const RawRanges& raw_ranges = *raw_ranges_;
  // A column of their own: of echoes, the compiler leaves the last eight to a slow loop, lest it
  // read beyond the last range.
  std::array<double, kBankLasers> ranges_m;
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    ranges_m[i] = static_cast<double>(echoes[i].range_m);
  }
  for (std::size_t i = 0; i < kBankLasers; ++i) {
    const auto word = static_cast<std::int32_t>(encoded[i]);
    const double raw = raw_ranges.counts(beams, i, ranges_m[i]);
    const double counts = choose((raw >= 0.5) & (raw < kFarthestCount + 0.5), raw, 0.0);
    const std::int32_t intensity =
        raw_ranges.intensity(beams.first_laser + i, static_cast<double>(word >> 16), counts);
    // Never negative; std::lround would cost the loop its vector instructions.
    // NOLINTNEXTLINE(bugprone-incorrect-roundings)
    const auto whole = static_cast<std::int32_t>(counts + 0.5);
    encoded[i] = choose((word != 0) & (whole != 0),
                        static_cast<velodyne::ChannelWord>(whole | intensity << 16), 0U);
  }
}

}  // namespace rigwire::emulators
