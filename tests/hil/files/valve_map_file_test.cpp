#include "hil/files/valve_map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "emulators/valve_driver/valve_driver.h"
#include "hil/configuration/problems.h"

namespace rigwire::hil {
namespace {

using namespace emulators;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kSource = RIGWIRE_SOURCE_DIR;

/// What is wrong with a map, one finding per line.
std::string faults_of(const std::string& text) {
  try {
    (void)parse_valve_map(text, "valve.yaml");
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "nothing";
}

std::string with_register(const std::string& flow) {
  return "always_enabled: true\nregisters:\n  - " + flow + "\n";
}

TEST(ValveMapFile, AMinimalMapIsThreeLines) {
  const ValveMap map = parse_valve_map(
      with_register("{name: set, table: holding, address: 0, access: write, signal: command}"),
      "valve.yaml");
  ASSERT_EQ(map.registers.size(), 1U);
  EXPECT_EQ(map.registers[0].signal, ValveSignal::command);
  EXPECT_TRUE(map.registers[0].writable);
  EXPECT_FALSE(map.registers[0].initial);
}

TEST(ValveMapFile, EveryExampleLoadsAndMakesADriver) {
  int files = 0;
  for (const auto& file : fs::directory_iterator(kSource + "/configs/valves")) {
    ValveDriverSettings settings;
    settings.map = load_valve_map(file.path());
    const ValveDriver driver(settings);
    EXPECT_FALSE(driver.quantities().empty()) << file.path();
    ++files;
  }
  EXPECT_GE(files, 2);
}

TEST(ValveMapFile, TheDocumentHoldsEveryRowOfTheExamples) {
  std::ifstream file(kSource + "/docs/your-own-valve.md");
  std::stringstream page;
  page << file.rdbuf();
  for (const auto& example : fs::directory_iterator(kSource + "/configs/valves")) {
    for (const ValveRegister& entry : load_valve_map(example.path()).registers) {
      EXPECT_THAT(page.str(), HasSubstr(markdown_row(entry))) << example.path();
    }
  }
}

TEST(ValveMapFile, TheDocumentsOwnExampleMakesADriver) {
  std::ifstream file(kSource + "/docs/your-own-valve.md");
  std::stringstream page;
  page << file.rdbuf();
  const std::string text = page.str();
  const std::size_t begin = text.find("```yaml\n") + 8;
  ValveDriverSettings settings;
  settings.map = parse_valve_map(text.substr(begin, text.find("```", begin) - begin), "example");
  EXPECT_EQ(settings.map->registers.size(), 4U);
  EXPECT_NO_THROW(ValveDriver{settings});
}

TEST(ValveMapFile, EveryFaultIsToldWithItsPlace) {
  EXPECT_THAT(faults_of(with_register("{name: a, table: holding, address: 0, signal: comand}")),
              HasSubstr("valve.yaml:3:"));
  EXPECT_THAT(faults_of(with_register("{name: a, table: holding, address: 0, signal: comand}")),
              HasSubstr("did you mean command?"));
  EXPECT_THAT(faults_of(with_register("{name: a, table: holding, adress: 0, signal: command}")),
              HasSubstr("did you mean address?"));
  EXPECT_THAT(faults_of(with_register("{name: a, table: coils, address: 0, signal: enable}")),
              HasSubstr("did you mean coil?"));
  EXPECT_THAT(faults_of("always_enabled: true\n"), HasSubstr("registers"));
  EXPECT_THAT(faults_of("registers: 5\n"), HasSubstr("valve.yaml:1:"));
  EXPECT_THAT(faults_of("registers: [3, four]\n"), HasSubstr("valve.yaml:1:"));
  EXPECT_THAT(faults_of("registers: []\n"), HasSubstr("no registers"));
  EXPECT_THAT(faults_of("[1, 2]\n"), HasSubstr("valve.yaml"));
  EXPECT_THAT(faults_of(""), HasSubstr("valve.yaml"));
  EXPECT_THAT(faults_of("registers: [\n"), HasSubstr("valve.yaml"));
}

TEST(ValveMapFile, OverlapsAreToldAtTheSecondRegister) {
  const std::string text =
      "always_enabled: true\n"
      "registers:\n"
      "  - {name: angle, table: input, address: 4, format: s32, signal: swing_angle}\n"
      "  - {name: rate, table: input, address: 5, format: s16, signal: swing_rate}\n";
  EXPECT_THAT(faults_of(text), HasSubstr("valve.yaml:4:"));
  EXPECT_THAT(faults_of(text), HasSubstr("input address 5 belongs to \"angle\" already"));
}

TEST(ValveMapFile, SeveralFaultsComeAtOnce) {
  const std::string text =
      "always_enabled: true\n"
      "registers:\n"
      "  - {name: a, table: input, address: 0, access: write, signal: fault_code}\n"
      "  - {name: b, table: input, address: 1, unit: bar, signal: coil_current}\n"
      "  - {name: c, table: input, address: 2, format: bit, signal: ready}\n";
  const std::string faults = faults_of(text);
  for (const char* line : {"valve.yaml:3:", "valve.yaml:4:", "valve.yaml:5:"}) {
    EXPECT_THAT(faults, HasSubstr(line));
  }
}

TEST(ValveMapFile, AbsurdNumbersAreRefusedNotTaken) {
  for (const char* bad : {"address: 65536",
                          "address: -1",
                          "address: x",
                          "address: 0, count: 0",
                          "address: 0, count: 126",
                          "address: 65535, count: 2",
                          "address: 0, scale: 0",
                          "address: 0, scale: .nan",
                          "address: 0, scale: .inf",
                          "address: 0, range: [1]",
                          "address: 0, range: [5, 4]",
                          "address: 0, range: [0, 65536]",
                          "address: 0, range: [0, 1.5]",
                          "address: 0, section: 9",
                          "address: 0, section: 0",
                          "address: 0, initial: 70000",
                          "address: 0, format: f64",
                          "address: 0, stride: -1",
                          "address: 0, format: u32, stride: 1",
                          "address: 0, bits: [{bit: 16, signal: ready}]",
                          "address: 0, values: [{count: 1}]",
                          "address: 0, content: abc",
                          "address: 0, access: maybe"}) {
    EXPECT_NE(faults_of(with_register("{name: a, table: holding, access: write, signal: command, " +
                                      std::string(bad) + "}")),
              "nothing")
        << bad;
  }
}

TEST(ValveMapFile, AFileThatIsNotThereSaysSo) {
  EXPECT_THROW((void)load_valve_map("/nowhere/valve.yaml"), ConfigurationError);
}

TEST(ValveMapFile, FormatsAndCountsThatFollowNeedNotBeWritten) {
  const ValveMap map = parse_valve_map(
      "always_enabled: true\n"
      "registers:\n"
      "  - {name: stop, table: coil, address: 0, access: write, signal: quick_stop}\n"
      "  - {name: ready, table: discrete, address: 0, signal: ready}\n"
      "  - {name: type, table: input, address: 0, signal: text, content: EHC-4}\n",
      "valve.yaml");
  EXPECT_EQ(map.registers[0].format, RegisterFormat::bit);
  EXPECT_EQ(map.registers[1].format, RegisterFormat::bit);
  EXPECT_EQ(map.registers[2].format, RegisterFormat::text);
  EXPECT_EQ(map.registers[2].count, 3);
  EXPECT_THAT(faults_of(with_register("{name: a, table: coil, address: 0, signal: ready, format: "
                                      "u16}")),
              HasSubstr("coils and discrete inputs have format bit"));
}

TEST(ValveMapFile, CountOfASignalThatIsThereOnceIsRefusedWithoutContradiction) {
  EXPECT_THAT(faults_of(with_register("{name: a, table: holding, address: 0, access: write, count: "
                                      "4, signal: enable}")),
              HasSubstr("count 4 of signal enable, which the amplifier has once, allowed: 1 "
                        "(signal enable_section is one for each section)"));
  EXPECT_THAT(faults_of(with_register("{name: a, table: holding, address: 0, count: 4, section: 6, "
                                      "signal: command}")),
              HasSubstr("count 4 of signal command from section 6 on, allowed: 1 .. 3, as there "
                        "are 8 sections"));
}

TEST(ValveMapFile, FunctionsThatLeaveATableOutOfReachAreRefused) {
  const std::string set = "{name: set, table: holding, address: 0, access: write, signal: command}";
  EXPECT_EQ(faults_of("functions: [3, 6]\n" + with_register(set)), "nothing");
  EXPECT_THAT(faults_of("functions: [3]\n" + with_register(set)),
              HasSubstr("none of the map's functions writes table holding"));
  EXPECT_THAT(faults_of("functions: [6]\n" + with_register(set)),
              HasSubstr("none of the map's functions reads table holding"));
  EXPECT_THAT(faults_of("functions: [3, 6, 99]\n" + with_register(set)),
              HasSubstr("functions: no function of a valve driver, found 99"));
}

}  // namespace
}  // namespace rigwire::hil
