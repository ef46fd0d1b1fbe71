// What the receiver reports for an echo: whether it is seen, its range with errors, its
// reflectivity. Formulas in link_budget.h.
//
// Random numbers belong to a shot (the number of its firing and its laser) and to the echo's rank
// in it, so that neither threads nor slices change them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::sim {

/// One echo of each of eight shots. No echo: energy 0.
struct EchoLanes {
  LaneArray range_m{};
  LaneArray energy{};      ///< In the unit of link_budget.h.
  LaneArray brightness{};  ///< Energy times range squared.
};

/// Eight shots: the firing's number, counted from the plan's first, times kMaxLasers, plus the
/// laser.
using ShotNumbers = std::array<std::uint64_t, kLanes>;

enum class EchoRank : std::uint8_t { strongest, second, last };

using EightReturns = std::array<LidarReturn, kLanes>;

class EchoModel {
 public:
  /// Throws std::invalid_argument for bad parameters. Noise, biases and losses depend on (seed,
  /// name) only.
  EchoModel(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
            std::uint64_t seed, std::string_view name);

  /// Minimum energy of a detected echo.
  [[nodiscard]] float threshold() const { return threshold_; }
  /// Minimum energy of a detected echo of the air.
  [[nodiscard]] double air_threshold() const { return air_threshold_; }
  [[nodiscard]] double air_minimum_range_m() const { return air_minimum_m_; }
  /// Where the receiver is focused, for the air (WeatherBeam::focus_m).
  [[nodiscard]] double air_focus_range_m() const { return air_focus_m_; }
  [[nodiscard]] float minimum_range_m() const { return minimum_m_; }
  /// How far rays must go: what is beyond does not come into the range window by its errors.
  [[nodiscard]] double reach_m() const { return reach_m_; }
  /// Constant error of a laser.
  [[nodiscard]] float bias_m(std::size_t laser) const { return biases_m_[laser]; }
  /// Ratio of its reported to the true reflectivity, about 1.
  [[nodiscard]] float reflectivity_gain(std::size_t laser) const { return gains_[laser]; }
  /// Onset for noise_growth(); 0: errors do not depend on the signal.
  [[nodiscard]] float noise_onset() const { return onset_; }

  /// What is reported of the echoes, empty where they are too faint, outside the pattern's range
  /// window (before or after the errors came to them), or lost.
  [[nodiscard]] EightReturns report(const EchoLanes& echo, const ShotNumbers& shots,
                                    EchoRank rank) const;

 private:
  static constexpr std::size_t kRanks = 3;

  /// Ranges and brightnesses with their errors.
  void measure(const EchoLanes& echo, const ShotNumbers& shots, EchoRank rank,
               LaneArray& measured_m, LaneArray& brightness) const;
  void lose(const LaneArray& reflectivity, const ShotNumbers& shots, EchoRank rank,
            EightReturns& returns) const;

  RangeNoise noise_;
  float sigma_m_;
  float resolution_m_;
  float onset_;
  float reflectivity_sigma_;
  float threshold_;
  double air_threshold_;
  double air_minimum_m_;
  double air_focus_m_;
  float minimum_m_;
  float maximum_m_;
  double reach_m_;
  double drop_rate_;
  double drop_limit_;
  double drop_at_zero_;
  bool biased_;
  std::array<float, kMaxLasers> biases_m_{};
  std::array<float, kMaxLasers> gains_{};
  std::array<std::uint64_t, kRanks> noise_keys_{};
  std::array<std::uint64_t, kRanks> loss_keys_{};
  std::uint64_t shot_loss_key_ = 0;
};

}  // namespace rigwire::sim
