// What a run records, judged by the tools that open it: tshark and capinfos, python-can, gpsd's
// decoder, and a reader of MCAP that shares nothing with us.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
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
using Json = nlohmann::json;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;
using testing::Not;

class RecordedRig : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire", "run", "excavator_pit",
                                   "--status", "none"};
    for (const auto& set : wires_.sets()) {
      words.insert(words.end(), {"--set", set});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::filesystem::path folder(const std::string& name) const {
    return wires_.folder / name;
  }
  /// What a shell command prints, which must end well.
  [[nodiscard]] std::string printed(const std::string& shell) const {
    const auto log = folder("printed.log");
    ChildProcess program({"bash", "-c", shell + " 2>" + folder("complaints.log").string()}, log);
    EXPECT_EQ(program.wait(), 0) << shell << "\n" << text(folder("complaints.log"));
    return program.output();
  }
  [[nodiscard]] static std::string text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::size_t lines(const std::string& shell) const {
    const std::string all = printed(shell);
    return static_cast<std::size_t>(std::ranges::count(all, '\n'));
  }
  [[nodiscard]] Json mcap(const std::string& recording) const {
    return Json::parse(printed("/usr/bin/python3 " RIGWIRE_SOURCE_DIR
                               "/tests/conformance/mcap_contents.py " +
                               (folder(recording) / "truth.mcap").string()));
  }
  void free_run(const std::string& recording, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"--clock", "free", "--duration", "2s"};
    if (!recording.empty()) {
      words.insert(words.end(), {"--record", folder(recording).string()});
    }
    words.insert(words.end(), more.begin(), more.end());
    ChildProcess rig(command(words), folder("rig.log"));
    ASSERT_EQ(rig.wait(), 0) << rig.output();
  }
  [[nodiscard]] std::string tshark(const std::string& recording, const std::string& more) const {
    return "tshark -r " + (folder(recording) / "all.pcapng").string() +
           " -d can.subdissector,j1939 -o mbtcp.tcp.port:" + std::to_string(wires_.modbus_port) +
           " " + more;
  }

  test::PrivateWires wires_;
};

TEST_F(RecordedRig, ToolsReadWhatDevicesAndClientsSaid) {
  ChildProcess rig(command({"--record", folder("a").string(), "--set",
                            "devices.gnss.faults=[{type: outage, at: 500 ms, for: 1 s}]"}),
                   folder("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_.are_up(); })) << rig.output();
  const std::string port = std::to_string(wires_.modbus_port);
  (void)printed("mbpoll -m tcp -p " + port + " -a 1 -0 -t 3 -r 30 -c 4 -1 127.0.0.1");
  (void)printed("mbpoll -m tcp -p " + port + " -a 1 -0 -t 4 -r 0 127.0.0.1 0 0 300");
  (void)printed(
      "/usr/bin/python3 -c 'import can, time\n"
      "bus = can.Bus(interface=\"slcan\", channel=\"" +
      wires_.can() +
      "\", bitrate=250000)\n"
      "bus.send(can.Message(arbitration_id=0x18EA80FE, data=[0xDA, 0xFE, 0]))\n"
      "end = time.monotonic() + 2\n"
      "while time.monotonic() < end: bus.recv(0.1)\n"
      "bus.shutdown()'");
  {  // a poll of MON-VER, and its answer
    const int line = ::open(wires_.gnss().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(line, 0);
    ASSERT_EQ(::write(line, "\xB5\x62\x0A\x04\x00\x00\x0E\x34", 8), 8);
    std::string taken;
    const bool answered = eventually([&] {
      std::array<char, 4096> bytes;
      for (ssize_t size = 0; (size = ::read(line, bytes.data(), bytes.size())) > 0;) {
        taken.append(bytes.data(), static_cast<std::size_t>(size));
      }
      return taken.find("\xB5\x62\x0A\x04") != std::string::npos;
    });
    ::close(line);
    EXPECT_TRUE(answered) << rig.output();
  }
  rig.signal(SIGINT);
  ASSERT_EQ(rig.wait(), 130) << rig.output();

  const std::string about = printed("capinfos " + (folder("a") / "all.pcapng").string());
  for (const char* expected :
       {"Strict time order:   True", "nanoseconds (9)", "Name = can", "Name = gnss", "Name = lidar",
        "Name = valves", "SocketCAN", "RTAC serial-line", "Ethernet"}) {
    EXPECT_THAT(about, HasSubstr(expected));
  }
  EXPECT_EQ(printed(tshark("a", "-Y '_ws.malformed || tcp.analysis.flags'")), "");
  // Modbus: each request has an answer of the same transaction.
  EXPECT_EQ(lines(tshark("a", "-Y 'modbus.func_code == 4 && frame.p2p_dir == 1'")), 1U);
  EXPECT_EQ(lines(tshark("a", "-Y 'modbus.func_code == 4 && modbus.request_frame'")), 1U);
  EXPECT_EQ(lines(tshark("a", "-Y 'modbus.func_code == 16'")), 2U);
  EXPECT_THAT(printed(tshark("a", "-Y 'modbus.func_code == 16' -V")),
              HasSubstr("Register 2 (UINT16): 300"));
  // J1939: the request, inbound, then the PGN that it asked for.
  EXPECT_EQ(lines(tshark("a", "-Y 'j1939.pgn == 59904 && frame.packet_flags_direction == 1'")), 1U);
  EXPECT_GT(lines(tshark("a", "-Y 'j1939.pgn == 61444 && frame.packet_flags_direction == 2'")),
            10U);
  EXPECT_GT(lines(tshark("a", "-Y 'udp.length == 1214 && frame.interface_name == \"lidar\"'")),
            100U);
  EXPECT_THAT(printed(tshark("a", "-Y frame.comment -T fields -e frame.comment")),
              HasSubstr("fault outage of gnss begins at 0.500 s"));

  // The bus as python-can reads it: as many frames, and the client's own as its own.
  const std::string log = (folder("a") / "wires/can.log").string();
  const Json frames = Json::parse(
      printed("/usr/bin/python3 -c 'import can, json\n"
              "all = list(can.LogReader(\"" +
              log +
              "\"))\n"
              "own = [m for m in all if not m.is_rx]\n"
              "ordered = all == sorted(all, key=lambda m: m.timestamp)\n"
              "print(json.dumps({\"all\": len(all), \"own\": [m.arbitration_id for m in own],"
              " \"data\": list(own[0].data), \"ordered\": ordered}))'"));
  EXPECT_EQ(frames["all"], lines(tshark("a", "-Y 'frame.interface_name == \"can\"'")));
  EXPECT_EQ(frames["own"], Json::array({0x18EA80FE}));
  EXPECT_EQ(frames["data"], Json::array({0xDA, 0xFE, 0}));
  EXPECT_EQ(frames["ordered"], true);

  // The receiver's line as gpsd decodes it; the poll and its answer.
  const auto line = folder("a") / "wires/gnss.bytes";
  EXPECT_THAT(printed("gpsdecode < " + line.string()), HasSubstr("\"class\":\"SKY\""));
  EXPECT_EQ(text(folder("a") / "wires/gnss.client"),
            std::string("\xB5\x62\x0A\x04\0\0\x0E\x34", 8));
  EXPECT_THAT(text(line), HasSubstr(std::string("\xB5\x62\x0A\x04", 4)));
  std::size_t of_device = 0;
  std::istringstream index(text(folder("a") / "wires/gnss.index"));
  for (std::string words; std::getline(index, words);) {
    std::istringstream row(words);
    double seconds = 0.0;
    std::string way;
    std::size_t offset = 0;
    std::size_t length = 0;
    if (row >> seconds >> way >> offset >> length && way == ">") {
      EXPECT_EQ(offset, of_device);
      of_device += length;
    }
  }
  EXPECT_EQ(of_device, std::filesystem::file_size(line));

  const Json contents = mcap("a");
  EXPECT_EQ(contents["whole"], true);
  EXPECT_EQ(contents["attachments"], Json::array({"rig.yaml"}));
  EXPECT_EQ(contents["topics"]["/tf"]["schema"], "foxglove.FrameTransforms");
  EXPECT_EQ(contents["topics"]["/tf"]["last"]["transforms"].size(), 5U);
  EXPECT_EQ(contents["topics"]["/antenna"]["last"]["frame_id"], "gnss");
  EXPECT_NEAR(contents["topics"]["/antenna"]["last"]["latitude"].get<double>(), 49.42, 0.01);
  EXPECT_GT(contents["topics"]["/events"]["messages"], 2);  // a fault's two ends, and clients
  EXPECT_TRUE(contents["topics"]["/truth"]["last"].contains("joint_rad"));
}

TEST_F(RecordedRig, AFreeRunRecordsTheSameBytesAndIsTheSameRun) {
  free_run("", {"--report", folder("report.json").string()});
  free_run("a", {"--report", folder("report_a.json").string()});
  free_run("b");
  EXPECT_EQ(printed("diff -r " + folder("a").string() + " " + folder("b").string()), "");
  const Json without = Json::parse(text(folder("report.json")));
  const Json with = Json::parse(text(folder("report_a.json")));
  for (const auto& [name, device] : without["devices"].items()) {
    EXPECT_EQ(device["stream_hash"], with["devices"][name]["stream_hash"]) << name;
    EXPECT_EQ(device["bytes"], with["devices"][name]["bytes"]) << name;
  }
  // The lidar's packets are all there.
  EXPECT_EQ(lines("tshark -r " + (folder("a") / "wires/lidar.pcapng").string()),
            with["devices"]["lidar"]["frames"].get<std::size_t>());
  // And the configuration in it is the run's own.
  const std::string checked = printed(RIGWIRE_BINARY_DIR "/rigwire check " +
                                      (folder("a") / "rig.yaml").string() + " --json");
  EXPECT_EQ(Json::parse(checked)["config_hash"], with["config_hash"]);
}

TEST_F(RecordedRig, OnlyWhatIsWantedIsRecorded) {
  free_run("a", {"--only", "can,gnss"});
  EXPECT_TRUE(std::filesystem::exists(folder("a") / "wires/can.pcapng"));
  EXPECT_TRUE(std::filesystem::exists(folder("a") / "wires/gnss.bytes"));
  EXPECT_FALSE(std::filesystem::exists(folder("a") / "wires/lidar.pcapng"));
  EXPECT_FALSE(std::filesystem::exists(folder("a") / "truth.mcap"));
  free_run("b", {"--only", "truth"});
  EXPECT_FALSE(std::filesystem::exists(folder("b") / "all.pcapng"));
  EXPECT_GT(mcap("b")["topics"]["/truth"]["messages"], 100);
  ChildProcess typo(command({"--record", folder("c").string(), "--only", "gnsss"}),
                    folder("rig.log"));
  EXPECT_EQ(typo.wait(), 2);
  EXPECT_THAT(typo.output(), HasSubstr("found \"gnsss\", allowed can, gnss, lidar, valves, truth, "
                                       "did you mean gnss?"));
  ChildProcess taken(command({"--record", folder("a").string()}), folder("rig.log"));
  EXPECT_EQ(taken.wait(), 3);
  EXPECT_THAT(taken.output(), HasSubstr("the folder is not empty"));
}

TEST_F(RecordedRig, ARunThatIsKilledLeavesFilesThatOpen) {
  ChildProcess rig(command({"--record", folder("a").string()}), folder("rig.log"));
  ASSERT_TRUE(eventually([&] {
    std::error_code none;
    return std::filesystem::file_size(folder("a") / "truth.mcap", none) > 400'000 && !none;
  })) << rig.output();
  rig.signal(SIGKILL);
  EXPECT_EQ(rig.wait(), 137);
  // tshark complains when a file is cut off within a packet, and shows what is before.
  const auto packets = folder("packets");
  ChildProcess shown({"bash", "-c", tshark("a", "> " + packets.string())}, folder("tshark.log"));
  EXPECT_TRUE(shown.wait().has_value());
  const std::string all = text(packets);
  EXPECT_GT(std::ranges::count(all, '\n'), 1'000);
  const Json contents = mcap("a");
  EXPECT_EQ(contents["whole"], false);
  EXPECT_GT(contents["topics"]["/truth"]["messages"], 50);
  const std::string rigwire = RIGWIRE_BINARY_DIR "/rigwire record ";
  EXPECT_THAT(printed(rigwire + "info " + folder("a").string()), HasSubstr("the run was killed"));
  EXPECT_THAT(printed(rigwire + "cut " + folder("a").string() + " -o " + folder("b").string()),
              Not(HasSubstr("killed")));
  EXPECT_EQ(mcap("b")["whole"], true);
}

TEST_F(RecordedRig, AFullDiskIsToldAtOnceAndHoldsUpNoWire) {
  free_run("", {"--report", folder("report.json").string()});
  std::string shell = "trap '' XFSZ; ulimit -f 1000; exec";
  for (const std::string& word :
       command({"--clock", "free", "--duration", "2s", "--record", folder("a").string(), "--report",
                folder("report_a.json").string()})) {
    shell += " '" + word + "'";
  }
  ChildProcess rig({"bash", "-c", shell}, folder("rig.log"));
  EXPECT_EQ(rig.wait(), 1) << rig.output();
  EXPECT_THAT(rig.output(), HasSubstr("error: the recording is not complete: "));
  EXPECT_THAT(rig.output(), HasSubstr("lidar.pcapng loses what passes: File too large"));
  const Json without = Json::parse(text(folder("report.json")));
  const Json with = Json::parse(text(folder("report_a.json")));
  for (const auto& [name, device] : without["devices"].items()) {
    EXPECT_EQ(device["stream_hash"], with["devices"][name]["stream_hash"]) << name;
  }
  EXPECT_GT(lines("tshark -r " + (folder("a") / "wires/lidar.pcapng").string()), 100U);
  const Json recording = Json::parse(text(folder("a") / "recording.json"));
  for (const Json& wire : recording["wires"]) {
    if (wire["name"] == "lidar") {
      EXPECT_GT(wire["lost"], 100);
    }
  }
}

}  // namespace
}  // namespace rigwire
