// Wires of a running rig as interfaces of tshark.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

class Extcap : public testing::Test {
 protected:
  Extcap() {
    const fs::path extcap = wires_.folder / "home/.config/wireshark/extcap";
    fs::create_directories(extcap);
    fs::create_directories(wires_.folder / "runs");
    fs::create_symlink(RIGWIRE_SOURCE_DIR "/python/rigwire/extcap.py", extcap / "rigwire");
  }

  [[nodiscard]] std::vector<std::string> run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire", "run", "excavator_pit",
                                   "--status", "none"};
    for (const auto& set : wires_.sets()) {
      words.insert(words.end(), {"--set", set});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::string place(const std::string& name) const {
    return (wires_.folder / "runs" / name).string();
  }
  /// What it prints; it must end well.
  [[nodiscard]] std::string tshark(const std::string& arguments) const {
    ChildProcess program(
        {"bash", "-c",
         "export HOME=" + (wires_.folder / "home").string() + " XDG_CONFIG_HOME= RIGWIRE_EXTCAP=" +
             (wires_.folder / "runs").string() + "; tshark " + arguments},
        wires_.folder / "tshark.log");
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  }

  test::PrivateWires wires_;
};

TEST_F(Extcap, ARecordingThatIsWrittenIsSeenLiveAsAWholeAndWireByWire) {
  ChildProcess rig(run({"--record", place("dig")}), wires_.folder / "rig.log");
  ASSERT_TRUE(eventually([&] { return fs::exists(place("dig") + "/recording.json"); }))
      << rig.output();
  EXPECT_THAT(tshark("-D"), AllOf(HasSubstr("rigwire-dig (Rigwire: "),
                                  HasSubstr("rigwire-dig-lidar"), HasSubstr("rigwire-dig-gnss")));
  const std::string bus = tshark(
      "-i rigwire-dig-can -c 40 -d can.subdissector,j1939 -T fields -e frame.interface_name "
      "-e frame.protocols");
  EXPECT_THAT(bus, AllOf(HasSubstr("can\t"), HasSubstr("j1939"), Not(HasSubstr("lidar"))));
  const std::string all = tshark("-i rigwire-dig -c 4000 -T fields -e frame.interface_name");
  EXPECT_THAT(all, AllOf(HasSubstr("can\n"), HasSubstr("lidar\n"), HasSubstr("gnss\n")));
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
  EXPECT_THAT(tshark("-D"), Not(HasSubstr("rigwire-dig")));
}

TEST_F(Extcap, ARunWithAControlSocketIsRecordedWhileItIsLookedAt) {
  ChildProcess rig(run({"--control", "unix:" + place("pit")}), wires_.folder / "rig.log");
  ASSERT_TRUE(eventually([&] { return wires_.are_up() && fs::exists(place("pit")); }))
      << rig.output();
  EXPECT_THAT(tshark("-i rigwire-pit -c 400 -T fields -e frame.interface_name"),
              AllOf(HasSubstr("can\n"), HasSubstr("lidar\n")));
  // Its recording is over: another one can begin.
  EXPECT_TRUE(eventually([&] {
    ChildProcess again(
        {RIGWIRE_BINARY_DIR "/rigwire", "ctl", "unix:" + place("pit"), "record", place("again")},
        wires_.folder / "ctl.log");
    return again.wait() == 0;
  })) << rig.output();
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
}

}  // namespace
}  // namespace rigwire
