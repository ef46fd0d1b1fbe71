// `rigwire schema` judged by a validator of others (python3-jsonschema): it is a schema, every file
// of configs/ keeps it, and files that the program refuses for what stands in one key break it too.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// Prints one line for each file: its name and what breaks the schema, if anything does. Dates, on
/// and off stay text, as in YAML 1.2.
constexpr const char* kValidator = R"py(
import json, sys, yaml, jsonschema
class Loader(yaml.SafeLoader):
    pass
Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:timestamp"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items() if first not in "oO"}
schema = json.load(open(sys.argv[1]))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
for name in sys.argv[2:]:
    errors = list(validator.iter_errors(yaml.load(open(name), Loader)))
    first = jsonschema.exceptions.best_match(errors)
    print(json.dumps({"file": name, "errors": len(errors),
                      "first": "" if first is None else first.json_path + ": " + first.message[:300]}))
)py";

class Schema : public testing::Test {
 protected:
  std::string rigwire(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{std::string(RIGWIRE_BINARY_DIR) + "/rigwire"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    test::ChildProcess program(command, wires_.folder / "rigwire.txt");
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  }

  std::vector<nlohmann::json> validate(const std::string& kind,
                                       const std::vector<std::string>& files) {
    const fs::path schema = wires_.folder / (kind + ".schema.json");
    std::ofstream(schema) << rigwire({"schema", kind});
    std::vector<std::string> command{"/usr/bin/python3", "-c", kValidator, schema.string()};
    command.insert(command.end(), files.begin(), files.end());
    test::ChildProcess validator(command, wires_.folder / "verdicts.txt");
    EXPECT_EQ(validator.wait(), 0) << validator.output();
    std::vector<nlohmann::json> verdicts;
    std::istringstream lines(validator.output());
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('{')) {
        verdicts.push_back(nlohmann::json::parse(line));
      }
    }
    EXPECT_EQ(verdicts.size(), files.size()) << validator.output();
    return verdicts;
  }

  void expect_all_keep_it(const std::string& kind, const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(fs::path(RIGWIRE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() == ".yaml") {
        files.push_back(entry.path().string());
      }
    }
    ASSERT_FALSE(files.empty());
    for (const auto& verdict : validate(kind, files)) {
      EXPECT_EQ(verdict.at("errors"), 0) << verdict.at("file") << " " << verdict.at("first");
    }
  }

  test::PrivateWires wires_;
};

TEST_F(Schema, every_rig_keeps_it) {
  expect_all_keep_it("rig", "configs/rigs");
  expect_all_keep_it("rig", "tests/hil/streams");
}
TEST_F(Schema, every_machine_keeps_it) {
  expect_all_keep_it("machine", "configs/machines");
}
TEST_F(Schema, every_scene_keeps_it) {
  expect_all_keep_it("scene", "configs/scenes");
}
TEST_F(Schema, every_valve_map_keeps_it) {
  expect_all_keep_it("valve-map", "configs/valves");
}
TEST_F(Schema, every_binding_of_a_can_device_keeps_it) {
  expect_all_keep_it("dbc-node", "configs/can");
}
TEST_F(Schema, every_campaign_keeps_it) {
  expect_all_keep_it("campaign", "configs/campaigns");
}

TEST_F(Schema, what_is_wrong_in_one_key_breaks_it) {
  const std::string machine = "machine: {type: excavator}\n";
  const std::vector<std::string> wrong{
      "seed: 1\n",                                                          // no machine
      machine + "sed: 1\n",                                                 // unknown key
      machine + "seed: -1\n",                                               // below the range
      machine + "step: 1 m\n",                                              // another dimension
      machine + "lead: -1\n",                                               // below the range
      machine + "origin: {latitude: 91}\n",                                 // beyond the range
      machine + "origin: {geoid: constant, geoid_file: a.gtx}\n",           // key of another choice
      machine + "origin: {geoid: egm69}\n",                                 // no such choice
      machine + "buses: {can: {bitrate: fast}}\n",                          // no number
      machine + "buses: {CAN: {}}\n",                                       // no name
      machine + "modbus: {cab: {wire: rtu, port: 502}}\n",                  // key of another choice
      machine + "devices: {gnss: {path: /tmp/a}}\n",                        // no type
      machine + "devices: {gnss: {type: ublox-neo-8p}}\n",                  // no such type
      machine + "devices: {gnss: {type: ublox-neo-7p, resolution: 13}}\n",  // of another type
      machine + "devices: {lidar: {type: velodyne-vlp-16, calibration: a}}\n",  // of another model
      machine +
          "devices: {gnss: {type: ublox-neo-7p, faults: [{type: jamming, at: 1, loss: 99}]}}\n",
      machine + "scene: {terrain: {type: level, benches: 2}}\n",
      machine + "faults: [{type: jamming, loss: 30}]\n",          // of nothing
      machine + "faults: [{on: sky, type: outage, every: x}]\n",  // no duration
      "machine: {type: excavator, excavator: {step: 80 s s}}\n",
      "machine: {type: excavator, excavator: {drives: {cushion: 0.6}}}\n",
      "machine: [excavator]\n",
  };
  const std::vector<std::string> right{
      machine,
      machine + "seed: 0xFF\nstep: 2 ms\n",
      machine + "faults: [{on: gnss, type: jamming, every: 2 s, duty: 10 %, loss: 30 dB}]\n",
      machine + "modbus: {cab: {wire: rtu, baud: 19200}}\n",
      machine + "origin: {geoid: egm96, geoid_interpolation: bicubic}\n",
      machine + "devices: {e: {type: cia406-encoder, event_timer: 10 ms}}\n",
      machine +
          "devices: {i: {type: openimu335ri, rate: 100Hz}, j: {type: openimu335ri, rate: 50}}\n",
      "machine: {include: other.yaml}\n",
  };
  std::vector<std::string> files;
  const auto write = [&](const std::vector<std::string>& texts, const std::string& name) {
    for (std::size_t i = 0; i < texts.size(); ++i) {
      files.push_back((wires_.folder / (name + std::to_string(i) + ".yaml")).string());
      std::ofstream(files.back()) << texts[i];
    }
  };
  write(wrong, "wrong");
  write(right, "right");
  const auto verdicts = validate("rig", files);
  ASSERT_EQ(verdicts.size(), wrong.size() + right.size());
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_GT(verdicts[i].at("errors"), 0) << wrong[i];
  }
  for (std::size_t i = 0; i < right.size(); ++i) {
    EXPECT_EQ(verdicts[wrong.size() + i].at("errors"), 0)
        << right[i] << verdicts[wrong.size() + i].at("first");
  }
}

}  // namespace
}  // namespace rigwire
