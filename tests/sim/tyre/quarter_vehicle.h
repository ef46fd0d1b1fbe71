// The smallest vehicle: one mass that sits in the middle of one wheel. Moves in three directions,
// the wheel turns about its fixed axis. Linearly implicit Euler, clamp last, positions with the new
// velocity: the rule of every machine here, small enough to be checked by hand.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "sim/tyre/tyre.h"

namespace rigwire::sim {

struct QuarterVehicle {
  static constexpr double kGravity = 9.80665;

  const Ground& ground;
  Tyre tyre;
  double mass_kg;
  double spin_inertia_kgm2 = 25.0;
  double pressure_pa = 4.5e5;
  bool locked = false;    ///< The wheel cannot turn.
  double drive_nm = 0.0;  ///< On the wheel, forward positive.
  double gravity_mps2 = kGravity;
  double friction_scale = 1.0;
  bool leaves_ruts = true;
  double pull_n = 0.0;  ///< On the mass, forward.

  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_W = Eigen::Vector3d::UnitY();
  double wheel_radps = 0.0;

  // What the last step found.
  double normal_n = 0.0;
  double along_n = 0.0;
  double across_n = 0.0;
  double rolling_nm = 0.0;
  double ploughing_n = 0.0;
  double slide_mps = 0.0;
  double sinkage_m = 0.0;
  bool slipping = false;
  double normal_heat_j = 0.0;  ///< Dissipated by the vertical damper so far.
  double slip_heat_j = 0.0;    ///< Force times sliding, both directions, so far.

  QuarterVehicle(const Ground& ground_in, const TyreParameters& parameters, double mass)
      : ground(ground_in), tyre(parameters, mass), mass_kg(mass) {}

  /// Puts the wheel down where the tyre carries `load_n`, at (x, y).
  void place(double x_m, double y_m, double load_n) {
    const double k = tyre.stiffness_npm(pressure_pa);
    p_W = {x_m, y_m, ground.height_m(x_m, y_m)};
    const Eigen::Vector3d normal = ground.at(x_m, y_m, p_W.z() + 1.0).normal_W;
    p_W += normal * (tyre.parameters().unloaded_radius_m - load_n / k);
  }

  void step(double h) {
    const double radius = tyre.parameters().unloaded_radius_m;
    const auto contact = ground.wheel_contact(p_W, axis_W, radius);
    const Eigen::Vector3d ahead = axis_W.cross(Eigen::Vector3d::UnitZ());
    const double reach = 0.5 * tyre.contact_length_m(0.0, sinkage_m);
    WheelFooting footing;
    if (contact) {
      footing = ground.footing(*contact, v_W.dot(ahead) < 0.0 ? -ahead : ahead, reach);
    }
    TyreLaws laws = tyre.laws(h, contact, footing, pressure_pa, wheel_radps * radius);
    const Eigen::Vector3d weight(0.0, 0.0, -mass_kg * gravity_mps2);
    if (!laws.touching) {
      normal_n = along_n = across_n = rolling_nm = ploughing_n = 0.0;
      v_W += h / mass_kg * weight;
      wheel_radps += locked ? -wheel_radps : h * drive_nm / spin_inertia_kgm2;
      p_W += h * v_W;
      return;
    }
    laws.friction *= friction_scale;
    const Eigen::Vector3d n = contact->normal_W;
    const Eigen::Vector3d t = axis_W.cross(n).normalized();
    const Eigen::Vector3d b = n.cross(t);
    const double r = laws.rolling_radius_m;

    // Normal.
    const double v_n = (mass_kg * v_W.dot(n) + h * (weight.dot(n) + laws.normal.offset)) /
                       (mass_kg + h * laws.normal.gain);
    normal_n = laws.normal.at(v_n);
    double v_n_end = v_n;
    if (normal_n < 0.0) {
      normal_n = 0.0;
      v_n_end = v_W.dot(n) + h * weight.dot(n) / mass_kg;
    }
    // Along, with the wheel's spin, and across; limits after the solve.
    bool clamped = false;
    bool rolling_clamped = false;
    bool ploughing_clamped = false;
    double v_t = 0.0;
    double v_b = 0.0;
    double rate = 0.0;
    const double limit = laws.limit_n(normal_n);
    const double rolling_limit = laws.rolling_arm_m * normal_n;
    for (int pass = 0; pass < 4; ++pass) {
      const ImplicitForce along = clamped ? ImplicitForce{along_n, 0.0} : laws.longitudinal;
      const ImplicitForce across = clamped ? ImplicitForce{across_n, 0.0} : laws.lateral;
      const ImplicitForce rolling = rolling_clamped ? ImplicitForce{rolling_nm, 0.0} : laws.rolling;
      const ImplicitForce ploughing =
          ploughing_clamped ? ImplicitForce{ploughing_n, 0.0} : laws.ploughing;
      // m v' + h g (v' - r w') = m v + h (offset + weight);  J w' - r h g (v' - r w') ...
      Eigen::Matrix2d left;
      left << mass_kg + h * (along.gain + ploughing.gain), -h * along.gain * r, -h * along.gain * r,
          spin_inertia_kgm2 + h * (along.gain * r * r + rolling.gain);
      Eigen::Vector2d right(
          mass_kg * v_W.dot(t) + h * (weight.dot(t) + pull_n + along.offset + ploughing.offset),
          spin_inertia_kgm2 * wheel_radps + h * (drive_nm + rolling.offset - r * along.offset));
      if (locked) {
        v_t = right[0] / left(0, 0);
        rate = 0.0;
      } else {
        const Eigen::Vector2d found = left.inverse() * right;
        v_t = found[0];
        rate = found[1];
      }
      v_b = (mass_kg * v_W.dot(b) + h * (weight.dot(b) + across.offset)) /
            (mass_kg + h * across.gain);
      along_n = along.at(v_t - r * rate);
      across_n = across.at(v_b);
      rolling_nm = rolling.at(rate);
      ploughing_n = ploughing.at(v_t);
      bool changed = false;
      const double size = std::hypot(along_n, across_n);
      if (!clamped && size > limit) {
        along_n *= limit / size;
        across_n *= limit / size;
        clamped = changed = true;
      }
      if (!locked && !rolling_clamped && std::abs(rolling_nm) > rolling_limit) {
        rolling_nm = std::copysign(rolling_limit, rolling_nm);
        rolling_clamped = changed = true;
      }
      if (!ploughing_clamped && std::abs(ploughing_n) > laws.ploughing_n) {
        ploughing_n = std::copysign(laws.ploughing_n, ploughing_n);
        ploughing_clamped = changed = true;
      }
      if (!changed) {
        break;
      }
    }
    slide_mps = v_t - r * rate;
    slipping = clamped;
    sinkage_m = laws.sinkage_m;
    tyre.settle(h, laws,
                {along_n, across_n, rolling_nm, ploughing_n, slide_mps, v_b, rate, v_t, clamped,
                 rolling_clamped, ploughing_clamped});
    if (leaves_ruts && laws.rut_m > laws.pressed_m) {
      ground.press(*contact, t, tyre.parameters().width_m, laws.rut_m);
    }
    // The mean speed of the step makes the energy of a constant force exact.
    const double mean_slide = 0.5 * (slide_mps + v_W.dot(t) - r * (locked ? 0.0 : wheel_radps));
    slip_heat_j -= h * (along_n * mean_slide + across_n * 0.5 * (v_b + v_W.dot(b)));
    normal_heat_j += h * tyre.parameters().vertical_damping_nspm * v_n * v_n;
    v_W = v_t * t + v_b * b + v_n_end * n;
    wheel_radps = rate;
    p_W += h * v_W;
  }

  void run(double seconds, double h) {
    const long steps = std::lround(seconds / h);
    for (long i = 0; i < steps; ++i) {
      step(h);
    }
  }
};

}  // namespace rigwire::sim
