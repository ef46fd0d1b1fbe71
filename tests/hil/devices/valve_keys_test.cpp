// Valve drivers name what they move.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "hil/devices/valve_driver.h"
#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ValveKeys : public testing::Test {
 protected:
  std::string complaints(const std::string& device, const std::string& machine = "excavator") {
    const std::string file = (wires_.folder / "rig.yaml").string();
    std::ofstream(file) << "machine: {type: " << machine << "}\n"
                        << "buses: {can: {wire: slcan, path: /tmp/rigwire/can}}\n"
                        << "devices:\n  valves: " << device << "\n";
    try {
      (void)load_rig(file, {});
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  rigwire::test::PrivateWires wires_;
};

TEST_F(ValveKeys, sections_in_any_order_and_fewer_than_actuators_are_fine) {
  EXPECT_EQ(complaints("{type: valve-driver, sections: [boom, stick]}"), "");
  EXPECT_EQ(complaints("{type: iso-valves, sections: [bucket, swing, boom]}"), "");
}

TEST_F(ValveKeys, a_section_that_the_machine_has_not_is_refused_with_those_that_it_has) {
  for (const char* type : {"valve-driver", "iso-valves"}) {
    EXPECT_THAT(
        complaints("{type: " + std::string(type) + ", sections: [boom, lid]}"),
        AllOf(
            HasSubstr("devices.valves.sections.1: no such actuator of the machine, found \"lid\""),
            HasSubstr("allowed swing, boom, stick, bucket")));
  }
  EXPECT_THAT(complaints("{type: valve-driver, sections: [bom]}"), HasSubstr("did you mean boom?"));
}

TEST_F(ValveKeys, a_section_named_twice_is_refused) {
  EXPECT_THAT(complaints("{type: valve-driver, sections: [boom, boom]}"), HasSubstr("\"boom\""));
}

TEST_F(ValveKeys, a_watchdog_that_the_map_overrules_is_refused_and_the_plan_has_the_effective_one) {
  std::ofstream(wires_.folder / "map.yaml") << R"(name: own
registers:
  - {name: enable, table: holding, address: 0, access: write, signal: enable, range: [0, 1]}
  - {name: watchdog, table: holding, address: 1, access: write, signal: watchdog, unit: ms,
     initial: 500}
  - {name: set_point, table: holding, address: 10, count: 3, access: write, signal: command,
     unit: "%", range: [-100, 100], format: s16, initial: 0}
)";
  EXPECT_THAT(complaints("{type: valve-driver, map: map.yaml, watchdog: 300 ms}"),
              AllOf(HasSubstr("devices.valves.watchdog: has no effect"), HasSubstr("500 ms")));
  EXPECT_EQ(complaints("{type: valve-driver, map: map.yaml}"), "");
  EXPECT_EQ(complaints("{type: valve-driver, map: map.yaml, watchdog: 500 ms}"), "")
      << "it says the same";
  const LoadedRig rig = load_rig((wires_.folder / "rig.yaml").string(), {});
  const auto& valves = rig.configuration.devices.at("valves");
  EXPECT_THAT(fields::as<ValveDriverConfiguration>(valves)->plan(view_of(rig.configuration)).with,
              HasSubstr("registers of own, 3 sections commanded, watchdog 500 ms"));
}

TEST_F(ValveKeys, a_map_that_is_chosen_later_overrules_in_silence) {
  std::ofstream(wires_.folder / "map.yaml") << R"(name: own
registers:
  - {name: enable, table: holding, address: 0, access: write, signal: enable, range: [0, 1]}
  - {name: watchdog, table: holding, address: 1, access: write, signal: watchdog, unit: ms,
     initial: 500}
)";
  EXPECT_EQ(complaints("{type: valve-driver, watchdog: 300 ms}"), "");
  const std::string map = (wires_.folder / "map.yaml").string();
  EXPECT_NO_THROW(
      (void)load_rig((wires_.folder / "rig.yaml").string(), {"devices.valves.map=" + map}));
  EXPECT_THROW((void)load_rig((wires_.folder / "rig.yaml").string(),
                              {"devices.valves.map=" + map, "devices.valves.watchdog=200ms"}),
               ConfigurationError);
}

TEST_F(ValveKeys, a_machine_without_valves_is_refused) {
  EXPECT_THAT(complaints("{type: valve-driver}", "wheeled"), HasSubstr("no valve block"));
}

// `check` found it good, and the run refused to begin.
TEST_F(ValveKeys, a_fault_of_its_own_line_that_cannot_be_is_refused) {
  EXPECT_THAT(complaints("{type: valve-driver, faults: [{type: frozen}]}"),
              AllOf(HasSubstr("frozen"), HasSubstr("allowed holding, input")));
  EXPECT_THAT(complaints("{type: valve-driver, faults: [{type: wrong_check}]}"),
              HasSubstr("wrong_check"));
  EXPECT_EQ(complaints("{type: valve-driver, faults: [{type: frozen, table: holding, last: 43}]}"),
            "");
}

// The list of faults had those of serial lines for it, which every rig then refused.
TEST_F(ValveKeys, its_own_line_has_the_kinds_of_tcp_alone) {
  const std::vector<fields::Named> kinds = ValveDriverConfiguration{}.fault_kinds();
  const auto has = [&](std::string_view kind) {
    return std::ranges::count(kinds, kind, &fields::Named::name) > 0;
  };
  EXPECT_TRUE(has("wrong_transaction") && has("disconnect") && has("frozen"));
  EXPECT_FALSE(has("wrong_check") || has("noise") || has("parity_mismatch"));
}

}  // namespace
}  // namespace rigwire::hil
