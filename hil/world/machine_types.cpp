#include "hil/world/machine_types.h"

#include <array>
#include <cmath>

#include "sim/driveline/driveline.h"
#include "sim/excavator/digging_excavator.h"
#include "sim/roller/tandem_roller.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::hil {
namespace {

template <class Type>
std::unique_ptr<MachineModel> fresh() {
  return std::make_unique<Type>();
}

constexpr std::array kTypes{
    MachineType{{"excavator", "Swing, boom, stick and bucket."}, fresh<ExcavatorMachine>},
    MachineType{{"wheeled", "Two axles, beams or independent wheels, and a drive line."},
                fresh<WheeledMachine>},
    MachineType{{"tandem_roller", "Two drums, each on a pivot that steers."}, fresh<RollerMachine>},
};

/// Returns the angle of the pose's x axis from east, left positive, rad.
double yaw_rad(const Eigen::Isometry3d& X) {
  return std::atan2(X.linear()(1, 0), X.linear()(0, 0));
}

}  // namespace

std::span<const MachineType> machine_types() {
  return kTypes;
}

void ExcavatorMachine::visit(fields::Visitor& v) {
  v.section("excavator", excavator, "Masses, pins, cylinders, hydraulics, drives.");
  v.boolean("digs", digs, "Whether the bucket moves the ground; else it passes through.");
  v.only_if(digs, "digs", "digs: true", [this](fields::Visitor& w) {
    w.section("digging", digging, "The bucket as a tool, and the ground's limits.");
  });
}

std::span<const std::string_view> ExcavatorMachine::links() const {
  return sim::kExcavatorLinks;
}

std::span<const std::string_view> ExcavatorMachine::standing_links() const {
  return std::span(sim::kExcavatorLinks).first(1);
}

std::unique_ptr<sim::Machine> ExcavatorMachine::make(const MachineSite& site) const {
  if (!digs) {
    return std::make_unique<sim::Excavator>(excavator, site.X_WB, &site.ground);
  }
  auto made = std::make_unique<sim::DiggingExcavator>(excavator, digging, site.X_WB, site.ground);
  made->bucket().set_fall_obstacle(&site.obstacles);
  return made;
}

void WheeledMachine::visit(fields::Visitor& v) {
  v.section("wheeled", wheeled, "Body, axles, tyres, steering, brakes.");
  v.section("driveline", driveline, "Engine to wheels.");
}

std::span<const std::string_view> WheeledMachine::links() const {
  return sim::kWheeledLinks;
}

std::unique_ptr<sim::Machine> WheeledMachine::make(const MachineSite& site) const {
  const Eigen::Vector2d place_m = site.X_WB.translation().head<2>();
  return sim::make_wheeled_vehicle(wheeled, site.ground, sim::make_driveline(driveline),
                                   {place_m.x(), place_m.y(), yaw_rad(site.X_WB)});
}

void RollerMachine::visit(fields::Visitor& v) {
  v.section("roller", roller, "Masses, drums, steering, drive, supplements.");
}

std::span<const std::string_view> RollerMachine::links() const {
  return sim::kRollerLinks;
}

std::unique_ptr<sim::Machine> RollerMachine::make(const MachineSite& site) const {
  return std::make_unique<sim::TandemRoller>(roller, site.ground, site.X_WB.translation().head<2>(),
                                             yaw_rad(site.X_WB));
}

}  // namespace rigwire::hil
