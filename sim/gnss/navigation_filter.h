// The navigation engine of a receiver: a Kalman filter for position, velocity and clock over
// pseudoranges and range rates, as in real receivers, with the covariance of its own errors.
//
// State: position (3), velocity (3), clock, clock rate, and the clocks of GLONASS, Galileo and
// BeiDou beside that of GPS. Velocity is constant but for white acceleration (q = sigma_a^2 per
// axis), so that
//
//   p' = p + v h,  v' = v,  Q = q [h^3/3 h^2/2; h^2/2 h]
//
// and one update takes all satellites of an epoch in information form:
//
//   P+ = (P^-1 + sum h h^T / r)^-1,   K = P+ h / r
//
// The filter assumes a standard deviation of code_sigma_m for a pseudorange and of rate_sigma_mps
// for a range rate, times the satellite's degradation relative to one overhead. With the defaults
// it behaves as recordings of u-blox receivers show: position without lag, velocity late by 0.23 s
// at 1 Hz, steps of the position correlated over ten seconds at rest, and the variance of speed
// grows by 0.5 (m/s)^2 per second without satellites, ten times as fast after 12 s (research of
// this project over recordings of NEO-7P, NEO-M8P and u-blox 7; docs/devices/ublox-neo-7p.md).
//
// There are two covariances. P is the filter's own; the gains and the accuracy of the speed come
// from it. It would be far too small for the position, since errors of satellites, air and
// reflections last for minutes and do not average out. Therefore M is computed as well, the
// covariance of these gains with lasting errors: the "consider" covariance (S. F. Schmidt,
// "Applications of State-Space Methods to Navigation Problems", 1966), with Gauss-Markov states for
// the ionosphere (zenith, two gradients), the troposphere, each satellite's orbit and multipath,
// and the error of a position by carriers. Accuracies of position and time come from M. A receiver
// whose corrections end therefore continues from the place and the accuracy that it had with them.
//
// Integrity. A satellite whose innovation exceeds five of its standard deviations is left out of
// the epoch if at least one more than the number of unknowns remain: with fewer, it is not possible
// to decide which of them is wrong. When ranges disagree with the state, i.e. when squared
// innovations over variances average 0.5 or more over ten seconds (below that under an open sky,
// since lasting errors are in the state, too), accuracies of position grow by the root. When more
// than half exceed the limit, the prediction is wrong (a jump, a hard stop), and the filter widens
// its covariance instead.
//
// Everything is linearised at the truth: 50 m of error cost 0.1 mm.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/gnss/position_solution.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::sim {

struct NavigationParameters {
  double code_sigma_m = 6.0;     ///< Sigma that the filter assumes for a pseudorange overhead; > 0.
  double rate_sigma_mps = 0.22;  ///< Sigma that the filter assumes for a range rate overhead; > 0.
};
void visit(fields::Visitor& v, NavigationParameters& p);

/// What the place and the clock truly are at an epoch.
struct NavigationTruth {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
  double clock_m = 0.0;
  double clock_rate_mps = 0.0;
  bool clock_reset = false;  ///< The receiver set its clock by whole milliseconds.
  Eigen::Matrix3d ned_from_world = Eigen::Matrix3d::Identity();
};

/// One satellite's measurements, less what the truth gives, and what the receiver knows of them.
struct NavigationSignal {
  std::size_t source = 0;  ///< Below the number of satellites given at construction.
  GnssSystem system = GnssSystem::gps;
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitZ();  ///< Unit, antenna to satellite.
  double range_error_m = 0.0;
  double rate_error_mps = 0.0;
  /// Standard deviations in parts: of noise, of multipath and detours, of the satellite itself, and
  /// those that all share (RangeEquation::common_m).
  double noise_sigma_m = 0.3;
  double multipath_sigma_m = 0.5;
  double orbit_sigma_m = 0.8;
  std::array<double, kCommonErrors> common_m{};
  double mistrust_sigma_m = 0.0;  ///< Only in its weight: reasons to doubt the signal.
  double rate_noise_mps = 0.02;

  [[nodiscard]] double sigma_m() const;
};

/// How long errors stay, s.
struct NavigationCorrelation {
  double ionosphere_s = 2400.0;
  double troposphere_s = 1800.0;
  double orbit_s = 7200.0;
  double multipath_s = 120.0;  ///< At the present speed.
  double carrier_s = 40.0;     ///< For positions by carriers.
};

/// What drives the prediction.
struct NavigationNoise {
  double horizontal = 0.45;        ///< White acceleration, m/s per sqrt(s), per axis.
  double vertical = 0.32;          ///< Vertical white acceleration, m/s per sqrt(s).
  double clock_rate_mps2s = 0.04;  ///< (m/s)^2 per second.
  double clock_m2ps = 0.01;        ///< m^2 per second.
};

class NavigationFilter {
 public:
  static constexpr int kStates = 11;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  /// `satellites`: how many sources there may be.
  NavigationFilter(const NavigationParameters& parameters, std::size_t satellites);

  /// Discards the state.
  void forget() { begun_ = false; }
  /// Whether it has had an update since construction or forget().
  [[nodiscard]] bool begun() const { return begun_; }

  /// `step_s` >= 0 on.
  void predict(double step_s, const NavigationNoise& noise,
               const NavigationCorrelation& correlation, const Eigen::Matrix3d& ned_from_world);

  /// A position from elsewhere (a held height, a carrier solution), in north, east, down.
  struct Position {
    Eigen::Vector3d error_ned_m = Eigen::Vector3d::Zero();  ///< Less the truth.
    Eigen::Vector3d sigma_ned_m = Eigen::Vector3d::Ones();  ///< Infinity: nothing is said.
    /// This is a carrier solution: the filter takes it over with its accuracy. Its errors stay
    /// (NavigationCorrelation::carrier_s) and do not average out.
    bool by_carriers = false;
  };
  /// Updates by one epoch. `still`: the receiver takes its velocity for zero, whatever the range
  /// rates. `left_out[i]` is true if signal i was left out; valid until the next call. The first
  /// update begins at the truth with a standard deviation of 10 km.
  void update(const NavigationTruth& truth, std::span<const NavigationSignal> signals,
              const std::optional<Position>& position, bool still);
  [[nodiscard]] const std::vector<bool>& left_out() const { return left_out_; }
  /// Range less what the state explains, of signal i of the last update, m.
  [[nodiscard]] const std::vector<double>& residuals_m() const { return residuals_m_; }

  /// For receivers without errors.
  void set(const NavigationTruth& truth);

  [[nodiscard]] Eigen::Vector3d p_W() const { return p_W_; }
  [[nodiscard]] Eigen::Vector3d v_W() const { return v_W_; }
  [[nodiscard]] double clock_m() const { return clock_m_; }
  [[nodiscard]] double clock_rate_mps() const { return clock_rate_mps_; }
  /// Returns the position's covariance from M, world axes, times disagreement().
  [[nodiscard]] Eigen::Matrix3d position_covariance_m2() const {
    return disagreement() * actual_.topLeftCorner<3, 3>();
  }
  /// At least 1: squared innovations of ranges over their variances, beyond what is usual, over
  /// some seconds.
  [[nodiscard]] double disagreement() const;
  /// Returns the velocity's covariance from P, world axes.
  [[nodiscard]] Eigen::Matrix3d velocity_covariance() const { return believed_.block<3, 3>(3, 3); }
  [[nodiscard]] double clock_variance_m2() const;
  [[nodiscard]] double clock_rate_variance() const;

 private:
  struct Row {
    State h = State::Zero();
    double variance = 1.0;  ///< Variance that the filter assumes.
    double white = 1.0;     ///< Variance of what does not stay.
    double innovation = 0.0;
    double stays_m = 0.0;  ///< Standard deviation of what stays, of a position by carriers.
    int axis = 0;          ///< 0 north, 1 east, 2 down: of that position.
  };

  void begin(const NavigationTruth& truth);
  [[nodiscard]] State error(const NavigationTruth& truth) const;
  void make_rows(const NavigationTruth& truth, std::span<const NavigationSignal> signals);
  /// Whether the prediction is to be believed; fills left_out_.
  [[nodiscard]] bool agree(std::span<const NavigationSignal> signals);
  void widen();
  void apply(std::span<const NavigationSignal> signals);
  void go_on_from(const Position& position, const NavigationTruth& truth);

  NavigationParameters parameters_;
  bool begun_ = false;
  double step_s_ = 0.0;      ///< Step of the last prediction.
  double innovation_ = 0.0;  ///< Mean squared innovation of ranges over variance, smoothed.
  Eigen::Vector3d p_W_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W_ = Eigen::Vector3d::Zero();
  double clock_m_ = 0.0;
  double clock_rate_mps_ = 0.0;
  Eigen::Vector3d systems_m_ = Eigen::Vector3d::Zero();  ///< Clocks beside that of GPS; truly 0.
  Covariance believed_ = Covariance::Zero();             ///< P.
  Covariance actual_ = Covariance::Zero();               ///< M.
  /// Covariances of the state's error with what stays, each of variance 1: M's other part.
  Eigen::Matrix<double, kStates, static_cast<int>(kCommonErrors)> with_common_;
  /// Covariances of the state's error with the errors of positions by carriers: north, east, down.
  Eigen::Matrix<double, kStates, 3> with_carriers_;
  struct Own {
    Eigen::Matrix<double, kStates, 2> with = Eigen::Matrix<double, kStates, 2>::Zero();
    bool present = false;  ///< In the update before.
  };
  std::vector<Own> own_;
  std::vector<std::size_t> present_;  ///< Sources of the update before.
  std::vector<Row> ranges_;
  std::vector<Row> rates_;
  std::vector<Row> others_;
  std::vector<bool> left_out_;
  std::vector<double> residuals_m_;
};

}  // namespace rigwire::sim
