// A tandem roller as its sensors and its controller see it: both drums steered on pivots,
// hydrostatic drive, vibration; commands in, motion of every link and its sensors' readings out.
//
// Chain per inner step: steering, exciters, cutter arm, hopper -> ground under the strips -> loads
// of the strips from statics (slope, acceleration of the step before, hopper) -> planar velocities
// and drum spins with drive, brakes and slip in one solve (roller_dynamics.h) -> heave, roll and
// pitch after the ground (ground_rest.h) -> pose by the exponential map. The kinematic level
// replaces the solve: v, yaw rate and drum rates of a bicycle that steers at both ends, each step
// an exact arc.
//
// The machine tips when the resultant of weight and inertia leaves the convex hull of the strips,
// seen from above, for 20 ms where all strips bear, or when a drum is in the air: it is then a free
// rigid body carried by its contacts (tipped_roller.h), until it lies at rest, or is back on both
// drums and calm for 0.3 s. The kinematic level, which has no forces, never tips.
//
// Steering of counter, crab and front-only is the controller's: it commands both angles. A drum
// reports as two wheels with one rate. The gear means nothing to this machine. The engine runs at
// the commanded governor speed; an accelerator above 0 sets it between idle and rated; with neither
// it idles while the parking brake is on and runs at rated speed otherwise. lock[centre] closes the
// flow divider. With the parking brake on the travel set point is taken as zero.
//
// Loads ignore the drums' gyroscopic moments and the vibration; the pivots' reaction on the frame
// while they start to turn is left out. Deterministic: the same parameters, commands and calls give
// the same bits on one compiler.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "sim/driveline/hydrostatic_drive.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"
#include "sim/roller/ground_rest.h"
#include "sim/roller/parameters.h"
#include "sim/roller/roller_dynamics.h"
#include "sim/roller/steering.h"
#include "sim/roller/supplements.h"
#include "sim/roller/tipped_roller.h"
#include "sim/roller/vibration.h"

namespace rigwire::sim {

class TandemRoller final : public Machine, public VehiclePort, public PowerUnitDefectPort {
 public:
  /// Places the machine on `ground` with the frame's origin above (x, y), its x turned by `yaw_rad`
  /// from east; parking brake on. `ground` must outlive the machine. Throws std::invalid_argument
  /// as validate does and when the place is not finite.
  TandemRoller(const RollerParameters& parameters, const Ground& ground,
               const Eigen::Vector2d& position_m, double yaw_rad);

  void step(Duration span) override;
  [[nodiscard]] SimTime time() const override { return time_; }
  [[nodiscard]] std::span<const LinkMotion> links() const override { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override {
    return kRollerLinks;
  }
  [[nodiscard]] const std::optional<NonFinite>& non_finite() const override { return non_finite_; }
  [[nodiscard]] const ContactReport* contact_report() const override { return &contact_.report(); }
  [[nodiscard]] std::span<const LeaningObstacle> leaning_obstacles() const override {
    return contact_.leaning();
  }
  [[nodiscard]] const ContactSet& contact() const { return contact_; }
  [[nodiscard]] std::span<const StatusQuantity> status_quantities() const override;
  void read_status(std::span<double> values) const override;
  [[nodiscard]] std::span<const TruthField> truth_fields() const override;
  void read_truth(std::span<double> values) const override;
  [[nodiscard]] VehiclePort* vehicle_port() override { return this; }
  /// Front and rear drum: dust of a road by load and speed.
  [[nodiscard]] std::span<const DustEmitter> dust_emitters() const override { return dust_; }

  void command(const VehicleCommand& command) override;
  [[nodiscard]] VehicleSample vehicle_sample(SimTime time) const override;
  void fail(const PowerUnitDefects& defects) override { drive_.fail(defects); }
  [[nodiscard]] EngineData engine_data() const override { return drive_.engine_data(); }
  [[nodiscard]] bool steers_rear() const override { return true; }

  /// Sets the motion of the frame in its own plane, for tests: forward and left at the origin,
  /// yaw rate; the drums roll along.
  void set_motion(double forward_mps, double left_mps, double yaw_rate_radps);

  [[nodiscard]] double drum_rate_radps(std::size_t which) const { return spin_radps_[which]; }
  [[nodiscard]] double steer_rad(std::size_t which) const { return steering_[which].angle_rad(); }
  /// Moment of the ground on a drum's pivot, left positive.
  [[nodiscard]] double pivot_moment_nm(std::size_t which) const {
    return dynamics_.drum(which).pivot_moment_nm();
  }
  /// Normal force of a drum in the last step.
  [[nodiscard]] double drum_load_n(std::size_t which) const { return load_n_[which]; }
  /// Returns whether it is no longer supported by both drums: it tips, falls or lies.
  [[nodiscard]] bool tipped() const { return tipped_; }
  /// Distance of the resultant of weight and inertia inside the edge of its support on the ground,
  /// in the last step on its drums; negative: outside.
  [[nodiscard]] double support_margin_m() const { return support_margin_m_; }
  [[nodiscard]] const RollerMass& mass() const { return mass_; }
  [[nodiscard]] const HydrostaticDrive& drive() const { return drive_; }
  [[nodiscard]] const RollerDynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] const ChipSpreader& spreader() const { return spreader_; }
  [[nodiscard]] const EdgeCutter& edge_cutter() const { return cutter_; }
  [[nodiscard]] const RollerParameters& parameters() const { return parameters_; }

 private:
  /// Frame's motion without vibration; position as displacement from the start, so that far from
  /// the world's origin nothing is lost.
  struct State {
    Eigen::Vector3d displacement_W = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
    Eigen::Vector3d v_WB_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();
    Eigen::Vector3d a_WB_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d alpha_WB_B = Eigen::Vector3d::Zero();
  };

  void inner_step(double h);
  /// Makes a part of the inner step: all of it, or a millisecond at most after it has tipped.
  void part_step(double h);
  /// Holds the commanded travel speed: raises the drive's set point by the drums' missing speed,
  /// and applies the brake at rest.
  void hold_travel_speed(double h);
  void command_drive();
  void supplements(double h, double speed_mps);
  void limit_climbs(double speed_mps);
  /// Loads and friction limits of all strips, weight, supplements.
  void load_strips(const Eigen::Matrix3d& R_WB, double speed_mps);
  void move_dynamic(double h, const Eigen::Matrix3d& R_WB, const RestMotion& rest_before,
                    State& next);
  void move_kinematic(double h, const Eigen::Matrix3d& R_WB, const RestMotion& rest_before,
                      State& next);
  [[nodiscard]] double kinematic_pressure_pa(double acceleration_mps2) const;
  void settle_on_ground();
  /// Preloads brakes and bristles so that they hold the machine on its slope.
  void hold_slope();
  [[nodiscard]] std::array<double, 2> brake_limits_nm() const;
  /// Gives the bodies' poses to the contacts. Returns false if nothing is near in this step.
  [[nodiscard]] bool place_bodies(double h, const Eigen::Matrix3d& R_WB);
  /// Finds the contact points with obstacles, and their rows, about the centre of mass.
  void meet_obstacles(double h, const Eigen::Matrix3d& R_WB);
  void settle_contacts(double h, const RollerVelocity& found);

  /// By these forces of the ground in the frame's plane, with `lever_nm` of obstacles about the
  /// centre of mass, about x and y.
  [[nodiscard]] double margin_m(const Eigen::Vector2d& push_n, const Eigen::Vector2d& lever_nm,
                                double normal_n) const;
  /// Whether it tips from this step on.
  [[nodiscard]] bool loses_its_footing(double h, const Eigen::Matrix3d& R_WB);
  void tip();
  void move_tipped(double h, const Eigen::Matrix3d& R_WB, State& next);
  [[nodiscard]] bool stands_again(double h, const Eigen::Matrix3d& R_WB);
  void stand();
  [[nodiscard]] bool record_non_finite(const State& next);
  void update_links();
  void update_dust();
  [[nodiscard]] OdometryReading odometry() const;

  RollerParameters parameters_;
  const Ground* ground_;
  Eigen::Vector3d start_W_ = Eigen::Vector3d::Zero();
  Duration inner_span_{};
  VehicleCommand command_;
  EngineCondition engine_;
  bool holding_ = false;
  double brake_share_ = 0.0;  ///< With what holds the machine at rest.
  double trim_mps_ = 0.0;
  double missing_s_ = 0.0;  ///< Since when the speed is missed.
  TravelLimit travel_limit_ = TravelLimit::none;

  std::array<PivotSteering, 2> steering_;
  std::array<DrumVibration, 2> vibration_;
  Sprinkler sprinkler_;
  ChipSpreader spreader_;
  EdgeCutter cutter_;
  HydrostaticDrive drive_;
  RollerDynamics dynamics_;
  GroundRest rest_;

  SimTime time_{};
  State state_;
  RollerMass mass_;
  RollerLoads loads_;
  ContactSet contact_;
  std::array<ContactLink, kRollerLinks.size()> contact_links_;
  std::vector<RollerContact> contacts_;
  TippedRoller free_;
  std::vector<TippedContact> free_contacts_;
  bool tipped_ = false;
  double unsteady_s_ = 0.0;  ///< Since when the resultant is outside.
  double calm_s_ = 0.0;      ///< Since when it is back on its drums.
  double support_margin_m_ = 0.0;
  bool near_ = false;  ///< Obstacles may be within reach in this step.
  std::array<double, 2> load_n_{};
  std::array<double, 2> spin_radps_{};
  std::array<double, 2> spin_acceleration_radps2_{};
  std::array<double, 2> spin_angle_rad_{};
  double pressure_pa_ = 0.0;  ///< On the gauge.
  std::array<LinkMotion, kRollerLinks.size()> links_;
  std::array<DustEmitter, 2> dust_;
  std::optional<NonFinite> non_finite_;
};

}  // namespace rigwire::sim
