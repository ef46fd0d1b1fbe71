// The excavator as its sensors and its valve driver see it: spool commands in; motion of every link
// and the readings of the valve block out.
//
// Chain per inner step: spool lag and dead band -> requested flows -> pump's share, within what the
// engine allows (power_unit.h) -> drives of the selected level (ExcavatorLevel) with relief and end
// stops -> joint motion (driven_arm.h) -> the pumps' load on the engine.
// Valve sections, everywhere in this class: 0 swing, 1 boom, 2 stick, 3 bucket; then those of the
// undercarriage (excavator_actuators): left and right track, blade, outriggers; the others are
// empty. A positive opening turns left, lifts the boom, draws in stick and bucket, drives forward
// and lowers blade and outriggers: it sends oil to port A and extends the cylinder.
//
// Its bodies (SolidBodyParameters) contact the ground's obstacles: each contact point is a force in
// the same solve (sim/contact). While one is within reach, an inner step is divided into parts
// short enough for the contact (contact_parts: three of 1 ms with the reference machine's numbers),
// so that neither overlap nor force depends on the step's length. On level kinematic, which has no
// forces, all drives are slowed together so that no gap closes beyond touching.
//
// The undercarriage is fixed where it was placed, or is supported by its tyres or tracks
// (ExcavatorCarrier, RunningGear, carried_arm.h). The caller sets the ground's forces on the
// bucket: set_bucket_force, set_bucket_resistances (bucket_load.h). Deterministic: the same
// parameters, commands and calls give the same bits on one compiler.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/excavator/bucket_load.h"
#include "sim/excavator/carried_arm.h"
#include "sim/excavator/driven_arm.h"
#include "sim/excavator/own_contact.h"
#include "sim/excavator/parameters.h"
#include "sim/excavator/power_unit.h"
#include "sim/hydraulics/chambers.h"
#include "sim/hydraulics/spool.h"
#include "sim/hydraulics/supply.h"
#include "sim/link_motion.h"
#include "sim/machine.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::sim {

class Excavator final : public Machine,
                        public ValvePort,
                        public PowerUnitPort,
                        public PowerUnitDefectPort {
 public:
  /// X_WC: the undercarriage's pose in the world. The machine starts at rest in parameters.initial,
  /// valves closed, drives carrying the load. Throws std::invalid_argument as validate does, and
  /// when X_WC is not a finite rigid pose.
  /// `ground` must outlive the machine; without one nothing is in its way. With carrier moving it
  /// must be given: an upright X_WC is leant as the ground under the wheels or the tracks' ends
  /// leans, and the machine first sinks into its tyres or onto its tracks from there with the arm
  /// held (5 s before time 0, 3 of them damped). unsteady_start() says whether it stayed.
  Excavator(const ExcavatorParameters& parameters, const Eigen::Isometry3d& X_WC,
            const Ground* ground = nullptr);

  /// New spool set points, valid until the next. A section whose opening is not a number keeps its
  /// old set point and is counted; openings outside -1 .. 1 are clamped.
  void command(const ValveCommand& command) override;
  [[nodiscard]] const ValveCommand& commanded() const override { return command_; }
  [[nodiscard]] std::span<const std::string_view> actuators() const override { return actuators_; }
  /// What the engine's controller asks for. Precondition: pumps engine, as of the three below.
  void command(const PowerUnitCommand& command) override { power_unit_->command(command); }
  void fail(const PowerUnitDefects& defects) override { power_unit_->fail(defects); }

  /// Advances the machine, dividing `span` into inner steps of parameters.step_s and a remainder:
  /// one call with N steps gives the same bits as N calls. span <= 0 changes nothing, not one bit.
  /// Never throws, never allocates. After a non-finite result the machine stays at rest in its last
  /// finite state, see non_finite().
  void step(Duration span) override;

  /// Time advanced so far.
  [[nodiscard]] SimTime time() const override { return time_; }

  /// Motion at the end of the last step in the world frame; accelerations are the solver's own.
  [[nodiscard]] const LinkMotion& link(Link which) const {
    return links_[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] std::span<const LinkMotion> links() const override { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override;

  /// Swing, boom, stick, bucket in degrees, "tip height" in metres above the world's origin,
  /// "supply" in bar.
  [[nodiscard]] std::span<const StatusQuantity> status_quantities() const override;
  void read_status(std::span<double> values) const override;

  /// joint_rad 4, joint_rate_radps 4, spool 4, bucket_tip_m 3 (in the world); of pumps engine
  /// engine_radps 1, engine_torque_nm 1, pump_flow_m3ps 1; on tracks track_m 2 and track_mps 2, the
  /// belts' ways and speeds, left and right, and track_load_n 2; of each support support_m, its
  /// pads' way down, and support_load_n; of a machine that strikes itself own_contact_n 1, the sum
  /// of its own points' normal forces.
  [[nodiscard]] std::span<const TruthField> truth_fields() const override { return truth_fields_; }
  void read_truth(std::span<double> values) const override;

  /// Boom, stick and bucket from pin to pin, the bucket to its teeth.
  [[nodiscard]] std::vector<BodyPoint> body_points() const override;

  /// Returns why a moving carrier does not stay where it was put: it slides or tips. Before time 0
  /// it settles on its ground for 5 s.
  [[nodiscard]] std::string unsteady_start() const override { return unsteady_start_; }

  [[nodiscard]] ValvePort* valve_port() override { return this; }
  /// Null with pumps `constant`.
  [[nodiscard]] PowerUnitPort* power_unit_port() override { return power_unit_ ? this : nullptr; }
  [[nodiscard]] PowerUnitSample power_unit_sample(SimTime time) const override;
  [[nodiscard]] EngineData engine_data() const override { return power_unit_->engine_data(); }
  [[nodiscard]] const PowerUnit& power_unit() const { return *power_unit_; }

  /// What the transducers read, stamped with `time`. Pressures are the chambers' own at that level,
  /// tank pressure at level kinematic, and otherwise the drives' forces over the areas (supply.h);
  /// a section that pushes against its end stop reads the supply's relief.
  [[nodiscard]] ValveSample valve_sample(SimTime time) const override;

  [[nodiscard]] const JointVector& joint_angles_rad() const { return state_.q_rad; }
  [[nodiscard]] const JointVector& joint_rates_radps() const { return state_.v_radps; }
  [[nodiscard]] const JointVector& joint_accelerations_radps2() const { return acceleration_; }

  /// Drive coordinates: swing angle in rad, cylinder lengths in m.
  [[nodiscard]] const JointVector& drive_positions() const { return pose_.x; }
  [[nodiscard]] const JointVector& drive_rates() const { return position_rate_; }
  /// Where Eq. 5's spring pulls to; on the other levels where the cylinder is wanted.
  [[nodiscard]] const JointVector& drive_targets() const { return target_; }
  /// N, extension positive; N m for swing. Without the end stops' share.
  [[nodiscard]] const JointVector& drive_forces() const { return force_; }
  /// Flows granted to the sections in the last inner step, m3/s, signed.
  [[nodiscard]] const std::array<double, kArmJoints>& flows_m3ps() const { return flow_; }
  [[nodiscard]] double supply_pressure_pa() const { return supply_pressure_pa_; }

  /// The teeth's tip in the world.
  [[nodiscard]] Eigen::Vector3d tip_W() const;

  void set_payload_kg(double mass_kg);
  [[nodiscard]] double payload_kg() const { return arm_.dynamics().payload_kg(); }

  /// A force (N, world frame) on the bucket at a point of the world, which from then on moves with
  /// the bucket. Acts in every step until the next call; zero ends it. Not-a-number is refused.
  void set_bucket_force(const Eigen::Vector3d& force_W, const Eigen::Vector3d& point_W);
  /// Resistances that the arm's solve finds, in every step until the next call; empty ends them,
  /// more than kTipResistances are dropped, as is one with a member that is not a number.
  void set_bucket_resistances(std::span<const TipResistance> resistances);
  void set_bucket_resistance(const TipResistance& resistance) {
    set_bucket_resistances({&resistance, 1});
  }
  /// Forces of the resistances in the last inner step, N along their directions, in the order in
  /// which they were kept.
  [[nodiscard]] std::span<const double> bucket_resistances_n() const {
    return {resistance_n_.data(), bucket_load_.resistance_count};
  }

  [[nodiscard]] bool finite() const { return !non_finite_.has_value(); }
  [[nodiscard]] const std::optional<NonFinite>& non_finite() const override { return non_finite_; }
  /// Sections whose command was refused because it was not a number.
  [[nodiscard]] std::uint64_t refused_commands() const { return refused_commands_; }

  [[nodiscard]] const DrivenArm& arm() const { return arm_; }
  /// Drives of the undercarriage: left and right track, then the supports; empty on a fixed
  /// carrier.
  [[nodiscard]] std::span<const CarrierDrive> carrier_drives() const { return drives_; }
  /// Null on a fixed carrier.
  [[nodiscard]] const CarriedArm* carried() const { return carried_ ? &*carried_ : nullptr; }
  [[nodiscard]] const Linkages& linkages() const { return arm_.linkages(); }
  [[nodiscard]] const ContactReport* contact_report() const override {
    return contact_ ? &contact_->report() : nullptr;
  }
  [[nodiscard]] std::span<const LeaningObstacle> leaning_obstacles() const override {
    return contact_ ? contact_->leaning() : std::span<const LeaningObstacle>();
  }
  /// Nothing unless it strikes itself.
  [[nodiscard]] const OwnContact* own_contact() const { return own_ ? &*own_ : nullptr; }
  /// Nothing without a ground.
  [[nodiscard]] const ContactSet* contact() const { return contact_ ? &*contact_ : nullptr; }

 private:
  struct Areas {
    double bottom = 0.0;  ///< m2 (m3/rad for swing): pushes left, up, in.
    double rod_side = 0.0;
  };

  void inner_step(double h);
  /// A part of an inner step, between whose parts only contacts are looked for anew.
  void part_step(double h);
  void share_flow();
  void drive_pumps(double h);
  /// Target speed that the cushion and the stroke's end allow.
  [[nodiscard]] double limited_flow(std::size_t section, double flow_m3ps) const;
  /// Speeds of the drives that the granted flows make, the stroke's ends left whole.
  [[nodiscard]] JointVector target_rates(double h) const;
  /// The levels' steps: each moves state_, acceleration_, force_ and target_.
  void step_kinematic(double h, const JointVector& rate);
  void step_quasi_static(double h, const JointVector& rate);
  void step_dynamic(double h, const JointVector& rate);
  void step_chambers(double h);
  /// One solve of the arm with its carrier, whichever it is.
  ArmStep advance(double h, const DriveLaws& laws, ArmState& next);
  void make_drives();
  void settle_on_ground();
  /// Returns why it does not stay at its initial pose after settling; empty: it stays.
  [[nodiscard]] std::string unsteadiness(const Eigen::Isometry3d& put) const;
  /// Accepts the solve's result unless it is not finite.
  [[nodiscard]] bool accept(const ArmState& next, const ArmStep& step);
  /// Converts the bucket's load into torques of the joints, in the current pose.
  void place_bucket_load();
  /// Finds the points of contact for the next solve, and their rows if the carrier is fixed.
  void meet_obstacles(double h);
  /// Adds a point with the rows of a fixed carrier's joints: its link's less those of the other
  /// link.
  void add_arm_contact(ContactPoint& point, std::size_t inner_link);
  void settle_contacts(double h, const ArmState& next);
  /// Returns the share of all drives' rates, 0 .. 1, that an obstacle leaves free (level
  /// kinematic).
  [[nodiscard]] double free_share(double h, const JointVector& rate);
  void hold_strokes();
  /// Updates `h` seconds after the last call; infinite: after a long rest.
  void update_pressures(double h);
  [[nodiscard]] bool record_non_finite(const ArmState& state, const JointVector& acceleration);
  [[nodiscard]] bool at_stroke_end(std::size_t section, double direction) const;
  void update_links();

  ExcavatorParameters parameters_;
  Eigen::Isometry3d X_WC_;
  DrivenArm arm_;
  std::vector<std::string_view> actuators_;
  std::vector<CarrierDrive> drives_;  ///< Tracks, then supports; sections 4 on.
  std::optional<CarriedArm> carried_;
  DriveGains closed_gains_;  ///< Gains with no section floating.
  JointVector rigid_gain_;   ///< Gains of level quasi_static, N s/m.
  std::array<ActuatorChambers, kArmJoints> chambers_;
  std::array<Spool, kArmJoints> spools_;
  std::array<Areas, kArmJoints> areas_;
  ValveCommand command_;
  std::array<bool, kArmJoints> floating_{};
  std::array<double, 2 * kArmJoints> hard_limits_rad_{};  ///< q_min, q_max per joint.
  Duration inner_span_{};

  SimTime time_{};
  ArmState state_;
  ArmPose pose_;  ///< Pose of state_.
  JointVector acceleration_ = JointVector::Zero();
  JointVector position_rate_ = JointVector::Zero();
  JointVector target_ = JointVector::Zero();
  JointVector force_ = JointVector::Zero();
  std::array<double, kArmJoints> flow_{};
  std::vector<double> requests_m3ps_;  ///< Requested flows of all sections.
  std::array<PortPressures, kArmJoints> ports_{};
  double supply_pressure_pa_ = 0.0;
  std::optional<PowerUnit> power_unit_;
  std::optional<ContactSet> contact_;
  std::optional<OwnContact> own_;
  std::array<ContactLink, kLinks> contact_links_;
  std::vector<ArmContact> arm_contacts_;  ///< Contacts of a fixed carrier.
  int contact_parts_ = 1;                 ///< Parts of an inner step within reach of an obstacle.
  bool near_ = false;                     ///< Obstacles may be within reach in this step.
  bool near_itself_ = false;              ///< Its own bodies may be.
  BucketLoad bucket_load_;
  std::array<double, kTipResistances> resistance_n_{};
  std::array<LinkMotion, kLinks> links_;
  std::vector<TruthField> truth_fields_;
  std::optional<NonFinite> non_finite_;
  std::string unsteady_start_;
  std::uint64_t refused_commands_ = 0;
};

}  // namespace rigwire::sim
