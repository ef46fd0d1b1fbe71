// What a receiver measures of each tracked signal (gnss_carriers.h): pseudorange, carrier phase and
// Doppler shift, from where satellite and antenna truly are, the receiver's clock, and the errors
// that surroundings and noise add.
//
//   pseudorange = range + c (receiver clock - satellite clock + group delay) + ionosphere +
//                 troposphere + code error
//   carrier     = (range + c (receiver clock - satellite clock) - ionosphere + troposphere +
//                 carrier error) / wavelength + N
//   Doppler     = -(rate of the pseudorange by the receiver's own clock + error) / wavelength
//
// N is a whole number, drawn when a signal is locked, so that the carrier begins within 401 cycles
// of the code as in receivers that start their phase there, and held until the signal slips. A set
// of the receiver's clock by a millisecond moves both, GPS' first carrier by 1 575 420 cycles. The
// ionosphere is stronger on a lower carrier by the square of the frequencies. GLONASS satellites
// send on channels of their own; the receiver's delays of these are taken as equal, as between
// receivers of one make.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/gnss/constellation.h"
#include "sim/gnss/receiver_clock.h"
#include "sim/gnss/signal_path.h"
#include "sim/random.h"

namespace rigwire::sim {

inline constexpr double kGpsL1Wavelength_m = kLightSpeed_mps / kGpsL1_hz;

/// One signal that the receiver tracks at this epoch. Delays and errors are metres, positive when
/// they lengthen the way.
struct TrackedSignal {
  std::size_t satellite = 0;  ///< Index within the constellation.
  bool second = false;        ///< On its second carrier.
  double cn0_dbhz = 45.0;
  double ionosphere_m = 0.0;  ///< On GPS L1. Delays the code, advances the carrier.
  double troposphere_m = 0.0;
  double code_error_m = 0.0;     ///< Noise, multipath, orbit and clock beyond the broadcast.
  double carrier_error_m = 0.0;  ///< Noise, multipath, orbit and clock for the carrier.
  double range_rate_error_mps = 0.0;
  bool slipped = false;  ///< The carrier's lock broke since the epoch before.
};

/// Standard deviations of thermal noise by carrier-to-noise density; code 0.3 m at 45 dBHz (u-blox
/// 7 open sky), carrier a loop of 15 Hz (Kaplan, Hegarty, "Understanding GPS", section 5.6.3),
/// Doppler 0.1 Hz at 45 dBHz. Each falls with the square root of the density.
[[nodiscard]] double code_sigma_m(double cn0_dbhz);
[[nodiscard]] double carrier_sigma_cycles(double cn0_dbhz);
[[nodiscard]] double doppler_sigma_hz(double cn0_dbhz);

/// The antenna at the measurement of `epoch`, whose wanted instant is `wanted` by GPS time.
[[nodiscard]] ReceptionPoint reception_point(const GpsTime& wanted, const ClockEpoch& epoch,
                                             const Eigen::Vector3d& position_E_m,
                                             const Eigen::Vector3d& velocity_E_mps);

class Observations {
 public:
  /// `satellites`: how many the constellation has. The random stream is named `name`.
  Observations(std::size_t satellites, std::uint64_t seed, std::string_view name);

  /// Measurements of `signals`, in their order, put into `measurements` (cleared first; allocates
  /// only while it grows). `wanted` as given to ReceiverClock::measure(), which made `epoch`;
  /// `antenna` as of reception_point(). A signal that is not among them has lost its lock. Every
  /// one at most once; the two of a satellite one after the other.
  void measure(const Constellation& constellation, SimTime wanted, const ClockEpoch& epoch,
               const ReceptionPoint& antenna, std::span<const TrackedSignal> signals,
               std::vector<GnssMeasurement>& measurements);

  /// All signals are lost: a reset of the receiver, or its antenna cut.
  void lose_lock();

 private:
  struct Lock {
    SimTime since = kNever;
    SimTime seen = kNever;
    double ambiguity_cycles = 0.0;
  };
  std::vector<Lock> locks_;  ///< Two of each satellite.
  RandomStream random_;
  SimTime last_ = kNever;
};

}  // namespace rigwire::sim
