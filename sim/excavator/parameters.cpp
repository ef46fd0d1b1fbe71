#include "sim/excavator/parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "sim/excavator/driven_arm.h"
#include "sim/excavator/linkage.h"

namespace rigwire::sim {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument(name + ": found " + found + ", allowed " + allowed);
}

std::string text(double value) {
  std::ostringstream stream;
  stream.precision(9);
  stream << value;
  return stream.str();
}

void require(bool fine, const std::string& name, double found, const std::string& allowed) {
  if (!fine) {
    refuse(name, text(found), allowed);
  }
}

void require_positive(const std::string& name, double found) {
  require(std::isfinite(found) && found > 0.0, name, found, "finite and > 0");
}

template <typename Vector>
void require_finite(const std::string& name, const Vector& found) {
  for (Eigen::Index i = 0; i < found.size(); ++i) {
    require(std::isfinite(found[i]), name + "[" + std::to_string(i) + "]", found[i], "finite");
  }
}

void check_body(const std::string& name, const RigidBodyParameters& body) {
  require_positive(name + ".mass_kg", body.mass_kg);
  require_finite(name + ".center_of_mass_m", body.center_of_mass_m);
  const Eigen::Vector3d& inertia = body.principal_inertia_kgm2;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double others = inertia.sum() - inertia[i];
    require(std::isfinite(inertia[i]) && inertia[i] > 0.0 && inertia[i] <= others * (1.0 + 1e-9),
            name + ".principal_inertia_kgm2[" + std::to_string(i) + "]", inertia[i],
            "> 0 and at most the sum of the other two (" + text(others) + ")");
  }
}

void check_four_bar(const BucketLinkageParameters& linkage) {
  require_finite("bucket_linkage.base_pin_m", linkage.base_pin_m);
  require_finite("bucket_linkage.idler_pivot_m", linkage.idler_pivot_m);
  require_positive("bucket_linkage.idler_length_m", linkage.idler_length_m);
  require_positive("bucket_linkage.link_length_m", linkage.link_length_m);
  require_positive("bucket_linkage.lug_radius_m", linkage.lug_radius_m);
  require(std::abs(linkage.lug_angle_rad) <= std::numbers::pi, "bucket_linkage.lug_angle_rad",
          linkage.lug_angle_rad, "-pi .. pi");
  require(linkage.branch == 1 || linkage.branch == -1, "bucket_linkage.branch", linkage.branch,
          "1 or -1");
}

void check_initial(const ExcavatorPose& pose, const Linkages& linkages) {
  require(std::isfinite(pose.swing_rad), "initial.swing_rad", pose.swing_rad, "finite");
  const std::array<double, 3> angles{pose.boom_rad, pose.stick_rad, pose.bucket_rad};
  const std::array<const char*, 3> names{"initial.boom_rad", "initial.stick_rad",
                                         "initial.bucket_rad"};
  for (int joint = 0; joint < 3; ++joint) {
    const auto i = static_cast<std::size_t>(joint);
    const WorkingRange& range = linkages.range(joint);
    require(
        angles[i] >= range.q_min_rad() && angles[i] <= range.q_max_rad(), names[i], angles[i],
        text(range.q_min_rad()) + " .. " + text(range.q_max_rad()) + " (the cylinder's stroke)");
  }
}

// The stiffest pose is searched on a grid of strokes, because levers and masses vary with it.
double stiffest_radps(const ExcavatorParameters& p, const DrivenArm& arm) {
  JointVector stiffness = arm.gains.stiffness;
  if (p.scheme == IntegrationScheme::runge_kutta4) {
    stiffness.tail<3>().array() += p.drives.end_stop_stiffness_npm;
  }
  double highest = 0.0;
  for (int boom = 0; boom <= 4; ++boom) {
    for (int stick = 0; stick <= 4; ++stick) {
      for (int bucket = 0; bucket <= 4; ++bucket) {
        const std::array<int, 3> at{boom, stick, bucket};
        JointVector q = JointVector::Zero();
        for (int joint = 0; joint < 3; ++joint) {
          const WorkingRange& range = arm.linkages().range(joint);
          const double share = 0.25 * at[static_cast<std::size_t>(joint)];
          q[joint + 1] = range.q_min_rad() + share * (range.q_max_rad() - range.q_min_rad());
        }
        highest = std::max(highest, arm.highest_frequency_radps(q, stiffness));
      }
    }
  }
  return highest;
}

}  // namespace

double drive_step_limit(IntegrationScheme scheme) {
  switch (scheme) {
    case IntegrationScheme::rosenbrock2:
      return 2.0;
    case IntegrationScheme::runge_kutta4:
      return 1.4;
    case IntegrationScheme::linearly_implicit_euler:
      break;
  }
  return 30.0;
}

void validate(const ExcavatorParameters& p) {
  check_body("undercarriage", p.undercarriage);
  check_body("upper", p.upper);
  check_body("boom", p.boom);
  check_body("stick", p.stick);
  check_body("bucket", p.bucket);
  require_finite("payload_center_of_mass_m", p.payload_center_of_mass_m);
  require(std::isfinite(p.payload_max_kg) && p.payload_max_kg >= 0.0, "payload_max_kg",
          p.payload_max_kg, "finite and >= 0");
  require(std::isfinite(p.swing_axis_height_m), "swing_axis_height_m", p.swing_axis_height_m,
          "finite");
  require_finite("boom_foot_m", p.boom_foot_m);
  require_positive("boom_length_m", p.boom_length_m);
  require_positive("stick_length_m", p.stick_length_m);
  require_positive("bucket_tip_m", p.bucket_tip_m);
  require_finite("boom_linkage.base_pin_m", p.boom_linkage.base_pin_m);
  require_finite("boom_linkage.rod_pin_m", p.boom_linkage.rod_pin_m);
  require_finite("stick_linkage.base_pin_m", p.stick_linkage.base_pin_m);
  require_finite("stick_linkage.rod_pin_m", p.stick_linkage.rod_pin_m);
  check_four_bar(p.bucket_linkage);
  validate(p.boom_cylinder, "boom_cylinder");
  validate(p.stick_cylinder, "stick_cylinder");
  validate(p.bucket_cylinder, "bucket_cylinder");
  require_positive("swing_displacement_m3prad", p.swing_displacement_m3prad);
  validate(p.supply, "supply");
  validate(p.swing_spool, "swing_spool");
  validate(p.boom_spool, "boom_spool");
  validate(p.stick_spool, "stick_spool");
  validate(p.bucket_spool, "bucket_spool");
  require_positive("drives.swing_stiffness_nmprad", p.drives.swing_stiffness_nmprad);
  require_positive("drives.boom_stiffness_npm", p.drives.boom_stiffness_npm);
  require_positive("drives.stick_stiffness_npm", p.drives.stick_stiffness_npm);
  require_positive("drives.bucket_stiffness_npm", p.drives.bucket_stiffness_npm);
  require(p.drives.damping_ratio >= 0.0 && p.drives.damping_ratio <= 10.0, "drives.damping_ratio",
          p.drives.damping_ratio, "0 .. 10");
  require(p.drives.end_stop_stiffness_npm >= 1e7 && p.drives.end_stop_stiffness_npm <= 1e12,
          "drives.end_stop_stiffness_npm", p.drives.end_stop_stiffness_npm, "1e7 .. 1e12 N/m");
  require(p.drives.cushion >= 0.0 && p.drives.cushion <= 0.25, "drives.cushion", p.drives.cushion,
          "0 .. 0.25 of the stroke");
  validate(p.chambers, "chambers");
  require_positive("wheels.wheelbase_m", p.wheels.wheelbase_m);
  require_positive("wheels.track_m", p.wheels.track_m);
  require_positive("wheels.tyre_pressure_pa", p.wheels.tyre_pressure_pa);
  validate(p.wheels.tyre, "wheels.tyre");
  if (p.carrier == ExcavatorCarrier::moving && p.level == ExcavatorLevel::kinematic) {
    refuse("carrier", "moving", "fixed where level is kinematic: without forces nothing rocks");
  }
  if (p.scheme != IntegrationScheme::linearly_implicit_euler &&
      (p.level != ExcavatorLevel::dynamic || p.carrier != ExcavatorCarrier::fixed)) {
    refuse("scheme", "another than linearly_implicit_euler",
           "linearly_implicit_euler, unless level is dynamic and carrier is fixed");
  }
  require(p.step_s >= 1e-6 && p.step_s <= 0.05, "step_s", p.step_s, "1e-6 .. 0.05 s");
  require(std::isfinite(p.gravity_mps2) && p.gravity_mps2 >= 0.0, "gravity_mps2", p.gravity_mps2,
          "finite and >= 0");

  const DrivenArm arm(p, Eigen::Vector3d(0.0, 0.0, -p.gravity_mps2));
  check_initial(p.initial, arm.linkages());
  if (p.level != ExcavatorLevel::dynamic) {
    return;  // No springs.
  }
  const double frequency = stiffest_radps(p, arm);
  const double limit = drive_step_limit(p.scheme);
  if (!(p.step_s * frequency <= limit)) {
    refuse("drives",
           "stiffnesses with a mode of " + text(frequency) + " rad/s, at step_s = " +
               text(p.step_s) + " s a product of " + text(p.step_s * frequency),
           "at most " + text(limit) + " for this scheme: a step_s of at most " +
               text(limit / frequency) + " s, or stiffnesses " +
               text(std::pow(p.step_s * frequency / limit, 2.0)) + " times smaller");
  }
}

}  // namespace rigwire::sim
