// Three differentials, each open or locked: which wheel rates are possible, and what happens to
// them when a lock engages.
//
// Front and rear differences, the difference of the axles' means and the common mean form an
// orthonormal basis of the four rates; a lock removes its direction. When one engages, the rates
// are projected so that angular momentum along the remaining directions is kept; for two equal
// wheels that is (J_l w_l + J_r w_r) / (J_l + J_r). Opening gives the direction back.
#pragma once

#include <array>

#include "sim/driveline/driveline.h"
#include "sim/driveline/parameters.h"

namespace rigwire::sim {

class DifferentialLocks {
 public:
  explicit DifferentialLocks(const AxleParameters& parameters);

  /// Requests for differentials that have no lock are ignored.
  void request(const std::array<bool, kDifferentials>& lock);

  /// Engages and opens locks; changes `rates` where one engages, with `inertia` (positive
  /// definite) of all that turns with the wheels. Returns whether rates changed.
  bool advance(double h, const WheelMatrix& inertia, WheelVector& rates);

  [[nodiscard]] const std::array<bool, kDifferentials>& engaged() const { return engaged_; }
  [[nodiscard]] const WheelMatrix& basis() const { return basis_; }
  [[nodiscard]] int coordinates() const { return coordinates_; }

 private:
  void make_basis();

  AxleParameters parameters_;
  std::array<bool, kDifferentials> requested_{};
  std::array<bool, kDifferentials> engaged_{};
  std::array<double, kDifferentials> waited_s_{};
  WheelMatrix basis_ = WheelMatrix::Identity();
  int coordinates_ = 4;
};

}  // namespace rigwire::sim
