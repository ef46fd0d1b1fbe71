#include "sim/contact/dents.h"

#include <algorithm>

namespace rigwire::sim {
namespace {

constexpr double kSameSide = 0.7;  // Cosine: the next face of a box is another side.
constexpr double kBeside_m = 0.1;  // So far about a patch the sheet metal has come along.

bool same_side(const Dent& dent, std::uint32_t body, const Eigen::Vector3d& normal_L) {
  return dent.body == body && dent.normal_L.dot(normal_L) > kSameSide;
}

}  // namespace

double Dents::depth_m(std::uint32_t body, const Eigen::Vector3d& p_L,
                      const Eigen::Vector3d& normal_L) const {
  double depth = 0.0;
  for (const Dent& dent : dents_) {
    if (same_side(dent, body, normal_L) && dent.patch_L.exteriorDistance(p_L) <= kBeside_m) {
      depth = std::max(depth, dent.depth_m);
    }
  }
  return depth;
}

bool Dents::bend(const Dent& dent) {
  deepest_m_ = std::max(deepest_m_, dent.depth_m);
  for (Dent& known : dents_) {
    if (same_side(known, dent.body, dent.normal_L) &&
        known.patch_L.exteriorDistance(dent.patch_L) <= kBeside_m) {
      known.patch_L.extend(dent.patch_L);
      known.depth_m = std::max(known.depth_m, dent.depth_m);
      return true;
    }
  }
  if (dents_.size() == kMost) {
    return false;
  }
  dents_.push_back(dent);
  return true;
}

}  // namespace rigwire::sim
