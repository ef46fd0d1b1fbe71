// python3-serial on the receiver's pseudo-terminal: what a real line does at a wrong speed, after a
// pause, and when the device goes away.
//
// The package is a required dependency: without it these tests fail. Every wait is bounded.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "child_process.h"
#include "live_receiver.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;
using test::LiveReceiver;

/// Functions that every script uses: whole sentences with a right checksum, and times of RMC. What
/// is listened for is a count; nothing hangs on how long that takes.
constexpr const char* kPrelude =
    "import json, os, serial, sys, time\n"
    "def good(line):\n"
    "    body, star, end = line.strip().rpartition(b'*')\n"
    "    if not star or not body.startswith(b'$G'): return False\n"
    "    x = 0\n"
    "    for c in body[1:]: x ^= c\n"
    "    return end == b'%02X' % x\n"
    "def listen(port, enough):\n"
    "    lines, count = [], 0\n"
    "    while not enough(lines, count):\n"
    "        line = port.readline()\n"
    "        count += len(line)\n"
    "        if good(line): lines.append(line)\n"
    "    return lines, count\n"
    "def times(lines):\n"
    "    t = [l[7:13].decode() for l in lines if l.startswith(b'$GPRMC')]\n"
    "    return [int(s[:2]) * 3600 + int(s[2:4]) * 60 + int(s[4:]) for s in t]\n"
    "def epochs(wanted):\n"
    "    return lambda lines, count: len(times(lines)) >= wanted\n"
    "def agree(done, go):\n"  // with the test, by files
    "    open(sys.argv[2] + '/' + done, 'w').close()\n"
    "    while not os.path.exists(sys.argv[2] + '/' + go): time.sleep(0.01)\n";

class SerialClient : public testing::Test {
 protected:
  SerialClient() { settings_.baud = 38'400; }
  [[nodiscard]] std::unique_ptr<ChildProcess> start(const std::string& script) {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{"/usr/bin/python3", "-c", kPrelude + script, wires_.gnss(),
                                 wires_.folder.string()},
        wires_.folder / "python.log");
  }
  /// Until the script has done that.
  void await(const std::string& done, const ChildProcess& python) {
    ASSERT_TRUE(test::eventually([&] { return std::filesystem::exists(wires_.folder / done); }))
        << python.output();
  }
  /// What the script printed, after it has ended by itself.
  [[nodiscard]] Json result(ChildProcess& python) {
    EXPECT_EQ(python.wait(), 0) << python.output();
    Json found = Json::parse(python.output(), nullptr, false);
    EXPECT_FALSE(found.is_discarded()) << python.output();
    return found;
  }

  emulators::UbloxSettings settings_;
  test::PrivateWires wires_;
};

TEST_F(SerialClient, HearsGarbageAtTheWrongSpeedAndSentencesAtTheRightOne) {
  LiveReceiver receiver(settings_, wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  auto python = start(
      "port = serial.Serial(sys.argv[1], 9600, timeout=0.2)\n"
      "wrong, wrong_bytes = listen(port, lambda lines, count: count > 400)\n"
      "port.write(b'\\xb5\\x62\\x0a\\x04\\x00\\x00\\x0e\\x34')\n"
      "agree('asked', 'taken')\n"
      "port.baudrate = 38400\n"
      "time.sleep(0.1)\n"
      "port.reset_input_buffer()\n"
      "listen(port, lambda lines, count: len(lines) >= 16)\n"
      "print(json.dumps([len(wrong)]))\n");
  await("asked", *python);
  ASSERT_TRUE(test::eventually([&] { return receiver.state().received.bytes >= 8; }));
  std::ofstream(wires_.folder / "taken");
  const Json found = result(*python);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], 0) << "a sentence was readable at a quarter of the speed";
  EXPECT_EQ(receiver.state().received.accepted, 0U) << "a poll at the wrong speed was understood";
}

TEST_F(SerialClient, FindsNoOldEpochsAfterAPause) {
  LiveReceiver receiver(settings_, wires_.gnss());
  ASSERT_TRUE(receiver.awake());
  auto python = start(
      "port = serial.Serial(sys.argv[1], 38400, timeout=0.2)\n"
      "before = times(listen(port, epochs(2))[0])\n"
      "port.close()\n"
      "agree('closed', 'paused')\n"
      "port = serial.Serial(sys.argv[1], 38400, timeout=0.2)\n"
      "after = times(listen(port, epochs(3))[0])\n"
      "print(json.dumps([before, after]))\n");
  const auto epochs = [&] { return receiver.state().counters.epochs; };
  await("closed", *python);
  const auto at_closing = epochs();
  ASSERT_TRUE(test::eventually([&] { return epochs() >= at_closing + 4; }));
  std::ofstream(wires_.folder / "paused");
  const Json found = result(*python);
  ASSERT_EQ(found.size(), 2U);
  ASSERT_FALSE(found[0].empty());
  ASSERT_FALSE(found[1].empty());
  EXPECT_GE(found[1][0].get<int>(), found[0].back().get<int>() + 3)
      << "epochs of the pause: " << found;
  for (std::size_t i = 1; i < found[1].size(); ++i) {
    EXPECT_EQ(found[1][i].get<int>(), found[1][i - 1].get<int>() + 1);
  }
}

TEST_F(SerialClient, NoticesThatTheDeviceIsGoneAndReadsTheNextOne) {
  auto receiver = std::make_unique<LiveReceiver>(settings_, wires_.gnss());
  ASSERT_TRUE(receiver->awake());
  auto python = start(
      "port = serial.Serial(sys.argv[1], 38400, timeout=0.2)\n"
      "gone = False\n"
      "try:\n"
      "    listen(port, lambda lines, count: False)\n"
      "except serial.SerialException:\n"
      "    gone = True\n"
      "port.close()\n"
      "while True:\n"
      "    try:\n"
      "        port = serial.Serial(sys.argv[1], 38400, timeout=0.2)\n"
      "        break\n"
      "    except serial.SerialException:\n"
      "        time.sleep(0.05)\n"
      "again = times(listen(port, epochs(1))[0])\n"
      "print(json.dumps([gone, again]))\n");
  ASSERT_TRUE(test::eventually([&] { return receiver->state().client_present; }));
  receiver.reset();
  receiver = std::make_unique<LiveReceiver>(settings_, wires_.gnss());
  const Json found = result(*python);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], true) << "the end of the line was not noticed";
  EXPECT_GE(found[1].size(), 1U);
}

}  // namespace
}  // namespace rigwire
