// A recorded run with its clients once more: equal, and a byte that was changed is named.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
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

class ReplayedRig : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path folder(const std::string& name) const {
    return wires_.folder / name;
  }
  [[nodiscard]] std::vector<std::string> run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{kProgram, "run",      "excavator_pit",     "--status",
                                   "none",   "--record", folder("a").string()};
    for (const auto& set : wires_.sets()) {
      words.insert(words.end(), {"--set", set});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Its exit code; what it printed is in `printed_`.
  int verify() {
    ChildProcess program({kProgram, "replay", folder("a").string(), "--verify"},
                         folder("verify.log"));
    const int code = program.wait().value_or(-1);
    printed_ = program.output();
    return code;
  }
  /// What a shell command prints, which must end well.
  void shell(const std::string& command) const {
    ChildProcess program({"bash", "-c", command}, folder("shell.log"));
    ASSERT_EQ(program.wait(), 0) << command << "\n" << program.output();
  }
  void free_run() const {
    ChildProcess rig(run({"--clock", "free", "--duration", "1s"}), folder("rig.log"));
    ASSERT_EQ(rig.wait(), 0) << rig.output();
  }
  /// Turns one bit of the byte `behind` the first place where `pattern` stands, in the later half.
  void damage(const std::string& file, const std::string& pattern, std::size_t behind) const {
    const auto path = folder("a") / file;
    std::ifstream in(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::size_t at = bytes.find(pattern, bytes.size() / 2);
    ASSERT_NE(at, std::string::npos);
    bytes[at + behind] = static_cast<char>(bytes[at + behind] ^ 1);
    std::ofstream(path, std::ios::binary) << bytes;
  }

  static constexpr const char* kProgram = RIGWIRE_BINARY_DIR "/rigwire";
  test::PrivateWires wires_;
  std::string printed_;
};

TEST_F(ReplayedRig, WithClientsOfModbusUbxAndCanIsTheSameRunAgain) {
  ChildProcess rig(run({}), folder("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_.are_up(); })) << rig.output();
  const std::string port = std::to_string(wires_.modbus_port);
  shell("mbpoll -m tcp -p " + port + " -a 1 -0 -t 3 -r 30 -c 4 -1 127.0.0.1");
  shell("mbpoll -m tcp -p " + port + " -a 1 -0 -t 4 -r 0 127.0.0.1 0 0 0");
  shell(
      "/usr/bin/python3 -c 'import can, time\n"
      "bus = can.Bus(interface=\"slcan\", channel=\"" +
      wires_.can() +
      "\", bitrate=250000)\n"
      "for i in range(20):\n"
      "  bus.send(can.Message(arbitration_id=0x18EA80FE, data=[0xDA, 0xFE, 0]))\n"
      "  time.sleep(0.01)\n"
      "bus.shutdown()'");
  {  // a poll of MON-VER, and its answer
    const int line = ::open(wires_.gnss().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(line, 0);
    ASSERT_EQ(::write(line, "\xB5\x62\x0A\x04\x00\x00\x0E\x34", 8), 8);
    std::string taken;
    EXPECT_TRUE(eventually([&] {
      std::array<char, 4096> bytes;
      for (ssize_t size = 0; (size = ::read(line, bytes.data(), bytes.size())) > 0;) {
        taken.append(bytes.data(), static_cast<std::size_t>(size));
      }
      return taken.find("\xB5\x62\x0A\x04") != std::string::npos;
    })) << rig.output();
    ::close(line);
  }
  // Beside the running rig, whose wires it must leave alone.
  rig.signal(SIGINT);
  ASSERT_EQ(rig.wait(), 130) << rig.output();
  EXPECT_EQ(verify(), 0) << printed_;
  EXPECT_THAT(printed_, AllOf(HasSubstr("gnss      clients  1 "), HasSubstr("equal to ")));
}

TEST_F(ReplayedRig, ARunInRealTimeThatClientAndHandMoveIsTheSameRunAgain) {
  const std::string control = "unix:" + folder("control").string();
  ChildProcess rig(run({"--control", control}), folder("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_.are_up(); })) << rig.output();
  const std::string write =
      "mbpoll -m tcp -p " + std::to_string(wires_.modbus_port) + " -a 1 -0 -t 4 -r 0 127.0.0.1 ";
  shell("for i in 1 2 3 4 5 6; do " + write + "300 200 -250; sleep 0.07; done; " + write + "0 0 0");
  const auto ctl = [&](const std::string& what) {
    return std::string(kProgram) + " ctl " + control + " " + what + "; ";
  };
  shell(ctl("set boom=0.5 swing=-0.3") + ctl("set on=air fog=60m") +
        ctl("fault_add on=machine.engine fault='{type: derate, share: 40 %}'") + "sleep 0.3; " +
        ctl("set boom= swing=") + ctl("set on=air fog=") + ctl("fault_clear id=2") + "sleep 0.3");
  rig.signal(SIGINT);
  ASSERT_EQ(rig.wait(), 130) << rig.output();
  EXPECT_EQ(verify(), 0) << printed_;
  // It hung on the wall clock from when on the machine followed.
  std::ofstream(folder("a") / "requests.log") << "# nothing\n";
  EXPECT_EQ(verify(), 5) << printed_;
  std::ofstream(folder("a") / "requests.log") << "0.500000000 soon\n";
  EXPECT_EQ(verify(), 3) << printed_;
  EXPECT_THAT(printed_, HasSubstr("requests.log: at 0.500000000 s: found \"soon\""));
}

TEST_F(ReplayedRig, IsToldByTheFirstByteThatDiffersWithMessageAndField) {
  free_run();
  EXPECT_EQ(verify(), 0) << printed_;
  // The third byte of the data of an OpenIMU's slope sensor (PGN 61481).
  damage("wires/can.pcapng", std::string("\x8C\xF0\x29", 3), 4 + 4 + 2);
  EXPECT_EQ(verify(), 5) << printed_;
  EXPECT_THAT(printed_, AllOf(HasSubstr("0CF029"), HasSubstr("data byte 2, signal "),
                              HasSubstr(": found "), HasSubstr("different to 1.0")));
}

TEST_F(ReplayedRig, BesideARunningRigLeavesItsWiresAlone) {
  free_run();
  std::filesystem::rename(folder("a"), folder("b"));
  ChildProcess rig(run({}), folder("live.log"));
  ASSERT_TRUE(eventually([&] { return wires_.are_up(); })) << rig.output();
  std::filesystem::rename(folder("b"), folder("c"));
  ChildProcess program({kProgram, "replay", folder("c").string(), "--verify"},
                       folder("verify.log"));
  EXPECT_EQ(program.wait(), 0) << program.output();
  EXPECT_TRUE(wires_.are_up());
  EXPECT_TRUE(std::filesystem::is_symlink(wires_.gnss()));
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
}

TEST_F(ReplayedRig, PlayedOnItsWiresGivesClientsTheSameBytes) {
  free_run();
  ChildProcess listener(
      {"/usr/bin/python3", "-c",
       "import os, socket, sys, time\n"
       "pty, recorded = sys.argv[1], open(sys.argv[2], 'rb').read()\n"
       "lidar = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
       "lidar.bind(('127.0.0.1', int(sys.argv[3])))\n"
       "lidar.settimeout(0.05)\n"
       "print('ready', flush=True)\n"
       "while not os.path.exists(pty): time.sleep(0.005)\n"
       "line = os.open(pty, os.O_RDWR | os.O_NONBLOCK | os.O_NOCTTY)\n"
       "capture = open(sys.argv[4], 'rb').read()\n"
       "heard, good, bad, end = b'', 0, 0, time.monotonic() + 200\n"
       "while time.monotonic() < end and (len(heard) < len(recorded) or good <= 20):\n"
       "  try: heard += os.read(line, 4096)\n"
       "  except (BlockingIOError, OSError): pass\n"
       "  try: datagram = lidar.recv(2000)\n"
       "  except TimeoutError: continue\n"
       "  good, bad = (good + 1, bad) if datagram in capture else (good, bad + 1)\n"
       "print('line', heard == recorded, 'lidar', good > 20, bad)\n",
       wires_.gnss(), (folder("a") / "wires/gnss.bytes").string(),
       std::to_string(wires_.lidar_port), (folder("a") / "wires/lidar.pcapng").string()},
      folder("listener.log"));
  ASSERT_TRUE(eventually([&] { return listener.output().find("ready") != std::string::npos; }));
  // A client opens the line before its first byte is due, also on a busy machine.
  ChildProcess replay({kProgram, "replay", folder("a").string(), "--clock", "scaled:0.25"},
                      folder("replay.log"));
  EXPECT_EQ(listener.wait(), 0) << listener.output();
  EXPECT_THAT(listener.output(), HasSubstr("line True lidar True 0")) << replay.output();
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(ReplayedRig, ShownGoesToAnyInstantAndIsTheSameThereEachTime) {
  free_run();
  const std::string control = "unix:" + folder("control").string();
  ChildProcess replay({kProgram, "replay", folder("a").string(), "--dashboard", "--control",
                       control, "--clock", "scaled:0.01", "--from", "300ms"},
                      folder("replay.log"));
  const auto ask = [&](const std::vector<std::string>& words) {
    std::vector<std::string> command{kProgram, "ctl", control};
    command.insert(command.end(), words.begin(), words.end());
    nlohmann::json told;
    // While it begins anew nobody is there, or the run that has ended.
    EXPECT_TRUE(eventually([&] {
      ChildProcess ctl(command, folder("ctl.log"));
      (void)ctl.wait();
      told = nlohmann::json::parse(ctl.output(), nullptr, false);
      return told.is_object() && told.value("what", "") != "the run has ended";
    })) << replay.output();
    return told;
  };
  const auto is_at = [&](std::int64_t time_ns) {
    return eventually([&] { return ask({"state"}).value("time_ns", -1) == time_ns; });
  };
  const auto machine = [&] { return ask({"read"})["machine"]; };

  EXPECT_TRUE(eventually([&] { return ask({"state"}).value("time_ns", 0) >= 300'000'000; }));
  EXPECT_EQ(ask({"pause"})["paused"], true);
  EXPECT_EQ(ask({"state"})["recorded_end_ns"], 1'000'000'000);
  EXPECT_EQ(ask({"seek", "time=600ms"})["time_ns"], 600'000'000);
  const auto once = machine();
  EXPECT_EQ(ask({"seek", "time=1s"})["paused"], true);
  const auto at_end = machine();
  EXPECT_NE(once, at_end);
  EXPECT_EQ(ask({"resume"})["ok"], false);
  EXPECT_EQ(ask({"step", "length=1ms"})["ok"], false);
  EXPECT_EQ(ask({"seek", "time=600ms"})["ok"], true);
  EXPECT_TRUE(is_at(600'000'000));
  EXPECT_EQ(machine(), once);
  EXPECT_EQ(ask({"seek", "time=0s"})["ok"], true);
  EXPECT_TRUE(is_at(0));
  EXPECT_EQ(ask({"seek", "time=1s"})["time_ns"], 1'000'000'000);
  EXPECT_EQ(machine(), at_end);
  EXPECT_THAT(ask({"seek", "time=2s"})["allowed"].get<std::string>(), HasSubstr("1 s"));
  EXPECT_THAT(ask({"set", "boom=0.5"})["what"].get<std::string>(), HasSubstr("read-only"));
  EXPECT_EQ(ask({"wait", "quantity=boom", "value=400", "limit=1h"})["time_ns"], 1'000'000'000);
  EXPECT_EQ(ask({"stop"})["ok"], true);
  EXPECT_EQ(replay.wait(), 0) << replay.output();
}

TEST_F(ReplayedRig, ThatIsNoRecordingCannotBeRun) {
  std::filesystem::create_directory(folder("a"));
  EXPECT_EQ(verify(), 3);
  EXPECT_THAT(printed_, HasSubstr("recording.json"));
}

}  // namespace
}  // namespace rigwire
