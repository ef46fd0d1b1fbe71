#include "sim/roller/tipped_roller.h"

#include <Eigen/Cholesky>

namespace rigwire::sim {
namespace {

constexpr int kPasses = 40;

}  // namespace

TippedRoller::TippedRoller(const RollerParameters& parameters)
    : spin_inertia_kgm2_(parameters.drum.spin_inertia_kgm2),
      gravity_mps2_(parameters.gravity_mps2) {}

TippedVelocity TippedRoller::body_row(const Eigen::Vector3d& d, const Eigen::Vector3d& p) {
  TippedVelocity row = TippedVelocity::Zero();
  row.head<3>() = d;
  row.segment<3>(3) = p.cross(d);
  return row;
}

// d . (v + w x p + (W - a . w) a x arm), W the drum's own rate about its axle a.
TippedVelocity TippedRoller::drum_row(const Eigen::Vector3d& d, const Eigen::Vector3d& p,
                                      const Eigen::Vector3d& axle_W, const Eigen::Vector3d& arm,
                                      std::size_t drum) {
  TippedVelocity row = body_row(d, p);
  const double spin = d.dot(axle_W.cross(arm));
  row.segment<3>(3) -= spin * axle_W;
  row[static_cast<Eigen::Index>(6 + drum)] = spin;
  return row;
}

void TippedRoller::step(double h, const TippedLoads& loads, DrumTrain& train,
                        HydrostaticDrive& drive, TippedVelocity& velocity) {
  using Matrix = Eigen::Matrix<double, 8, 8>;
  const double m = loads.mass.mass_kg;
  const Eigen::Matrix3d I =
      loads.R_WB * loads.mass.inertia_kgm2.asDiagonal() * loads.R_WB.transpose();
  const Eigen::Vector3d w = velocity.segment<3>(3);
  // Angular momentum of body and drums.
  Eigen::Vector3d H = I * w;
  Eigen::Matrix<double, 2, 8> turn = Eigen::Matrix<double, 2, 8>::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    H += spin_inertia_kgm2_ * velocity[6 + k] * loads.axle_W[i];
    turn.row(k).segment<3>(3) = -loads.axle_W[i].transpose();
    turn(k, 6 + k) = 1.0;
  }
  Matrix A0 = Matrix::Zero();
  A0.topLeftCorner<3, 3>().diagonal().setConstant(m);
  A0.block<3, 3>(3, 3) = I;
  A0.bottomRightCorner<2, 2>().diagonal().setConstant(spin_inertia_kgm2_);
  TippedVelocity b0 = A0 * velocity;
  b0[2] -= h * m * gravity_mps2_;
  b0.segment<3>(3) -= h * w.cross(H);

  train.begin(h, loads.torque, drive, turn * velocity);
  TippedVelocity x = velocity;
  bool changed = true;
  for (int pass = 0; changed && pass < kPasses; ++pass) {
    Matrix A = A0;
    TippedVelocity b = b0;
    // Between a drum and the body that carries it.
    const DrumTrain::Torques torques = train.torques();
    A += h * turn.transpose() * torques.gain * turn;
    b += h * turn.transpose() * torques.offset;
    for (const TippedContact& contact : loads.contacts) {
      contact.add(h, A, b);
    }
    x = A.llt().solve(b);
    changed = train.test(turn * x);
    for (const TippedContact& contact : loads.contacts) {
      changed = contact.point->changes(contact.along(x)) || changed;
    }
  }
  velocity = x;
  train.settle(turn * x, drive);
}

}  // namespace rigwire::sim
