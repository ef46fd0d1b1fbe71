#include "sim/roller/stability.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "sim/roller/drum_contact.h"
#include "sim/roller/roller_dynamics.h"

namespace rigwire::sim {
namespace {

using Square = Eigen::Matrix<double, 5, 5>;
using Matrix13 = Eigen::Matrix<double, 13, 13>;

// Stiffness and damping of all strips in (u, v, r, w_f, w_r), and how fast bristles are renewed.
struct Contact {
  Square stiffness = Square::Zero();
  Square damping = Square::Zero();
  double renewal = 0.0;
};

void add(const DrumForces& forces, Eigen::Index spin, double factor, Square& sum) {
  const std::array<Eigen::Index, 4> at{0, 1, 2, spin};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      sum(at[i], at[k]) +=
          factor * forces.gain(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
    }
  }
}

Contact contact(const RollerParameters& p, const std::array<double, 2>& steer_rad,
                double speed_mps) {
  const DrumContact drum(p.drum, 0.5 * p.mass_kg);
  Contact sum;
  for (std::size_t i = 0; i < 2; ++i) {
    DrumSituation situation;
    situation.x_m = (i == 0 ? p.pivot_x_m : -p.pivot_x_m) - p.center_of_mass_x_m;
    DrumInstant at;
    at.steer_rad = steer_rad[i];
    at.velocity[3] = speed_mps / p.drum.radius_m;
    DrumTangent tangent = drum.tangent(situation, at);
    const auto spin = static_cast<Eigen::Index>(3 + i);
    add(drum.stage(tangent, 0.0, {}), spin, 1.0, sum.damping);
    // Only stiffness, without renewal, over an ahead of one second.
    sum.renewal = std::max({sum.renewal, tangent.along.renewal, tangent.across.renewal});
    tangent.along = {tangent.along.stiffness, 0.0, 0.0};
    tangent.across = {tangent.across.stiffness, 0.0, 0.0};
    add(drum.stage(tangent, 1.0, {}), spin, 1.0, sum.stiffness);
  }
  return sum;
}

// Gelfand's formula, |A^n|^(1/n) for n = 2^20: within 1e-4, whatever the eigenvectors.
double spectral_radius(Matrix13 A) {
  double logarithm = 0.0;
  double share = 1.0;
  for (int i = 0; i < 20; ++i) {
    const double size = A.norm();
    if (!(size > 0.0)) {
      return 0.0;
    }
    logarithm += share * std::log(size);
    share *= 0.5;
    const Matrix13 scaled = A / size;
    A = scaled.lazyProduct(scaled);
  }
  return std::exp(logarithm + share * std::log(A.norm()));
}

// Of deflections of the strips (5), of brakes and rolling resistance (2), velocities (5), pressure.
double fastest(const RollerParameters& p, const std::array<double, 2>& steer_rad,
               double speed_mps) {
  const Contact drums = contact(p, steer_rad, speed_mps);
  const HydrostaticDriveParameters& drive = p.drive;
  Eigen::Matrix<double, 5, 1> inverse_mass;
  const double spin = p.drum.spin_inertia_kgm2;
  inverse_mass << 1.0 / p.mass_kg, 1.0 / p.mass_kg, 1.0 / p.yaw_inertia_kgm2, 1.0 / spin,
      1.0 / spin;
  Square damping = drums.damping;
  // Brake and rolling resistance; with towing valves open there is no oil.
  const std::array<BristleParameters, 2> held = spin_bristles(p);
  const double spin_damping = held[0].damping + held[1].damping + drive.motor_friction_nmsprad;
  const double spin_stiffness = held[0].stiffness + held[1].stiffness;
  damping(3, 3) += spin_damping;
  damping(4, 4) += spin_damping;

  // y' = A y linearised: z' = J v - renewal z, M v' = -K z - D v + d p, C p' = -d . w - leak p.
  Matrix13 A = Matrix13::Zero();
  A.block<5, 5>(0, 0).diagonal().setConstant(-drums.renewal);
  A.block<5, 5>(0, 7).setIdentity();
  A(5, 10) = 1.0;
  A(6, 11) = 1.0;
  A.block<5, 5>(7, 0) = -(inverse_mass.asDiagonal() * drums.stiffness);
  A(10, 5) = A(11, 6) = -spin_stiffness / spin;
  A.block<5, 5>(7, 7) = -(inverse_mass.asDiagonal() * damping);
  if (!drive.bypass) {
    const double capacity = drive.oil_volume_m3 / drive.bulk_modulus_pa;
    A(10, 12) = A(11, 12) = drive.motor_displacement_m3prad / spin;
    A(12, 10) = A(12, 11) = -drive.motor_displacement_m3prad / capacity;
    A(12, 12) = -drive.leakage_m3pspa / capacity;
  }
  // Rows and columns differ by many powers of ten (metres, pascals): in units of equal energy.
  Eigen::Matrix<double, 13, 1> scale = Eigen::Matrix<double, 13, 1>::Ones();
  scale[12] = std::sqrt(drive.oil_volume_m3 / drive.bulk_modulus_pa / spin);
  const Matrix13 scaled = scale.asDiagonal() * A * scale.cwiseInverse().asDiagonal();
  return spectral_radius(scaled);
}

}  // namespace

double fastest_rate_radps(const RollerParameters& p) {
  const double stop = p.steering.angle_max_rad;
  double result = 0.0;
  for (const double speed : {0.0, 0.5 * p.drive.speed_max_mps, p.drive.speed_max_mps}) {
    for (const std::array<double, 2>& steer :
         {std::array{0.0, 0.0}, std::array{stop, -stop}, std::array{stop, stop}}) {
      result = std::max(result, fastest(p, steer, speed));
    }
  }
  const auto lag = [&result](double time_constant_s) {
    if (time_constant_s > 0.0) {
      result = std::max(result, 1.0 / time_constant_s);
    }
  };
  lag(p.drive.swash_time_constant_s);
  lag(p.drive.engine_time_constant_s);
  if (!p.drive.bypass) {
    // Pump on the hyperbola at full swash: dQ/dp = n D^2 / T.
    const double slope = p.drive.engine_rated_radps * p.drive.pump_displacement_m3prad *
                         p.drive.pump_displacement_m3prad / p.drive.engine_torque_nm;
    result = std::max(
        result, (slope + p.drive.leakage_m3pspa) * p.drive.bulk_modulus_pa / p.drive.oil_volume_m3);
  }
  return result;
}

}  // namespace rigwire::sim
