#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "findings_of.h"
#include "hil/configuration/outline.h"
#include "hil/world/machine.h"

namespace rigwire::hil {
namespace {

// A machine has one step; files from before, which could choose, are not taken for what they say.
TEST(MachineKeys, AnIntegrationSchemeIsAnUnknownKey) {
  using Machine = std::pair<std::string, std::string>;  // Type, and its section.
  for (const auto& [type, section] :
       {Machine("excavator", "excavator"), Machine("wheeled", "wheeled"),
        Machine("tandem_roller", "roller")}) {
    MachineConfiguration machine;
    EXPECT_THAT(
        findings_of("type: " + type + "\n" + section + ": {scheme: runge_kutta4}\n", machine),
        testing::HasSubstr(section + ".scheme: unknown key"));
  }
}

/// Numbers below the node whose range has an open end, by their paths.
void open_ended(const OutlineNode& node, const std::string& path, std::vector<std::string>& found) {
  if (node.type.find("number") != std::string::npos &&
      node.allowed.find("..") == std::string::npos) {
    found.push_back(path + " " + node.allowed);
  }
  for (const OutlineNode& child : node.children) {
    open_ended(child, path + "." + child.key, found);
  }
}

TEST(MachineKeys, EveryNumberHasTwoEnds) {
  for (std::size_t type = 0; type < machine_types().size(); ++type) {
    MachineConfiguration machine;
    machine.model.choose(type);
    std::vector<std::string> found;
    open_ended(reference_outline(machine), std::string(machine_types()[type].named.name), found);
    EXPECT_THAT(found, testing::IsEmpty());
  }
}

TEST(MachineKeys, NumbersThatNoMachineCanHaveAreRefusedWithWhatIsAllowed) {
  struct Absurd {
    std::string type;
    std::string text;
    std::string finding;
  };
  for (const Absurd& absurd : std::vector<Absurd>{
           {"excavator", "position: [1e9 m, 0 m, 0 m]", "allowed -10000 .. 10000 m"},
           {"tandem_roller", "roller: {drum: {radius: 1e-12 m}}", "allowed 0.001 .. 10000 mm"},
           {"excavator", "excavator: {boom: {mass: 1e-300 kg}}", "allowed 0.01 .. 1000000 kg"},
           {"excavator", "excavator: {boom: {mass: 1e30 kg}}", "allowed 0.01 .. 1000000 kg"},
           {"wheeled", "wheeled: {body: {mass: 1e-300 kg}}", "allowed 10 .. 1000000 kg"},
           {"wheeled", "wheeled: {front: {tyre: {unloaded_radius: 1e-12 m}}}",
            "allowed 0.001 .. 100 m"},
           {"wheeled", "driveline: {engine: {inertia: 1e99 kg m2}}", "kg m2"},
           {"excavator", "excavator: {supply: {relief_pressure: 1e12 MPa}}", "1000 MPa"},
       }) {
    MachineConfiguration machine;
    EXPECT_THAT(findings_of("type: " + absurd.type + "\n" + absurd.text + "\n", machine),
                testing::HasSubstr(absurd.finding))
        << absurd.text;
  }
}

}  // namespace
}  // namespace rigwire::hil
