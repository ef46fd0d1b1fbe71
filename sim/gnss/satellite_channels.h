// The satellites that a receiver knows: where they are, how their signals arrive, which are
// tracked, and what their pseudoranges are off by.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sim/gnss/constellation.h"
#include "sim/gnss/error_field.h"
#include "sim/gnss/gnss_fault.h"
#include "sim/gnss/gnss_parameters.h"
#include "sim/gnss/multipath.h"
#include "sim/gnss/range_errors.h"
#include "sim/gnss/sky_view.h"
#include "sim/local_frame.h"
#include "sim/visibility.h"

namespace rigwire::sim {

/// A carrier is taken up for a carrier solution from this strength on: 0.03 cycles of noise. A
/// ZED-F9P holds those of 28 to 32 dBHz and gives them 0.02 to 0.03 cycles (gpsd's regression
/// tests, ublox-zed-f9p_hpg1.11).
constexpr double kCarrierCn0_dbhz = 27.0;

/// The place and the instant of reception.
struct Reception {
  SimTime time{};
  GpsTime gps;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< Place of the antenna in the scene.
  /// Place to which the ranges refer (faults).
  Eigen::Vector3d ranges_p_W = Eigen::Vector3d::Zero();
  double speed_mps = 0.0;
};

/// One satellite above the horizon.
struct ReceivedSatellite {
  std::size_t index = 0;  ///< In the constellation.
  Satellite satellite;
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d direction_ned = -Eigen::Vector3d::UnitZ();
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double cn0_dbhz = 0.0;
  double second_weaker_db = 0.0;  ///< What its second carrier has lost more than the first.
  bool tracked = false;
  bool acquired = false;   ///< Since this epoch.
  bool direct = false;     ///< In line of sight, not by a reflection alone.
  bool carries = false;    ///< Its carrier is good for a carrier solution.
  bool slipped = false;    ///< Acquired, changed between direct and reflected signal, or by crowns.
  double held_s = 0.0;     ///< Since the carrier slipped last.
  bool two_bands = false;  ///< Its ionosphere is known by two bands; set by the sensor.
  bool usable = false;     ///< Tracked, healthy, above the mask.
  bool used = false;       ///< Takes part in the fix; set by the sensor.
  double residual_m = 0.0;  ///< What the fix does not explain; set by the sensor.
  RangeError error;         ///< When tracked, coloured model.
};

class SatelliteChannels {
 public:
  SatelliteChannels(const GnssParameters& parameters,
                    std::shared_ptr<const Constellation> constellation, std::uint64_t seed,
                    std::string_view name);

  /// One epoch. By system and number; valid until the next call. range_errors() fills the errors
  /// in.
  std::span<ReceivedSatellite> receive(const Reception& reception, const LocalFrame& frame,
                                       const Visibility& visibility, const GnssFaultState& fault);
  /// Errors of the tracked ones, with the corrections that apply.
  void range_errors(const CorrectedShare& share, bool spoofed);

  /// What orbit and air add to ranges of satellite `index` elsewhere and at another time: the
  /// shared part of RangeError. 0 where the model has no errors.
  [[nodiscard]] RangeError shared_error(std::size_t index, SimTime time,
                                        const Eigen::Vector3d& p_E_m,
                                        const Eigen::Vector3d& direction_E,
                                        double elevation_rad) const;

  /// Any satellite of that system among those received at all.
  [[nodiscard]] bool knows(GnssSystem system) const;
  /// Rays cast for reflections so far.
  [[nodiscard]] std::uint64_t reflection_rays() const { return reflections_.rays(); }

 private:
  struct Channel {
    std::size_t index = 0;
    Satellite satellite;
    SatelliteErrors errors;
    SatelliteTracker tracker;
    SimTime last = kNever;
    SkyArrival arrival;
    bool direct = false;     ///< At the epoch before.
    bool carries = false;    ///< At the epoch before.
    bool slips = false;      ///< Under crowns, since then.
    bool scattered = false;  ///< Another part of a wall reflects it, since then.
    SimTime held = kNever;   ///< Since when the carrier is.
    double fade_db = 0.0;
    double envelope_m = 0.0;
    double extra_path_m = 0.0;
  };

  void find_above_horizon(const Reception& reception, const LocalFrame& frame);
  void arrive_as_in_paper(ReceivedSatellite& received, const Reception& reception,
                          const Visibility& visibility) const;
  void arrive(Channel& channel, ReceivedSatellite& received, const Reception& reception,
              const Visibility& visibility);
  void advance_errors(const Reception& reception);
  [[nodiscard]] double foliage_db(const Channel& channel) const;
  void fade(const Reception& reception);
  void track(const Reception& reception, const GnssFaultState& fault);
  [[nodiscard]] double ionosphere_length_m() const;

  GnssParameters parameters_;
  std::shared_ptr<const Constellation> constellation_;
  std::vector<Channel> channels_;
  std::vector<std::size_t> indices_;         ///< Constellation indices of channels_.
  std::vector<SatelliteState> states_;       ///< States of these satellites.
  std::shared_ptr<const ErrorField> field_;  ///< Shared by all receivers.
  /// Where and when the ranges are received.
  double time_s_ = 0.0;
  Eigen::Vector3d p_E_m_ = Eigen::Vector3d::UnitX();
  Eigen::Matrix3d ecef_from_world_ = Eigen::Matrix3d::Identity();
  ReflectionSearch reflections_;
  std::vector<ReceivedSatellite> received_;
  std::vector<std::uint32_t> channel_of_;  ///< Channel of each of received_.
  std::vector<ReflectionSearch::Satellite> searched_;
  std::vector<bool> healthy_;
  bool near_crowns_ = false;  ///< Some signal passed through crowns, an epoch before.
};

}  // namespace rigwire::sim
