#include "hil/world/machine.h"

#include <cmath>

#include "sim/driveline/make_driveline.h"
#include "sim/excavator/digging_excavator.h"
#include "sim/roller/tandem_roller.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::hil {
namespace {

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

double yaw_rad(const Eigen::Isometry3d& X) {
  return std::atan2(X.linear()(1, 0), X.linear()(0, 0));
}

}  // namespace

std::span<const std::string_view> link_names(const MachineSettings& settings) {
  using Names = std::span<const std::string_view>;
  return std::visit(
      Overloaded{[](const ExcavatorMachine&) -> Names { return sim::kExcavatorLinks; },
                 [](const WheeledMachine&) -> Names { return sim::kWheeledLinks; },
                 [](const RollerMachine&) -> Names { return sim::kRollerLinks; }},
      settings);
}

std::unique_ptr<sim::Machine> make_machine(const MachineSettings& settings,
                                           const MachineSite& site) {
  using Made = std::unique_ptr<sim::Machine>;
  const Eigen::Vector2d place_m = site.X_WB.translation().head<2>();
  return std::visit(Overloaded{[&](const ExcavatorMachine& machine) -> Made {
                                 if (!machine.digs) {
                                   return std::make_unique<sim::Excavator>(machine.excavator,
                                                                           site.X_WB, &site.ground);
                                 }
                                 auto made = std::make_unique<sim::DiggingExcavator>(
                                     machine.excavator, machine.digging, site.X_WB, site.ground);
                                 made->bucket().set_fall_obstacle(&site.obstacles);
                                 return made;
                               },
                               [&](const WheeledMachine& machine) -> Made {
                                 return sim::make_wheeled_vehicle(
                                     machine.wheeled, site.ground,
                                     sim::make_driveline(machine.driveline),
                                     {place_m.x(), place_m.y(), yaw_rad(site.X_WB)});
                               },
                               [&](const RollerMachine& machine) -> Made {
                                 return std::make_unique<sim::TandemRoller>(
                                     machine.roller, site.ground, place_m, yaw_rad(site.X_WB));
                               }},
                    settings);
}

double gravity_mps2(const MachineSettings& settings) {
  return std::visit(
      Overloaded{[](const ExcavatorMachine& machine) { return machine.excavator.gravity_mps2; },
                 [](const WheeledMachine& machine) { return machine.wheeled.gravity_mps2; },
                 [](const RollerMachine& machine) { return machine.roller.gravity_mps2; }},
      settings);
}

bool changes_ground(const MachineSettings& settings) {
  const auto* excavator = std::get_if<ExcavatorMachine>(&settings);
  return excavator != nullptr && excavator->digs;
}

}  // namespace rigwire::hil
