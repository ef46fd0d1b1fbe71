#include "protocols/velodyne/model.h"

#include <algorithm>
#include <array>

#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr BeamDivergence kHdlBeam{.horizontal_mrad = 3.3, .vertical_mrad = 0.7};
constexpr BeamDivergence kVlpBeam{.horizontal_mrad = 3.0, .vertical_mrad = 1.5};
constexpr BeamDivergence kHdl64eBeam{.horizontal_mrad = 3.4, .vertical_mrad = 3.4};

constexpr PacketHeaders kHdlHeaders{.data_time_to_live = 128, .data_unfragmented = false};

/// Firings and their pauses, from the firing tables of the manuals.
constexpr std::int32_t kHdl32ePeriod_ns = 32 * 1152 + 9216;  // and recharging
constexpr std::int32_t kVlpPeriod_ns = 16 * 2304 + 18432;    // 16 shots or pairs
constexpr std::int32_t kHdl64eS2Period_ns = 8 * 6000;        // groups of four
constexpr std::int32_t kHdl64eS3Period_ns = 8 * 7200;        //
constexpr std::int32_t vls_128_period_ns(std::int32_t group_ns) {
  return (16 + 1 + 3) * group_ns;  // groups of eight, two pauses
}
static_assert(kHdl32ePeriod_ns == 46080 && kVlpPeriod_ns == 55296);
static_assert(kHdl64eS2Period_ns == 48000 && kHdl64eS3Period_ns == 57600);
static_assert(vls_128_period_ns(kVls128GroupUntil517_ns) == 53300);

constexpr Model kHdl32e{.name = "HDL-32E",
                        .product_id = 0x21,
                        .distance_unit_mm = 2,
                        .firing_period_ns = kHdl32ePeriod_ns,
                        .firings_per_block = 1,
                        .minimum_rotor_rpm = 300.0,
                        .maximum_rotor_rpm = 1200.0,
                        .minimum_range_m = 0.17,
                        .maximum_range_m = 100.0,
                        .divergence = kHdlBeam,
                        .position_layout = PositionLayout::inertial,
                        .dual_return = true,
                        .source_port = 443,
                        .headers = kHdlHeaders,
                        .no_return = {255, 255},
                        .lasers = kHdl32eLasers};

constexpr Model kVlp16{.name = "VLP-16",
                       .product_id = 0x22,
                       .distance_unit_mm = 2,
                       .firing_period_ns = kVlpPeriod_ns,
                       .firings_per_block = 2,
                       .minimum_rotor_rpm = 300.0,
                       .maximum_rotor_rpm = 1200.0,
                       .minimum_range_m = 0.5,
                       .maximum_range_m = 100.0,
                       .divergence = kVlpBeam,
                       .pulse_ns = 6.0,
                       .position_layout = PositionLayout::plain,
                       .dual_return = true,
                       .web_interface = true,
                       .no_return = {3, 24},
                       .lasers = kVlp16Lasers};

constexpr Model kPuckHiRes = [] {
  Model model = kVlp16;
  model.name = "Puck Hi-Res";
  model.product_id = 0x24;
  model.lasers = kPuckHiResLasers;
  return model;
}();

constexpr Model kVlp32c = [] {
  Model model = kVlp16;
  model.name = "VLP-32C";
  model.product_id = 0x28;
  model.distance_unit_mm = 4;
  model.firings_per_block = 1;
  model.minimum_range_m = 0.7;
  model.maximum_range_m = 200.0;
  model.position_layout = PositionLayout::extended;
  model.no_return = {1, 100};
  model.lasers = kVlp32cLasers;
  return model;
}();

constexpr Model kHdl64eS2{.name = "HDL-64E S2",
                          .distance_unit_mm = 2,
                          .firing_period_ns = kHdl64eS2Period_ns,
                          .firings_per_block = 1,
                          .blocks_per_firing = 2,
                          .minimum_rotor_rpm = 300.0,
                          .maximum_rotor_rpm = 900.0,
                          .minimum_range_m = 2.0,  // the calibrated zero lies at 1.5 m
                          .maximum_range_m = 120.0,
                          .divergence = kHdl64eBeam,
                          .position_layout = PositionLayout::none,
                          .status_channel = true,
                          .source_port = 443,
                          .headers = kHdlHeaders,
                          .lasers = kHdl64eS2Lasers};

constexpr Model kHdl64eS3 = [] {
  Model model = kHdl64eS2;
  model.name = "HDL-64E S3";
  model.firing_period_ns = kHdl64eS3Period_ns;
  model.maximum_rotor_rpm = 1200.0;
  model.dual_return = true;
  model.lasers = kHdl64eS3Lasers;
  return model;
}();

constexpr Model kVls128{.name = "VLS-128",
                        .firmware = "5.2.3",
                        .product_id = 0xA1,
                        .distance_unit_mm = 4,
                        .firing_period_ns = vls_128_period_ns(kVls128Group_ns),
                        .firings_per_block = 1,
                        .blocks_per_firing = 4,
                        .timestamp_lag_ns = 8700,
                        .minimum_rotor_rpm = 300.0,
                        .maximum_rotor_rpm = 1200.0,
                        .minimum_range_m = 1.0,
                        .maximum_range_m = 245.0,
                        .divergence = kVlpBeam,
                        .pulse_ns = 6.0,
                        .position_layout = PositionLayout::extended,
                        .dual_return = true,
                        .web_interface = true,
                        .no_return = {3, 101},
                        .lasers = kVls128Lasers};

constexpr Model kVls128Until517 = [] {
  Model model = kVls128;
  model.firmware = "5.1.7";
  model.firing_period_ns = vls_128_period_ns(kVls128GroupUntil517_ns);
  model.lasers = kVls128LasersUntil517;
  return model;
}();

constexpr std::array kModels{kHdl32e,   kVlp16,    kPuckHiRes, kVlp32c,
                             kHdl64eS2, kHdl64eS3, kVls128,    kVls128Until517};

}  // namespace

std::span<const Model> models() {
  return kModels;
}

const Model* find_model(std::string_view name) {
  const auto* found = std::ranges::find(kModels, name, &Model::name);
  return found == kModels.end() ? nullptr : found;
}

const Model* find_model(std::string_view name, std::string_view firmware) {
  const auto* found = std::ranges::find_if(kModels, [&](const Model& model) {
    return model.name == name && model.firmware == firmware;
  });
  return found == kModels.end() ? nullptr : found;
}

const Model* find_model(std::uint8_t product_id) {
  if (product_id == 0) {
    return nullptr;
  }
  const auto* found = std::ranges::find(kModels, product_id, &Model::product_id);
  return found == kModels.end() ? nullptr : found;
}

}  // namespace rigwire::protocols::velodyne
