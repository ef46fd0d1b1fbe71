// The rigs of tests/hil/streams/, which scripts/compare-streams.sh runs beside those of configs/:
// each family of faults has one in which all its kinds happen, so that a change of any of them
// shows in a stream. What kinds there are is asked of the configuration itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

const std::string kFolder = std::string(RIGWIRE_SOURCE_DIR) + "/tests/hil/streams";

std::string rig_file(const std::string& name) {
  return kFolder + "/" + name + ".yaml";
}

std::vector<std::string> rig_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

bool loads_with(const std::string& rig, const std::string& set) {
  try {
    static_cast<void>(load_rig(rig_file(rig), {set}));
    return true;
  } catch (const ConfigurationError&) {
    return false;
  }
}

/// The words that `<list>.0.type` of a rig may be, as the refusal of another word tells them.
std::set<std::string> kinds_allowed(const std::string& rig, const std::string& list) {
  std::set<std::string> kinds;
  try {
    static_cast<void>(load_rig(rig_file(rig), {list + "=[{at: 1 s, type: no_such_kind}]"}));
  } catch (const ConfigurationError& error) {
    for (const Problem& problem : error.problems()) {
      if (problem.path == list + ".0.type") {
        std::istringstream words(problem.allowed);
        for (std::string word; std::getline(words >> std::ws, word, ',');) {
          kinds.insert(word);
        }
      }
    }
  }
  return kinds;
}

/// A value of a rig's file by its key path; null when there is none.
const Value* find(const Value& document, const std::string& path) {
  const Value* value = &document;
  std::istringstream keys(path);
  for (std::string key; value != nullptr && std::getline(keys, key, '.');) {
    value = value->find(key);
  }
  return value;
}

/// The words that stand behind `type` in the lists of a rig's file.
std::set<std::string> kinds_written(const std::string& rig, const std::vector<std::string>& lists) {
  Problems problems;
  const Value document = load_document(rig_file(rig), problems);
  std::set<std::string> kinds;
  for (const std::string& list : lists) {
    const Value* faults = find(document, list);
    if (faults == nullptr) {
      ADD_FAILURE() << rig << " has no " << list;
      continue;
    }
    for (const Value& fault : faults->items) {
      kinds.insert(fault.find("type")->scalar);
    }
  }
  return kinds;
}

TEST(Streams, every_rig_loads) {
  EXPECT_THAT(rig_names(), testing::ElementsAre("can", "gnss", "lidar", "modbus", "usb"));
  for (const std::string& rig : rig_names()) {
    EXPECT_NO_THROW(static_cast<void>(load_rig(rig_file(rig), {}))) << rig;
  }
}

struct Family {
  std::string rig;
  std::vector<std::string> lists;  ///< Where the kinds happen, together.
};

void PrintTo(const Family& family, std::ostream* out) {
  *out << family.rig << " " << family.lists.front();
}

class StreamsOfAFamily : public testing::TestWithParam<Family> {};

TEST_P(StreamsOfAFamily, have_every_kind_of_fault) {
  const Family& family = GetParam();
  const std::set<std::string> written = kinds_written(family.rig, family.lists);
  for (const std::string& list : family.lists) {
    std::set<std::string> allowed = kinds_allowed(family.rig, list);
    allowed.erase("unplugged");  // of a receiver, only on USB: that rig has it
    EXPECT_THAT(allowed, Not(IsEmpty())) << list;
    EXPECT_THAT(written, IsSupersetOf(allowed)) << list;
  }
}

INSTANTIATE_TEST_SUITE_P(
    , StreamsOfAFamily,
    testing::Values(Family{"gnss", {"devices.gnss.faults"}},
                    Family{"lidar", {"devices.lidar.faults"}}, Family{"can", {"buses.can.faults"}},
                    Family{"modbus", {"modbus.tcp.faults", "modbus.rtu.faults"}},
                    Family{"modbus",
                           {"devices.valves_tcp.faults", "modbus.tcp.faults", "modbus.rtu.faults"}},
                    Family{"modbus", {"devices.valves_can.faults"}},
                    Family{"can", {"devices.imu.faults"}},
                    Family{"lidar", {"surroundings.air.faults"}},
                    Family{"modbus", {"surroundings.engine.faults"}},
                    Family{"modbus", {"surroundings.pumps.faults"}}),
    [](const auto& test) {
      std::string name = test.param.lists.front();
      std::ranges::replace(name, '.', '_');
      return name;
    });

TEST(Streams, a_star_fire_has_every_fault_that_it_accepts) {
  const std::string list = "devices.starfire.faults";
  const std::set<std::string> written = kinds_written("gnss", {list});
  for (const std::string& kind : kinds_allowed("gnss", list)) {
    if (loads_with("gnss", list + "=[{at: 1 s, type: " + kind + "}]")) {
      EXPECT_TRUE(written.contains(kind)) << kind;
    }
  }
}

/// In all rigs, each device that can lose its plug or its supply loses it.
TEST(Streams, every_plug_and_every_supply_fails) {
  std::map<std::string, int> lost;
  for (const std::string& rig : rig_names()) {
    for (const auto& [name, device] : load_rig(rig_file(rig), {}).configuration.devices) {
      for (const std::string kind : {"unplugged", "off"}) {
        if (std::ranges::count(device->fault_kinds(), kind, &fields::Named::name) > 0 &&
            device.type() != "iso-valves" && device.type() != "valve-driver") {
          EXPECT_TRUE(kinds_written(rig, {"devices." + name + ".faults"}).contains(kind))
              << rig << " " << name;
          ++lost[kind];
        }
      }
    }
  }
  EXPECT_EQ(lost["unplugged"], 2);
  EXPECT_EQ(lost["off"], 14);
}

}  // namespace
}  // namespace rigwire::hil
