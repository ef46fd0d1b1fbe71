// `rigwire conform` against our devices on live wires of a rig that is started for it: receivers,
// nodes on CAN, a lidar, a camera. The machine digs nothing, and stands unless its valves are
// commanded, so that the rig keeps up with the clock; chapters and cases that judge this machine's
// pace are left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <ostream>
#include <regex>
#include <string>

#include "conform_result.h"
#include "private_wires.h"

namespace rigwire::conformance {
namespace {

struct Live {
  const char* name;
  const char* suite;
  const char* devices;  ///< YAML of the rig behind its machine.
  const char* device;   ///< Behind the #.
  const char* profile;  ///< In configs/profiles, or none.
  const char* options;
  std::size_t least;  ///< Cases that pass.
  bool moves = false;
};
void PrintTo(const Live& live, std::ostream* out) {
  *out << live.name;
}

class ConformLive : public testing::TestWithParam<Live> {
 protected:
  /// A copy of the profile that waits longer for an answer: the machine may be busy.
  std::string patient_profile(const std::string& name) {
    std::ifstream stream(RIGWIRE_SOURCE_DIR "/configs/profiles/" + name);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    static const std::regex patience("\\npatience: [^\n]*");
    EXPECT_TRUE(std::regex_search(text, patience)) << name;
    const std::string file = (wires_.folder / name).string();
    std::ofstream(file) << std::regex_replace(text, patience, "\npatience: 2500 ms");
    return file;
  }

  test::PrivateWires wires_;
};

TEST_P(ConformLive, OurDeviceFailsNowhere) {
  const Live& live = GetParam();
  const std::string rig = (wires_.folder / "rig.yaml").string();
  std::ofstream(rig) << "machine: {type: excavator, digs: false}\n" << live.devices;
  const std::string endpoint = " 'rig:" + rig + "#" + live.device + "' ";
  std::string options = live.options;
  if (live.profile != nullptr) {
    options += " --profile '" + patient_profile(live.profile) + "'";
  }
  const Conformed found =
      conformed(wires_.folder, live.suite + endpoint + options +
                                   (live.moves ? " --moves" + endpoint : std::string()));
  EXPECT_EQ(found.exit_code, 0) << found.text;
  ASSERT_FALSE(found.result.is_null()) << found.text;
  EXPECT_GE(found.count("pass"), live.least) << found.text;
}

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): a literal that stands within literals.
#define PROFILE "--profile " RIGWIRE_SOURCE_DIR "/configs/profiles/"

INSTANTIATE_TEST_SUITE_P(
    , ConformLive,
    testing::Values(
        Live{"ubx_neo_m8", "ubx", "devices:\n  gnss: {type: ublox-neo-m8, baud: 115200}\n",
             "gnss@115200", "ublox_neo_m8.yaml",
             "--writes ubx/32.2 ubx/32.5.1 ubx/32.10.18 ubx/32.10.27 "
             "ubx/32.17.17",
             35},
        Live{"canopen_encoder", "canopen",
             "buses:\n  can: {}\ndevices:\n  encoder: {type: cia406-encoder, bus: can, node_id: "
             "0x20, "
             "base: undercarriage, link: upper, resolution: 14, event_timer: 20, "
             "starts_itself: true}\n",
             "encoder", "cia406_encoder.yaml",
             "--writes canopen/7.2.4.1 canopen/7.2.4.3.17 "
             "canopen/7.2.4.3.6 canopen/7.2.8.3.1.1 canopen-406",
             25},
        Live{"j1939_engine", "j1939",
             "buses:\n  can: {}\ndevices:\n  engine: {type: engine-controller, bus: can}\n",
             "engine", "engine_controller.yaml",
             "--writes j1939/5.4.4 j1939/5.10.3 j1939/5.10.2.4 j1939-81", 17, true},
        Live{
            "iso_valves", "iso11783-valves",
            "buses:\n  can: {}\ndevices:\n  valves: {type: iso-valves, bus: can, first_valve: 1}\n",
            "valves", "iso_valves.yaml",
            "--writes iso11783-valves/NAME iso11783-valves/FUNC "
            "iso11783-valves/AVC/1 iso11783-valves/AVC/2 iso11783-valves/AVC/3 "
            "iso11783-valves/AVC/4 "
            "iso11783-valves/AVC/5 iso11783-valves/AVC/6 iso11783-valves/AVC/7 "
            "iso11783-valves/AVC/8 iso11783-valves/AVC/9 iso11783-valves/AVC/10 "
            "iso11783-valves/AVC/11",
            15, true},
        Live{"velodyne_vlp_16", "velodyne", "devices:\n  lidar: {type: velodyne-vlp-16}\n", "lidar",
             nullptr,
             "--listen 3s velodyne/data velodyne/azimuth velodyne/returns velodyne/position "
             "velodyne/time/2 velodyne/time/4 velodyne/time/6",
             25}),
    [](const auto& live) { return std::string(live.param.name); });

TEST(ConformMoves, LeaveIsForThisEndpointAndForSuitesThatMove) {
  const test::PrivateWires wires;
  const Conformed another =
      conformed(wires.folder,
                "iso11783-valves can:none0 --moves can:none1 " PROFILE "iso_valves.yaml --writes");
  EXPECT_EQ(another.exit_code, 2);
  EXPECT_THAT(another.text,
              testing::HasSubstr("--moves: found \"can:none1\", allowed \"can:none0\""));
  const Conformed still =
      conformed(wires.folder, "canopen can:none0 --moves can:none0 " PROFILE "cia406_encoder.yaml");
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_THAT(still.text, testing::HasSubstr("--moves: found \"canopen\", allowed a suite with"));
  // With leave it comes as far as the bus, which there is not.
  const Conformed given = conformed(
      wires.folder, "iso11783-valves can:none0 --moves can:none0 " PROFILE "iso_valves.yaml");
  EXPECT_EQ(given.exit_code, 3) << given.text;
}

TEST(ConformGigeVision, OurCameraFailsNowhere) {
  const test::PrivateWires wires;
  const std::string rig = (wires.folder / "rig.yaml").string();
  std::ofstream(rig)
      << "machine: {type: excavator, digs: false}\n"
         "devices:\n"
         "  camera: {type: gige-camera, sensor: {image_sensor: {width: 128, height: 96}}}\n";
  const Conformed found = conformed(
      wires.folder, "gige-vision 'rig:" + rig +
                        "#camera' " PROFILE
                        "gige_camera.yaml --writes gige-vision/discovery gige-vision/reading "
                        "gige-vision/registers gige-vision/memory gige-vision/description "
                        "gige-vision/acknowledge gige-vision/control gige-vision/stream");
  EXPECT_EQ(found.exit_code, 0) << found.text;
  EXPECT_GE(found.count("pass"), 80U) << found.text;
}

}  // namespace
}  // namespace rigwire::conformance
