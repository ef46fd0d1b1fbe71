// How the reflectance of fixed things varies over their surface: worn and dirty paint, windows in a
// facade, stones, tufts of grass. In cells of 0.5 m it is the material's times 1 + v (4 u^3 - 1),
// with v the material's variation and u uniform in 0 .. 1, drawn from the cell alone: the mean is
// the material's, most cells are darker, few are up to 1 + 3 v times as bright, and it does not
// depend on place or time of the view. Public scans have such tails: neighbouring returns mostly
// agree within the noise, and now and then differ by a multiple (docs/devices/velodyne.md).
//
// The cells are cubes of a lattice in the world that is turned against its axes, so that no wall or
// floor lies along their faces.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace rigwire::sim {

inline constexpr double kGrainCell_m = 0.5;

/// Rows of the turn by 0.7 rad about z, 0.5 about y and 0.4 about x.
inline constexpr std::array<std::array<float, 3>, 3> kGrainAxes{
    {{0.6712122F, -0.4505700F, 0.5886093F},
     {0.5653542F, 0.8247399F, -0.0133698F},
     {-0.4794255F, 0.3417467F, 0.8083071F}}};

/// Where the lattice lies in coordinates relative to `origin_W`.
struct GrainLattice {
  explicit GrainLattice(const Eigen::Vector3d& origin_W) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& axis = kGrainAxes[i];
      const double cells = (static_cast<double>(axis[0]) * origin_W.x() +
                            static_cast<double>(axis[1]) * origin_W.y() +
                            static_cast<double>(axis[2]) * origin_W.z()) /
                           kGrainCell_m;
      const double whole = std::round(cells);
      start[i] = static_cast<float>(cells - whole);
      first[i] = static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
    }
  }

  std::array<float, 3> start{};          ///< Place of the origin within its cell, -0.5 .. 0.5.
  std::array<std::uint32_t, 3> first{};  ///< Cell of the origin.
};

/// Bits of three numbers, mixed in the upper ones: a product of each, which wait for nothing, and
/// two more steps.
[[nodiscard]] inline std::uint32_t grain_bits(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint32_t bits = a * 0x9E3779B1U + b * 0x85EBCA77U + c * 0xC2B2AE3DU;
  bits = (bits ^ (bits >> 15U)) * 0x2C1B3C6DU;
  bits = (bits ^ (bits >> 13U)) * 0x297A2D39U;
  return bits;
}

/// 1 + v (4 u^3 - 1) for u of these bits.
[[nodiscard]] inline float grain_gain(std::uint32_t bits, float variation) {
  const float u = static_cast<float>(static_cast<std::int32_t>(bits >> 8U)) * 0x1.0p-24F;
  return 1.0F + variation * (4.0F * u * u * u - 1.0F);
}

/// Returns the reflectance, at most 1, of a surface of that mean reflectance at a place relative to
/// the lattice's origin. Without branches, for loops over lanes.
[[nodiscard]] inline float grained(float reflectance, float variation, float x, float y, float z,
                                   const GrainLattice& lattice) {
  constexpr auto kPerCell = static_cast<float>(1.0 / kGrainCell_m);
  // Adding 1.5 x 2^23 leaves the nearest whole number in the lowest bits.
  constexpr float kWhole = 12582912.0F;
  const auto cell = [&](std::size_t i) {
    const auto& axis = kGrainAxes[i];
    const float cells = (axis[0] * x + axis[1] * y + axis[2] * z) * kPerCell + lattice.start[i];
    return std::bit_cast<std::uint32_t>(cells + kWhole) + lattice.first[i];
  };
  const float varied = reflectance * grain_gain(grain_bits(cell(0), cell(1), cell(2)), variation);
  return varied < 1.0F ? varied : 1.0F;
}

}  // namespace rigwire::sim
