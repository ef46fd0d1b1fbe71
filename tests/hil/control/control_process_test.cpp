// A run that is governed from outside: by curl at a port, by `rigwire ctl` and the Python package
// at a Unix socket.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "child_process.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;
using Json = nlohmann::json;

namespace fs = std::filesystem;

class ControlProcess : public testing::Test {
 protected:
  ControlProcess() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    std::ofstream(folder_ / "rig.yaml")
        << "name: small\nmachine: {type: excavator}\ndevices:\n  gnss: {type: ublox-neo-7p, path: "
        << (folder_ / "gnss").string() << "}\n";
  }
  ~ControlProcess() override { fs::remove_all(folder_); }

  [[nodiscard]] std::vector<std::string> run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{kProgram, "run", (folder_ / "rig.yaml").string(), "--status",
                                   "none"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  struct Done {
    int code;
    std::string output;
  };
  Done program(const std::vector<std::string>& words, std::chrono::seconds patience = 30s) {
    ChildProcess child(words, folder_ / "output");
    const int code = child.wait(patience).value_or(-1);
    return {code, child.output()};
  }
  Done ctl(const std::vector<std::string>& words) {
    std::vector<std::string> all{kProgram, "ctl", socket()};
    all.insert(all.end(), words.begin(), words.end());
    return program(all);
  }
  [[nodiscard]] std::string socket() const { return "unix:" + (folder_ / "control").string(); }

  static constexpr const char* kProgram = RIGWIRE_BINARY_DIR "/rigwire";
  fs::path folder_;
};

TEST_F(ControlProcess, CtlMovesTimeReadsAndStops) {
  ChildProcess rig(run({"--clock", "step", "--control", socket()}), folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const Done until = ctl({"run_until", "time=250ms"});
  EXPECT_EQ(until.code, 0) << until.output;
  EXPECT_EQ(Json::parse(until.output)["time_ns"], 250'000'000);
  const Done over = ctl({"run_until", "time=1ms"});
  EXPECT_EQ(over.code, 1);
  EXPECT_THAT(over.output, HasSubstr("later than 250 ms"));
  const Done typo = ctl({"run_untill", "time=1s"});
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.output, HasSubstr("run_until"));
  EXPECT_EQ(ctl({"step", "length"}).code, 2);
  EXPECT_EQ(Json::parse(ctl({"read"}).output)["devices"]["gnss"]["client_present"], false);
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  EXPECT_FALSE(fs::exists(folder_ / "control"));
  const Done nobody = ctl({"state"});
  EXPECT_EQ(nobody.code, 3);
  EXPECT_THAT(nobody.output, HasSubstr("no run answers"));
}

TEST_F(ControlProcess, CtlAddsListsAndClearsAFault) {
  ChildProcess rig(run({"--clock", "step", "--control", socket()}), folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const Done added = ctl({"fault_add", "on=gnss", "fault={type: jamming, at: 1 s, for: 5 s}"});
  EXPECT_EQ(added.code, 0) << added.output;
  EXPECT_EQ(Json::parse(added.output)["fault"]["id"], 1);
  EXPECT_EQ(ctl({"run_until", "time=2s"}).code, 0);
  EXPECT_EQ(Json::parse(ctl({"read"}).output)["faults"][0]["type"], "jamming");
  EXPECT_EQ(ctl({"fault_clear", "id=1"}).code, 0);
  const Json listed = Json::parse(ctl({"fault_list"}).output);
  EXPECT_GE(listed["faults"][0]["end_ns"], 2'000'000'000) << "in the past";
  EXPECT_LT(listed["faults"][0]["end_ns"], 2'010'000'000) << "later than the next slice";
  EXPECT_TRUE(listed["targets"]["gnss"].contains("frozen"));
  const Done none = ctl({"fault_add", "on=gnss", "fault={type: motor_stall}"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.output, HasSubstr("jamming"));
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
}

TEST_F(ControlProcess, APortWantsTheTokenAndNoPageOfElsewhere) {
  ChildProcess rig(run({"--control", "127.0.0.1:0"}), folder_ / "log");
  std::string at;
  std::string token;
  ASSERT_TRUE(eventually(
      [&] {
        const std::string log = rig.output();
        const auto begin = log.find("control at ");
        const auto comma = log.find(", token ", begin);
        const auto end = log.find('\n', comma);
        if (begin == std::string::npos || comma == std::string::npos || end == std::string::npos) {
          return false;
        }
        at = log.substr(begin + 11, comma - begin - 11);
        token = log.substr(comma + 8, end - comma - 8);
        return true;
      },
      20s))
      << rig.output();
  const auto status = [&](const std::vector<std::string>& headers) {
    std::vector<std::string> words{"/usr/bin/curl", "-s", "-o", "/dev/null", "-w", "%{http_code}"};
    for (const std::string& header : headers) {
      words.insert(words.end(), {"-H", header});
    }
    words.push_back("http://" + at + "/state");
    return program(words).output;
  };
  const std::string bearer = "Authorization: Bearer " + token;
  EXPECT_EQ(status({bearer}), "200");
  EXPECT_EQ(status({}), "401");
  EXPECT_EQ(status({bearer + "0"}), "401");
  EXPECT_EQ(status({bearer, "Host: evil.example"}), "403");
  EXPECT_EQ(status({bearer, "Origin: http://evil.example"}), "403");
}

TEST_F(ControlProcess, AClockThatStepsWithoutSomebodyToStepItIsRefused) {
  const Done refused = program(run({"--clock", "step"}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.output, HasSubstr("--control"));
  EXPECT_EQ(program(run({"--control", "0.0.0.0:80"})).code, 2);
  EXPECT_EQ(program(run({"--ready-fd", "77", "--duration", "1ms"})).code, 2);
}

TEST_F(ControlProcess, PrometheusReadsTheMetricsAndTheyAreTheReports) {
  ChildProcess rig(run({"--clock", "step", "--control", socket(), "--report",
                        (folder_ / "report.json").string()}),
                   folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  EXPECT_EQ(ctl({"fault_add", "on=gnss", "fault={type: jamming, for: 100 s}"}).code, 0);
  EXPECT_EQ(ctl({"run_until", "time=2s"}).code, 0);
  const Done metrics = program({"/usr/bin/curl", "-s", "--unix-socket",
                                (folder_ / "control").string(), "http://localhost/metrics"});
  std::ofstream(folder_ / "metrics") << metrics.output;
  const Done read = program(
      {"/usr/bin/python3", "-c",
       "import json, sys\n"
       "from prometheus_client.parser import text_string_to_metric_families as families\n"
       "print(json.dumps({s.name + '/' + s.labels.get('device', s.labels.get('type', '')):\n"
       "    s.value for f in families(open(sys.argv[1]).read()) for s in f.samples}))",
       (folder_ / "metrics").string()});
  ASSERT_EQ(read.code, 0) << read.output;
  const Json samples = Json::parse(read.output);
  EXPECT_EQ(samples["rigwire_simulated_seconds/"], 2.0);
  EXPECT_EQ(samples["rigwire_faults_active/jamming"], 1.0);
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  std::ifstream file(folder_ / "report.json");
  const Json gnss = Json::parse(file)["devices"]["gnss"];
  EXPECT_EQ(samples["rigwire_device_messages_total/gnss"], gnss["frames"].get<double>());
  EXPECT_EQ(samples["rigwire_device_bytes_total/gnss"], gnss["bytes"].get<double>());
}

TEST_F(ControlProcess, AnOverrunPolicyThatCouldNotActIsRefused) {
  const Done free = program(run({"--clock", "free", "--overrun", "stop"}));
  EXPECT_EQ(free.code, 2);
  EXPECT_THAT(free.output, HasSubstr("allowed with real and scaled:X"));
  const Done word = program(run({"--overrun", "warm"}));
  EXPECT_EQ(word.code, 2);
  EXPECT_THAT(word.output, HasSubstr("did you mean warn"));
  EXPECT_EQ(program(run({"--overrun", "slip", "--overrun-limit", "0.1 ms"})).code, 2);
  EXPECT_NE(program(run({"--overrun-limit", "1 s"})).code, 0);
}

TEST_F(ControlProcess, ProcessorsAreKeptAwakeOnlyForAClockWithInstants) {
  for (const char* clock : {"free", "step", "drained"}) {
    const Done done = program(run({"--clock", clock, "--awake"}));
    EXPECT_EQ(done.code, 2) << clock;
    EXPECT_THAT(done.output, HasSubstr("--awake: the clock " + std::string(clock))) << clock;
  }
}

TEST_F(ControlProcess, WhatKeepsProcessorsAwakeIsNotInTheReportedTime) {
  const Done done =
      program(run({"--awake", "--duration", "2s", "--report", (folder_ / "report.json").string()}));
  ASSERT_EQ(done.code, 0) << done.output;
  std::ifstream file(folder_ / "report.json");
  // A processor alone would be 2 s, whatever else goes on.
  EXPECT_LT(Json::parse(file)["cpu_s"].get<double>(), 1.5);
}

TEST_F(ControlProcess, IsolatedRunsOfOneRigStandSideBySideAndSendItsBytes) {
  const auto hash = [](const fs::path& report) {
    std::ifstream file(report);
    const Json json = Json::parse(file, nullptr, false);
    return json["config_hash"].get<std::string>() + " " +
           json["devices"]["gnss"]["stream_hash"].get<std::string>();
  };
  const std::vector<std::string> length{"--clock", "free", "--duration", "2s"};
  auto words = length;
  words.insert(words.end(), {"--report", (folder_ / "plain.json").string()});
  ASSERT_EQ(program(run(words)).code, 0);
  std::vector<std::unique_ptr<ChildProcess>> runs;
  for (const char* name : {"one", "two", "three"}) {
    runs.push_back(std::make_unique<ChildProcess>(
        run({"--isolated", (folder_ / name).string(), "--clock", "step", "--duration", "2s"}),
        folder_ / (std::string(name) + ".log")));
  }
  for (const char* name : {"one", "two", "three"}) {
    const fs::path told = folder_ / name / "run.json";
    ASSERT_TRUE(eventually([&] { return fs::exists(told); }, 20s)) << runs.front()->output();
    std::ifstream file(told);
    const Json json = Json::parse(file);
    EXPECT_EQ(json["replaced"]["devices.gnss.path"], (folder_ / name / "wires/gnss").string());
    EXPECT_TRUE(fs::is_symlink(folder_ / name / "wires/gnss"));
    const Done done = program({kProgram, "ctl", json["control"], "run_until", "time=2s"});
    EXPECT_THAT(done.output, HasSubstr("time_ns"));
  }
  for (const auto& one : runs) {
    EXPECT_EQ(one->wait(20s), 0) << one->output();
  }
  for (const char* name : {"one", "two", "three"}) {
    EXPECT_EQ(hash(folder_ / name / "report.json"), hash(folder_ / "plain.json")) << name;
  }
  const Done again = program(run({"--isolated", (folder_ / "one").string(), "--duration", "1ms"}));
  EXPECT_EQ(again.code, 3);
  EXPECT_THAT(again.output, HasSubstr("new or empty"));
}

TEST_F(ControlProcess, EventsAreTheSameThroughEveryDoorAndInTheRecording) {
  ChildProcess rig(run({"--clock", "step", "--control", socket()}), folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  ChildProcess follower({kProgram, "ctl", socket(), "events", "--follow"}, folder_ / "followed");
  EXPECT_EQ(ctl({"record", (folder_ / "take").string()}).code, 0);
  EXPECT_EQ(ctl({"fault_add", "on=gnss", "fault={type: jamming, at: 100 ms, for: 200 ms}"}).code,
            0);
  EXPECT_EQ(ctl({"wait", "quantity=bom", "value=1"}).code, 2);
  EXPECT_EQ(ctl({"run_until", "time=500ms"}).code, 0);
  EXPECT_EQ(ctl({"record", "--stop"}).code, 0);
  const Json all = Json::parse(ctl({"events"}).output);
  std::vector<std::string> kinds;
  for (const Json& event : all["events"]) {
    kinds.push_back(event["kind"]);
  }
  EXPECT_THAT(kinds, testing::ElementsAre("recording_began", "refused", "fault_begun",
                                          "fault_ended", "recording_ended"));
  EXPECT_EQ(all["events"][2]["time_ns"], 100'000'000);
  EXPECT_EQ(all["events"][2]["where"], "gnss");
  EXPECT_THAT(all["events"][1]["text"].get<std::string>(), HasSubstr("quantity"));
  EXPECT_EQ(all["lost"], 0);
  const Json later = Json::parse(ctl({"events", "since=3"}).output);
  EXPECT_EQ(later["events"][0]["kind"], "fault_ended");
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  EXPECT_EQ(follower.wait(20s), 0);
  EXPECT_EQ(std::ranges::count(follower.output(), '\n'), 5) << follower.output();
  const Done info = program({kProgram, "record", "info", (folder_ / "take").string(), "--json"});
  // From its beginning to its end.
  EXPECT_EQ(Json::parse(info.output)["channels"]["/events"]["messages"], 3) << info.output;
}

TEST_F(ControlProcess, ARecordingInTheMiddleOfARunVerifiesWithWhatAHandSet) {
  ChildProcess rig(run({"--clock", "step", "--control", socket()}), folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const std::string take = (folder_ / "take").string();
  EXPECT_EQ(ctl({"run_until", "time=500333us"}).code, 0);
  EXPECT_EQ(ctl({"set", "boom=0.6", "swing=-20%"}).code, 0);
  EXPECT_EQ(ctl({"set", "on=air", "rain=50 mm/h", "fog=80 m"}).code, 0);
  EXPECT_EQ(ctl({"run_until", "time=1000500us"}).code, 0);
  EXPECT_EQ(ctl({"record", take}).code, 0);
  const Done second = ctl({"record", (folder_ / "other").string()});
  EXPECT_EQ(second.code, 1);
  EXPECT_THAT(second.output, HasSubstr("a recording is on its way"));
  EXPECT_EQ(ctl({"run_until", "time=1700ms"}).code, 0);
  EXPECT_EQ(ctl({"set", "boom="}).code, 0);
  EXPECT_EQ(ctl({"set", "on=air", "rain=", "fog=30 m"}).code, 0);
  const Json read = Json::parse(ctl({"read"}).output);
  EXPECT_EQ(read["air"], (Json{{"rain", nullptr}, {"snow", nullptr}, {"fog", "30 m"}}));
  EXPECT_EQ(ctl({"set", "on=gnss", "rate=2Hz", "nmea_sentences=[RMC, GGA]"}).code, 0);
  EXPECT_EQ(ctl({"fault_add", "on=gnss", "fault={type: jamming, for: 200 ms}"}).code, 0);
  EXPECT_EQ(ctl({"run_until", "time=2600700us"}).code, 0);
  const Done stopped = ctl({"record", "--stop"});
  EXPECT_EQ(Json::parse(stopped.output)["end_ns"], 2'600'700'000);
  EXPECT_EQ(ctl({"record", "--stop"}).code, 1);
  EXPECT_EQ(ctl({"record", (folder_ / "other").string(), "--only", "truth"}).code, 0);
  EXPECT_EQ(ctl({"step", "length=1s"}).code, 0);
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  const Json about = Json::parse(std::ifstream(folder_ / "take/recording.json"));
  EXPECT_EQ(about["begin_ns"], 1'000'500'001);
  const Done verified = program({kProgram, "replay", take, "--verify"}, 120s);
  EXPECT_EQ(verified.code, 0) << verified.output;
  const Done next = program({kProgram, "replay", (folder_ / "other").string(), "--verify"}, 120s);
  EXPECT_EQ(next.code, 0) << next.output;
  // Without what the hand did it is another run.
  std::ofstream(folder_ / "take/commands.log") << "# nothing\n";
  const Done other = program({kProgram, "replay", take, "--verify"}, 120s);
  EXPECT_EQ(other.code, 5) << other.output;
}

TEST_F(ControlProcess, AHandRaisesTheBoomAndWhatItCannotSetIsRefused) {
  ChildProcess rig(
      run({"--clock", "step", "--control", socket(), "--truth", (folder_ / "truth").string()}),
      folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const auto boom = [&] {
    return Json::parse(ctl({"read"}).output)["machine"]["quantities"]["boom"]["value"]
        .get<double>();
  };
  EXPECT_EQ(ctl({"run_until", "time=500ms"}).code, 0);
  const double at_first = boom();
  const Done wide = ctl({"set", "boom=1.5"});
  EXPECT_EQ(wide.code, 2);
  EXPECT_THAT(wide.output, HasSubstr("-1 .. 1"));
  const Done unit = ctl({"set", "boom=3 bar"});
  EXPECT_EQ(unit.code, 2);
  const Done name = ctl({"set", "bom=0.5"});
  EXPECT_EQ(name.code, 2);
  EXPECT_THAT(name.output, HasSubstr("boom"));
  EXPECT_EQ(ctl({"set", "on=gns", "rate=5"}).code, 2);
  EXPECT_EQ(ctl({"set"}).code, 2);
  EXPECT_EQ(ctl({"run_until", "time=600ms"}).code, 0);
  EXPECT_NEAR(boom(), at_first, 0.2) << "a refused request moved the machine";
  const Json done = Json::parse(ctl({"set", "boom=0.8"}).output);
  EXPECT_GE(done["acts_from_ns"], 600'000'000);
  EXPECT_LE(done["acts_from_ns"], 602'000'001);
  EXPECT_EQ(ctl({"run_until", "time=2s"}).code, 0);
  const double raised = boom();
  EXPECT_GT(raised, at_first + 2.0);
  EXPECT_EQ(ctl({"set", "boom=null"}).code, 0);
  EXPECT_EQ(ctl({"run_until", "time=3s"}).code, 0);
  const double let_go = boom();
  EXPECT_EQ(ctl({"run_until", "time=4s"}).code, 0);
  EXPECT_NEAR(boom(), let_go, 0.5) << "the client's set point, neutral, holds again";
  const Json events = Json::parse(ctl({"events"}).output)["events"];
  EXPECT_EQ(std::ranges::count(events, "set", [](const Json& e) { return e["kind"]; }), 1);
  EXPECT_EQ(std::ranges::count(events, "released", [](const Json& e) { return e["kind"]; }), 1);
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  std::ifstream truth(folder_ / "truth");
  std::size_t by_hand = 0;
  for (std::string line; std::getline(truth, line);) {
    by_hand += line.find(R"("hand":["boom"])") != std::string::npos ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(by_hand) * 0.01, 1.4, 0.05);
}

TEST_F(ControlProcess, ATokenThatCanBeGuessedOrIsNoHeaderIsRefused) {
  for (const char* const token : {"x", "fifteen-letters", "sixteen letters!",
                                  "a-token-of-two\nlines", "umlauts-are-\xC3\xA4-no-ASCII"}) {
    ::setenv("RIGWIRE_CONTROL_TOKEN", token, 1);
    const Done refused = program({kProgram, "ctl", "127.0.0.1:1", "state"});
    EXPECT_EQ(refused.code, 2) << token;
    EXPECT_THAT(refused.output, HasSubstr("RIGWIRE_CONTROL_TOKEN"));
    EXPECT_THAT(refused.output, HasSubstr("allowed 16 to 256 printable characters"));
  }
  ::unsetenv("RIGWIRE_CONTROL_TOKEN");
}

TEST_F(ControlProcess, AtAPortARecordingStaysBelowTheRunsFolder) {
  ::setenv("RIGWIRE_CONTROL_TOKEN", "a-secret-of-this-test", 1);
  fs::create_directory(folder_ / "own");
  const std::string log = (folder_ / "log").string();
  ChildProcess rig(
      {"/usr/bin/env", "-C", (folder_ / "own").string(), kProgram, "run",
       (folder_ / "rig.yaml").string(), "--status", "none", "--control", "127.0.0.1:0"},
      log);
  std::string at;
  ASSERT_TRUE(eventually(
      [&] {
        const std::string text = rig.output();
        const auto begin = text.find("control at ");
        const auto comma = text.find(", token ", begin);
        at = comma == std::string::npos ? "" : text.substr(begin + 11, comma - begin - 11);
        return !at.empty();
      },
      20s));
  for (const std::string& folder : {(folder_ / "else").string(), std::string("../else")}) {
    const Done refused = program({kProgram, "ctl", at, "record", folder});
    EXPECT_EQ(refused.code, 1) << folder;
    EXPECT_THAT(refused.output, HasSubstr("below"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "else"));
  EXPECT_EQ(program({kProgram, "ctl", at, "record", "take"}).code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "own/take/recording.json"));
  ::unsetenv("RIGWIRE_CONTROL_TOKEN");
}

TEST_F(ControlProcess, TheClockThatWaitsForItsClientsLosesNothingToASlowReader) {
  const std::string report = (folder_ / "report.json").string();
  ChildProcess rig(
      run({"--clock", "drained", "--duration", "120s", "--control", socket(), "--report", report}),
      folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const int line = ::open((folder_ / "gnss").c_str(), O_RDONLY | O_NOCTTY);
  ASSERT_GE(line, 0);
  EXPECT_EQ(ctl({"resume"}).code, 0);
  std::size_t bytes = 0;
  std::array<char, 256> piece{};
  // At most 256 kB/s, while nobody holds the run back; to the end of the line.
  for (ssize_t count = 0; (count = ::read(line, piece.data(), piece.size())) > 0;) {
    bytes += static_cast<std::size_t>(count);
    std::this_thread::sleep_for(1ms);
  }
  ::close(line);
  ASSERT_EQ(rig.wait(60s), 0) << rig.output();
  const Json json = Json::parse(std::ifstream(report));
  EXPECT_EQ(json["clock"], "drained");
  EXPECT_EQ(json["devices"]["gnss"]["dropped"], 0);
  EXPECT_EQ(json["patience_expiries"], 0);
  EXPECT_GT(json["clients_waited_for_s"], 0.0);
  EXPECT_EQ(bytes, json["devices"]["gnss"]["bytes"].get<std::size_t>());
}

TEST_F(ControlProcess, AReaderThatStoppedCostsThePatienceOnceAndIsTold) {
  ChildProcess rig(run({"--clock", "drained", "--patience", "50 ms", "--control", socket()}),
                   folder_ / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(folder_ / "control"); }, 20s)) << rig.output();
  const int line = ::open((folder_ / "gnss").c_str(), O_RDONLY | O_NOCTTY);
  ASSERT_GE(line, 0);
  EXPECT_EQ(ctl({"resume"}).code, 0);
  ASSERT_TRUE(eventually(
      [&] {
        const Json state = Json::parse(ctl({"state"}).output);
        return state["time_ns"] > 60'000'000'000;
      },
      60s))
      << "one that does not read holds the run up for ever";
  const Json events = Json::parse(ctl({"events"}).output)["events"];
  EXPECT_EQ(std::ranges::count(events, "impatient", [](const Json& e) { return e["kind"]; }), 1)
      << events;
  ::close(line);
  EXPECT_EQ(ctl({"stop"}).code, 0);
  EXPECT_EQ(rig.wait(20s), 0) << rig.output();
  EXPECT_EQ(program(run({"--clock", "free", "--patience", "1 s"})).code, 2);
}

TEST_F(ControlProcess, TheExamplesForPytestPass) {
  const Done pytest =
      program({"/usr/bin/env", "RIGWIRE=" + std::string(kProgram),
               "PYTHONPATH=" RIGWIRE_SOURCE_DIR "/python", "PYTHONDONTWRITEBYTECODE=1",
               "/usr/bin/python3", "-m", "pytest", "-q", "-p", "no:cacheprovider", "--basetemp",
               (folder_ / "py").string(), RIGWIRE_SOURCE_DIR "/examples/pytest"},
              300s);
  EXPECT_EQ(pytest.code, 0) << pytest.output;
}

}  // namespace
}  // namespace rigwire
