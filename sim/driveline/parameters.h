// What a drive line is made of: engine, clutch, gearbox or belt variator, differentials.
//
// Defaults of GearedParameters: Unimog U5023. Read in sources: 170 kW, 900 Nm up to 1600 rpm, eight
// gears with crawler group, three differential locks. Estimates, to be shown as such: everything
// else, among it all inertias, times and ratios; docs/machines/drive-lines.md lists them.
//
// Ratios are speed towards the engine over speed towards the wheels. Shaft torques and inertias
// hold at the shaft that the name says. SI units, rates in rad/s.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "sim/engine/engine_condition.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

/// A point of the full-load curve; linear between points, constant outside them.
struct TorquePoint {
  double speed_radps = 0.0;
  double torque_nm = 0.0;

  friend bool operator==(const TorquePoint&, const TorquePoint&) = default;
};
void visit(fields::Visitor& v, TorquePoint& p);

/// 900 Nm from 1200 to 1600 rpm, 170 kW at 2200 rpm; below 1200 rpm an estimate.
[[nodiscard]] std::vector<TorquePoint> unimog_full_load();

struct EngineParameters {
  /// In order of rising speed; at least one point.
  std::vector<TorquePoint> full_load = unimog_full_load();
  double inertia_kgm2 = 1.3;   ///< Crank, flywheel, clutch disc.
  double drag_nm = 60.0;       ///< Friction at standstill, extrapolated.
  double drag_nmsprad = 0.35;  ///< Growth of the friction with speed.
  double idle_radps = rpm(700);
  double maximum_radps = rpm(2200);  ///< Full torque up to here, ...
  double cut_off_radps = rpm(2400);  ///< ... none from here on.
  double governor_nmsprad = 180.0;   ///< Idle and set-speed governor: torque per missing speed.
  double governor_integral_s = 1.0;  ///< Time in which the set-speed governor repeats it.
  double torque_lag_s = 0.15;        ///< Accelerator to torque, first order.
  EngineConditionParameters condition;

  [[nodiscard]] double greatest_torque_nm() const;

  friend bool operator==(const EngineParameters&, const EngineParameters&) = default;
};
void visit(fields::Visitor& v, EngineParameters& p);
/// Throws std::invalid_argument.
void validate(const EngineParameters& parameters);
/// Its data sheet.
[[nodiscard]] EngineData engine_data(const EngineParameters& parameters);

/// A friction clutch that an automatic or a centrifugal weight closes with speed: open below
/// open_radps, in between in proportion, full capacity from full_radps on. As it opens above the
/// stalling speed, the engine is not stalled.
struct ClutchParameters {
  bool centrifugal = false;  ///< Goes by the engine's speed; an automatic by the faster side's.
  double capacity_nm = 1400.0;
  double open_radps = rpm(740);
  double full_radps = rpm(1050);

  friend bool operator==(const ClutchParameters&, const ClutchParameters&) = default;
};
void visit(fields::Visitor& v, ClutchParameters& p);
/// Throws std::invalid_argument.
void validate(const ClutchParameters& parameters);

enum class AxleDrive {
  rear,                 ///< Rear axle only.
  switchable_front,     ///< Rear axle; the centre lock couples the front axle rigidly.
  centre_differential,  ///< Both axles, equal torque.
};

/// Open differentials share torque equally. A lock removes the difference of their speeds.
struct AxleParameters {
  AxleDrive drive = AxleDrive::centre_differential;
  std::array<bool, kDifferentials> lockable{true, true, true};
  double lock_time_s = 0.3;  ///< Request to engagement.
  /// Differences of wheel rates (centre: of axle means) above this keep a lock from engaging.
  double lock_rate_difference_radps = 2.0;
  double final_ratio = 6.5 / 2.2;
  double portal_ratio = 2.2;          ///< At the hub; 1 without.
  double output_inertia_kgm2 = 0.25;  ///< Gearbox output, shafts, bevel gears, at the output.
  double output_drag_nmsprad = 0.05;  ///< Oil drag at the output.

  [[nodiscard]] double ratio() const { return final_ratio * portal_ratio; }

  friend bool operator==(const AxleParameters&, const AxleParameters&) = default;
};
void visit(fields::Visitor& v, AxleParameters& p);
/// Throws std::invalid_argument.
void validate(const AxleParameters& parameters);

struct GearboxParameters {
  /// First gear first; positive, also in reverse.
  std::vector<double> forward = geometric(8, 0.8, 1.44, 8);
  std::vector<double> reverse = geometric(8, 0.8, 1.44, 6);
  double crawler_factor = 87.0;    ///< Multiplies every ratio; 0 = no crawler group.
  double ramp_down_s = 0.3;        ///< Clutch and engine torque to zero.
  double synchronisation_s = 0.2;  ///< Out of gear, engine speed brought to the next gear's.
  double ramp_up_s = 0.3;
  double group_change_radps = 0.2;  ///< Mean wheel rate below which the group may change.

  /// The first `count` of `gears` ratios that rise by `step` from `top`, first gear first.
  [[nodiscard]] static std::vector<double> geometric(int gears, double top, double step, int count);

  friend bool operator==(const GearboxParameters&, const GearboxParameters&) = default;
};
void visit(fields::Visitor& v, GearboxParameters& p);
/// Throws std::invalid_argument.
void validate(const GearboxParameters& parameters);

/// Engine, automated clutch, step gearbox.
struct GearedParameters {
  static constexpr fields::Named kNamed{"geared", "Automated friction clutch and step gearbox."};

  EngineParameters engine;
  ClutchParameters clutch;
  GearboxParameters gearbox;
  AxleParameters axles;

  friend bool operator==(const GearedParameters&, const GearedParameters&) = default;
};
void visit(fields::Visitor& v, GearedParameters& p);

/// A belt variator whose centrifugal weights move it from launch to top as the engine speeds up;
/// the logarithm of its ratio falls linearly between the two speeds.
struct VariatorParameters {
  double launch_ratio = 2.8;
  double top_ratio = 0.8;
  double shift_from_radps = rpm(2000);
  double shift_to_radps = rpm(3200);
  double lag_s = 0.25;  ///< First-order lag of the sheaves.
  /// Range groups: gear 1, 2 ...; their ratio between variator and axle.
  std::vector<double> ranges = std::vector<double>(1, 1.0);
  double reverse_range = 1.0;
  double range_change_radps = 0.3;  ///< Mean wheel rate below which the range may change.

  friend bool operator==(const VariatorParameters&, const VariatorParameters&) = default;
};
void visit(fields::Visitor& v, VariatorParameters& p);
/// Throws std::invalid_argument.
void validate(const VariatorParameters& parameters);

/// Engine, centrifugal clutch, belt variator, range groups. Defaults: Gator XUV 855D, 17 kW read in
/// a source, the rest estimates.
struct CvtParameters {
  static constexpr fields::Named kNamed{"cvt", "Centrifugal clutch, belt variator, range groups."};

  CvtParameters();

  EngineParameters engine;
  ClutchParameters clutch;
  VariatorParameters variator;
  AxleParameters axles;

  friend bool operator==(const CvtParameters&, const CvtParameters&) = default;
};
void visit(fields::Visitor& v, CvtParameters& p);

using DrivelineParameters = std::variant<GearedParameters, CvtParameters>;
/// `type` beside the keys of that type.
void visit(fields::Visitor& v, DrivelineParameters& p);

/// Each throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const GearedParameters& parameters);
void validate(const CvtParameters& parameters);
void validate(const DrivelineParameters& parameters);

}  // namespace rigwire::sim
