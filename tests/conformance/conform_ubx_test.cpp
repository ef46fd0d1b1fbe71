// `rigwire conform ubx` on our receivers, each on a line of its own and with the profile that is
// delivered. What is broken is found in tests/conform, in simulated time.
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

struct UbxReceiver {
  const char* name;
  const char* type;
};
void PrintTo(const UbxReceiver& receiver, std::ostream* out) {
  *out << receiver.type;
}

class ConformUbx : public testing::TestWithParam<UbxReceiver> {
 protected:
  std::string endpoint() {
    const std::string rig = (wires_.folder / "rig.yaml").string();
    std::ofstream(rig) << "machine: {type: excavator, digs: false}\n"
                       << "devices:\n  gnss: {type: " << GetParam().type << ", baud: 115200}\n";
    return "'rig:" + rig + "#gnss@115200' ";
  }

  test::PrivateWires wires_;
};

const std::string kUbx = RIGWIRE_BINARY_DIR "/rigwire conform ubx ";

// All but timing, which is the host's on a busy machine, and what listens for long.
TEST_P(ConformUbx, OurReceiverPassesWhatItClaims) {
  const std::string file = (wires_.folder / "result.json").string();
  const std::string profile =
      std::string(RIGWIRE_SOURCE_DIR "/configs/profiles/") + GetParam().name + ".yaml";
  const ProgramResult ran = run_program(
      kUbx + endpoint() + "--profile " + profile + " --writes --json " + file +
          " ubx/32.2 ubx/32.4 ubx/32.5.1 ubx/32.10.19 ubx/32.10.25 ubx/32.16.13 ubx/32.17.17 "
          "ubx/3.10.24 ubx/3.10.25 ubx/epoch",
      120);
  EXPECT_EQ(ran.exit_code, 0) << ran.text;
  std::ifstream stream(file);
  ASSERT_TRUE(stream) << ran.text;
  const Json result = Json::parse(stream);
  EXPECT_EQ(result.at("counts").at("fail"), 0) << ran.text;
  EXPECT_EQ(result.at("counts").at("lenient"), 0) << ran.text;
  EXPECT_EQ(result.at("counts").at("error"), 0) << ran.text;
  EXPECT_GT(result.at("counts").at("pass"), 50) << ran.text;
}

TEST_P(ConformUbx, AProfileThatWasAskedForIsTheOneThatIsDelivered) {
  const ProgramResult asked = run_program(kUbx + endpoint() + "--make-profile", 60);
  ASSERT_EQ(asked.exit_code, 0) << asked.text;
  std::ifstream stream(std::string(RIGWIRE_SOURCE_DIR "/configs/profiles/") + GetParam().name +
                       ".yaml");
  const std::string delivered{std::istreambuf_iterator<char>(stream), {}};
  const auto messages = [](const std::string& text) {
    const std::size_t at = text.find("messages: [");
    return text.substr(at, text.find(']', at) - at);
  };
  EXPECT_EQ(messages(asked.text), messages(delivered));
  EXPECT_THAT(asked.text, testing::HasSubstr("rate: 1 Hz"));
}

INSTANTIATE_TEST_SUITE_P(, ConformUbx,
                         testing::Values(UbxReceiver{"ublox_neo_7p", "ublox-neo-7p"},
                                         UbxReceiver{"ublox_neo_m8", "ublox-neo-m8"},
                                         UbxReceiver{"ublox_zed_f9p", "ublox-zed-f9p"}),
                         [](const auto& receiver) { return std::string(receiver.param.name); });

}  // namespace
}  // namespace rigwire::conformance
