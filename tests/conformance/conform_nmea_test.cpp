// `rigwire conform nmea` listens to our receivers, each on a line of its own.
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

struct Receiver {
  const char* name;
  const char* type;
};
void PrintTo(const Receiver& receiver, std::ostream* out) {
  *out << receiver.type;
}

class ConformNmea : public testing::TestWithParam<Receiver> {
 protected:
  test::PrivateWires wires_;
};

TEST_P(ConformNmea, OurReceiverSaysNothingWrong) {
  const std::string type = GetParam().type;
  const std::string rig = (wires_.folder / "rig.yaml").string();
  const std::string file = (wires_.folder / "result.json").string();
  std::ofstream(rig) << "machine: {type: excavator, digs: false}\n"
                     << "devices:\n  gnss: {type: " << type << ", baud: 115200}\n";
  const ProgramResult ran = run_program(RIGWIRE_BINARY_DIR "/rigwire conform nmea 'rig:" + rig +
                                            "#gnss@115200' --listen 8s --json " + file,
                                        60);
  EXPECT_EQ(ran.exit_code, 0) << ran.text;
  std::ifstream stream(file);
  ASSERT_TRUE(stream) << ran.text;
  const Json result = Json::parse(stream);
  EXPECT_EQ(result.at("counts").at("fail"), 0) << ran.text;
  EXPECT_EQ(result.at("counts").at("lenient"), 0) << ran.text;
  EXPECT_GT(result.at("counts").at("pass"), 20) << ran.text;
}

INSTANTIATE_TEST_SUITE_P(, ConformNmea,
                         testing::Values(Receiver{"neo_7p", "ublox-neo-7p"},
                                         Receiver{"neo_m8", "ublox-neo-m8"},
                                         Receiver{"neo_m8t", "ublox-neo-m8t"},
                                         Receiver{"zed_f9p", "ublox-zed-f9p"}),
                         [](const auto& receiver) { return std::string(receiver.param.name); });

}  // namespace
}  // namespace rigwire::conformance
