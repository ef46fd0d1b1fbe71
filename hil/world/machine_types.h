// The topologies of machines: numbers alone make a machine of one. A new one is a class here and a
// row of the list.
#pragma once

#include <memory>

#include "hil/world/machine.h"
#include "sim/driveline/parameters.h"
#include "sim/excavator/bucket_soil_parameters.h"
#include "sim/excavator/parameters.h"
#include "sim/roller/parameters.h"
#include "sim/vehicle/parameters.h"

namespace rigwire::hil {

/// Implements copy() for a topology.
template <class Type>
class MachineModelOf : public MachineModel {
 public:
  [[nodiscard]] std::unique_ptr<MachineModel> copy() const override {
    return std::make_unique<Type>(static_cast<const Type&>(*this));
  }
};

struct ExcavatorMachine final : MachineModelOf<ExcavatorMachine> {
  sim::ExcavatorParameters excavator;
  bool digs = true;  ///< Else the bucket passes through the ground.
  sim::DiggingParameters digging;

  void visit(fields::Visitor& v) override;
  [[nodiscard]] std::span<const std::string_view> links() const override;
  [[nodiscard]] std::span<const std::string_view> standing_links() const override;
  [[nodiscard]] std::vector<std::string_view> actuators() const override {
    return sim::excavator_actuators(excavator);
  }
  [[nodiscard]] bool drives() const override { return false; }
  [[nodiscard]] bool has_power_unit() const override {
    return excavator.pumps == sim::ExcavatorPumps::engine;
  }
  [[nodiscard]] bool has_engine() const override { return has_power_unit(); }
  [[nodiscard]] bool changes_ground() const override { return digs; }
  [[nodiscard]] double gravity_mps2() const override { return excavator.gravity_mps2; }
  [[nodiscard]] std::unique_ptr<sim::Machine> make(const MachineSite& site) const override;
};

/// Model of a machine with a drive train that does not dig; all links but the first stand on the
/// ground.
template <class Type>
class DrivingMachineOf : public MachineModelOf<Type> {
 public:
  [[nodiscard]] std::span<const std::string_view> standing_links() const override {
    return this->links().subspan(1);
  }
  [[nodiscard]] bool drives() const override { return true; }
  [[nodiscard]] bool has_power_unit() const override { return false; }
  [[nodiscard]] bool changes_ground() const override { return false; }
};

struct WheeledMachine final : DrivingMachineOf<WheeledMachine> {
  sim::WheeledVehicleParameters wheeled;
  sim::DrivelineParameters driveline;

  void visit(fields::Visitor& v) override;
  [[nodiscard]] bool has_engine() const override { return true; }
  [[nodiscard]] std::span<const std::string_view> links() const override;
  [[nodiscard]] double gravity_mps2() const override { return wheeled.gravity_mps2; }
  [[nodiscard]] std::unique_ptr<sim::Machine> make(const MachineSite& site) const override;
};

struct RollerMachine final : DrivingMachineOf<RollerMachine> {
  sim::RollerParameters roller;

  void visit(fields::Visitor& v) override;
  /// Without an engine, the kinematic level follows its commands exactly.
  [[nodiscard]] bool has_engine() const override {
    return roller.level == sim::RollerLevel::dynamic;
  }
  [[nodiscard]] std::span<const std::string_view> links() const override;
  [[nodiscard]] double gravity_mps2() const override { return roller.gravity_mps2; }
  [[nodiscard]] std::unique_ptr<sim::Machine> make(const MachineSite& site) const override;
};

}  // namespace rigwire::hil
