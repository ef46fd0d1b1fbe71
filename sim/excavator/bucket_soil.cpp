#include "sim/excavator/bucket_soil.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/ground/earthmoving.h"

namespace rigwire::sim {
namespace {

constexpr double kAhead = 0.75;  // Cells ahead of the lip, where the surface is still uncut.
constexpr double kSupportDepth_m = 0.1;  // Depth from which the soil ahead closes the opening.
constexpr double kHardForceMax_n = 4e6;  // Far beyond what a cylinder can push.
// Minimum outflow, as a share of the heaped capacity per outflow time.
constexpr double kLeastOutflow = 0.02;
constexpr int kDegrees = 360;
constexpr int kPoints = 48;  // Number of points along each side of the cross-section.

bool finite(const LinkMotion& motion) {
  return motion.X_WL.matrix().allFinite() && motion.v_WL_W.allFinite() && motion.w_WL_W.allFinite();
}

}  // namespace

BucketSoil::BucketSoil(const BucketSoilParameters& parameters, double bucket_tip_m,
                       double gravity_mps2, DiggableTerrain& terrain, const LinkMotion& bucket)
    : parameters_(parameters),
      capacity_(parameters, bucket_tip_m),
      tip_m_(bucket_tip_m),
      gravity_mps2_(gravity_mps2),
      terrain_(terrain),
      heaped_units_(terrain.units(capacity_.heaped_m3())),
      lip_(lip_of(bucket.X_WL)) {}

double BucketSoil::volume_m3() const {
  return static_cast<double>(units_) * terrain_.unit_m3();
}
double BucketSoil::elsewhere_m3() const {
  return static_cast<double>(elsewhere_) * terrain_.unit_m3();
}

void BucketSoil::fill(double volume_m3, double mass_kg) {
  const std::int64_t added = terrain_.units(volume_m3);
  units_ += added;
  elsewhere_ -= added;
  mass_kg_ += std::max(0.0, mass_kg);
}

BucketSoil::Lip BucketSoil::lip_of(const Eigen::Isometry3d& X_WB) const {
  Lip lip;
  const Eigen::Matrix3d R = X_WB.linear();
  lip.middle_W = X_WB * Eigen::Vector3d(tip_m_, 0.0, 0.0);
  lip.rear_W = X_WB * Eigen::Vector3d(parameters_.rear_lip_m, 0.0, 0.0);
  lip.edge.left_W = lip.middle_W + 0.5 * parameters_.width_m * R.col(1);
  lip.edge.right_W = lip.middle_W - 0.5 * parameters_.width_m * R.col(1);
  lip.left_W = Eigen::Vector3d(R(0, 1), R(1, 1), 0.0).normalized();
  // The bucket's x axis turned by the lip angle towards -z.
  lip.blade_W = std::cos(parameters_.lip_angle_rad) * R.col(0) -
                std::sin(parameters_.lip_angle_rad) * R.col(2);
  // Horizontal, square to the lip, on the side to which the opening looks.
  lip.forward_W = lip.left_W.cross(Eigen::Vector3d::UnitZ());
  if (lip.forward_W.dot(lip.blade_W - R.col(2)) < 0.0) {
    lip.forward_W = -lip.forward_W;
  }
  return lip;
}

double BucketSoil::depth_ahead_m(const Lip& lip) const {
  double sum = 0.0;
  // Mean of three places along the lip, 0.4 of its width to either side.
  for (const double side : {-0.4, 0.0, 0.4}) {
    const Eigen::Vector3d p = lip.middle_W + side * (lip.edge.left_W - lip.edge.right_W);
    const Eigen::Vector3d ahead = p + kAhead * terrain_.cell_m() * lip.forward_W;
    sum += std::max(0.0, terrain_.height_m(ahead.x(), ahead.y()) - p.z());
  }
  return sum / 3.0;
}

double BucketSoil::cutting_limit_n(const Lip& lip, const SoilParameters& soil) const {
  const double rake = std::acos(std::clamp(lip.blade_W.dot(lip.forward_W), -1.0, 1.0));
  const EarthmovingFactors factors =
      earthmoving_factors(soil.internal_friction_rad, soil.tool_friction_rad, rake);
  // Content as surcharge q over the opening; P of the earthmoving equation plus the teeth's share.
  const double surcharge_pa =
      mass_kg_ * gravity_mps2_ / (parameters_.width_m * capacity_.opening_length_m());
  return earthmoving_force_n(soil, factors, depth_m_, parameters_.width_m, surcharge_pa,
                             gravity_mps2_) +
         edge_limit_n();
}

double BucketSoil::side_limit_n(const SoilParameters& soil) const {
  const EarthmovingFactors factors = earthmoving_factors(
      soil.internal_friction_rad, soil.tool_friction_rad, 0.5 * std::numbers::pi);
  return earthmoving_force_n(soil, factors, depth_m_, std::min(depth_m_, capacity_.depth_m()), 0.0,
                             gravity_mps2_);
}

BucketGroundLoad BucketSoil::load(double h, const LinkMotion& bucket) {
  BucketGroundLoad load;
  depth_m_ = 0.0;
  limit_n_ = 0.0;
  if (!(h > 0.0) || !finite(bucket)) {
    return load;
  }
  const Lip lip = lip_of(bucket.X_WL);
  load.point_W = lip.middle_W;
  depth_m_ = depth_ahead_m(lip);
  const double hard_m = hard_depth_m(lip);
  if (depth_m_ <= 0.0 && hard_m <= 0.0) {
    return load;
  }
  double side_n = 0.0;
  if (depth_m_ > 0.0) {
    const SoilParameters& soil = terrain_.soil_at(lip.middle_W.x(), lip.middle_W.y());
    limit_n_ = cutting_limit_n(lip, soil);
    side_n = side_limit_n(soil);
  }
  // Hard ground below: linear spring on the deeper corner, friction mu times its push.
  const double push_n = std::clamp(parameters_.hard_stiffness_npm * hard_m, 0.0, kHardForceMax_n);
  const double grip_n = parameters_.hard_friction * push_n;
  const double ramp = 1.0 / parameters_.ramp_speed_mps;
  // Directions and bounds depend on where the lip is, not on how it moves: so nothing can chatter.
  resist(lip.forward_W, {-limit_n_ - grip_n, grip_n}, 0.0, ramp * (limit_n_ + grip_n), load);
  resist(lip.left_W, {-side_n - grip_n, side_n + grip_n}, 0.0, ramp * (side_n + grip_n), load);
  if (hard_m > 0.0) {
    resist(Eigen::Vector3d::UnitZ(), {0.0, kHardForceMax_n}, push_n,
           h * parameters_.hard_stiffness_npm + parameters_.hard_damping_nspm, load);
  } else {
    resist(Eigen::Vector3d::UnitZ(), {0.0, edge_limit_n()}, 0.0, ramp * edge_limit_n(), load);
  }
  return load;
}

void BucketSoil::resist(const Eigen::Vector3d& direction_W, ForceRange range, double at_rest_n,
                        double gain_nspm, BucketGroundLoad& load) const {
  const double half = 0.5 * (range.greatest_n - range.least_n);
  if (!(half > 0.0)) {
    return;
  }
  // A resistance is bounded by +-limit; the constant force moves its middle.
  const double middle = 0.5 * (range.greatest_n + range.least_n);
  load.force_W += middle * direction_W;
  load.resistances[load.count++] = {.direction_W = direction_W,
                                    .offset_n = at_rest_n - middle,
                                    .gain_nspm = gain_nspm,
                                    .limit_n = half,
                                    .point_B = {tip_m_, 0.0, 0.0}};
}

double BucketSoil::hard_depth_m(const Lip& lip) const {
  double depth_m = 0.0;
  for (const Eigen::Vector3d& corner : {lip.edge.left_W, lip.edge.right_W}) {
    depth_m = std::max(depth_m, terrain_.floor_height_m(corner.x(), corner.y()) - corner.z());
  }
  return depth_m;
}

void BucketSoil::advance(double h, const LinkMotion& bucket) {
  if (!(h > 0.0) || !finite(bucket)) {
    return;
  }
  const Lip next = lip_of(bucket.X_WL);
  const CutSoil soil = terrain_.cut(lip_.edge, next.edge, next.forward_W);
  lip_ = next;
  units_ += soil.units;
  mass_kg_ += soil.mass_kg;
  depth_m_ = depth_ahead_m(lip_);
  if (units_ > heaped_units_) {
    const std::int64_t pushed = units_ - heaped_units_;
    release(pushed);
    spill(lip_, pushed);
  }
  if (units_ > 0) {
    // What stays: held at this pitch, up to heaped as the soil ahead closes the opening.
    const double pitch = std::atan2(bucket.X_WL.linear()(2, 0), bucket.X_WL.linear()(2, 2));
    const double support = std::min(1.0, depth_m_ / kSupportDepth_m);
    const double held = capacity_.held_m3(pitch);
    const std::int64_t stays = terrain_.units(held + support * (capacity_.heaped_m3() - held));
    const std::int64_t excess = units_ - stays;
    if (excess > 0) {
      // Outflow decays exponentially over h, and ends in finite time because of a minimum rate.
      const double share = -std::expm1(-h / parameters_.outflow_time_s);
      const double least =
          kLeastOutflow * static_cast<double>(heaped_units_) * h / parameters_.outflow_time_s;
      const auto out = std::min(
          excess, static_cast<std::int64_t>(share * static_cast<double>(excess) + least) + 1);
      release(out);
      if (support > 0.0) {
        spill(lip_, out);
      } else {
        drop(lip_.middle_W.z() < lip_.rear_W.z() ? lip_.middle_W : lip_.rear_W, out);
      }
    }
  }
  terrain_.settle();
}

void BucketSoil::place(const LinkMotion& bucket) {
  if (finite(bucket)) {
    lip_ = lip_of(bucket.X_WL);
  }
}

void BucketSoil::release(std::int64_t units) {
  // The density is uniform: mass leaves with its share of the volume.
  mass_kg_ = units >= units_
                 ? 0.0
                 : mass_kg_ * (static_cast<double>(units_ - units) / static_cast<double>(units_));
  units_ -= units;
}

void BucketSoil::spill(const Lip& lip, std::int64_t units) {
  const Eigen::Vector3d ahead = lip.middle_W + terrain_.cell_m() * lip.forward_W;
  terrain_.pour(ahead.x(), ahead.y(), parameters_.pour_radius_m, units);
}

void BucketSoil::drop(const Eigen::Vector3d& from_W, std::int64_t units) {
  if (obstacle_ != nullptr &&
      obstacle_->catches(from_W, terrain_.height_m(from_W.x(), from_W.y()))) {
    elsewhere_ += units;
    return;
  }
  terrain_.pour(from_W.x(), from_W.y(), parameters_.pour_radius_m, units);
}

// What the shell holds.

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
  const double top = half * slope;  // Height of the heap on the side of z < 0.
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
