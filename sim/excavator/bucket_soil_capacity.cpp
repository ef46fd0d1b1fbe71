#include "sim/excavator/bucket_soil_capacity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr int kDegrees = 360;
constexpr int kPoints = 48;  // Counted along each side of the cross-section.

}  // namespace

BucketCapacity::BucketCapacity(const BucketSoilParameters& parameters, double bucket_tip_m) {
  validate(parameters, bucket_tip_m);
  opening_m_ = bucket_tip_m - parameters.rear_lip_m;
  const double area_m2 = parameters.struck_capacity_m3 / parameters.width_m;
  // Half ellipse over the opening with the struck area: A = pi / 4 x opening x depth.
  depth_m_ = 4.0 * area_m2 / (std::numbers::pi * opening_m_);
  // Roof at the angle of repose: triangle of half the opening, area (o / 2)^2 tan.
  heaped_m3_ = parameters.struck_capacity_m3 + 0.25 * opening_m_ * opening_m_ *
                                                   std::tan(parameters.heap_repose_rad) *
                                                   parameters.width_m;
  for (int degree = 0; degree <= kDegrees; ++degree) {
    held_m3_.push_back(
        std::min(heaped_m3_, counted_m3(parameters, (degree - 180) * std::numbers::pi / 180.0)));
  }
}

double BucketCapacity::counted_m3(const BucketSoilParameters& parameters, double pitch_rad) const {
  const double sine = std::sin(pitch_rad);
  const double cosine = std::cos(pitch_rad);
  const double slope = std::tan(parameters.heap_repose_rad);
  const double half = 0.5 * opening_m_;
  // Coordinates from the opening's middle: x to the teeth, z into the shell; h and s are height
  // and horizontal distance along the arm.
  const auto below = [&](double h, double s, double lip_x) {
    return h <= lip_x * sine + slope * std::abs(s - lip_x * cosine);
  };
  const double top = half * slope;  // Of the roof, on the side of z < 0.
  const double cell_x = opening_m_ / kPoints;
  const double cell_z = (depth_m_ + top) / kPoints;
  double area = 0.0;
  double shell = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      const double x = -half + (i + 0.5) * cell_x;
      const double z = -top + (j + 0.5) * cell_z;
      const double h = x * sine + z * cosine;
      const double s = x * cosine - z * sine;
      const bool over_opening = std::abs(s) < half * std::abs(cosine);
      bool carried = false;
      if (z >= 0.0) {
        if (std::hypot(x / half, z / depth_m_) > 1.0) {
          continue;  // Outside the shell.
        }
        shell += cell_x * cell_z;
        carried = cosine < 0.0 || !over_opening;
      } else {
        carried = cosine < 0.0 && over_opening;
      }
      if (carried && below(h, s, half) && below(h, s, -half)) {
        area += cell_x * cell_z;
      }
    }
  }
  return area / shell * parameters.struck_capacity_m3;
}

double BucketCapacity::held_m3(double pitch_rad) const {
  if (!std::isfinite(pitch_rad)) {
    return 0.0;
  }
  double turn = pitch_rad / (2.0 * std::numbers::pi) + 0.5;
  turn -= std::floor(turn);
  // Linear between whole degrees.
  const double place = turn * kDegrees;
  const auto at = std::min(static_cast<std::size_t>(place), held_m3_.size() - 2);
  const double share = place - static_cast<double>(at);
  return held_m3_[at] + share * (held_m3_[at + 1] - held_m3_[at]);
}

}  // namespace rigwire::sim
