// Eight shots side by side: the arithmetic between firings and Embree's packets of eight rays.
// Eigen puts it into the processor's vector registers.
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

namespace rigwire::sim {

inline constexpr std::size_t kLanes = 8;

/// One value per lane.
using Lanes = Eigen::Array<float, kLanes, 1>;
using LanesIn = Eigen::Map<const Lanes, Eigen::Aligned32>;

/// `kColumns` quantities of eight lanes.
template <int kColumns>
class LaneTable {
 public:
  /// Copies all quantities of lane `from` of `source` to lane `to`.
  void copy_lane(const LaneTable& source, std::size_t from, std::size_t to) {
    table_.row(static_cast<Eigen::Index>(to)) = source.table_.row(static_cast<Eigen::Index>(from));
  }

  /// All columns one after the other, eight lanes each.
  [[nodiscard]] const float* data() const { return table_.data(); }

 protected:
  [[nodiscard]] auto column(std::size_t i) { return table_.col(static_cast<Eigen::Index>(i)); }
  [[nodiscard]] auto column(std::size_t i) const {
    return table_.col(static_cast<Eigen::Index>(i));
  }

 private:
  Eigen::Array<float, kLanes, kColumns> table_ = Eigen::Array<float, kLanes, kColumns>::Zero();
};

/// Firings at the instant of their first laser, in Embree's coordinates.
class FiringLanes : public LaneTable<9 + 3 + 3 + 3 + 3> {
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
  auto cos_azimuth() { return column(18); }
  auto cos_azimuth() const { return column(18); }
  auto sin_azimuth() { return column(19); }
  auto sin_azimuth() const { return column(19); }
  auto time() { return column(20); }  ///< Share of the slice.
  auto time() const { return column(20); }
  // clang-format on
};

class LaserLanes : public LaneTable<7> {
 public:
  // clang-format off
  auto cos_elevation() { return column(0); }
  auto cos_elevation() const { return column(0); }
  auto sin_elevation() { return column(1); }
  auto sin_elevation() const { return column(1); }
  auto offset_m() { return column(2); }
  auto offset_m() const { return column(2); }
  auto delay_s() { return column(3); }
  auto delay_s() const { return column(3); }
  auto cos_turn() { return column(4); }  ///< Of the rotor during the delay.
  auto cos_turn() const { return column(4); }
  auto sin_turn() { return column(5); }
  auto sin_turn() const { return column(5); }
  auto delay_share() { return column(6); }  ///< Of the slice.
  auto delay_share() const { return column(6); }
  // clang-format on
};

/// What all rays of a packet have in common.
struct RayLimits {
  float near_m = 0.0F;
  float far_m = 0.0F;
  std::uint32_t mask = 0xFFFFFFFFU;
};

/// A packet ready to be cast. Directions have unit length to 1e-6.
void fill_rays(const FiringLanes& firing, const LaserLanes& laser, const RayLimits& limits,
               RTCRayHit8& packet);

/// A standard normal number for each shot, of (key, shot) alone.
[[nodiscard]] Lanes gaussian_lanes(std::uint64_t key,
                                   const std::array<std::uint64_t, kLanes>& shots);

}  // namespace rigwire::sim
