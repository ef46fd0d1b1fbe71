#include "dig_cycle/machine.h"

#include <cmath>

namespace rigwire::dig_cycle {

ArmShape arm_shape(const Machine& machine, const PerJoint& angles_rad) {
  const auto along = [](PlanePoint from, double length_m, double pitch_rad) {
    return PlanePoint{from.x_m + length_m * std::cos(pitch_rad),
                      from.z_m + length_m * std::sin(pitch_rad)};
  };
  ArmShape shape;
  double pitch_rad = angles_rad[boom];
  shape.foot = {machine.boom_foot_x_m, machine.boom_foot_z_m};
  shape.stick_pin = along(shape.foot, machine.boom_length_m, pitch_rad);
  pitch_rad += angles_rad[stick];
  shape.bucket_pin = along(shape.stick_pin, machine.stick_length_m, pitch_rad);
  pitch_rad += angles_rad[bucket];
  shape.tip = along(shape.bucket_pin, machine.bucket_length_m, pitch_rad);
  return shape;
}

double boom_lever_m(const Machine& machine, double boom_rad) {
  const double rod_x_m =
      machine.boom_rod_x_m * std::cos(boom_rad) - machine.boom_rod_z_m * std::sin(boom_rad);
  const double rod_z_m =
      machine.boom_rod_x_m * std::sin(boom_rad) + machine.boom_rod_z_m * std::cos(boom_rad);
  const double x_m = rod_x_m - machine.boom_base_x_m;
  const double z_m = rod_z_m - machine.boom_base_z_m;
  // |base x rod| over the cylinder's length.
  return (machine.boom_base_x_m * rod_z_m - machine.boom_base_z_m * rod_x_m) / std::hypot(x_m, z_m);
}

double load_reach_m(const Machine& machine, const PerJoint& angles_rad) {
  const double pitch_rad = angles_rad[boom] + angles_rad[stick] + angles_rad[bucket];
  return arm_shape(machine, angles_rad).bucket_pin.x_m - machine.boom_foot_x_m +
         machine.load_x_m * std::cos(pitch_rad) - machine.load_z_m * std::sin(pitch_rad);
}

std::optional<PerJoint> reach(const Machine& machine, PlanePoint tip, double bucket_rad) {
  // Stick and bucket, held at one angle, are one link from the stick's pin to the tip.
  const double lower_x_m = machine.stick_length_m + machine.bucket_length_m * std::cos(bucket_rad);
  const double lower_z_m = machine.bucket_length_m * std::sin(bucket_rad);
  const double lower_m = std::hypot(lower_x_m, lower_z_m);
  const double bend_rad = std::atan2(lower_z_m, lower_x_m);

  const double x_m = tip.x_m - machine.boom_foot_x_m;
  const double z_m = tip.z_m - machine.boom_foot_z_m;
  const double upper_m = machine.boom_length_m;
  const double cosine =
      (x_m * x_m + z_m * z_m - upper_m * upper_m - lower_m * lower_m) / (2.0 * upper_m * lower_m);
  if (!(std::abs(cosine) <= 1.0)) {
    return std::nullopt;
  }
  const double elbow_rad = -std::acos(cosine);
  PerJoint angles{};
  angles[stick] = wrapped(elbow_rad - bend_rad);
  angles[boom] =
      wrapped(std::atan2(z_m, x_m) -
              std::atan2(lower_m * std::sin(elbow_rad), upper_m + lower_m * std::cos(elbow_rad)));
  angles[bucket] = bucket_rad;
  for (const Joint joint : {boom, stick, bucket}) {
    if (angles[joint] < machine.lower_rad[joint] || angles[joint] > machine.upper_rad[joint]) {
      return std::nullopt;
    }
  }
  return angles;
}

}  // namespace rigwire::dig_cycle
