// A machine whose motion is a recording's. Sensors, devices and the scene see it as the original
// machine; so does its ground where a bucket digs. Nothing moves it: commands are kept, can be read
// back, and have no effect.
//
// Links. Recorded links move as they did (motion_track.h); the others stay fixed relative to the
// first link, as in the machine at rest.
//
// Ports return the values recorded for them. Without a record they return what the motion alone
// determines: the swing from the upper structure relative to the undercarriage; wheel rates,
// odometry, ground speed and the front axle's angle from the first link, for wheels that roll
// without slip. All else is as in the machine at rest.
//
// Truth: the machine's own fields, NaN where they were not recorded, and commands_without_effect.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/machine.h"
#include "sim/replay/motion_track.h"
#include "sim/replay/recorded_numbers.h"

namespace rigwire::sim {

/// What was recorded of a machine. Instants count from the start of the replay.
struct MachineRecord {
  /// By link, in the machine's order; an empty place: not recorded. The first must be there.
  std::vector<std::unique_ptr<MotionTrack>> links;
  /// In the order of the machine's truth fields, empty if there is none; `valves` and `vehicle` in
  /// the order of its ports' members (sim/samples/port_members.h).
  RecordedNumbers truth;
  RecordedNumbers valves;
  RecordedNumbers vehicle;
  RecordedNumbers power_unit;
};

class ReplayedMachine final : public Machine {
 public:
  /// `model`: the machine at rest on its ground, whose names, data sheets and tools are used.
  /// Throws std::invalid_argument where the record does not fit it.
  ReplayedMachine(std::unique_ptr<Machine> model, MachineRecord record);
  ~ReplayedMachine() override;

  void step(Duration span) override;
  [[nodiscard]] SimTime time() const override { return time_; }
  [[nodiscard]] std::span<const LinkMotion> links() const override { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override {
    return model_->link_names();
  }
  [[nodiscard]] const std::optional<NonFinite>& non_finite() const override { return non_finite_; }

  /// Place and speed of the first link, and commands_without_effect().
  [[nodiscard]] std::span<const StatusQuantity> status_quantities() const override;
  void read_status(std::span<double> values) const override;
  [[nodiscard]] std::span<const TruthField> truth_fields() const override { return truth_fields_; }
  void read_truth(std::span<double> values) const override;

  [[nodiscard]] std::optional<NodeRectangle> take_ground_changes() override {
    return model_->take_ground_changes();
  }
  [[nodiscard]] std::span<const DustEmitter> dust_emitters() const override {
    return model_->dust_emitters();
  }
  [[nodiscard]] ValvePort* valve_port() override;
  [[nodiscard]] VehiclePort* vehicle_port() override;
  [[nodiscard]] PowerUnitPort* power_unit_port() override;

  /// Changes of what was commanded, since the start.
  [[nodiscard]] std::uint64_t commands_without_effect() const { return commands_; }

 private:
  class Valves;
  class Vehicle;
  class PowerUnit;
  void place();

  std::unique_ptr<Machine> model_;
  MachineRecord record_;
  SimTime time_ = kStart;
  std::vector<LinkMotion> links_;
  std::vector<Eigen::Isometry3d> X_BL_;  ///< At rest, against the first link.
  std::vector<TruthField> truth_fields_;
  std::unique_ptr<Valves> valves_;
  std::unique_ptr<Vehicle> vehicle_;
  std::unique_ptr<PowerUnit> power_unit_;
  std::uint64_t commands_ = 0;
  std::optional<NonFinite> non_finite_;
};

}  // namespace rigwire::sim
