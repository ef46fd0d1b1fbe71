#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "findings_of.h"
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

}  // namespace
}  // namespace rigwire::hil
