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
constexpr double kAgreement_cycles = 0.12;
constexpr double kAveraged_epochs = 60.0;

/// By what the ionosphere is stronger on a satellite's first carrier than on GPS L1.
double ionosphere_share(const GnssCorrections::Signal& signal) {
  const double ratio =
      kGpsL1_hz / carrier_hz(signal.system, false, glonass_channel(signal.system, signal.number));
  return ratio * ratio;
}

Eigen::Vector3d to_eigen(const Vector3& v) {
  return {v.x, v.y, v.z};
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
    : constellation_(std::move(constellation)), sound_(constellation_->satellites().size()) {}

std::optional<std::size_t> ReferenceStation::index_of(const GnssCorrections::Signal& signal) const {
  const auto satellites = constellation_->satellites();
  const auto found = std::ranges::find(satellites, Satellite{signal.system, signal.number});
  return found == satellites.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - satellites.begin()));
}

/// Whole milliseconds of light where they are not told: by what the claimed place predicts, with
/// the clock that the first satellite shows.
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

/// Place and clock by least squares (Gauss and Newton) from what rows_ have; the worst one is left
/// out while it contradicts the rest.
std::optional<ReferenceStation::Fit> ReferenceStation::fit_code(const Eigen::Vector3d& start_E_m,
                                                                const GpsTime& time,
                                                                const DelayOf& delay_of) {
  constexpr int kRounds = 3;
  while (rows_.size() >= kLeastSatellites) {
    Fit fit{start_E_m, 0.0};
    bool solved = true;
    for (int round = 0; round < kRounds && solved; ++round) {
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      Eigen::Vector4d right = Eigen::Vector4d::Zero();
      const ReceptionPoint point = at(time, fit.p_E_m, fit.clock_m);
      for (Row& row : rows_) {
        const SignalPath path = signal_path(*constellation_, row.index, point);
        const KnownDelay delay = delay_of(row.index, fit.p_E_m, path.direction_E);
        row.residual_m =
            row.range_m - (path.range_m + fit.clock_m + delay.common_m +
                           ionosphere_share(*row.signal) * delay.ionosphere_m +
                           kLightSpeed_mps * (path.group_delay_s - path.satellite_clock_s));
        Eigen::Vector4d line;
        line << -path.direction_E, 1.0;
        normal += line * line.transpose();
        right += row.residual_m * line;
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

/// Whether the carriers at that place are whole wavelengths apart, system by system, whose signals
/// have one wavelength.
bool ReferenceStation::bears_out(const Eigen::Vector3d& p_E_m, const Fit& fit, const GpsTime& time,
                                 const DelayOf& delay_of) const {
  constexpr std::array kSystems{GnssSystem::gps, GnssSystem::galileo, GnssSystem::beidou,
                                GnssSystem::qzss};
  // The clock that goes with this place.
  double clock_m = fit.clock_m;
  std::vector<std::pair<double, double>> carriers;  // predicted part, wavelength
  const auto predict = [&](const Row& row, bool code) {
    const SignalPath path = signal_path(*constellation_, row.index, at(time, p_E_m, clock_m));
    const KnownDelay delay = delay_of(row.index, p_E_m, path.direction_E);
    const double common_m =
        path.range_m - kLightSpeed_mps * path.satellite_clock_s + delay.common_m;
    const double ionosphere_m = ionosphere_share(*row.signal) * delay.ionosphere_m;
    return code ? common_m + kLightSpeed_mps * path.group_delay_s + ionosphere_m
                : common_m - ionosphere_m;
  };
  double sum_m = 0.0;
  for (const Row& row : rows_) {
    sum_m += row.range_m - predict(row, true);
  }
  clock_m = sum_m / static_cast<double>(rows_.size());

  double squares = 0.0;
  std::size_t differences = 0;
  for (const GnssSystem system : kSystems) {
    std::vector<double> cycles;
    for (const Row& row : rows_) {
      const GnssCorrections::Signal& signal = *row.signal;
      if (signal.system == system && signal.wavelength_m > 0.0 && std::isfinite(row.phase_m)) {
        cycles.push_back((row.phase_m - predict(row, false)) / signal.wavelength_m);
      }
    }
    if (cycles.size() < 2) {
      continue;
    }
    // Their mean on the circle of one cycle; from it each is off by so much.
    std::complex<double> mean;
    for (const double value : cycles) {
      mean += std::polar(1.0, kTurn * (value - cycles.front()));
    }
    const double middle = cycles.front() + std::arg(mean) / kTurn;
    for (const double value : cycles) {
      const double off = std::remainder(value - middle, 1.0);
      squares += off * off;
    }
    differences += cycles.size() - 1;
  }
  return differences + 1 >= kLeastSatellites + 1 &&
         std::sqrt(squares / static_cast<double>(differences)) < kAgreement_cycles;
}

void ReferenceStation::take(const GnssCorrections& corrections, const GpsTime& time,
                            const DelayOf& delay_of, std::span<const Eigen::Vector3d> places_E_m) {
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

  // The error of the claim by code: the mean of its last minute, while the claim stays.
  const Eigen::Vector3d by_code_m = claimed_E_m - fit->p_E_m;
  if (!corrections.moving && claimed_E_m != claimed_E_m_) {
    averaged_epochs_ = 0.0;
  }
  claimed_E_m_ = claimed_E_m;
  averaged_epochs_ = std::min(averaged_epochs_ + 1.0, kAveraged_epochs);
  averaged_E_m_ += (by_code_m - averaged_E_m_) / averaged_epochs_;
  claim_error_E_m_ = averaged_E_m_;

  const auto look = [&](const Eigen::Vector3d& place_E_m) {
    if (!carriers_agree_ && (place_E_m - fit->p_E_m).norm() < kSearched_m &&
        bears_out(place_E_m, *fit, time, delay_of)) {
      carriers_agree_ = true;
      claim_error_E_m_ = claimed_E_m - place_E_m;
    }
  };
  look(claimed_E_m);
  for (const Eigen::Vector3d& place_E_m : places_E_m) {
    look(place_E_m);
  }
}

}  // namespace rigwire::sim
