#include "sim/gnss/observations.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "sim/samples/gnss_carriers.h"

namespace rigwire::sim {
namespace {

/// Standard deviation relative to that at 45 dBHz.
double noise_ratio(double cn0_dbhz) {
  return std::pow(10.0, (45.0 - cn0_dbhz) / 20.0);
}

}  // namespace

double code_sigma_m(double cn0_dbhz) {
  return 0.3 * noise_ratio(cn0_dbhz);
}

double carrier_sigma_cycles(double cn0_dbhz) {
  constexpr double kBandwidth_hz = 15.0;
  // Thermal noise of a phase loop: sqrt(B / (C/N0)) / (2 pi) cycles (Kaplan, Hegarty, 5.6.3).
  return std::sqrt(kBandwidth_hz / std::pow(10.0, cn0_dbhz / 10.0)) / (2.0 * std::numbers::pi);
}

double doppler_sigma_hz(double cn0_dbhz) {
  return 0.1 * noise_ratio(cn0_dbhz);
}

ReceptionPoint reception_point(const GpsTime& wanted, const ClockEpoch& epoch,
                               const Eigen::Vector3d& position_E_m,
                               const Eigen::Vector3d& velocity_E_mps) {
  return {wanted, epoch.measured_after_s, position_E_m, velocity_E_mps};
}

Observations::Observations(std::size_t satellites, std::uint64_t seed, std::string_view name)
    : locks_(2 * satellites), random_(seed, name) {}

void Observations::lose_lock() {
  locks_.assign(locks_.size(), Lock{});
}

void Observations::measure(const Constellation& constellation, SimTime wanted,
                           const ClockEpoch& epoch, const ReceptionPoint& antenna,
                           std::span<const TrackedSignal> signals,
                           std::vector<GnssMeasurement>& measurements) {
  measurements.clear();
  SignalPath path;
  std::optional<std::size_t> path_of;
  for (const TrackedSignal& signal : signals) {
    if (path_of != signal.satellite) {
      path = signal_path(constellation, signal.satellite, antenna);
      path_of = signal.satellite;
    }
    const Satellite& satellite = constellation.satellites()[signal.satellite];
    const int channel = glonass_channel(satellite.system, satellite.number);
    const double carrier_hz = rigwire::carrier_hz(satellite.system, signal.second, channel);
    const double wavelength_m = kLightSpeed_mps / carrier_hz;
    const double to_l1 = kGpsL1_hz / carrier_hz;
    const double ionosphere_m = to_l1 * to_l1 * signal.ionosphere_m;
    const double delay_s = signal.second ? path.second_delay_s : path.group_delay_s;
    // Pseudorange and carrier phase of observations.h, what they share first.
    const double clocks_m = kLightSpeed_mps * (epoch.bias_s - path.satellite_clock_s);
    const double common_m = path.range_m + clocks_m + signal.troposphere_m;
    const double code_m = common_m + kLightSpeed_mps * delay_s + ionosphere_m + signal.code_error_m;
    const double carrier_cycles = (common_m - ionosphere_m + signal.carrier_error_m) / wavelength_m;

    Lock& lock = locks_[2 * signal.satellite + (signal.second ? 1 : 0)];
    const bool slipped = signal.slipped || lock.since == kNever || lock.seen != last_;
    if (slipped) {
      lock.since = wanted;
      // A whole number that puts the carrier near the code.
      lock.ambiguity_cycles =
          std::round(code_m / wavelength_m - carrier_cycles + random_.uniform(-400.0, 400.0));
    }
    lock.seen = wanted;

    // The satellite's clock runs at the time of transmission, which passes the slower the faster
    // the satellite recedes; and the receiver counts cycles per second of its own clock.
    const double rate_mps =
        path.range_rate_mps +
        kLightSpeed_mps * (epoch.drift - path.satellite_clock_drift *
                                             (1.0 - path.range_rate_mps / kLightSpeed_mps));

    GnssMeasurement measurement;
    measurement.system = satellite.system;
    measurement.number = satellite.number;
    measurement.second = signal.second;
    measurement.channel = static_cast<std::int8_t>(channel);
    measurement.pseudorange_m = code_m;
    measurement.carrier_phase_cycles = carrier_cycles + lock.ambiguity_cycles;
    measurement.doppler_hz =
        -(rate_mps / (1.0 + epoch.drift) + signal.range_rate_error_mps) / wavelength_m;
    measurement.cn0_dbhz = signal.cn0_dbhz;
    measurement.locked = wanted - lock.since;
    measurement.slipped = slipped;
    measurement.pseudorange_sigma_m = code_sigma_m(signal.cn0_dbhz);
    measurement.carrier_sigma_cycles = carrier_sigma_cycles(signal.cn0_dbhz);
    measurement.doppler_sigma_hz = doppler_sigma_hz(signal.cn0_dbhz);
    measurements.push_back(measurement);
  }
  last_ = wanted;
}

}  // namespace rigwire::sim
