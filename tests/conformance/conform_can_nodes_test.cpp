// `rigwire conform` against nodes on CAN that software of others makes: a J1939 node on Debian's
// python-can, whose adapter's line is one end of a null modem. Cases that judge this machine's pace
// are left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "child_process.h"
#include "conform_result.h"
#include "private_wires.h"

namespace rigwire::conformance {
namespace {

using testing::IsEmpty;

class ConformPythonCan : public testing::Test {
 protected:
  ConformPythonCan() {
    std::ofstream(profile_) << "address: 40\n"
                               "periodic: [65262 every 1000 ms, 65265 every 100 ms]\n"
                               "requested: [65262, 65265, 65259]\n";
  }
  void SetUp() override {
    ASSERT_TRUE(test::eventually([&] { return node_.output() == "claimed\n"; })) << node_.output();
  }
  Conformed conform(const std::string& more) {
    return conformed(wires_.folder, "j1939 " + endpoint_ + " " + more);
  }

  test::PrivateWires wires_;
  std::string line_ = (wires_.folder / "line").string();
  std::string endpoint_ = "slcan:" + line_;
  std::string profile_ = (wires_.folder / "profile.yaml").string();
  test::ChildProcess node_{
      {"/usr/bin/python3", RIGWIRE_SOURCE_DIR "/tests/conformance/python_can_node.py", "slcan",
       line_},
      wires_.folder / "node.log"};
};

TEST_F(ConformPythonCan, ANodeFailsNowhereAndIsGivenItsAddressBack) {
  const Conformed found =
      conform("--profile " + profile_ + " --writes --moves " + endpoint_ +
              " j1939-81 j1939/5.2 j1939/5.4.4 j1939/5.4.2/25 j1939/5.10.3 j1939/5.10.2.4"
              " j1939-71/CCVS1/2 j1939-71/CCVS1/3");
  EXPECT_EQ(found.exit_code, 0) << found.text << node_.output();
  EXPECT_THAT(found.with("lenient"), IsEmpty()) << found.text;
  EXPECT_GE(found.count("pass"), 21U) << found.text;
  EXPECT_THAT(found.text, testing::HasSubstr("by a commanded address"));
}

TEST_F(ConformPythonCan, AProfileIsWhatTheNodeSays) {
  const ProgramResult asked =
      run_program(RIGWIRE_BINARY_DIR "/rigwire conform j1939 " + endpoint_ + " --make-profile", 60);
  EXPECT_EQ(asked.exit_code, 0) << asked.text << node_.output();
  EXPECT_THAT(asked.text, testing::HasSubstr("address: 40"));
  EXPECT_THAT(asked.text, testing::HasSubstr("65265 every 100 ms"));
  EXPECT_THAT(asked.text, testing::HasSubstr("65259"));
}

// A claim that is too much is found: the node has no trip distance.
TEST_F(ConformPythonCan, AGroupThatItDoesNotHaveIsMissed) {
  std::ofstream(profile_) << "address: 40\nrequested: [65248]\n";
  const Conformed found = conform("--profile " + profile_ + " j1939/5.4.2");
  EXPECT_EQ(found.exit_code, 5) << found.text;
  EXPECT_THAT(found.with("fail"), testing::ElementsAre("j1939/5.4.2/10")) << found.text;
}

}  // namespace
}  // namespace rigwire::conformance
