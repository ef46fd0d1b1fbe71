#include "hil/machine_factory.h"

#include "sim/excavator/excavator.h"

namespace rigwire::hil {
namespace {

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

std::span<const std::string_view> link_names(const MachineSettings& settings) {
  return std::visit(Overloaded{[](const ExcavatorMachine&) -> std::span<const std::string_view> {
                      return sim::kExcavatorLinkNames;
                    }},
                    settings);
}

std::unique_ptr<sim::Machine> make_machine(const MachineSettings& settings, sim::Ground& ground,
                                           const Eigen::Isometry3d& X_WB) {
  (void)ground;
  return std::visit(
      Overloaded{[&](const ExcavatorMachine& machine) -> std::unique_ptr<sim::Machine> {
        return std::make_unique<sim::Excavator>(machine.excavator, X_WB);
      }},
      settings);
}

double gravity_mps2(const MachineSettings& settings) {
  return std::visit(
      Overloaded{[](const ExcavatorMachine& machine) { return machine.excavator.gravity_mps2; }},
      settings);
}

}  // namespace rigwire::hil
