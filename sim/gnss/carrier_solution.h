// Improves a position by corrections: SBAS and a code-differential share, a precise point service,
// and real-time kinematic positions with their convergence and losses.
//
//   none     the code position
//   sbas     code position with better orbits, clocks and ionosphere: 2.0 m CEP in place of 2.5 m
//   service  precise point positions by satellite (StarFire SF2 class, 5 cm): the error shrinks
//            over minutes, quickly again after a short loss
//   rtk      real-time kinematic positions by a base station's messages that arrive at one of the
//            device's ports (reference_station.h), and by nothing else: without a byte there is
//            no differential position. Differential with the first usable epoch, float with the
//            second, fixed once the ambiguities are found; then 1 cm + 1 ppm of the baseline
//            horizontally and 2 cm + 1 ppm vertically, as data sheets of such receivers state, and
//            3 cm per minute of age. Integers fail their test at random, 12 times a second times
//            the square of the share of unsound carriers beyond 0.2 and two of them (an estimate,
//            by the share of time that a ZED-F9P was fixed in fields and forest). A fix is lost
//            where fewer than five common satellites, or fewer than half of those that are used,
//            have a usable carrier (CarrierCount), and with corrections older than 30 s; all is
//            lost with corrections older than the receiver's limit. A lost fix continues as float
//            from its place: its error grows from that of the fix to that of a float, over
//            float_decay. Integers are kept while four satellites or more, and half of those
//            used, have carriers without a slip: their position yields the others' integers, and
//            the fix returns a second after the missing condition holds again; after slips the
//            receiver searches anew.
//   assumed_rtk  the same without a base station, so not causal: corrections are assumed to arrive
//            at an interval with a latency, from a base at a distance. Only the fault
//            correction_outage interrupts them. For receivers whose link to their corrections is
//            not emulated.
//
// Corrections of sbas, service and assumed_rtk arrive at an interval with a latency; without them
// the state is kept to a largest age.
//
// Time to fix of rtk: a draw of a gamma distribution (shape 16) with mean `convergence`, 7 s, at
// least 4 s and at most 1.2 times the mean: "below 10 s" of a ZED-F9P's data sheet (UBX-21044850,
// table 2); three times that with GPS alone (the same, "below 30 s"), four times with one band
// alone (NEO-M8P data sheet: "below 60 s"), and (1 + baseline / 15 km) times. No fix beyond 50 km
// with two bands, 15 km with one, where the ionosphere differs by a quarter of a wavelength (closed
// form over 2 mm/km).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "fields/rules.h"
#include "sim/gnss/gauss_markov.h"
#include "sim/gnss/range_errors.h"
#include "sim/random.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

enum class CorrectionKind : unsigned char { none, sbas, service, rtk, assumed_rtk };

struct CorrectionParameters {
  CorrectionKind kind = CorrectionKind::none;
  double interval_s = 1.0;      ///< Interval of corrections, above 0; not for rtk.
  double latency_s = 0.6;       ///< From their measurement to their arrival; not for rtk.
  double largest_age_s = 60.0;  ///< Older corrections are not applied; rtk: the receiver's.
  double sbas_share = 0.7;      ///< Share of orbit, clock and ionosphere errors that SBAS leaves.

  double baseline_m = 500.0;           ///< Assumed RTK: distance from the base station.
  double fixed_horizontal_m = 0.01;    ///< RTK fixed: 1 sigma, radial, without the baseline.
  double fixed_vertical_m = 0.02;      ///< RTK fixed: 1 sigma.
  double fixed_per_baseline = 1e-6;    ///< Added to both per metre of baseline.
  double float_start_m = 1.0;          ///< RTK float, per axis: at the start ...
  double float_end_m = 0.2;            ///< ... and after long; exponentially between,
  double float_decay_s = 20.0;         ///< with this time constant.
  double first_fix_s = 30.0;           ///< Assumed RTK: from float to fixed, the first time.
  double convergence_s = 7.0;          ///< RTK: mean time from float to fixed, two bands near by.
  double fixed_age_s = 30.0;           ///< RTK: older corrections hold no ambiguities.
  double refix_shortest_s = 5.0;       ///< RTK: after a loss, uniform between these.
  double refix_longest_s = 30.0;       ///< At least refix_shortest_s.
  std::uint32_t least_satellites = 5;  ///< In line of sight, to fix and to keep the fix.

  double service_start_m = 1.0;    ///< Service, per axis: at the start ...
  double service_end_m = 0.035;    ///< ... and converged (5 cm radial);
  double service_decay_s = 300.0;  ///< time constant;
  double vertical_ratio = 2.0;     ///< Float and service: vertical over one horizontal axis.
  double service_bridge_s = 60.0;  ///< A loss not longer than this costs no convergence.

  double correlation_s = 40.0;  ///< Correlation time of the errors of carrier positions.
};
void visit(fields::Visitor& v, CorrectionParameters& p);

/// Throws std::invalid_argument naming the key, its value and what is allowed.
void validate(const CorrectionParameters& parameters);

/// Satellites by the quality of their carriers. A receiver cannot distinguish a mirrored or
/// slipping carrier from a sound one: where less than half of those in use are sound, its test of
/// integers against the next best ones fails (an estimate; a ZED-F9P in fields and forest was fixed
/// half of the time and less, Stefal/rtkbase #351).
struct CarrierCount {
  int used = 0;           ///< Used for the fix.
  int line_of_sight = 0;  ///< Those not mirrored, with a carrier strong enough for use.
  int held = 0;           ///< Those of line_of_sight without a slip for two seconds.
  int two_band = 0;       ///< Those of held that have the second band, too.
  [[nodiscard]] bool can_fix(std::uint32_t least) const {
    return held >= static_cast<int>(least) && 2 * held >= used;
  }
};

/// What arrived from a base station, as far as it is of use at an epoch.
struct ReceivedCorrections {
  SimTime measured{};  ///< The station's epoch.
  Duration largest_age = std::chrono::seconds{60};
  double baseline_m = 0.0;
  CarrierCount common;    ///< Satellites that the station has, too.
  bool gps_only = false;  ///< All of these in line of sight.
  bool carriers_agree = false;
  bool floating_only = false;
};

/// What the receiver has to work with at an epoch.
struct CorrectionInput {
  SimTime time{};
  CarrierCount carriers;      ///< Its second bands are not counted.
  bool has_position = false;  ///< A code position exists.
  bool link = true;           ///< Corrections can arrive (for SBAS: one of its satellites, too).
  std::optional<ReceivedCorrections> received{};  ///< rtk: nothing before the first.
};

struct CorrectionOutput {
  CarrierSolution carrier = CarrierSolution::none;
  bool differential = false;
  std::optional<double> age_s;
  CorrectedShare share;  ///< For the code position.
  /// Replaces the code position's error, when the carrier is used.
  std::optional<Eigen::Vector3d> error_ned_m;
  double horizontal_sigma_m = 0.0;  ///< Per axis; with error_ned_m.
  double vertical_sigma_m = 0.0;
};

class CarrierEngine {
 public:
  CarrierEngine(const CorrectionParameters& parameters, std::uint64_t seed, std::string_view name);
  /// Times not earlier than the one before.
  CorrectionOutput advance(const CorrectionInput& input);

 private:
  void receive(const CorrectionInput& input);
  void advance_assumed_rtk(const CorrectionInput& input, CorrectionOutput& output);
  void advance_rtk(const CorrectionInput& input, double step_s, CorrectionOutput& output);
  void lose();
  void fall(SimTime now);
  void put_fixed(double horizontal_m, double vertical_m, CorrectionOutput& output);
  [[nodiscard]] double float_sigma_m(SimTime now) const;
  [[nodiscard]] double drawn_convergence_s();
  [[nodiscard]] bool validated(const CarrierCount& carriers, double step_s);
  void advance_service(const CorrectionInput& input, CorrectionOutput& output);
  void put_error(double horizontal_m, double vertical_m, CorrectionOutput& output) const;

  CorrectionParameters parameters_;
  RandomStream noise_;
  RandomStream waits_;
  RandomStream tests_;
  GaussMarkov north_;
  GaussMarkov east_;
  GaussMarkov down_;
  SimTime last_ = kNever;
  SimTime measured_ = kNever;  ///< When the newest corrections were measured.
  SimTime floating_ = kNever;  ///< Since when; kNever: no carrier position.
  SimTime enough_ = kNever;    ///< Since when there are enough satellites to fix.
  SimTime good_ = kNever;      ///< When the service's position was last carried on.
  double wait_s_ = 0.0;        ///< From enough_ to fixed.
  bool fixed_ = false;
  bool fixed_before_ = false;
  bool fell_ = false;           ///< It floats on from a fix ...
  double fixed_sigma_m_ = 0.0;  ///< ... whose error per axis was this.
  bool remembered_ = false;     ///< rtk: the integers of the last fix are still those.
  int epochs_ = 0;              ///< rtk: of the station, since there was nothing usable.
};

}  // namespace rigwire::sim
