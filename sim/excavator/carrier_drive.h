// One hydraulic function of a moving undercarriage with the one thing that it moves: a travel motor
// with its track's belt, the cylinders of a blade or of outriggers.
//
// Its coordinate x is the way of what it moves, m: of a belt over the shoes, forward positive; of
// pads, downwards. Valve section, flow sharing and the levels of drive are those of the arm
// (excavator.h): level quasi_static a damper so stiff that the rate is the oil's, dynamic Eq. 5 of
// the paper with the oil's stiffness, chambers two pressures. A positive opening sends oil to port
// A: forward, down.
//
// What it moves has a mass and one equation of its own beside the machine's ten (carried_arm.h):
//
//     m x'' = drive + stop + holding + weight - ground
//
// `stop`: the ends of the cylinders. `holding`: dry friction, a bristle: what rollers and links
// resist, and the parking brake, which springs put on where the section asks for no oil and the
// belt has come nearly to rest (5 cm/s), and its oil takes off.
#pragma once

#include <algorithm>
#include <array>

#include "sim/contact/bristle.h"
#include "sim/excavator/parameters.h"
#include "sim/hydraulics/chambers.h"
#include "sim/hydraulics/spool.h"
#include "sim/hydraulics/supply.h"

namespace rigwire::sim {

/// A force on what is moved, linear in its rate at the step's end, with limits.
struct DriveForce {
  ImplicitForce law;
  double least = 0.0;
  double greatest = 0.0;
  bool held = false;  ///< At a limit in this pass.
  double force_n = 0.0;
  int switches = 0;

  /// What the law gives at the rate found, within its limits; true when the pass before had it
  /// otherwise.
  [[nodiscard]] bool clamp(double free) {
    constexpr int kSwitchesMax = 4;
    const bool beyond = held ? !(force_n >= greatest ? free < greatest : free > least)
                             : free < least || free > greatest;
    if (beyond != held && switches < kSwitchesMax) {
      held = beyond;
      ++switches;
      force_n = std::clamp(free, least, greatest);
      return true;
    }
    if (!held) {
      force_n = std::clamp(free, least, greatest);
    }
    return false;
  }
};

class CarrierDrive {
 public:
  /// Makes the drive of one track. `carried_kg`: mass for its damping.
  CarrierDrive(const ExcavatorParameters& parameters, const TrackParameters& track,
               double carried_kg);
  /// Makes the drive of a blade or of outriggers, raised.
  CarrierDrive(const ExcavatorParameters& parameters, const SupportParameters& support,
               double carried_kg);

  /// Sets the command. Returns false if it is not a number; the old set point is kept.
  bool command(double opening, bool floating);

  // Each step, in this order.
  void step_spool(double h) { spool_.step(h); }
  /// What its section asks for, the ends of its stroke left whole; m3/s, signed.
  [[nodiscard]] double flow_request_m3ps() const;
  /// The pump's share of it.
  void grant(double flow_m3ps) { flow_m3ps_ = flow_m3ps; }
  /// Forces of a step of h seconds under that load on the ground.
  void begin(double h, double supply_pressure_pa, double ground_n);
  /// Ends it with the rate found there.
  void settle(double h, double rate_mps);
  void update_ports();

  [[nodiscard]] std::array<DriveForce, 3>& forces() { return forces_; }
  [[nodiscard]] double mass_kg() const { return mass_kg_; }
  [[nodiscard]] double weight_n() const { return weight_n_; }
  [[nodiscard]] double position_m() const { return x_m_; }
  [[nodiscard]] double rate_mps() const { return rate_mps_; }
  [[nodiscard]] double spool() const { return spool_.position(); }
  [[nodiscard]] double flow_m3ps() const { return flow_m3ps_; }
  /// Flow that the section's spool requests, regardless of the stroke's ends.
  [[nodiscard]] double asked_m3ps() const { return floating_ ? 0.0 : spool_.flow_request_m3ps(); }
  [[nodiscard]] const PortPressures& ports() const { return ports_; }
  /// Force of oil, friction and brake in the last step, N.
  [[nodiscard]] double drive_n() const { return forces_[0].force_n; }
  [[nodiscard]] double holding_n() const { return forces_[1].force_n; }
  [[nodiscard]] bool braked() const { return braked_; }
  [[nodiscard]] bool finite() const;
  /// Stops at its current position.
  void stop() { rate_mps_ = 0.0; }

 private:
  CarrierDrive(const ExcavatorParameters& parameters, const SpoolParameters& spool,
               const ActuatorSize& size, double mass_kg, double carried_kg);
  [[nodiscard]] bool at_end(double direction) const;

  ExcavatorLevel level_;
  SupplyParameters supply_;
  double cushion_;
  double stop_npm_;
  Spool spool_;
  ActuatorSize size_;  ///< Without a stroke: a motor.
  bool cylinder_ = false;
  double mass_kg_;
  double weight_n_ = 0.0;
  double stiffness_npm_;
  double damping_nspm_;
  double rigid_nspm_;
  double stop_nspm_;
  ActuatorChambers chambers_;
  ForceLimits limits_;
  double brake_n_ = 0.0;
  double resistance_ = 0.0;  ///< Force over load.
  BristleParameters holding_;
  Bristle held_;
  double holding_n_limit_ = 0.0;

  bool floating_ = false;
  bool braked_ = false;
  double flow_m3ps_ = 0.0;
  double x_m_ = 0.0;
  double target_m_ = 0.0;
  double wanted_mps_ = 0.0;
  double rate_mps_ = 0.0;
  std::array<DriveForce, 3> forces_;
  PortPressures ports_;
};

}  // namespace rigwire::sim
