// Eight shots side by side: the arithmetic between firings and Embree's packets of eight rays.
// Written as loops over lanes, which the compiler puts into the processor's vector registers.
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/lidar/lane_array.h"
#include "sim/samples/wide_vectors.h"

// Embree reads a packet in registers of eight floats. Written in halves, it waits for the stores;
// so functions that write one are marked RIGWIRE_WIDE_VECTORS.

namespace rigwire::sim {

/// `kColumns` quantities of eight lanes.
template <int kColumns>
class LaneTable {
 public:
  /// All columns one after the other, eight lanes each.
  [[nodiscard]] const float* data() const { return table_.data(); }
  [[nodiscard]] float* data() { return table_.data(); }

  static constexpr std::size_t kFloats = kLanes * kColumns;

 protected:
  [[nodiscard]] auto column(std::size_t i) { return table_.col(static_cast<Eigen::Index>(i)); }
  [[nodiscard]] auto column(std::size_t i) const {
    return table_.col(static_cast<Eigen::Index>(i));
  }

 private:
  alignas(32) Eigen::Array<float, kLanes, kColumns> table_ =
      Eigen::Array<float, kLanes, kColumns>::Zero();
};

/// Firings at the instant of their first laser, in Embree's coordinates.
class FiringLanes : public LaneTable<9 + 3 + 3 + 3 + 4> {
 public:
  // clang-format off
  auto R(std::size_t i) { return column(i); }  ///< R_WS, column by column, i = 0 .. 8.
  auto R(std::size_t i) const { return column(i); }
  auto p(std::size_t i) { return column(9 + i); }  ///< m, i = 0 .. 2.
  auto p(std::size_t i) const { return column(9 + i); }
  auto v(std::size_t i) { return column(12 + i); }  ///< m/s
  auto v(std::size_t i) const { return column(12 + i); }
  auto w(std::size_t i) { return column(15 + i); }  ///< rad/s
  auto w(std::size_t i) const { return column(15 + i); }
  auto cos_azimuth() { return column(18); }  ///< Azimuth of the rotor.
  auto cos_azimuth() const { return column(18); }
  auto sin_azimuth() { return column(19); }
  auto sin_azimuth() const { return column(19); }
  auto rotor_rate() { return column(20); }  ///< rad/s, clockwise.
  auto rotor_rate() const { return column(20); }
  auto time() { return column(21); }  ///< Share of the slice.
  auto time() const { return column(21); }
  // clang-format on
};

/// Lasers of the head, as LaserGeometry has them.
class LaserLanes : public LaneTable<7> {
 public:
  // clang-format off
  auto cos_elevation() { return column(0); }
  auto sin_elevation() { return column(1); }
  auto cos_offset() { return column(2); }  ///< Azimuth offset of the laser.
  auto sin_offset() { return column(3); }
  auto up_m() { return column(4); }  ///< Vertical offset of the exit.
  auto right_m() { return column(5); }  ///< Horizontal offset of the exit.
  auto delay_s() { return column(6); }  ///< After the firing's first laser.
  // clang-format on
};

/// What all rays of a packet have in common.
struct RayLimits {
  float near_m = 0.0F;
  float far_m = 0.0F;
  std::uint32_t mask = 0xFFFFFFFFU;
  float slices_per_s = 0.0F;  ///< One over the length of the slice.
};

/// A packet ready to be cast. Directions have unit length to 1e-6. The rotor's turn during a
/// laser's delay is taken to third order: exact to 1e-10 rad for all models.
void fill_rays(const FiringLanes& firing, const LaserLanes& laser, const RayLimits& limits,
               RTCRayHit8& packet);

/// A standard normal number for each shot, of (key, shot) alone; at most 6.3 in size, because it is
/// the quantile of one of 2^32 equally probable numbers. Cheapest for many at a time. Precondition:
/// both spans have the same length.
///
/// `speckle`, where it is not empty, gets a second number for each shot, independent of the first:
/// mean 0, variance 1, nearly normal (the sum of four equally spread bytes, at most 3.45 in size).
void gaussian(std::uint64_t key, std::span<const std::uint64_t> shots, std::span<float> normal,
              std::span<float> speckle = {});

}  // namespace rigwire::sim
