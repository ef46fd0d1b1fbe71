#include "sim/excavator/linkage.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "fields/check.h"

namespace rigwire::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kScanStep_rad = 0.25 * kPi / 180.0;
constexpr double kDeadCentreMargin_m = 0.010;

Eigen::Vector2d perpendicular(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

double wrap(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * kPi);
}

/// `end`: the key of a file.
[[noreturn]] void refuse(const char* cylinder, const char* end, double found_m, double from_m,
                         double to_m) {
  std::ostringstream text;
  text << "not reachable with these pins, found " << found_m << " m, allowed " << from_m << " .. "
       << to_m << " m (" << kDeadCentreMargin_m << " m from the dead centres)";
  throw fields::Refused(std::string(cylinder) + "." + end, text.str());
}

void check_reach(const char* name, const CylinderParameters& cylinder, double shortest_m,
                 double longest_m) {
  const double from = shortest_m + kDeadCentreMargin_m;
  const double to = longest_m - kDeadCentreMargin_m;
  if (!(cylinder.length_min_m >= from && cylinder.length_min_m <= to)) {
    refuse(name, "length_min", cylinder.length_min_m, from, to);
  }
  if (!(cylinder.length_max_m > cylinder.length_min_m && cylinder.length_max_m <= to)) {
    refuse(name, "length_max", cylinder.length_max_m, cylinder.length_min_m, to);
  }
}

WorkingRange direct_range(const DirectLinkage& linkage, const CylinderParameters& cylinder,
                          int lever_sign) {
  return {linkage.angle_at(cylinder.length_min_m, lever_sign),
          linkage.angle_at(cylinder.length_max_m, lever_sign), cylinder.length_min_m,
          cylinder.length_max_m};
}

struct Interval {
  double upper_rad = 0.0;
  double lower_rad = 0.0;
  double shortest_m = 0.0;
  double longest_m = 0.0;
};

// The stretch of joint angles, going down, on which the four-bar closes and the length grows; of
// all such stretches within two turns the one with the most travel, and of its repetitions the one
// whose middle is nearest to zero.
Interval growing_interval(const BucketLinkage& linkage) {
  Interval best;
  Interval current;
  bool inside = false;
  const auto close = [&](double q_rad) {
    current.lower_rad = q_rad;
    current.longest_m = linkage.at(q_rad).length_m;
    const double gain =
        (current.longest_m - current.shortest_m) - (best.longest_m - best.shortest_m);
    const bool nearer =
        std::abs(current.upper_rad + current.lower_rad) < std::abs(best.upper_rad + best.lower_rad);
    if (gain > 1e-6 || (gain > -1e-6 && nearer)) {
      best = current;
    }
    inside = false;
  };
  double previous = 0.0;
  for (double q = 3.0 * kPi; q > -3.0 * kPi; q -= kScanStep_rad) {
    const bool growing = linkage.closes_at(q) && linkage.at(q).lever_m < 0.0;
    if (growing && !inside) {
      current = {q, q, linkage.at(q).length_m, 0.0};
      inside = true;
    } else if (!growing && inside) {
      close(previous);
    }
    previous = q;
  }
  return best;
}

}  // namespace

double WorkingRange::q_min_rad() const {
  return std::min(q_retracted_rad, q_extended_rad);
}
double WorkingRange::q_max_rad() const {
  return std::max(q_retracted_rad, q_extended_rad);
}

DirectLinkage::DirectLinkage(const Eigen::Vector2d& base_pin_m, const Eigen::Vector2d& rod_pin_m)
    : base_radius_m_(base_pin_m.norm()),
      rod_radius_m_(rod_pin_m.norm()),
      offset_rad_(std::atan2(rod_pin_m.y(), rod_pin_m.x()) -
                  std::atan2(base_pin_m.y(), base_pin_m.x())),
      offset_(Turn::by(offset_rad_)) {}

// Law of cosines on base pin, joint and rod pin; the lever dL/dq = a b sin(theta) / L.
CylinderGeometry DirectLinkage::at(double q_rad) const {
  const double theta = q_rad + offset_rad_;
  const double product = base_radius_m_ * rod_radius_m_;
  // (a - b)^2 + 4 a b sin^2(theta / 2) keeps its digits where a^2 + b^2 - 2 a b cos loses them.
  const double half_sine = std::sin(0.5 * theta);
  const double difference = base_radius_m_ - rod_radius_m_;
  const double length = std::sqrt(difference * difference + 4.0 * product * half_sine * half_sine);
  return {length, length > 0.0 ? product * std::sin(theta) / length : 0.0};
}

CylinderGeometry DirectLinkage::at(const Turn& q) const {
  const Turn theta = q + offset_;
  const double product = base_radius_m_ * rod_radius_m_;
  const double length =
      std::sqrt(std::max(0.0, base_radius_m_ * base_radius_m_ + rod_radius_m_ * rod_radius_m_ -
                                  2.0 * product * theta.cosine));
  return {length, length > 0.0 ? product * theta.sine / length : 0.0};
}

double DirectLinkage::angle_at(double length_m, int lever_sign) const {
  // Law of cosines solved for the angle, on the branch asked for.
  const double cosine =
      (base_radius_m_ * base_radius_m_ + rod_radius_m_ * rod_radius_m_ - length_m * length_m) /
      (2.0 * base_radius_m_ * rod_radius_m_);
  return wrap(lever_sign * std::acos(std::clamp(cosine, -1.0, 1.0)) - offset_rad_);
}

double DirectLinkage::shortest_m() const {
  return std::abs(base_radius_m_ - rod_radius_m_);
}
double DirectLinkage::longest_m() const {
  return base_radius_m_ + rod_radius_m_;
}

BucketLinkage::BucketLinkage(const BucketLinkageParameters& parameters, double stick_length_m)
    : base_pin_m_(parameters.base_pin_m),
      idler_pivot_m_(parameters.idler_pivot_m),
      bucket_pin_m_(stick_length_m, 0.0),
      idler_length_m_(parameters.idler_length_m),
      link_length_m_(parameters.link_length_m),
      lug_radius_m_(parameters.lug_radius_m),
      lug_angle_rad_(parameters.lug_angle_rad),
      branch_(parameters.branch < 0 ? -1.0 : 1.0),
      lug_(Turn::by(lug_angle_rad_)) {}

Eigen::Vector2d BucketLinkage::lug_arm_m(const Turn& q) const {
  const Turn psi = q + lug_;
  return {lug_radius_m_ * psi.cosine, lug_radius_m_ * psi.sine};
}

bool BucketLinkage::closes_at(double q_rad) const {
  const double distance = (bucket_pin_m_ + lug_arm_m(Turn::by(q_rad)) - idler_pivot_m_).norm();
  return distance < idler_length_m_ + link_length_m_ &&
         distance > std::abs(idler_length_m_ - link_length_m_);
}

Eigen::Vector2d BucketLinkage::idler_joint_m(double q_rad) const {
  return idler_joint_of(bucket_pin_m_ + lug_arm_m(Turn::by(q_rad)));
}

Eigen::Vector2d BucketLinkage::idler_joint_of(const Eigen::Vector2d& lug_m) const {
  const Eigen::Vector2d to_lug = lug_m - idler_pivot_m_;
  const double distance = std::max(to_lug.norm(), 1e-9);
  const Eigen::Vector2d along = to_lug / distance;
  const double idler2 = idler_length_m_ * idler_length_m_;
  // Circles about idler pivot and lug: (d^2 + r1^2 - r2^2) / (2 d) along the line, the rest aside.
  const double reach =
      (distance * distance + idler2 - link_length_m_ * link_length_m_) / (2.0 * distance);
  const double clamped = std::clamp(reach, -idler_length_m_, idler_length_m_);
  const double aside = std::sqrt(std::max(idler2 - clamped * clamped, 0.0));
  return idler_pivot_m_ + clamped * along + branch_ * aside * perpendicular(along);
}

CylinderGeometry BucketLinkage::at(const Turn& q) const {
  const Eigen::Vector2d lug_arm = lug_arm_m(q);
  const Eigen::Vector2d lug = bucket_pin_m_ + lug_arm;
  const Eigen::Vector2d joint = idler_joint_of(lug);
  const Eigen::Vector2d link = joint - lug;
  // The link keeps its length: idler rate w = link . lug' / (link . swing), dL/dq = w (u . swing).
  const Eigen::Vector2d swing = perpendicular(joint - idler_pivot_m_);
  const Eigen::Vector2d cylinder = joint - base_pin_m_;
  const double length = cylinder.norm();
  double across = link.dot(swing);
  const double least = 1e-6 * idler_length_m_ * link_length_m_;
  if (std::abs(across) < least) {
    across = std::copysign(least, across);
  }
  const double idler_rate = link.dot(perpendicular(lug_arm)) / across;
  return {length, length > 0.0 ? idler_rate * cylinder.dot(swing) / length : 0.0};
}

double BucketLinkage::angle_at(double length_m, double from_rad, double to_rad) const {
  const bool rises = at(to_rad).length_m > at(from_rad).length_m;
  double low = rises ? from_rad : to_rad;
  double high = rises ? to_rad : from_rad;
  if (length_m <= at(low).length_m) {
    return low;
  }
  if (length_m >= at(high).length_m) {
    return high;
  }
  // Bisection: the length is monotone between the two ends.
  for (int i = 0; i < 60 && std::abs(high - low) > 1e-14; ++i) {
    const double middle = 0.5 * (low + high);
    (at(middle).length_m < length_m ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double BucketLinkage::dead_centre(double from_rad) const {
  double high = from_rad;
  double low = high - kScanStep_rad;
  while (at(low).lever_m < 0.0 && closes_at(low) && from_rad - low < 2.0 * kPi) {
    high = low;
    low -= kScanStep_rad;
  }
  // Bisection on the sign of the lever.
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (at(middle).lever_m < 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

Linkages::Linkages(const ExcavatorParameters& parameters)
    : boom_(parameters.boom_linkage.base_pin_m, parameters.boom_linkage.rod_pin_m),
      stick_(parameters.stick_linkage.base_pin_m - Eigen::Vector2d(parameters.boom_length_m, 0.0),
             parameters.stick_linkage.rod_pin_m),
      bucket_(parameters.bucket_linkage, parameters.stick_length_m) {
  check_reach("boom_cylinder", parameters.boom_cylinder, boom_.shortest_m(), boom_.longest_m());
  check_reach("stick_cylinder", parameters.stick_cylinder, stick_.shortest_m(), stick_.longest_m());
  const Interval bucket = growing_interval(bucket_);
  check_reach("bucket_cylinder", parameters.bucket_cylinder, bucket.shortest_m, bucket.longest_m);

  ranges_[0] = direct_range(boom_, parameters.boom_cylinder, 1);
  ranges_[1] = direct_range(stick_, parameters.stick_cylinder, -1);
  const CylinderParameters& cylinder = parameters.bucket_cylinder;
  ranges_[2] = {bucket_.angle_at(cylinder.length_min_m, bucket.upper_rad, bucket.lower_rad),
                bucket_.angle_at(cylinder.length_max_m, bucket.upper_rad, bucket.lower_rad),
                cylinder.length_min_m, cylinder.length_max_m};

  const auto margin = [](const CylinderParameters& c, double shortest_m, double longest_m) {
    return std::min(c.length_min_m - shortest_m, longest_m - c.length_max_m);
  };
  margins_m_ = {margin(parameters.boom_cylinder, boom_.shortest_m(), boom_.longest_m()),
                margin(parameters.stick_cylinder, stick_.shortest_m(), stick_.longest_m()),
                margin(cylinder, bucket.shortest_m, bucket.longest_m)};
}

CylinderGeometry Linkages::at(int joint, double q_rad) const {
  switch (joint) {
    case 0:
      return boom_.at(q_rad);
    case 1:
      return stick_.at(q_rad);
    default:
      return bucket_.at(q_rad);
  }
}

CylinderGeometry Linkages::at(int joint, const Turn& q) const {
  switch (joint) {
    case 0:
      return boom_.at(q);
    case 1:
      return stick_.at(q);
    default:
      return bucket_.at(q);
  }
}

double Linkages::angle_at(int joint, double length_m) const {
  const WorkingRange& range = ranges_[index(joint)];
  switch (joint) {
    case 0:
      return boom_.angle_at(length_m, 1);
    case 1:
      return stick_.angle_at(length_m, -1);
    default:
      return bucket_.angle_at(length_m, range.q_retracted_rad, range.q_extended_rad);
  }
}

}  // namespace rigwire::sim
