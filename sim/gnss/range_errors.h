// What a single-frequency receiver's pseudoranges are off by, satellite by satellite, when
// broadcast orbits, clocks and atmosphere have been applied: zero-mean terms, and the exact delay
// of reflected signals on top. The first three are the same for every receiver (error_field.h); the
// others are each receiver's own, Gauss-Markov processes discretised exactly.
//
//   orbit and clock   per satellite, hours: signal-in-space error of 0.5 .. 1 m (GPS performance
//                     standard's order of magnitude; recalled)
//   ionosphere        what Klobuchar's model leaves: half of the delay (as RTKLIB's ERR_BRDCI
//                     assumes), common to all satellites up to its gradient, 30 .. 60 min; mapped
//                     by 1 + 16 (0.53 - E / pi)^3, IS-GPS-200 section 20.3.3.5.2.5
//   troposphere       0.05 m at the zenith after Saastamoinen's model, 1 / sin E; half an hour
//   code noise        0.15 m at 45 dBHz, times 10^((45 - C/N0) / 20): 1.2 m at 27 dBHz (a ZED-F9P,
//                     which smooths, has 0.45 m at 24 to 27 dBHz, 0.04 m at 36 to 39)
//   multipath         0.5 m at 45 dBHz, times 10^((45 - C/N0) / 20) without fading: reflections
//                     bend the code as much as they are strong beside the direct signal; minutes at
//                     rest, seconds in motion, since they change with the place: 1/tau = 1/tau_rest
//                     + speed / length. Accuracies that u-blox receivers of generations 7 to 9
//                     report follow HDOP x 0.6 m x 10^((45 - C/N0) / 20) within a third in 11 of 13
//                     logs (gpsd's regression tests; medians of 16 to 44 dBHz of the satellites
//                     used)
//   foliage           0.3 m of multipath for each dB that crowns take: errors of several metres
//                     under trees (recalled, not measured here); its carrier slips at random,
//                     0.045 times a second for each dB: an estimate, so that under closed crowns an
//                     RTK receiver is fixed a part of the time only (carrier_solution.h)
//   range rate        white 10 mm/s at 45 dBHz, and 20 mm/s that stay 2.5 s at rest, 1 s in motion
//                     (u-blox receivers at rest show speeds of 14 to 24 mm/s)
//   carrier           thermal noise of its loop, and 2 mm over sin E of multipath
//   second signal     code and carrier have noise and multipath of their own, of the same size
//   receiver          leaves the broadcast share of orbit, clock and ionosphere in its ranges: 1 on
//                     a NEO-7P; the accuracies that newer ones report are too small for all of them
//   reflections       found by rays (multipath.h): a direct signal gains an error of that envelope
//                     as multipath does; a signal that arrives only by reflection is long by its
//                     extra path, and by an exponential scatter that another part of the wall
//                     renews at random
//
// Fading of C/N0: 6 s at rest, over 15 m in motion (recordings of NEO-7Ps: 4 to 8 s, 1 to 2 s in a
// town's traffic).
//
// Each satellite draws from its own streams, so that what happens to one never changes another.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "fields/rules.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/gauss_markov.h"
#include "sim/gnss/position_solution.h"
#include "sim/random.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

struct RangeErrorParameters {
  /// What this receiver leaves of the errors of broadcast orbits, clocks and ionosphere when its
  /// ranges are used; measured ranges have all of them.
  double broadcast_share = 1.0;
  double orbit_clock_sigma_m = 0.8;
  double orbit_clock_correlation_s = 7200.0;
  double ionosphere_sigma_m = 2.2;                 ///< Vertical, what the model leaves.
  double ionosphere_gradient_sigma_mpkm = 1.5e-3;  ///< Per axis, m per km of the pierce point.
  double ionosphere_correlation_s = 2400.0;
  double troposphere_sigma_m = 0.05;  ///< Vertical, what the model leaves.
  double troposphere_correlation_s = 1800.0;
  double code_noise_m = 0.15;              ///< At 45 dBHz.
  double code_noise_correlation_s = 0.5;   ///< Correlation time of the code loop.
  double multipath_sigma_m = 0.5;          ///< At 45 dBHz.
  double multipath_correlation_s = 120.0;  ///< At rest ...
  double multipath_length_m = 50.0;        ///< ... and over this way in motion.
  /// What the receiver adds to its sigma for each dB that a signal is weaker than its elevation
  /// lets expect, beyond 3 dB: how receivers mistrust signals that came by a detour.
  double weak_signal_sigma_mpdb = 1.0;
  /// Multipath of the crowns that a signal comes through, for each dB that they take.
  double foliage_multipath_mpdb = 0.3;
  double foliage_slips_psdb = 0.045;   ///< Carrier slips per second for each of these dB.
  double rate_noise_mps = 0.01;        ///< White noise of a range rate, at 45 dBHz.
  double carrier_multipath_m = 0.002;  ///< Multipath of the carrier, at the zenith; over sin E.
  double rate_multipath_mps = 0.02;    ///< What reflections add to a range rate; seconds at rest.
};
void visit(fields::Visitor& v, RangeErrorParameters& p);

/// Throws std::invalid_argument naming the key, its value and what is allowed.
void validate(const RangeErrorParameters& parameters);

/// Factor from zenith delays to slant delays at an elevation of at least 0, rad.
[[nodiscard]] double ionosphere_mapping(double elevation_rad);
[[nodiscard]] double troposphere_mapping(double elevation_rad);

/// How corrections shrink what they know about; 1 without.
struct CorrectedShare {
  double orbit_clock = 1.0;
  double ionosphere = 1.0;
};

/// What the field of errors says of a signal, each of variance 1: see error_field.h.
struct SharedErrors {
  double orbit_clock = 0.0;
  double ionosphere = 0.0;   ///< Vertical, where the signal passes it.
  double troposphere = 0.0;  ///< Vertical.
};

/// How a satellite's signal arrives.
struct SignalArrival {
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double cn0_dbhz = 45.0;
  double fade_db = 0.0;                ///< Fading that cn0_dbhz contains.
  double second_weaker_db = 0.0;       ///< How much weaker its second carrier is.
  double missing_db = 0.0;             ///< Weaker by so much than under an open sky.
  double foliage_db = 0.0;             ///< Part of missing_db that crowns take.
  double reflection_envelope_m = 0.0;  ///< Error by reflections that join the direct signal.
  double extra_path_m = 0.0;           ///< Extra path of a signal without line of sight.
  SharedErrors shared{};
};

/// The error of one pseudorange in parts, and what the receiver believes of it.
struct RangeError {
  double orbit_clock_m = 0.0;     ///< In code and carrier alike.
  double ionosphere_m = 0.0;      ///< Delays the code, advances the carrier.
  double troposphere_m = 0.0;     ///< In code and carrier alike.
  double local_m = 0.0;           ///< Noise and multipath: the code's alone.
  double carrier_m = 0.0;         ///< Noise and multipath of the carrier, not in the total.
  double second_local_m = 0.0;    ///< Noise and multipath of the second signal's code.
  double second_carrier_m = 0.0;  ///< Noise and multipath of the second signal's carrier.
  double detour_m = 0.0;          ///< Extra path without line of sight, in code and carrier alike.
  double rate_mps = 0.0;          ///< Error of the Doppler measurement, sigma 1: coloured model.
  double range_rate_mps = 0.0;    ///< Error of the range rate by its own parameters: engine.
  double range_rate_noise_mps = 0.0;  ///< Sigma that the receiver assumes for it.
  /// What corrections, or a second band, take out of orbit, clock and ionosphere before the range
  /// is used: in the total, not in what is measured.
  double corrected_m = 0.0;
  double sigma_m = 1.0;  ///< 1 sigma by elevation and C/N0; knows nothing of reflections.
  /// What the engine knows of it: noise, multipath (by C/N0, too), what is the satellite's own
  /// (orbit, clock, its part of the ionosphere); and what makes its weight smaller still.
  double noise_sigma_m = 0.0;
  double multipath_sigma_m = 0.0;
  double orbit_sigma_m = 0.0;
  double mistrust_sigma_m = 0.0;
  /// Parts of sigma_m that all satellites share: ionosphere at the zenith, its gradients north and
  /// east, troposphere.
  std::array<double, kCommonErrors> common_m{};
  [[nodiscard]] double total_m() const {
    return orbit_clock_m + ionosphere_m + troposphere_m + local_m + detour_m - corrected_m;
  }
};

/// Errors of one satellite's own.
class SatelliteErrors {
 public:
  SatelliteErrors(std::uint64_t seed, std::string_view name);
  /// Advances by `step_s` since the last call, however long the satellite was out of sight.
  void advance(const RangeErrorParameters& parameters, double step_s, double speed_mps);
  /// Advances what a second signal has of its own; without this call it has no errors.
  void advance_second(const RangeErrorParameters& parameters, double step_s, double speed_mps);
  /// Advances the fading alone.
  void fade(double step_s, double speed_mps);
  /// Moves on along the walls that reflect the signal; returns whether another part of them does
  /// so now.
  bool scatter(double step_s, double rest_s, double speed_mps, double length_m);
  /// The satellite was acquired anew: what belongs to the receiver's lock is drawn afresh.
  void acquired();
  [[nodiscard]] RangeError error(const RangeErrorParameters& parameters,
                                 const SignalArrival& arrival, const CorrectedShare& share) const;
  /// Whether the carrier slips within a step under crowns that take so much.
  [[nodiscard]] bool slips(const RangeErrorParameters& parameters, double foliage_db,
                           double step_s);
  /// Unit fading of C/N0.
  [[nodiscard]] double fading() const { return fading_.value(); }
  /// Unit fading by leaves and branches.
  [[nodiscard]] double foliage_fading() const { return foliage_fading_.value(); }
  /// Returns the excess of a reflected path, exponentially distributed with mean 1.
  [[nodiscard]] double scattered() const { return scattered_; }

 private:
  RandomStream random_;
  RandomStream fading_random_;
  GaussMarkov code_noise_;
  GaussMarkov multipath_;
  GaussMarkov fading_;
  RandomStream foliage_random_;
  GaussMarkov foliage_fading_;
  RandomStream scatter_random_;
  double scattered_ = -1.0;  ///< Below 0: not drawn.
  GaussMarkov rate_;
  RandomStream rate_random_;
  GaussMarkov rate_noise_;
  GaussMarkov rate_multipath_;
  /// Noise and multipath of a carrier, and of a code.
  struct Local {
    GaussMarkov code_noise;
    GaussMarkov code_multipath;
    GaussMarkov carrier_noise;
    GaussMarkov carrier_multipath;
  };
  GaussMarkov carrier_noise_;
  GaussMarkov carrier_multipath_;
  RandomStream second_random_;
  RandomStream slip_random_;
  Local second_;
};

}  // namespace rigwire::sim
