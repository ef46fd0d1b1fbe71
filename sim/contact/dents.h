// Permanent dents of a machine's bodies: how deep, and where.
//
// A dent is a patch of one body's surface, seen from one side, everywhere as deep as at its
// deepest; overlapping patches of the same side are merged. Later contacts at the patch touch the
// dented surface, not the original one.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rigwire::sim {

struct Dent {
  std::uint32_t body = 0;
  Eigen::AlignedBox3d patch_L;  ///< Patch of the undented surface, in the axes of the body's link.
  Eigen::Vector3d normal_L = Eigen::Vector3d::UnitX();  ///< Into the body.
  double depth_m = 0.0;
};

class Dents {
 public:
  static constexpr std::size_t kMost = 64;

  Dents() { dents_.reserve(kMost); }

  /// Returns the depth of the dent at a point of the body's surface, seen along the unit normal.
  [[nodiscard]] double depth_m(std::uint32_t body, const Eigen::Vector3d& p_L,
                               const Eigen::Vector3d& normal_L) const;
  /// Adds a dent; allocates nothing. Returns false if there is no room for it.
  bool bend(const Dent& dent);

  [[nodiscard]] std::span<const Dent> dents() const { return dents_; }
  [[nodiscard]] double deepest_m() const { return deepest_m_; }

 private:
  std::vector<Dent> dents_;
  double deepest_m_ = 0.0;
};

}  // namespace rigwire::sim
