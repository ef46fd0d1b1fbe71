#include "sim/vehicle/planar_vehicle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPlanarPasses = 12;
constexpr double kLoadLag_s = 0.1;
constexpr double kPlanarSteep = 0.87;  // Cosine, 30 degrees about the body's z.
// The unknowns of this level among those of VelocitySystem: ahead, left, yaw, wheels.
constexpr std::array<std::size_t, 3> kPlane{0, 1, 5};
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Vector7d = Eigen::Matrix<double, 7, 1>;

/// About x: two springs at half their base, k b^2 / 2, or at half the track, and the bar.
double roll_stiffness(const VehicleAxleParameters& axle) {
  if (axle.type == AxleType::beam) {
    return 0.5 * axle.beam.spring_npm * axle.beam.spring_base_m * axle.beam.spring_base_m +
           axle.beam.roll_bar_nmprad;
  }
  return (0.5 * axle.independent.spring_npm + axle.independent.roll_bar_npm) * axle.track_m *
         axle.track_m;
}

}  // namespace

PlanarVehicle::PlanarVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                             std::unique_ptr<Driveline> driveline, const VehiclePlace& place)
    : WheeledVehicle(parameters, ground, std::move(driveline)),
      follower_(parameters_),
      wheel_terms_{WheelTerms(parameters.front, 0.25 * parameters.mass_kg(), 0,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.front, 0.25 * parameters.mass_kg(), 1,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.rear, 0.25 * parameters.mass_kg(), 2,
                              parameters.brake_stiffness_nmprad),
                   WheelTerms(parameters.rear, 0.25 * parameters.mass_kg(), 3,
                              parameters.brake_stiffness_nmprad)} {
  contact_rows_.reserve(kMostContactPoints);
  const Vector3d& centre = static_.center_of_mass_m;
  // Yaw inertia about the common centre of mass: own inertias and Steiner's terms.
  yaw_inertia_kgm2_ =
      parameters.body.principal_inertia_kgm2.z() +
      parameters.body.mass_kg * std::pow(parameters.body.center_of_mass_m.x() - centre.x(), 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double half = 0.5 * axle(i).track_m;
    const double own = axle(i).type == AxleType::beam
                           ? axle(i).beam.roll_inertia_kgm2
                           : 2.0 * axle(i).independent.corner_mass_kg * half * half;
    yaw_inertia_kgm2_ +=
        own + parameters.axle_mass_kg(axle(i)) * std::pow(axle(i).position_x_m - centre.x(), 2);
    roll_share_[i] = roll_stiffness(axle(i)) /
                     (roll_stiffness(parameters.front) + roll_stiffness(parameters.rear));
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    frames_[i].hub_m = wheel_centre_m(parameters, static_, i) - centre;
    frames_[i].velocity_by_s = {Vector3d::Zero(), Vector3d::Zero()};
    frames_[i].rate_by_s = frames_[i].velocity_by_s;
  }
  follower_.reset(ground, place);
  const Vector3d down = follower_.R_WB().transpose() * Vector3d::UnitZ();
  transfer_mps2_ = parameters_.gravity_mps2 * down.head<2>();
  update_links();
}

void PlanarVehicle::load_wheels(double h) {
  const Vector3d up_B = parameters_.gravity_mps2 * follower_.R_WB().row(2).transpose();
  // Specific force a - g in the plane, through a first-order lag, exact over h.
  const Vector2d felt = acceleration_mps2_ + up_B.head<2>();
  transfer_mps2_ -= (felt - transfer_mps2_) * std::expm1(-h / kLoadLag_s);
  const double m = parameters_.mass_kg();
  const Vector3d& c = static_.center_of_mass_m;
  const double wheelbase = parameters_.wheelbase_m();
  // Moments about the rear contact line: N_f L = m (f_z (x_c - x_r) - f_x z_c).
  const double front =
      m * (up_B.z() * (c.x() - parameters_.rear.position_x_m) - transfer_mps2_.x() * c.z()) /
      wheelbase;
  const std::array<double, 2> load{front, m * up_B.z() - front};
  for (std::size_t i = 0; i < kWheels; ++i) {
    // Leans to the right when accelerated to the left.
    const double across = m * transfer_mps2_.y() * c.z() * roll_share_[i / 2] / axle(i / 2).track_m;
    load_n_[i] = std::max(0.0, 0.5 * load[i / 2] + (i % 2 == 0 ? -across : across));
  }
}

void PlanarVehicle::meet_obstacles(double h, const Velocities& start) {
  const LinkMotion& body = follower_.body();
  near_ =
      contact_.near(h, body.v_WL_W.norm() +
                           2.0 * reach_m_ * (body.w_WL_W.norm() + std::abs(yaw_rate_radps_)) + 0.1);
  if (!near_) {
    return;
  }
  place_rigid_links(parameters_, static_,
                    {steer_rad(0)[0], steer_rad(0)[1], steer_rad(1)[0], steer_rad(1)[1]}, body,
                    contact_links_);
  contact_.begin(h, contact_links_);
  contact_rows_.clear();
  const Matrix3d R_WB = follower_.R_WB();
  for (ContactPoint& point : contact_.points()) {
    const Vector3d p_C = R_WB.transpose() * (point.p_W - body.X_WL.translation()) -
                         Vector3d(static_.center_of_mass_m);
    VehicleContactRows& rows =
        contact_rows_.emplace_back(contact_rows(point, R_WB, p_C, nullptr, 0));
    // Moves in its plane only: what pushes it up or down more than along it does not hold it.
    const bool steep = std::abs(R_WB.col(2).dot(point.direction_W[0])) > kPlanarSteep;
    for (VelocityRow& row : rows.rows) {
      row.value[2] = row.value[3] = row.value[4] = 0.0;
      if (steep) {
        row.value = {};
      }
    }
    point.begin(h, rows.of(start));
    if (steep) {
      point.law.greatest_n = 0.0;
      point.blocks = point.gap_m < 0.0;
    }
  }
}

void PlanarVehicle::inner_step(double h) {
  WheelVector rates(rate_radps_.data());
  driveline_->begin(h, wheel_terms_[0].spin_inertia_kgm2(), rates);
  load_wheels(h);

  const Matrix3d R_WB = follower_.R_WB();
  Velocities start{};
  start[0] = velocity_mps_.x();
  start[1] = velocity_mps_.y();
  start[5] = yaw_rate_radps_;
  for (std::size_t i = 0; i < kWheels; ++i) {
    rate_radps_[i] = rates[static_cast<Eigen::Index>(i)];
    start[kWheelVelocity + i] = rate_radps_[i];
  }
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double steer = steer_rad(i / 2)[i % 2];
    frames_[i].axis = Vector3d(-std::sin(steer), std::cos(steer), 0.0);
    const GroundPoint& ground = follower_.ground()[i];
    std::optional<WheelContact> contact;
    if (load_n_[i] > 0.0) {
      contact.emplace();
      contact->ground = ground;
      contact->normal_W = R_WB.col(2);
      contact->point_W = follower_.places()[i];
      contact->terrain_share = ground.obstacle ? 0.0 : 1.0;
      // The load's overlap, of the tyre and of the soil, in the rut that lies there.
      contact->depth_m = wheel_terms_[i].tyre().overlap_m(
          load_n_[i], ground_->footing(*contact, R_WB.col(0), 0.0).under, tyre_pressure_pa(i));
    }
    wheel_terms_[i].begin(h, frames_[i], R_WB, contact, *ground_, tyre_pressure_pa(i),
                          brake_limit_nm(i), start);
  }

  meet_obstacles(h, start);
  const double m = parameters_.mass_kg();
  const Vector3d gravity_B = -parameters_.gravity_mps2 * R_WB.row(2).transpose();
  // Weight along the plane, quadratic air drag.
  const Vector2d force =
      m * gravity_B.head<2>() - parameters_.air_drag_ns2pm2 * velocity_mps_.norm() * velocity_mps_;
  Velocities found = start;
  Vector7d change = Vector7d::Zero();
  for (int pass = 1;; ++pass) {
    VelocitySystem system;
    for (const WheelTerms& wheel : wheel_terms_) {
      wheel.add(h, start, system);
    }
    if (near_) {
      add_contacts(h, start, contact_.points(), contact_rows_, system);
    }
    const SpinEquations& drive = driveline_->equations();
    system.add_wheels(drive.inertia + h * drive.damping, h * drive.torque_nm);

    // Surge, sway, yaw and four spins out of the fourteen equations of velocity_system.h.
    Matrix7d A;
    Vector7d b;
    const auto place = [](Eigen::Index i) {
      return i < 3 ? kPlane[static_cast<std::size_t>(i)]
                   : kWheelVelocity + static_cast<std::size_t>(i - 3);
    };
    for (Eigen::Index i = 0; i < 7; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        A(i, j) = system.matrix[place(i)][place(j)];
        A(j, i) = A(i, j);
      }
      b[i] = system.right[place(i)];
    }
    A(0, 0) += m;
    A(1, 1) += m;
    A(2, 2) += yaw_inertia_kgm2_;
    b.head<2>() += h * force;
    if (drive.coordinates < 4) {
      // Locked differentials: congruence T^T A T, an identity row for each direction removed.
      Matrix7d T = Matrix7d::Identity();
      T.bottomRightCorner<4, 4>() = drive.basis;
      A = (T.transpose() * A * T).eval();
      b = (T.transpose() * b).eval();
      for (Eigen::Index i = 3 + drive.coordinates; i < 7; ++i) {
        A.row(i).setZero();
        A.col(i).setZero();
        A(i, i) = 1.0;
        b[i] = 0.0;
      }
      change = T * A.llt().solve(b);
    } else {
      change = A.llt().solve(b);
    }
    for (Eigen::Index i = 0; i < 7; ++i) {
      found[place(i)] = start[place(i)] + change[i];
    }
    if (pass >= kPlanarPasses) {
      break;
    }
    bool changed = near_ && contacts_change(found, contact_.points(), contact_rows_);
    for (WheelTerms& wheel : wheel_terms_) {
      changed = wheel.changes(found) || changed;
    }
    if (!changed) {
      changed = !driveline_->accept(h, WheelVector(&found[kWheelVelocity]));
    }
    if (!changed) {
      break;
    }
  }
  for (Eigen::Index i = 0; i < 7; ++i) {
    if (!std::isfinite(change[i])) {
      record_non_finite(
          i < 2 ? "acceleration" : (i == 2 ? "yaw acceleration" : "wheel acceleration"),
          i < 3 ? "body" : kWheeledLinks[static_cast<std::size_t>(i)].data());
      return;
    }
  }

  if (near_) {
    contact_.settle(h, [&](const ContactPoint& point) {
      return contact_rows_[static_cast<std::size_t>(&point - contact_.points().data())].of(found);
    });
  }
  acceleration_mps2_ = change.head<2>() / h;
  yaw_rate_radps_ = found[5];
  const Vector2d new_velocity(found[0], found[1]);
  for (std::size_t i = 0; i < kWheels; ++i) {
    wheel_terms_[i].settle(h, found, wheels_[i]);
    wheel_terms_[i].press(*ground_);
    rate_radps2_[i] = (found[kWheelVelocity + i] - start[kWheelVelocity + i]) / h;
    rate_radps_[i] = found[kWheelVelocity + i];
    spin_rad_[i] = std::remainder(spin_rad_[i] + h * rate_radps_[i], 2.0 * std::numbers::pi);
  }
  driveline_->finish(h, WheelVector(&found[kWheelVelocity]));
  // B's origin, not the centre of mass, is led over the ground.
  const double behind = static_.center_of_mass_m.x();
  follower_.step(h, *ground_,
                 new_velocity + Vector2d(yaw_rate_radps_ * static_.center_of_mass_m.y(),
                                         -yaw_rate_radps_ * behind),
                 yaw_rate_radps_);
  // The axes turned with the body meanwhile.
  const double turn = h * yaw_rate_radps_;
  velocity_mps_ = Eigen::Rotation2Dd(-turn) * new_velocity;
  if (!follower_.finite()) {
    record_non_finite("position", "body");
  }
}

void PlanarVehicle::start_rolling(double speed_mps) {
  velocity_mps_ = {speed_mps, 0.0};
  yaw_rate_radps_ = 0.0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    rate_radps_[i] = speed_mps / static_.rolling_radius_m[i / 2];
    wheels_[i].rate_radps = rate_radps_[i];
  }
  follower_.set_speed(velocity_mps_);
  update_links();
}

void PlanarVehicle::update_links() {
  const std::array<double, 4> steer{steer_rad(0)[0], steer_rad(0)[1], steer_rad(1)[0],
                                    steer_rad(1)[1]};
  rigid_links(parameters_, static_, steer, spin_rad_, rate_radps_, rate_radps2_, follower_.body(),
              links_);
}

}  // namespace rigwire::sim
