// What a receiver's engine makes of a base station's measurements: which satellites both can use,
// how far away the station is, and by what the place that it claims is off.
//
//   code      the station's place and clock by least squares from its pseudoranges, with the orbits
//             and the air of this sky; satellites that contradict the rest by more than 30 m are
//             left out. Measurements of another sky (a real caster's) leave none.
//   carrier   a receiver finds integers; here the place that they lead to is looked up, and the
//             carriers must bear it out: less what geometry and air make of them, the carriers of
//             each system must be whole wavelengths apart, to 0.12 cycles rms over at least four of
//             them. Looked up are the place that the station claims, and the antennas of this world
//             that had an epoch at the station's (antenna_book.h), of those within 10 m of the
//             place by code. Nothing else lets an ambiguity be fixed: slipped, garbled or foreign
//             carriers do not.
//
// Ranges that are told but for whole milliseconds of light (RTCM 1001, 1003, 1009, 1011) are put
// together by the place that the station claims, its clock within half a millisecond.
//
// A station that claims a place where it is not moves every rover that trusts it; claim_error_E_m
// is by how much. Without carriers that bear a place out it is the error by code, averaged over a
// minute.
//
// Known limit: the air above the station is that of this rig's seed, so a station of another rig
// agrees only where both have the same seed and date, or no errors.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/gnss/constellation.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::sim {

/// How much longer than the range code and carrier are by orbit and air, as the messages of the
/// sky's satellites do not tell it, metres.
struct KnownDelay {
  double common_m = 0.0;
  double ionosphere_m = 0.0;  ///< On GPS L1; delays the code, advances the carrier.
};

class ReferenceStation {
 public:
  /// Delays of satellite `index` at an earth-fixed place, seen in that earth-fixed direction, at
  /// the station's epoch.
  using DelayOf = std::function<KnownDelay(std::size_t index, const Eigen::Vector3d& p_E_m,
                                           const Eigen::Vector3d& direction_E)>;

  explicit ReferenceStation(std::shared_ptr<const Constellation> constellation);

  /// Takes the station's epoch, measured at `time`. `places_E_m`: antennas that it could be.
  void take(const GnssCorrections& corrections, const GpsTime& time, const DelayOf& delay_of,
            std::span<const Eigen::Vector3d> places_E_m);

  /// Whether the station has that satellite, soundly; on its second band, too.
  [[nodiscard]] bool has(std::size_t index) const { return sound_[index].first; }
  [[nodiscard]] bool has_second(std::size_t index) const { return sound_[index].second; }
  /// The carriers bear a place out.
  [[nodiscard]] bool carriers_agree() const { return carriers_agree_; }
  /// Claimed place less true place, as far as the engine would be misled.
  [[nodiscard]] const Eigen::Vector3d& claim_error_E_m() const { return claim_error_E_m_; }

 private:
  struct Sound {
    bool first = false;
    bool second = false;
  };
  struct Row {
    std::size_t index = 0;
    const GnssCorrections::Signal* signal = nullptr;
    double range_m = 0.0;  ///< As told, with the milliseconds that were missing.
    double phase_m = 0.0;
    double residual_m = 0.0;
  };
  struct Fit {
    Eigen::Vector3d p_E_m = Eigen::Vector3d::Zero();
    double clock_m = 0.0;
  };

  [[nodiscard]] std::optional<std::size_t> index_of(const GnssCorrections::Signal& signal) const;
  void put_milliseconds(const Eigen::Vector3d& claimed_E_m, const GpsTime& time);
  [[nodiscard]] std::optional<Fit> fit_code(const Eigen::Vector3d& start_E_m, const GpsTime& time,
                                            const DelayOf& delay_of);
  [[nodiscard]] bool bears_out(const Eigen::Vector3d& p_E_m, const Fit& fit, const GpsTime& time,
                               const DelayOf& delay_of) const;

  std::shared_ptr<const Constellation> constellation_;
  std::vector<Sound> sound_;  ///< By index.
  std::vector<Row> rows_;     ///< First band, with a pseudorange.
  bool carriers_agree_ = false;
  Eigen::Vector3d claim_error_E_m_ = Eigen::Vector3d::Zero();
  // The error by code, averaged.
  Eigen::Vector3d averaged_E_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d claimed_E_m_ = Eigen::Vector3d::Zero();
  double averaged_epochs_ = 0.0;
};

}  // namespace rigwire::sim
