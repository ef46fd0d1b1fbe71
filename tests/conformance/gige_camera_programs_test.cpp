// Aravis' own programs, unmodified, against cameras of a running rig: found, described, set,
// streamed from; with packets that are lost, and with clients that are killed. A program that is
// not installed is a failure.
//
// How many pictures come in a second depends on what else the machine does: they are rendered in
// what time everybody leaves, and a camera skips what it has no time for. A quiet machine shows a
// hundred of them at the first try, one with twenty programs beside a handful in a minute or two.
// So what is judged is not their number: none may fail, and every picture that the camera had must
// have come.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "gige_camera_rig.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
using ::testing::HasSubstr;

/// Time for a picture on a busy machine, and packets that come no faster than a client that has to
/// share it can take them: twice what 20 pictures a second need.
constexpr const char* kSlow = "    processing: 6 s\n    throughput: 100 Mbit/s\n";

/// Looks into the sky, which costs a third of what the ground does, and as much to send.
std::vector<std::string> to_the_sky(const std::string& camera) {
  return {"--set", "devices." + camera + ".mount.rotation.pitch=-60 deg"};
}

class GigeCameraPrograms : public ::testing::Test {
 protected:
  /// What a program has said, when it has ended; it must end well.
  std::string run(const std::vector<std::string>& command) {
    const auto log = scratch_.folder / ("program" + std::to_string(++runs_) + ".log");
    ChildProcess program(command, log);
    EXPECT_EQ(program.wait(), 0) << command[0] << ": " << program.output();
    return program.output();
  }
  std::string tool(const std::string& address, std::vector<std::string> arguments) {
    std::vector<std::string> command{"arv-tool-0.8"};
    if (!address.empty()) {
      command.insert(command.end(), {"-a", address});
    }
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run(command);
  }
  /// By broadcast, until a camera at that address has answered.
  void await(GigeCameraRig& rig, const std::string& address) {
    ASSERT_TRUE(eventually([&] { return tool("", {}).find(address) != std::string::npos; }))
        << rig.process->output();
  }
  static std::vector<std::string> camera_test(const std::string& address,
                                              const std::vector<std::string>& more = {}) {
    std::vector<std::string> command{
        "stdbuf", "-oL", "arv-camera-test-0.8", "--no-packet-socket", "-n", address, "-f", "20"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  /// A number of the summary: "n_completed_buffers    = 97".
  static int number(const std::string& text, const std::string& name) {
    const std::size_t at = text.rfind(name);
    int value = -1;
    if (at != std::string::npos) {
      (void)std::sscanf(text.c_str() + at + name.size(), " = %d", &value);
    }
    EXPECT_GE(value, 0) << name << " is not in: " << text;
    return value;
  }

  /// Patient with a client that the machine does not run for a while.
  inline static const std::vector<std::string> kPatient{"-m", "10000", "-q", "2"};

  /// What arv-camera-test says, which is interrupted when `enough` of it is there.
  std::string stream_until(const std::string& address, const std::vector<std::string>& options,
                           const std::function<bool(const std::string&)>& enough) {
    ChildProcess program(camera_test(address, options),
                         scratch_.folder / ("program" + std::to_string(++runs_) + ".log"));
    EXPECT_TRUE(eventually([&] { return enough(program.output()) || program.wait(0s); }))
        << program.output();
    const auto interrupted = std::chrono::steady_clock::now();
    program.signal(SIGINT);
    EXPECT_EQ(program.wait(), 0) << program.output();
    ending_ += std::chrono::steady_clock::now() - interrupted;
    return program.output();
  }
  /// Streams until a picture has come. None may fail.
  void stream(const std::string& address, const std::vector<std::string>& more = {}) {
    std::vector<std::string> options = kPatient;
    options.insert(options.end(), more.begin(), more.end());
    const std::string said = stream_until(address, options, a_picture_came);
    completed_ += number(said, "n_completed_buffers");
    EXPECT_EQ(number(said, "n_failures"), 0) << said;
    ++streams_;
    EXPECT_GE(completed_, 1);
  }
  /// It says each second how many came in it: "  3 frames - 0.9 MiB/s".
  static bool a_picture_came(const std::string& said) {
    static const std::regex some("[1-9][0-9.]* frames?");
    return std::regex_search(said, some);
  }
  /// Ends the run. Every picture that the camera was handed has come; but for those that were on
  /// their way when a client was interrupted, and those of the time that it took to end.
  void expect_all_came(GigeCameraRig& rig, const std::string& camera) const {
    constexpr int kOnTheirWay = 5;
    const auto report = nlohmann::json::parse(rig.report());
    const auto& counts = report["devices"][camera]["counts"];
    EXPECT_EQ(counts["lost_pictures"], 0);
    EXPECT_GE(counts["pictures"].get<int>(), completed_);
    const double while_ending = 20.0 * std::chrono::duration<double>(ending_).count();
    EXPECT_LE(counts["pictures"].get<int>(),
              completed_ + kOnTheirWay * streams_ + static_cast<int>(std::ceil(while_ending)));
    EXPECT_TRUE(counts.contains("skipped_pictures"));
  }

  test::PrivateWires scratch_;
  int runs_ = 0;
  int streams_ = 0;
  int completed_ = 0;
  std::chrono::steady_clock::duration ending_{};
};

TEST_F(GigeCameraPrograms, arv_tool_finds_describes_reads_and_writes) {
  const std::string address = own_address();
  const std::string other = own_address();
  GigeCameraRig rig(camera_yaml("left", "gige-camera", address) +
                    camera_yaml("right", "gige-camera", other));
  await(rig, address);
  const std::string list = tool("", {});
  EXPECT_THAT(list, HasSubstr("Rigwire-AreaCamera-left"));
  EXPECT_THAT(list, HasSubstr(other));

  EXPECT_THAT(tool(address, {"genicam"}), HasSubstr("<RegisterDescription"));
  EXPECT_THAT(tool(address, {"features"}), HasSubstr("AcquisitionFrameRate"));
  const std::string values =
      tool(address, {"control", "Width=320", "OffsetX=64", "Width", "OffsetX", "ExposureTime=2500",
                     "ExposureTime", "PixelFormat=Mono12", "PixelFormat", "DeviceVendorName"});
  EXPECT_THAT(values, HasSubstr("Width = 320"));
  EXPECT_THAT(values, HasSubstr("OffsetX = 64"));
  EXPECT_THAT(values, HasSubstr("ExposureTime = 2500"));
  EXPECT_THAT(values, HasSubstr("PixelFormat = Mono12"));
  EXPECT_THAT(values, HasSubstr("DeviceVendorName = Rigwire"));
  // The one beside it has heard nothing of that.
  EXPECT_THAT(tool(other, {"control", "Width"}), HasSubstr("Width = 640"));
}

TEST_F(GigeCameraPrograms, arv_camera_test_streams_without_a_failed_buffer) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("steady", "gige-camera", address, kSlow), to_the_sky("steady"));
  await(rig, address);
  stream(address);
  expect_all_came(rig, "steady");
}

TEST_F(GigeCameraPrograms, lost_packets_are_sent_again_where_they_are_asked_for) {
  const std::string address = own_address();
  GigeCameraRig rig(
      camera_yaml("lossy", "gige-camera", address,
                  std::string(kSlow) + "    faults: [{type: lost, at: 0 s, for: 1000 s, "
                                       "share: 1 %}]\n"),
      to_the_sky("lossy"));
  await(rig, address);
  // Small packets, so that each picture loses some.
  const std::vector<std::string> small{"-i", "1500", "-j", "never"};
  stream(address, small);
  // Without asking again some are torn.
  static const std::regex errors("- [1-9][0-9]* error");
  const std::string torn =
      stream_until(address, {"-i", "1500", "-j", "never", "-r"},
                   [](const std::string& said) { return std::regex_search(said, errors); });
  EXPECT_GT(number(torn, "n_failures"), 0) << torn;
}

TEST_F(GigeCameraPrograms, client_that_is_killed_leaves_the_camera_to_the_next) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("left_alone", "gige-camera", address, kSlow),
                    to_the_sky("left_alone"));
  await(rig, address);
  {
    ChildProcess killed(camera_test(address), scratch_.folder / "killed.log");
    ASSERT_TRUE(eventually([&] { return killed.output().find("frames/s") != std::string::npos; }))
        << killed.output();
    killed.signal(SIGKILL);
    killed.wait();
  }
  // Its heartbeat has to run out first, 3 s of the rig's time; until then nobody else may write.
  ASSERT_TRUE(eventually([&] {
    ChildProcess next({"arv-tool-0.8", "-a", address, "control", "Width=320"},
                      scratch_.folder / "next.log");
    (void)next.wait();
    return tool(address, {"control", "Width"}).find("Width = 320") != std::string::npos;
  }));
  stream(address);
}

/// The command run by an ordinary user, whose clients cannot open packet sockets.
std::vector<std::string> unprivileged(const std::vector<std::string>& command) {
  std::vector<std::string> all;
  if (::getuid() == 0) {
    all = {"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"};
  }
  all.insert(all.end(), command.begin(), command.end());
  return all;
}

TEST_F(GigeCameraPrograms, gstreamer_and_opencv_read_pictures) {
  const std::string address = own_address();
  GigeCameraRig rig(
      camera_yaml("gst", "gige-camera", address, "    rate: 5 Hz\n    exposure: 600 us\n"));
  await(rig, address);
  std::filesystem::permissions(scratch_.folder, std::filesystem::perms::all);
  ::setenv("GST_REGISTRY", (scratch_.folder / "registry.bin").c_str(), 1);
  const auto png = scratch_.folder / "picture.png";
  // The source ends its stream when no picture has come for two seconds. A busy host takes that
  // long for a whole picture: both programs take a part of it.
  std::string said;
  ASSERT_TRUE(eventually([&] {
    ChildProcess launch(
        unprivileged({"gst-launch-1.0", "aravissrc", "camera-name=" + address, "num-buffers=2",
                      "offset-x=240", "offset-y=240", "!",
                      "video/x-raw,format=GRAY8,width=160,height=120", "!", "videoconvert", "!",
                      "pngenc", "snapshot=true", "!", "filesink", "location=" + png.string()}),
        scratch_.folder / "launch.log");
    const bool ended_well = launch.wait() == 0;
    said = launch.output();
    return ended_well;
  })) << said;
  ASSERT_TRUE(std::filesystem::exists(png));
  EXPECT_GT(std::filesystem::file_size(png), 2000U);

  const auto script = scratch_.folder / "read.py";
  std::ofstream(script) << R"(
import sys, cv2
still = cv2.imread(sys.argv[2], cv2.IMREAD_GRAYSCALE)
assert still.shape == (120, 160)
assert still.std() > 5, 'nothing to see'
for attempt in range(10):
    stream = cv2.VideoCapture('aravissrc camera-name=' + sys.argv[1] +
                              ' offset-x=240 offset-y=240 ! '
                              'video/x-raw,format=GRAY8,width=160,height=120 ! appsink',
                              cv2.CAP_GSTREAMER)
    came = 0
    while came < 5 and stream.isOpened():
        ok, next_picture = stream.read()
        if not ok:
            break
        picture = next_picture
        assert picture.shape[:2] == (120, 160)
        came += 1
    stream.release()
    if came == 5:
        break
assert came == 5, came
# The machine stands: but for noise the stream shows what the still shows.
difference = cv2.absdiff(still, picture if picture.ndim == 2 else picture[:, :, 0])
assert difference.mean() < 4, difference.mean()
print('seen')
)";
  EXPECT_THAT(run(unprivileged({"/usr/bin/python3", script.string(), address, png.string()})),
              HasSubstr("seen"));
}

}  // namespace
}  // namespace rigwire::conformance
