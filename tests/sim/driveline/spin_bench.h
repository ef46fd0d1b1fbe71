// Four wheels on a test stand: each with an inertia, a load torque and a pad of dry friction, their
// rates solved together with a drive line as a vehicle solves them.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/contact/bristle.h"
#include "sim/driveline/driveline.h"

namespace rigwire::test {

using sim::Bristle;
using sim::BristleParameters;
using sim::Driveline;
using sim::ImplicitForce;
using sim::SpinEquations;
using sim::WheelMatrix;
using sim::WheelVector;

class SpinBench {
 public:
  explicit SpinBench(Driveline& driveline, double wheel_inertia_kgm2 = 33.0)
      : driveline_(driveline), wheel_inertia_kgm2_(wheel_inertia_kgm2) {}

  WheelVector rates = WheelVector::Zero();
  WheelVector load_nm = WheelVector::Zero();  ///< Against forward rotation, constant.
  double viscous_nmsprad = 0.0;               ///< Load per rate, each wheel.
  WheelVector grip_nm = WheelVector::Zero();  ///< Greatest torque of the pads on fixed ground.
  WheelVector pad_nm = WheelVector::Zero();   ///< Out: torque of the pads on the wheels.
  double pad_heat_j = 0.0;
  double load_work_j = 0.0;  ///< Done on loads.
  int solves = 0;
  int worst_solves = 0;

  void step(double h) {
    driveline_.begin(h, wheel_inertia_kgm2_, rates);
    const WheelVector start = rates;
    std::array<bool, kWheels> slides{};
    WheelVector next = rates;
    bool pads_hold = false;
    int calls = 0;
    bool accepted = false;
    for (int round = 0; round < 12 && !(accepted && pads_hold); ++round) {
      next = solve(h, slides);
      ++calls;
      // Only the pad that is furthest over its grip lets go: behind an open differential the others
      // then carry less.
      std::size_t worst = kWheels;
      double excess = 1.0 + 1e-12;
      for (std::size_t i = 0; i < kWheels; ++i) {
        const double force = slides[i] ? 0.0 : pad(i, h).at(next(index(i)));
        if (grip_nm(index(i)) > 0.0 && std::abs(force) > excess * grip_nm(index(i))) {
          excess = std::abs(force) / grip_nm(index(i));
          worst = i;
          side_[i] = force > 0.0 ? 1.0 : -1.0;
        }
      }
      pads_hold = worst == kWheels;
      if (!pads_hold) {
        slides[worst] = true;
      }
      if (pads_hold) {
        accepted = driveline_.accept(h, next);
      }
    }
    driveline_.finish(h, next);
    for (std::size_t i = 0; i < kWheels; ++i) {
      const double mean = 0.5 * (start(index(i)) + next(index(i)));
      if (slides[i]) {
        pad_nm(index(i)) = side_[i] * grip_nm(index(i));
        pads_[i].yield(kPad, pad_nm(index(i)));
      } else {
        pad_nm(index(i)) = grip_nm(index(i)) > 0.0 ? pad(i, h).at(next(index(i))) : 0.0;
        pads_[i].slide(kPad, h, 0.0, next(index(i)));
      }
      pad_heat_j -= h * pad_nm(index(i)) * mean;
      load_work_j += h * (load_nm(index(i)) + viscous_nmsprad * next(index(i))) * mean;
    }
    rates = next;
    solves += calls;
    worst_solves = std::max(worst_solves, calls);
  }

  [[nodiscard]] double wheel_energy_j() const {
    return 0.5 * wheel_inertia_kgm2_ * rates.squaredNorm();
  }

 private:
  static Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  [[nodiscard]] ImplicitForce pad(std::size_t i, double h) const {
    return grip_nm(index(i)) > 0.0 ? pads_[i].force(kPad, h, 0.0) : ImplicitForce{};
  }

  [[nodiscard]] WheelVector solve(double h, const std::array<bool, kWheels>& slides) const {
    const SpinEquations& e = driveline_.equations();
    WheelMatrix left = e.inertia / h + e.damping;
    WheelVector right = e.torque_nm + left * rates - load_nm;
    for (std::size_t i = 0; i < kWheels; ++i) {
      const Eigen::Index k = index(i);
      left(k, k) += wheel_inertia_kgm2_ / h + viscous_nmsprad;
      right(k) += wheel_inertia_kgm2_ / h * rates(k);
      if (slides[i]) {
        right(k) += side_[i] * grip_nm(k);
      } else {
        const ImplicitForce force = pad(i, h);
        left(k, k) += force.gain;
        right(k) += force.offset;
      }
    }
    const auto basis = e.basis.leftCols(e.coordinates);
    const Eigen::MatrixXd reduced = basis.transpose() * left * basis;
    const Eigen::VectorXd free = reduced.ldlt().solve(basis.transpose() * right);
    return basis * free;
  }

  static constexpr BristleParameters kPad{2e5, 2e4, 0.0};

  Driveline& driveline_;
  double wheel_inertia_kgm2_;
  std::array<Bristle, kWheels> pads_{};
  std::array<double, kWheels> side_{};
};

}  // namespace rigwire::test
