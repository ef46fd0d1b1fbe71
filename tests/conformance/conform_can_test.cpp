// `rigwire conform canopen` and `j1939` on our nodes, through the slcan adapter that a rig of ours
// is, with the profiles that are delivered. What is broken is found in tests/conform.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "modbus_programs.h"
#include "private_wires.h"

namespace rigwire::conformance {
namespace {

using Json = nlohmann::json;

struct CanNode {
  const char* name;
  const char* suite;
  const char* device;
  const char* profile;
  const char* cases;
  int least;  ///< That pass.
};
void PrintTo(const CanNode& node, std::ostream* out) {
  *out << node.name;
}

class ConformCan : public testing::TestWithParam<CanNode> {
 protected:
  test::PrivateWires wires_;
};

TEST_P(ConformCan, OurNodePassesWhatItClaims) {
  const CanNode& node = GetParam();
  const std::string rig = (wires_.folder / "rig.yaml").string();
  const std::string file = (wires_.folder / "result.json").string();
  std::ofstream(rig) << "machine: {type: excavator, digs: false}\n"
                     << "buses:\n  can: {wire: slcan, path: " << (wires_.folder / "can").string()
                     << "}\n"
                     << "devices:\n  node: {" << node.device << ", bus: can}\n";
  const ProgramResult ran =
      run_program(std::string(RIGWIRE_BINARY_DIR "/rigwire conform ") + node.suite +
                      " 'rig:" + rig + "#node' --profile " RIGWIRE_SOURCE_DIR "/configs/profiles/" +
                      node.profile + " --writes --json " + file + " " + node.cases,
                  100);
  EXPECT_EQ(ran.exit_code, 0) << ran.text;
  std::ifstream stream(file);
  ASSERT_TRUE(stream) << ran.text;
  const Json result = Json::parse(stream);
  EXPECT_EQ(result.at("counts").at("fail"), 0) << ran.text;
  EXPECT_EQ(result.at("counts").at("lenient"), 0) << ran.text;
  EXPECT_GE(result.at("counts").at("pass"), node.least) << ran.text;
}

INSTANTIATE_TEST_SUITE_P(
    , ConformCan,
    testing::Values(CanNode{"encoder", "canopen",
                            "type: cia406-encoder, node_id: 0x20, base: undercarriage, link: upper",
                            "cia406_encoder.yaml",
                            "canopen/7.2.4.3.5 canopen/7.2.4.3.6 canopen/7.2.4.3.17 "
                            "canopen/7.5.2 canopen/406 canopen/7.2.8.3.1.1 canopen-406",
                            90},
                    CanNode{"engine", "j1939", "type: engine-controller", "engine_controller.yaml",
                            "j1939-81 j1939/5.2 j1939/5.4.4 j1939/5.10.3 j1939/5.10.2.4", 12}),
    [](const auto& node) { return std::string(node.param.name); });

}  // namespace
}  // namespace rigwire::conformance
