#include "sim/gnss/reference_station.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "fields/constants.h"
#include "sim/gnss/signal_path.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::sim {
namespace {

constexpr std::size_t kLeastSatellites = 4;
constexpr double kContradiction_m = 30.0;
constexpr double kSearched_m = 10.0;
/// Places nearer to each other than this have the same integers.
constexpr double kSameIntegers_m = 0.05;
constexpr double kIntegerRatio = 3.0;
constexpr std::size_t kLeastDifferences = 4;
constexpr double kIntegerQuantile = 3.09;  ///< 99.9 %.
// Standard deviations: a constant part, and one that is multiplied by 1 / sin E.
constexpr double kStationCarrier_m = 3e-3;
constexpr double kStationCarrierByElevation_m = 3e-3;
constexpr double kStationCode_m = 0.3;
constexpr double kStationCodeByElevation_m = 0.6;
constexpr double kGreatestInverseSine = 11.5;  ///< 5 degrees.
constexpr double kMaskInverseSine = 5.76;      ///< 10 degrees: lower ones find no integers.
/// How long errors of code stay.
constexpr double kCodeStays_s = 120.0;
/// How fast a place without integers becomes doubtful, m per sqrt(s): that of a station at rest,
constexpr double kStationWander = 5e-3;
/// and of one that moves, by what it claims of its motion alone.
constexpr double kClaimWander = 0.2;
/// From this many standard deviations on, a carrier's jump is not used to find a motion.
constexpr double kCarrierJump = 4.0;

/// Ratio of the ionospheric delay on a satellite's first carrier to that on GPS L1.
double ionosphere_share(const GnssCorrections::Signal& signal) {
  const double ratio =
      kGpsL1_hz / carrier_hz(signal.system, false, glonass_channel(signal.system, signal.number));
  return ratio * ratio;
}

Eigen::Vector3d to_eigen(const Vector3& v) {
  return {v.x, v.y, v.z};
}

/// Normal of the ellipsoid below a place near the ground.
Eigen::Vector3d up_at(const Eigen::Vector3d& p_E_m) {
  constexpr double kAxisRatio = 1.0067394967;  // (a / b)^2, WGS-84
  return Eigen::Vector3d(p_E_m.x(), p_E_m.y(), kAxisRatio * p_E_m.z()).normalized();
}

double station_carrier_sigma_m(double inverse_sine) {
  return std::hypot(kStationCarrier_m, kStationCarrierByElevation_m * inverse_sine);
}

double station_code_sigma_m(double inverse_sine) {
  return std::hypot(kStationCode_m, kStationCodeByElevation_m * inverse_sine);
}

/// A place and a clock by which signals can be predicted.
ReceptionPoint at(const GpsTime& time, const Eigen::Vector3d& p_E_m, double clock_m) {
  // The epoch is what the receiver's clock showed: by true time it was earlier by its bias.
  constexpr double kGreatest_s = 5e-3;
  const double offset_s = std::clamp(-clock_m / kLightSpeed_mps, -kGreatest_s, kGreatest_s);
  return {time, offset_s, p_E_m, Eigen::Vector3d::Zero()};
}

}  // namespace

ReferenceStation::ReferenceStation(std::shared_ptr<const Constellation> constellation)
    : constellation_(std::move(constellation)),
      sound_(constellation_->satellites().size()),
      carriers_(constellation_->satellites().size()) {}

std::optional<std::size_t> ReferenceStation::index_of(const GnssCorrections::Signal& signal) const {
  const auto satellites = constellation_->satellites();
  const auto found = std::ranges::find(satellites, Satellite{signal.system, signal.number});
  return found == satellites.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - satellites.begin()));
}

/// Restores missing whole milliseconds of light: from the claimed place's predicted ranges, with
/// the clock that the first satellite gives.
void ReferenceStation::put_milliseconds(const Eigen::Vector3d& claimed_E_m, const GpsTime& time) {
  if (std::ranges::all_of(rows_, [](const Row& row) { return row.signal->modulus_m == 0.0; })) {
    return;
  }
  const ReceptionPoint point = at(time, claimed_E_m, 0.0);
  std::optional<double> clock_m;
  for (Row& row : rows_) {
    const SignalPath path = signal_path(*constellation_, row.index, point);
    const double off_m =
        row.range_m -
        (path.range_m + kLightSpeed_mps * (path.group_delay_s - path.satellite_clock_s));
    const double modulus_m = row.signal->modulus_m;
    if (!clock_m) {
      clock_m = modulus_m > 0.0 ? std::remainder(off_m, modulus_m) : off_m;
    }
    if (modulus_m > 0.0) {
      const double missing_m = *clock_m + std::remainder(off_m - *clock_m, modulus_m) - off_m;
      row.range_m += missing_m;
      row.phase_m += missing_m;
    }
  }
}

/// Solves place and clock from rows_ by weighted least squares (Gauss-Newton); leaves out the worst
/// satellite while it contradicts the rest.
std::optional<ReferenceStation::Fit> ReferenceStation::fit_code(const Eigen::Vector3d& start_E_m,
                                                                const GpsTime& time,
                                                                const DelayOf& delay_of) {
  constexpr int kRounds = 3;
  const Eigen::Vector3d up = up_at(start_E_m);
  while (rows_.size() >= kLeastSatellites) {
    Fit fit{.p_E_m = start_E_m};
    bool solved = true;
    for (int round = 0; round < kRounds && solved; ++round) {
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      Eigen::Vector4d right = Eigen::Vector4d::Zero();
      const ReceptionPoint point = at(time, fit.p_E_m, fit.clock_m);
      for (Row& row : rows_) {
        const SignalPath path = signal_path(*constellation_, row.index, point);
        const KnownDelay delay = delay_of(row.index, fit.p_E_m, path.direction_E);
        row.inverse_sine = 1.0 / std::max(path.direction_E.dot(up), 1.0 / kGreatestInverseSine);
        row.residual_m =
            row.range_m - (path.range_m + fit.clock_m + delay.common_m +
                           ionosphere_share(*row.signal) * delay.ionosphere_m +
                           kLightSpeed_mps * (path.group_delay_s - path.satellite_clock_s));
        const double weight = 1.0 / std::pow(station_code_sigma_m(row.inverse_sine), 2);
        Eigen::Vector4d line;
        line << -path.direction_E, 1.0;
        normal += weight * line * line.transpose();
        right += weight * row.residual_m * line;
      }
      const Eigen::LDLT<Eigen::Matrix4d> factors(normal);
      const Eigen::Vector4d step = factors.solve(right);
      solved = factors.info() == Eigen::Success && step.allFinite() && step.norm() < 1e8;
      if (solved) {
        fit.p_E_m += step.head<3>();
        fit.clock_m += step(3);
        for (Row& row : rows_) {
          row.residual_m -= step(3);
        }
        const Eigen::Matrix4d covariance = factors.solve(Eigen::Matrix4d::Identity());
        fit.covariance_m2 = covariance.topLeftCorner<3, 3>();
      }
    }
    // Residuals are those before the last, vanishing step.
    const auto worst = std::ranges::max_element(
        rows_, {}, [](const Row& row) { return std::abs(row.residual_m); });
    if (solved && std::abs(worst->residual_m) < kContradiction_m) {
      return fit;
    }
    rows_.erase(worst);
  }
  return std::nullopt;
}

/// Returns what code or carrier of a satellite is at a place, without the receiver's clock.
double ReferenceStation::predicted_m(const Row& row, Quantity quantity, const ReceptionPoint& point,
                                     const DelayOf& delay_of) const {
  const SignalPath path = signal_path(*constellation_, row.index, point);
  const KnownDelay delay = delay_of(row.index, point.position_E_m, path.direction_E);
  const double common_m = path.range_m - kLightSpeed_mps * path.satellite_clock_s + delay.common_m;
  const double ionosphere_m = ionosphere_share(*row.signal) * delay.ionosphere_m;
  return quantity == Quantity::code ? common_m + kLightSpeed_mps * path.group_delay_s + ionosphere_m
                                    : common_m - ionosphere_m;
}

/// Returns a place as a point of reception, with the clock that the code has there.
ReceptionPoint ReferenceStation::point_at(const Eigen::Vector3d& p_E_m, const Fit& fit,
                                          const GpsTime& time, const DelayOf& delay_of) const {
  const ReceptionPoint about = at(time, p_E_m, fit.clock_m);
  double sum_m = 0.0;
  double weights = 0.0;
  for (const Row& row : rows_) {
    const double weight = 1.0 / std::pow(station_code_sigma_m(row.inverse_sine), 2);
    sum_m += weight * (row.range_m - predicted_m(row, Quantity::code, about, delay_of));
    weights += weight;
  }
  return at(time, p_E_m, sum_m / weights);
}

bool ReferenceStation::Misfit::passes() const {
  if (differences < kLeastDifferences) {
    return false;
  }
  // Quantile of chi^2 by Wilson and Hilferty.
  const double n = static_cast<double>(differences);
  const double part = 2.0 / (9.0 * n);
  return squares < n * std::pow(1.0 - part + kIntegerQuantile * std::sqrt(part), 3);
}

/// Returns how far the carriers at that place are from whole wavelengths apart. Signals of one
/// system have one wavelength, so each system is tested by itself.
ReferenceStation::Misfit ReferenceStation::misfit(const Eigen::Vector3d& p_E_m, const Fit& fit,
                                                  const GpsTime& time,
                                                  const DelayOf& delay_of) const {
  constexpr std::array kSystems{GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou,
                                GnssSystem::qzss};
  const ReceptionPoint point = point_at(p_E_m, fit, time, delay_of);
  struct Cycles {
    double value = 0.0;
    double weight = 0.0;
  };
  Misfit misfit;
  std::vector<Cycles> cycles;
  for (const GnssSystem system : kSystems) {
    cycles.clear();
    for (const Row& row : rows_) {
      const GnssCorrections::Signal& signal = *row.signal;
      if (signal.system == system && signal.wavelength_m > 0.0 && std::isfinite(row.phase_m) &&
          row.inverse_sine < kMaskInverseSine) {
        const double off_m = row.phase_m - predicted_m(row, Quantity::carrier, point, delay_of);
        const double sigma = station_carrier_sigma_m(row.inverse_sine) / signal.wavelength_m;
        cycles.push_back({off_m / signal.wavelength_m, 1.0 / (sigma * sigma)});
      }
    }
    if (cycles.size() < 2) {
      continue;
    }
    // Their weighted mean on the circle of one cycle; from it each is off by so much.
    std::complex<double> mean;
    for (const Cycles& one : cycles) {
      mean += std::polar(one.weight, kTurn * (one.value - cycles.front().value));
    }
    const double middle = cycles.front().value + std::arg(mean) / kTurn;
    for (const Cycles& one : cycles) {
      const double off = std::remainder(one.value - middle, 1.0);
      misfit.squares += one.weight * off * off;
    }
    misfit.differences += cycles.size() - 1;
  }
  return misfit;
}

/// Returns the place that is held while it passes the test, or a new one that passed it twice; null
/// when there is none.
const ReferenceStation::Candidate* ReferenceStation::borne_out(const Fit& fit, const GpsTime& time,
                                                               const DelayOf& delay_of) {
  if (held_) {
    const auto held = std::ranges::find(candidates_, *held_, &Candidate::identity);
    if (held != candidates_.end()) {
      held->misfit = misfit(held->p_E_m, fit, time, delay_of);
      if (held->misfit.passes()) {
        return &*held;
      }
    }
    held_.reset();
    likely_.reset();
  }
  for (Candidate& candidate : candidates_) {
    candidate.misfit = misfit(candidate.p_E_m, fit, time, delay_of);
  }
  const auto best = std::ranges::min_element(
      candidates_, {}, [](const Candidate& candidate) { return candidate.misfit.squares; });
  if (best == candidates_.end() || !best->misfit.passes() ||
      std::ranges::any_of(candidates_, [&](const Candidate& other) {
        return (other.p_E_m - best->p_E_m).norm() > kSameIntegers_m &&
               other.misfit.squares < kIntegerRatio * best->misfit.squares;
      })) {
    likely_.reset();
    return nullptr;
  }
  if (likely_ == best->identity) {
    held_ = best->identity;
    return &*best;
  }
  likely_ = best->identity;
  return nullptr;
}

/// Carries the place of the filter on by what the carriers say of the station's motion since the
/// epoch before. Returns false where less than three of four agree on a motion.
bool ReferenceStation::move_by_carriers(const Fit& fit, const GpsTime& time,
                                        const DelayOf& delay_of) {
  struct Change {
    Eigen::Vector4d line = Eigen::Vector4d::Zero();
    double metres = 0.0;
    double sigma_m = 1.0;
  };
  const ReceptionPoint point = point_at(fit.p_E_m, fit, time, delay_of);
  std::vector<Change> changes;
  for (const Row& row : rows_) {
    if (const Carrier& before = carriers_[row.index]; before.known && std::isfinite(row.phase_m)) {
      Change& change = changes.emplace_back();
      change.line << -signal_path(*constellation_, row.index, point).direction_E, 1.0;
      change.metres =
          row.phase_m - predicted_m(row, Quantity::carrier, point, delay_of) - before.rest_m;
      change.sigma_m = station_carrier_sigma_m(row.inverse_sine);
    }
  }
  const std::size_t most = changes.size() - changes.size() / 4;
  while (changes.size() > kLeastSatellites && changes.size() >= most) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const Change& change : changes) {
      const double weight = 1.0 / (change.sigma_m * change.sigma_m);
      normal += weight * change.line * change.line.transpose();
      right += weight * change.metres * change.line;
    }
    const Eigen::LDLT<Eigen::Matrix4d> factors(normal);
    const Eigen::Vector4d solution = factors.solve(right);
    if (factors.info() != Eigen::Success || !solution.allFinite()) {
      break;
    }
    const auto jump = [&](const Change& change) {
      return std::abs(change.metres - change.line.dot(solution)) / change.sigma_m;
    };
    const auto worst = std::ranges::max_element(changes, {}, jump);
    if (jump(*worst) < kCarrierJump) {
      place_E_m_ = fit.p_E_m + solution.head<3>();
      double squares = 0.0;
      for (const Change& change : changes) {
        squares += jump(change) * jump(change);
      }
      const double excess =
          std::max(1.0, squares / static_cast<double>(changes.size() - kLeastSatellites));
      const Eigen::Matrix4d covariance = factors.solve(Eigen::Matrix4d::Identity());
      covariance_m2_ += excess * covariance.topLeftCorner<3, 3>();
      return true;
    }
    changes.erase(worst);
  }
  return false;
}

void ReferenceStation::remember_carriers(const Fit& fit, const GpsTime& time,
                                         const DelayOf& delay_of) {
  const ReceptionPoint point = point_at(place_E_m_, fit, time, delay_of);
  for (const Row& row : rows_) {
    if (std::isfinite(row.phase_m)) {
      carriers_[row.index] = {row.phase_m - predicted_m(row, Quantity::carrier, point, delay_of),
                              true};
    }
  }
}

/// Updates the filter by the code. Its errors stay for tau: the epochs of 2 tau count as one.
void ReferenceStation::pull_by_code(const Fit& fit, double step_s) {
  if (!placed_) {
    place_E_m_ = fit.p_E_m;
    covariance_m2_ = fit.covariance_m2;
    placed_ = true;
    return;
  }
  const double epochs = std::max(1.0, 2.0 * kCodeStays_s / std::max(step_s, 1e-3));
  const Eigen::Matrix3d innovation_m2 = covariance_m2_ + epochs * fit.covariance_m2;
  const Eigen::Matrix3d gain = innovation_m2.ldlt().solve(covariance_m2_).transpose();
  place_E_m_ += gain * (fit.p_E_m - place_E_m_);
  const Eigen::Matrix3d after = covariance_m2_ - gain * covariance_m2_;
  covariance_m2_ = 0.5 * (after + after.transpose());
}

void ReferenceStation::list_candidates(const Fit& fit, const Eigen::Vector3d& claimed_E_m,
                                       std::span<const KnownAntenna> antennas) {
  candidates_.clear();
  const auto is_near = [&](const Eigen::Vector3d& p_E_m) {
    return (p_E_m - fit.p_E_m).norm() < kSearched_m;
  };
  for (const KnownAntenna& antenna : antennas) {
    if (is_near(antenna.p_E_m)) {
      candidates_.push_back({{antenna.id}, antenna.p_E_m, {}});
    }
  }
  // A claim that is right is the antenna's own place.
  if (is_near(claimed_E_m) && std::ranges::none_of(candidates_, [&](const Candidate& candidate) {
        return (candidate.p_E_m - claimed_E_m).norm() < kSameIntegers_m;
      })) {
    candidates_.push_back({{}, claimed_E_m, {}});
  }
}

void ReferenceStation::take(const GnssCorrections& corrections, const GpsTime& time,
                            const DelayOf& delay_of, std::span<const KnownAntenna> antennas) {
  std::ranges::fill(sound_, Sound{});
  carriers_agree_ = false;
  rows_.clear();
  for (const GnssCorrections::Signal& signal : corrections.signals) {
    if (const auto index = index_of(signal);
        index && !signal.second && std::isfinite(signal.range_m)) {
      rows_.push_back({*index, &signal, signal.range_m, signal.phase_m});
    }
  }
  const Eigen::Vector3d claimed_E_m = to_eigen(corrections.station_E_m);
  put_milliseconds(claimed_E_m, time);
  const auto fit = fit_code(claimed_E_m, time, delay_of);
  if (!fit) {
    std::ranges::fill(carriers_, Carrier{});
    return;
  }
  for (const Row& row : rows_) {
    sound_[row.index].first = std::isfinite(row.signal->phase_m);
  }
  for (const GnssCorrections::Signal& signal : corrections.signals) {
    if (const auto index = index_of(signal);
        index && signal.second && std::isfinite(signal.phase_m)) {
      sound_[*index].second = sound_[*index].first;
    }
  }

  if (!corrections.moving && claimed_E_m != claimed_E_m_) {  // this may be another station
    placed_ = false;
    if (held_ && !held_->antenna) {
      held_.reset();
    }
    likely_.reset();
  }
  const Eigen::Vector3d claimed_way_m = claimed_E_m - claimed_E_m_;
  claimed_E_m_ = claimed_E_m;
  const double step_s = measured_ == kNever ? 0.0 : to_seconds(corrections.measured - measured_);
  measured_ = corrections.measured;

  list_candidates(*fit, claimed_E_m, antennas);
  if (const Candidate* const found = borne_out(*fit, time, delay_of)) {
    carriers_agree_ = true;
    placed_ = true;
    place_E_m_ = found->p_E_m;
    covariance_m2_.setZero();
  } else {
    if (placed_ && corrections.moving && !move_by_carriers(*fit, time, delay_of)) {
      place_E_m_ += claimed_way_m;
      covariance_m2_.diagonal().array() += kClaimWander * kClaimWander * step_s;
    } else if (placed_ && !corrections.moving) {
      covariance_m2_.diagonal().array() += kStationWander * kStationWander * step_s;
    }
    pull_by_code(*fit, step_s);
  }
  claim_error_E_m_ = claimed_E_m - place_E_m_;
  std::ranges::fill(carriers_, Carrier{});
  if (corrections.moving) {
    remember_carriers(*fit, time, delay_of);
  }
}

}  // namespace rigwire::sim
