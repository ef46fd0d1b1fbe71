// A satellite receiver's antenna and navigation engine: which satellites it sees past the scene,
// how good its position is, and the position with its error.
//
// Three models behind one interface.
//
// Engine, the default: every pseudorange and range rate has its own error (range_errors.h,
// multipath.h), and a receiver's filter makes position, velocity and clock of them
// (navigation_filter.h, navigation_engine.h), with accuracies from its covariance, integrity, and
// prediction when satellites are gone. Dilutions are those of the satellites used, with one clock
// for all systems. A 2D fix holds the height of the last 3D fix.
//
// Paper (Wolf, Groll, Hemer, Berns, SIMULTECH 2020): one ray per satellite, which crowns stop too;
// dilution by Eq. 1 and Table 1; error by Eq. 2; kind of fix by Eq. 3. The paper's open points are
// settled so: satellites are directions (not points "above the scene"); Eq. 2 gives metres in the
// local tangent plane; horizontal dilution scales north and east, vertical dilution the height; the
// data-sheet precision is a CEP, so that one horizontal axis has sigma = dilution * CEP / 1.1774 /
// sqrt(2) with dilution understood as the horizontal one. Position dilution is 0 for a 2D fix, and
// there is none without a fix. Consecutive errors are correlated (first-order Gauss-Markov, exact
// discretisation) unless correlation_time_s is 0, the paper's white noise.
//
// Coloured, cheaper than the engine: the same errors, and each epoch's position by weighted least
// squares (position_solution.h). Correlation in time, jumps when satellites come and go, and
// residuals follow from that. Accuracies follow the error model, not the error. A 2D fix holds the
// height of the last 3D fix. The velocity is solved from Doppler errors in the same way. Eq. 3
// counts satellites less one for each further system's clock. This receiver neither filters in time
// nor rejects ranges that contradict the rest.
//
// All models have corrections (carrier_solution.h; those of a base station come with GnssCommand),
// faults (gnss_fault.h), the receiver's clock (receiver_clock.h; position and velocity are of the
// instant at which it measures), and raw measurements (observations.h), whose pseudoranges have the
// same errors as the solution. The paper's model has no range errors, so raw ranges are exact in
// it.
//
// All receivers with one seed share the errors of satellites and air, a function of satellite,
// place and time (error_field.h); multipath and noise are each receiver's own.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/gnss/antenna_book.h"
#include "sim/gnss/carrier_solution.h"
#include "sim/gnss/constellation.h"
#include "sim/gnss/dilution.h"
#include "sim/gnss/gnss_parameters.h"
#include "sim/gnss/navigation_engine.h"
#include "sim/gnss/observations.h"
#include "sim/gnss/position_solution.h"
#include "sim/gnss/receiver_clock.h"
#include "sim/gnss/reference_station.h"
#include "sim/gnss/satellite_channels.h"
#include "sim/link_motion.h"
#include "sim/local_frame.h"
#include "sim/random.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"
#include "sim/visibility.h"

namespace rigwire::sim {

/// Returns the kind of fix for a number of satellites by Eq. 3.
[[nodiscard]] GnssFix fix_by_count(int satellites);

class GnssSensor {
 public:
  /// Throws as validate(), and std::invalid_argument without a constellation. The receiver's own
  /// random streams are named `name` and below. Calendar and frame are copied.
  GnssSensor(const GnssParameters& parameters, std::shared_ptr<const Constellation> constellation,
             const Calendar& calendar, const LocalFrame& frame, std::uint64_t seed,
             std::string_view name);
  /// Uses the nominal slots of the received systems.
  GnssSensor(const GnssParameters& parameters, const Calendar& calendar, const LocalFrame& frame,
             std::uint64_t seed, std::string_view name);

  /// Applies the receiver's settings from the next epoch on.
  void command(const GnssCommand& command);
  /// Shares the antennas of the same world, to which this one is added; not null. Without this call
  /// the engine can check a base station only against the place that it claims.
  void share(std::shared_ptr<AntennaBook> antennas) { antennas_ = std::move(antennas); }

  /// Faults of the receiver; changes take effect at the next epoch.
  [[nodiscard]] FaultBook<GnssFault>& faults() { return faults_; }

  /// One navigation epoch at `time` (not earlier than the one before). `antenna`: motion of the
  /// antenna's phase centre, X_WL its frame. Position and velocity are meaningful for 2D and 3D.
  [[nodiscard]] GnssSample sample(SimTime time, const LinkMotion& antenna,
                                  const Visibility& visibility);

 private:
  /// One epoch in the making.
  struct Epoch {
    ClockEpoch clock;
    GnssFaultState fault;
    Reception reception;
    /// Velocity to which the ranges refer (faults).
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    Eigen::Matrix3d ned_from_world = Eigen::Matrix3d::Identity();
    double height_m = 0.0;  ///< Above the ellipsoid, at the place to which the ranges refer.
    std::vector<ReceivedSatellite*> used;
    bool augmented = false;  ///< An SBAS satellite is received above the mask.
    CorrectionOutput corrections;
    Eigen::Vector3d error_ned_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_error_ned_mps = Eigen::Vector3d::Zero();
  };

  [[nodiscard]] Epoch begin(SimTime time, const LinkMotion& antenna);
  void select(std::span<ReceivedSatellite> received, Epoch& epoch) const;
  [[nodiscard]] GnssFix fix_of(const Epoch& epoch) const;
  [[nodiscard]] bool quadrants_filled(const Epoch& epoch) const;
  void correct(Epoch& epoch, GnssSample& sample);
  void take_corrections(const Epoch& epoch);
  [[nodiscard]] std::optional<ReceivedCorrections> received_corrections(const Epoch& epoch) const;
  void solve_paper(Epoch& epoch, GnssSample& sample);
  void solve_coloured(Epoch& epoch, GnssSample& sample);
  [[nodiscard]] HeldHeight held_height(const Epoch& epoch);
  void solve_velocity(Epoch& epoch, GnssSample& sample);
  void solve_engine(Epoch& epoch, GnssSample& sample);
  void coast(const Epoch& epoch, GnssSample& sample);
  [[nodiscard]] NavigationEngine::Epoch engine_epoch(const Epoch& epoch) const;
  void put_dilution(const Dilution& geometric, GnssSample& sample) const;
  void put_carrier(Epoch& epoch, GnssSample& sample) const;
  void put_position(const Epoch& epoch, GnssSample& sample) const;
  void put_fix(const NavigationFix& fix, const Epoch& epoch, GnssSample& sample) const;
  void put_place(const Eigen::Vector3d& p_W, GnssSample& sample) const;
  void put_satellites(std::span<const ReceivedSatellite> received, const Epoch& epoch,
                      GnssSample& sample) const;
  void measure(std::span<const ReceivedSatellite> received, const Epoch& epoch, GnssSample& sample);

  std::string name_;
  GnssParameters parameters_;
  FaultBook<GnssFault> faults_;
  std::shared_ptr<const Constellation> constellation_;
  Calendar calendar_;
  LocalFrame frame_;
  std::unique_ptr<DilutionModel> dilution_;
  RandomStream random_;
  RandomStream held_random_;
  ReceiverClock clock_;
  SatelliteChannels channels_;
  CarrierEngine carrier_;
  ReferenceStation station_;
  std::shared_ptr<const GnssCorrections> corrections_;  ///< Those that station_ took last.
  std::shared_ptr<AntennaBook> antennas_ = std::make_shared<AntennaBook>();
  Observations observations_;
  std::vector<TrackedSignal> signals_;
  std::vector<RangeEquation> equations_;
  GnssCommand command_;
  NavigationEngine engine_;
  std::vector<NavigationSignal> engine_signals_;
  std::vector<Eigen::Vector3d> directions_enu_;
  std::array<GaussMarkov, 3> unit_error_;                    ///< Paper: east, north, up.
  Eigen::Vector3d unit_velocity_ = Eigen::Vector3d::Zero();  ///< Paper: white.
  SimTime last_ = kNever;
  /// Height held in a 2D fix, from the last 3D fix or guessed before it.
  struct Held {
    double height_m = 0.0;
    double sigma_m = 0.0;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  };
  std::optional<Held> held_;
};

}  // namespace rigwire::sim
