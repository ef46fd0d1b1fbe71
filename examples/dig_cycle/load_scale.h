// Weighs what is in the bucket by the oil in the boom's cylinders: their force with soil less that
// without, in one pose of the arm, times their lever over the soil's. No mass of the machine
// enters.
#pragma once

#include <cstdint>
#include <optional>

#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

class LoadScale {
 public:
  /// So many samples in a row make a mean.
  static constexpr int kSamples = 20;

  explicit LoadScale(const Machine& machine) : machine_(machine) {}

  /// Discards the samples collected so far.
  void begin() { sum_n_ = 0.0, samples_ = 0; }
  /// Adds one sample of the boom's force with the arm at rest in the pose of weighing.
  void add(double force_n) { sum_n_ += force_n, ++samples_; }
  [[nodiscard]] bool full() const { return samples_ >= kSamples; }

  /// Stores the mean as that of the empty bucket.
  void tare();
  [[nodiscard]] bool tared() const { return empty_n_.has_value(); }
  /// Returns the load by the mean; empty before it is full, or without a tare.
  [[nodiscard]] std::optional<double> load_kg(const PerJoint& angles_rad) const;

 private:
  Machine machine_;
  double sum_n_ = 0.0;
  int samples_ = 0;
  std::optional<double> empty_n_;
};

}  // namespace rigwire::dig_cycle
