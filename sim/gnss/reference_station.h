// How a rover's engine uses a base station's measurements: which satellites both can use, how far
// away the station is, and the error of the place that it claims.
//
//   weights   a measurement's variance grows with 1 / sin^2 of its elevation, as an engine weighs
//             those of its own antenna: carrier 3 mm and 3 mm / sin E (RTKLIB's defaults), code
//             0.3 m and 0.6 m / sin E (noise and multipath of range_errors.h).
//   code      the station's place and clock by weighted least squares from its pseudoranges, with
//             the orbits and the air of this sky; satellites that contradict the rest by more than
//             30 m are left out. Measurements of another sky (a real caster's) leave none.
//   integers  a receiver searches integers; here the places that they lead to are known, and the
//             carriers must confirm one: after subtracting geometry and air, the carriers of each
//             system are whole wavelengths apart. Candidates are the place that the station claims,
//             and the antennas of this world that had an epoch at the station's (antenna_book.h),
//             if they are within 10 m of the place by code. The test: the squared residuals over
//             their variances, of satellites above 10 degrees and at least five of them, stay below
//             the 99.9 % quantile of chi^2. A place must pass it in two successive epochs, three
//             times better than any other that is not within 5 cm (the ratio test). Once found it
//             is held as long as it passes. Ambiguities are fixed in no other way: slipped, garbled
//             or foreign carriers never fix one.
//   floating  while no place is confirmed, the station's place is the state of a filter: it moves
//             from the last one by the motion that the carriers show or the station claims (a
//             station at rest does not move), and the code pulls it slowly, since the code's errors
//             last for minutes. The filter has its covariance, too.
//
// Ranges without their whole milliseconds of light (RTCM 1001, 1003, 1009, 1011) are completed from
// the place that the station claims, its clock within half a millisecond.
//
// A station that claims a wrong place shifts every rover that trusts it; claim_error_E_m is the
// shift.
//
// Known limit: the air above the station is that of this rig's seed, so a station of another rig
// agrees only where both have the same seed and date, or no errors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/gnss/constellation.h"
#include "sim/gnss/signal_path.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

/// What orbit and air add to code and carrier beyond what the satellites' messages report, metres.
struct KnownDelay {
  double common_m = 0.0;
  double ionosphere_m = 0.0;  ///< On GPS L1; delays the code, advances the carrier.
};

/// An antenna of this world at the station's epoch.
struct KnownAntenna {
  std::size_t id = 0;  ///< AntennaBook's.
  Eigen::Vector3d p_E_m = Eigen::Vector3d::Zero();
};

class ReferenceStation {
 public:
  /// Delays of satellite `index` at an earth-fixed place, seen in that earth-fixed direction, at
  /// the station's epoch.
  using DelayOf = std::function<KnownDelay(std::size_t index, const Eigen::Vector3d& p_E_m,
                                           const Eigen::Vector3d& direction_E)>;

  explicit ReferenceStation(std::shared_ptr<const Constellation> constellation);

  /// Takes the station's epoch, measured at `time`. `antennas`: those that it could be.
  void take(const GnssCorrections& corrections, const GpsTime& time, const DelayOf& delay_of,
            std::span<const KnownAntenna> antennas);

  /// Whether the station has sound measurements of that satellite; on its second band, too.
  [[nodiscard]] bool has(std::size_t index) const { return sound_[index].first; }
  [[nodiscard]] bool has_second(std::size_t index) const { return sound_[index].second; }
  /// Whether the carriers confirm a place.
  [[nodiscard]] bool carriers_agree() const { return carriers_agree_; }
  /// Claimed place less true place, as far as the engine would be misled.
  [[nodiscard]] const Eigen::Vector3d& claim_error_E_m() const { return claim_error_E_m_; }
  /// Covariance of that error, earth-fixed; 0 while the carriers confirm a place.
  [[nodiscard]] const Eigen::Matrix3d& claim_covariance_m2() const { return covariance_m2_; }

 private:
  struct Sound {
    bool first = false;
    bool second = false;
  };
  struct Row {
    std::size_t index = 0;
    const GnssCorrections::Signal* signal = nullptr;
    double range_m = 0.0;  ///< Reported pseudorange, missing milliseconds restored.
    double phase_m = 0.0;
    double residual_m = 0.0;
    double inverse_sine = 1.0;  ///< One over the sine of the elevation.
  };
  struct Fit {
    Eigen::Vector3d p_E_m = Eigen::Vector3d::Zero();
    double clock_m = 0.0;
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< Covariance of p_E_m.
  };
  /// How badly the carriers fit a place.
  struct Misfit {
    double squares = 0.0;  ///< Squared residuals over their variances.
    std::size_t differences = 0;
    [[nodiscard]] bool passes() const;
  };
  /// Antenna that the station is; empty: it is where it claims to be.
  struct Identity {
    std::optional<std::size_t> antenna;
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  struct Candidate {
    Identity identity;
    Eigen::Vector3d p_E_m = Eigen::Vector3d::Zero();
    Misfit misfit;
  };
  /// A carrier of the epoch before, less what place and clock explained of it.
  struct Carrier {
    double rest_m = 0.0;
    bool known = false;
  };

  [[nodiscard]] std::optional<std::size_t> index_of(const GnssCorrections::Signal& signal) const;
  void put_milliseconds(const Eigen::Vector3d& claimed_E_m, const GpsTime& time);
  [[nodiscard]] std::optional<Fit> fit_code(const Eigen::Vector3d& start_E_m, const GpsTime& time,
                                            const DelayOf& delay_of);
  enum class Quantity : unsigned char { code, carrier };
  [[nodiscard]] double predicted_m(const Row& row, Quantity quantity, const ReceptionPoint& point,
                                   const DelayOf& delay_of) const;
  [[nodiscard]] ReceptionPoint point_at(const Eigen::Vector3d& p_E_m, const Fit& fit,
                                        const GpsTime& time, const DelayOf& delay_of) const;
  [[nodiscard]] Misfit misfit(const Eigen::Vector3d& p_E_m, const Fit& fit, const GpsTime& time,
                              const DelayOf& delay_of) const;
  void list_candidates(const Fit& fit, const Eigen::Vector3d& claimed_E_m,
                       std::span<const KnownAntenna> antennas);
  [[nodiscard]] const Candidate* borne_out(const Fit& fit, const GpsTime& time,
                                           const DelayOf& delay_of);
  [[nodiscard]] bool move_by_carriers(const Fit& fit, const GpsTime& time, const DelayOf& delay_of);
  void remember_carriers(const Fit& fit, const GpsTime& time, const DelayOf& delay_of);
  void pull_by_code(const Fit& fit, double step_s);

  std::shared_ptr<const Constellation> constellation_;
  std::vector<Sound> sound_;       ///< By index.
  std::vector<Row> rows_;          ///< First band, with a pseudorange.
  std::vector<Carrier> carriers_;  ///< By index.
  std::vector<Candidate> candidates_;
  bool carriers_agree_ = false;
  std::optional<Identity> held_;    ///< Borne out in two epochs and since.
  std::optional<Identity> likely_;  ///< Borne out in the last epoch.
  Eigen::Vector3d claim_error_E_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d claimed_E_m_ = Eigen::Vector3d::Zero();
  SimTime measured_ = kNever;
  // State of the filter while no place is borne out.
  bool placed_ = false;
  Eigen::Vector3d place_E_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2_ = Eigen::Matrix3d::Zero();
};

}  // namespace rigwire::sim
