#include "protocols/velodyne/model.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::size_t kHdl32eLasers = 32;
constexpr std::int32_t kHdl32eLaserStep_ns = 1152;
constexpr std::int32_t kHdl32eRecharge_ns = 9216;
constexpr std::int32_t kHdl32eFiringPeriod_ns =
    static_cast<std::int32_t>(kHdl32eLasers) * kHdl32eLaserStep_ns + kHdl32eRecharge_ns;
static_assert(kHdl32eFiringPeriod_ns == 46080);

struct Optics {
  double elevation_deg;
  double vertical_offset_mm;
};

constexpr std::array<Optics, kHdl32eLasers> kHdl32eOptics{{
    {-30.67, 17.17}, {-9.33, 4.76}, {-29.33, 16.27}, {-8.00, 4.07},   //
    {-28.00, 15.40}, {-6.67, 3.38}, {-26.67, 14.54}, {-5.33, 2.70},   //
    {-25.33, 13.71}, {-4.00, 2.02}, {-24.00, 12.89}, {-2.67, 1.35},   //
    {-22.67, 12.09}, {-1.33, 0.67}, {-21.33, 11.31}, {0.00, 0.00},    //
    {-20.00, 10.54}, {1.33, -0.67}, {-18.67, 9.78},  {2.67, -1.35},   //
    {-17.33, 9.04},  {4.00, -2.02}, {-16.00, 8.30},  {5.33, -2.70},   //
    {-14.67, 7.58},  {6.67, -3.38}, {-13.33, 6.86},  {8.00, -4.07},   //
    {-12.00, 6.15},  {9.33, -4.76}, {-10.67, 5.45},  {10.67, -5.45},  //
}};

constexpr std::array<Laser, kHdl32eLasers> kHdl32eTable = [] {
  std::array<Laser, kHdl32eLasers> lasers{};
  for (std::size_t i = 0; i < kHdl32eLasers; ++i) {
    lasers[i] = {.elevation_deg = kHdl32eOptics[i].elevation_deg,
                 .vertical_offset_mm = kHdl32eOptics[i].vertical_offset_mm,
                 .time_offset_ns = static_cast<std::int32_t>(i) * kHdl32eLaserStep_ns};
  }
  return lasers;
}();

constexpr std::array<Model, 1> kModels{{
    {.name = "HDL-32E",
     .product_id = 0x21,
     .distance_unit_mm = 2,
     .firing_period_ns = kHdl32eFiringPeriod_ns,
     .firings_per_block = 1,
     .minimum_rotor_rpm = 300.0,
     .maximum_rotor_rpm = 1200.0,
     .minimum_range_m = 1.0,
     .maximum_range_m = 100.0,
     .divergence = {.horizontal_mrad = 3.3, .vertical_mrad = 0.7},
     .dual_return = true,
     .lasers = kHdl32eTable},
}};

}  // namespace

std::span<const Model> models() {
  return kModels;
}

const Model* find_model(std::string_view name) {
  const auto* found = std::ranges::find(kModels, name, &Model::name);
  return found == kModels.end() ? nullptr : found;
}

const Model* find_model(std::uint8_t product_id) {
  const auto* found = std::ranges::find(kModels, product_id, &Model::product_id);
  return found == kModels.end() ? nullptr : found;
}

Shot shot(const Model& model, std::size_t block, std::size_t channel) {
  const std::size_t count = model.lasers.size();
  const std::size_t firing = channel / count;
  assert(firing < static_cast<std::size_t>(model.firings_per_block));
  Shot result;
  result.laser = channel % count;
  result.block_offset_ns = static_cast<std::int32_t>(firing) * model.firing_period_ns +
                           model.lasers[result.laser].time_offset_ns;
  result.packet_offset_ns =
      static_cast<std::int32_t>(block) * model.firings_per_block * model.firing_period_ns +
      result.block_offset_ns;
  return result;
}

}  // namespace rigwire::protocols::velodyne
