// What is bolted to a road roller beside its drums: sprinkler tank, chip spreader, edge cutter.
//
// Water and chips leave at the machine's own velocity: the mass in gravity and inertia falls, and
// no thrust appears.
#pragma once

#include "fields/rules.h"

namespace rigwire::sim {

/// Water for the drums. Estimates.
struct SprinklerParameters {
  double capacity_kg = 850.0;
  double initial_kg = 800.0;
  double flow_kgps = 0.05;  ///< While the machine moves.
  double x_m = -0.3;        ///< Centre of the tank, in the frame.
  double height_m = 1.3;

  friend bool operator==(const SprinklerParameters&, const SprinklerParameters&) = default;
};
void visit(fields::Visitor& v, SprinklerParameters& p);

/// Hopper with a metering roll over the whole width. Estimates.
struct SpreaderParameters {
  double capacity_kg = 2400.0;
  double initial_kg = 1200.0;
  double width_m = 1.68;
  double rate_max_kgpm2 = 2.0;
  double x_m = -2.4;  ///< Centre of the hopper, in the frame.
  double height_m = 1.2;

  friend bool operator==(const SpreaderParameters&, const SpreaderParameters&) = default;
};
void visit(fields::Visitor& v, SpreaderParameters& p);

/// A cutting wheel on an arm beside the frame. Estimates.
struct EdgeCutterParameters {
  double lift_m = 0.6;
  double lift_time_s = 2.5;   ///< Over the whole lift.
  double press_share = 0.95;  ///< Share of the lift at which the wheel touches the mat.
  double lateral_n = 7500.0;  ///< Reaction on the frame when fully pressed and moving.
  double moving_mps = 0.05;   ///< Speed from which the reaction is full.
  double x_m = 0.6;           ///< Position of the wheel, in the frame.
  double y_m = -1.0;          ///< The reaction points away from the wheel's side.

  friend bool operator==(const EdgeCutterParameters&, const EdgeCutterParameters&) = default;
};
void visit(fields::Visitor& v, EdgeCutterParameters& p);

/// Each throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const SprinklerParameters& parameters);
void validate(const SpreaderParameters& parameters);
void validate(const EdgeCutterParameters& parameters);

class Sprinkler {
 public:
  explicit Sprinkler(const SprinklerParameters& p) : parameters_(p), mass_kg_(p.initial_kg) {}
  void step(double h, double speed_mps);
  [[nodiscard]] double mass_kg() const { return mass_kg_; }

 private:
  SprinklerParameters parameters_;
  double mass_kg_;
};

/// Mass flow = speed x width x rate, until the hopper is empty.
class ChipSpreader {
 public:
  explicit ChipSpreader(const SpreaderParameters& p) : parameters_(p), mass_kg_(p.initial_kg) {}
  /// kg/m2, clamped to what the roll can do; not a number: the old rate stays.
  void command(double rate_kgpm2);
  void step(double h, double speed_mps);

  [[nodiscard]] double mass_kg() const { return mass_kg_; }
  /// Since the start; with mass_kg() always the initial mass.
  [[nodiscard]] double spread_kg() const { return parameters_.initial_kg - mass_kg_; }
  /// What lies on the road behind: 0 when empty.
  [[nodiscard]] double rate_kgpm2() const { return mass_kg_ > 0.0 ? rate_kgpm2_ : 0.0; }

 private:
  SpreaderParameters parameters_;
  double mass_kg_;
  double rate_kgpm2_ = 0.0;
};

/// The arm moves at its own speed towards the commanded share of its lift.
class EdgeCutter {
 public:
  explicit EdgeCutter(const EdgeCutterParameters& p) : parameters_(p) {}
  /// Sets the position, 0 raised .. 1 pressed down; not a number: it stays.
  void command(double share);
  void step(double h);

  [[nodiscard]] double share() const { return share_; }
  /// Height of the wheel above the mat.
  [[nodiscard]] double height_m() const { return (1.0 - share_) * parameters_.lift_m; }
  /// Returns the force on the frame, left positive.
  [[nodiscard]] double lateral_n(double speed_mps) const;

 private:
  EdgeCutterParameters parameters_;
  double wanted_ = 0.0;
  double share_ = 0.0;
};

}  // namespace rigwire::sim
