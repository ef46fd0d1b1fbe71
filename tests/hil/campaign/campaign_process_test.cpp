// Campaigns as a user and an engine run them: the program, its folders, what is killed and resumed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child_process.h"

namespace rigwire {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;
using Json = nlohmann::json;

std::string campaign_process_content(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class CampaignProcess : public testing::Test {
 protected:
  CampaignProcess() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    std::ofstream(folder_ / "rig.yaml")
        << "machine: {type: wheeled, wheeled: {level: kinematic}}\ndevices:\n"
           "  gnss: {type: ublox-neo-7p, path: /tmp/rigwire/g, baud: 115200, mount: {link: "
           "body}}\n";
  }
  ~CampaignProcess() override { fs::remove_all(folder_); }

  /// Two headings times two rates; a heading of 80 degrees is one too many.
  void write_campaign(const std::string& more = "") const {
    std::ofstream(folder_ / "campaign.yaml")
        << "rig: rig.yaml\nduration: 500 ms\nparameters:\n"
           "  rate: {type: values, values: [1 Hz, 5 Hz], keys: [devices.gnss.rate]}\n"
           "  yaw: {type: values, values: [0 deg, 80 deg], keys: [machine.yaw]}\n"
           "criteria:\n  turned: {type: stays, quantity: heading_deg, above: false, value: 60}\n"
        << more;
  }
  struct Done {
    int code;
    std::string output;
  };
  Done rigwire(std::vector<std::string> words, std::chrono::seconds patience = 60s) const {
    words.insert(words.begin(), {kProgram, "campaign"});
    ChildProcess child(words, folder_ / "output");
    const int code = child.wait(patience).value_or(-1);
    return {code, child.output()};
  }
  [[nodiscard]] std::vector<std::string> run(const std::string& index,
                                             const std::string& into = "runs") const {
    return {"run", campaign(), "--index", index, "-o", (folder_ / into).string()};
  }
  [[nodiscard]] std::string campaign() const { return (folder_ / "campaign.yaml").string(); }
  [[nodiscard]] fs::path place(std::size_t index, const std::string& of = "runs") const {
    return folder_ / of / "runs" / fmt::format("{:06}", index);
  }
  [[nodiscard]] Json result(std::size_t index, const std::string& of = "runs") const {
    return Json::parse(campaign_process_content(place(index, of) / "result.json"));
  }

  static constexpr const char* kProgram = RIGWIRE_BINARY_DIR "/rigwire";
  fs::path folder_;
};

TEST_F(CampaignProcess, its_runs_are_judged_and_counted) {
  write_campaign();
  EXPECT_THAT(rigwire({"expand", campaign()}).output, HasSubstr("index,seed,rate,yaw\n0,"));
  const Done done = rigwire(run("0-2"));
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.output, "run 0: passed\nrun 1: failed\nrun 2: passed\n");
  EXPECT_TRUE(fs::exists(place(1) / "DONE"));
  EXPECT_FALSE(fs::exists(place(1) / "truth.jsonl"));
  EXPECT_EQ(result(1)["first_failure"], "turned");
  EXPECT_EQ(rigwire({"collect", (folder_ / "runs").string()}).output,
            "2 passed, 1 failed, 0 crashed, 0 unfinished, 1 missing\n");
  EXPECT_EQ(rigwire(run("0-3")).output,
            "run 0: done before\nrun 1: done before\nrun 2: done before\nrun 3: failed\n");
}

TEST_F(CampaignProcess, a_run_is_a_function_of_program_rig_and_index) {
  write_campaign("keep_truth: true\n");
  ASSERT_EQ(rigwire(run("2", "one")).code, 0);
  ASSERT_EQ(rigwire(run("0-2", "other")).code, 0);
  Json one = result(2, "one");
  Json other = result(2, "other");
  one.erase("wall");
  other.erase("wall");
  EXPECT_EQ(one, other);
  EXPECT_EQ(campaign_process_content(place(2, "one") / "truth.jsonl"),
            campaign_process_content(place(2, "other") / "truth.jsonl"));
  const auto hash = [&](const std::string& of) {
    return Json::parse(
        campaign_process_content(place(2, of) / "report.json"))["devices"]["gnss"]["stream_hash"];
  };
  EXPECT_EQ(hash("one"), hash("other"));
  EXPECT_NE(hash("one"), Json::parse(campaign_process_content(
                             place(0, "other") / "report.json"))["devices"]["gnss"]["stream_hash"]);
}

TEST_F(CampaignProcess, the_effective_configuration_runs_again_by_itself) {
  write_campaign("keep_truth: true\n");
  ASSERT_EQ(rigwire(run("3")).code, 0);
  ChildProcess again({kProgram, "run", (place(3) / "rig.yaml").string(), "--clock", "free",
                      "--duration", "500ms", "--isolated", (folder_ / "again").string(), "--truth",
                      (folder_ / "truth").string(), "--status", "none"},
                     folder_ / "output");
  ASSERT_EQ(again.wait(60s).value_or(-1), 0) << again.output();
  EXPECT_EQ(campaign_process_content(folder_ / "truth"),
            campaign_process_content(place(3) / "truth.jsonl"));
}

TEST_F(CampaignProcess, what_was_killed_is_run_again_and_nothing_else) {
  write_campaign("duration: 1 h\n");  // given twice: refused
  EXPECT_EQ(rigwire(run("0")).code, 2);
  write_campaign();
  ASSERT_EQ(rigwire(run("0")).code, 0);
  const auto before = fs::last_write_time(place(0) / "result.json");
  {
    // The run is left as by an engine's node that loses power: nothing is tidied up.
    fs::create_directories(place(1));
    std::ofstream(place(1) / "result.json") << "{}";
    std::ofstream(place(1) / "truth.jsonl") << "half a li";
  }
  EXPECT_EQ(rigwire(run("0-1")).output, "run 0: done before\nrun 1: failed\n");
  EXPECT_EQ(fs::last_write_time(place(0) / "result.json"), before);
}

// It held the engine's slot for ever.
TEST_F(CampaignProcess, a_run_that_does_not_end_is_ended_and_not_judged) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nclock: real\nduration: 10 min\npatience: 2 s\n"
         "program: [sh, -c, \"for child in $(cat /proc/$PPID/task/$PPID/children); do test $child "
         "= "
         "$$ || kill -STOP $child; done; exec sleep 600\"]\n"
         "criteria: {ended: {type: program_exit}}\n";
  const Done done = rigwire(run("0"));
  EXPECT_EQ(done.code, 1) << done.output;
  EXPECT_THAT(done.output, HasSubstr("not done within its patience, 2 s"));
  EXPECT_EQ(result(0)["outcome"], "crashed");
  EXPECT_FALSE(fs::exists(place(0) / "DONE"));
}

TEST_F(CampaignProcess, a_signal_ends_rig_and_program_and_leaves_no_mark) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nclock: real\nduration: 10 min\n"
         "program: [sh, -c, \"echo $$ > {folder}/pid; exec sleep 600\"]\n"
         "criteria: {ended: {type: program_exit}}\n";
  std::vector<std::string> words = run("0");
  words.insert(words.begin(), {kProgram, "campaign"});
  ChildProcess child(words, folder_ / "output");
  ASSERT_TRUE(eventually([&] { return !campaign_process_content(place(0) / "pid").empty(); }))
      << child.output();
  const pid_t program = std::stoi(campaign_process_content(place(0) / "pid"));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait(30s), 128 + SIGTERM);
  EXPECT_TRUE(eventually([&] { return ::kill(program, 0) != 0; }));
  EXPECT_FALSE(fs::exists(place(0) / "DONE"));
  EXPECT_THAT(rigwire({"collect", (folder_ / "runs").string()}).output,
              HasSubstr("1 unfinished, 0 missing"));
}

TEST_F(CampaignProcess, a_killed_process_takes_its_rig_and_program_along) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nclock: real\nduration: 10 min\n"
         "program: [sh, -c, \"echo $$ > {folder}/pid; exec sleep 600\"]\n"
         "criteria: {ended: {type: program_exit}}\n";
  std::vector<std::string> words = run("0");
  words.insert(words.begin(), {kProgram, "campaign"});
  ChildProcess child(words, folder_ / "output");
  ASSERT_TRUE(eventually([&] { return !campaign_process_content(place(0) / "pid").empty(); }))
      << child.output();
  const pid_t program = std::stoi(campaign_process_content(place(0) / "pid"));
  child.signal(SIGKILL);
  EXPECT_EQ(child.wait(30s), 128 + SIGKILL);
  EXPECT_TRUE(eventually([&] { return ::kill(program, 0) != 0; }));
}

TEST_F(CampaignProcess, a_program_gets_what_its_words_name) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nclock: real\nduration: 1 min\nseed: 5\n"
         "parameters:\n  speed: {type: values, values: [1, 3]}\n"
         "program: [sh, -c, \"echo {speed} {index} {devices.gnss.baud} {devices.gnss.path}; "
         "test -e {devices.gnss.path} && exit {speed}\"]\n"
         "criteria: {ended: {type: program_exit, status: 3}}\n";
  EXPECT_EQ(rigwire(run("0-1")).output, "run 0: failed\nrun 1: passed\n");
  EXPECT_THAT(campaign_process_content(place(1) / "program.log"),
              testing::StartsWith("3 1 115200 bit/s /tmp/rigwire-run-"));
  EXPECT_EQ(result(0)["criteria"]["ended"]["text"], "the program ended with status 1");
}

// All runs were run to their end, and then none could be judged.
TEST_F(CampaignProcess, a_criterion_that_no_run_can_meet_is_refused_before_any_begins) {
  write_campaign();
  std::string text = campaign_process_content(campaign());
  text.replace(text.find("heading_deg"), 11, "heading_dog");
  std::ofstream(folder_ / "campaign.yaml") << text;
  const std::vector<std::vector<std::string>> actions{
      {"expand", campaign()},
      {"expand", campaign(), "-o", (folder_ / "runs").string()},
      run("0-3")};
  for (const std::vector<std::string>& words : actions) {
    const Done done = rigwire(words);
    EXPECT_EQ(done.code, 2) << done.output;
    EXPECT_THAT(done.output, HasSubstr("campaign.yaml:7:"));
    EXPECT_THAT(done.output,
                HasSubstr("criteria.turned.quantity: the machine has no such quantity, found "
                          "\"heading_dog\", allowed speed (km/h)"));
    EXPECT_THAT(done.output, HasSubstr("did you mean heading_deg?"));
    EXPECT_LT(done.output.size(), 700U) << done.output;
    EXPECT_FALSE(fs::exists(folder_ / "runs/plan.json"));
  }
}

TEST_F(CampaignProcess, a_criterion_takes_the_words_of_read) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nduration: 500 ms\ncriteria:\n"
         "  stands: {type: stays, quantity: speed, above: false, value: 0.5 m/s}\n"
         "  turns: {type: reaches, quantity: engine, value: 90000, limit: 1 s}\n";
  EXPECT_EQ(rigwire(run("0")).output, "run 0: failed\n");
  const Json criteria = result(0)["criteria"];
  EXPECT_EQ(criteria["stands"]["text"], "stayed speed below 0.5 m/s");
  EXPECT_EQ(criteria["turns"]["text"], "was never engine above 90000 rpm");
  EXPECT_THAT(criteria["turns"]["detail"].get<std::string>(), testing::EndsWith(" rpm"));
}

TEST_F(CampaignProcess, a_rig_that_dies_is_a_row_that_crashed) {
  std::ofstream(folder_ / "campaign.yaml")
      << "rig: rig.yaml\nclock: real\nduration: 1 min\n"
         // The parent of the program is the run, its other child the rig. Sanitizers let it end so.
         "program: [sh, -c, \"for p in $(cat /proc/$PPID/task/*/children); do "
         "[ $p = $$ ] || kill -ABRT $p; done; sleep 20\"]\n"
         "criteria: {ended: {type: program_exit}}\n";
  const Done done = rigwire(run("0"));
  EXPECT_EQ(done.code, 1);
  EXPECT_EQ(result(0)["outcome"], "crashed");
  EXPECT_THAT(result(0)["what"].get<std::string>(), HasSubstr("the rig ended by signal 6"));
}

TEST_F(CampaignProcess, a_folder_is_of_one_campaign) {
  write_campaign();
  ASSERT_EQ(rigwire(run("0")).code, 0);
  write_campaign("seed: 2\n");
  const Done done = rigwire(run("0"));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.output, HasSubstr("the folder is of another campaign"));
  write_campaign();
  std::ofstream(folder_ / "rig.yaml", std::ios::app) << "name: changed\n";
  EXPECT_EQ(rigwire(run("0")).code, 2) << "the rig is another one";
}

TEST_F(CampaignProcess, what_a_rig_refuses_is_found_before_anything_runs) {
  write_campaign();
  std::string text = campaign_process_content(campaign());
  text.replace(text.find("5 Hz"), 4, "5 m");
  std::ofstream(folder_ / "campaign.yaml") << text;
  const Done done = rigwire({"expand", campaign()});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.output, HasSubstr("devices.gnss.rate: wrong unit, found \"5 m\""));
}

TEST_F(CampaignProcess, options_of_another_action_are_refused) {
  write_campaign();
  EXPECT_EQ(rigwire({"run", campaign(), "-o", "x"}).code, 2);
  EXPECT_EQ(rigwire({"run", campaign(), "--index", "0"}).code, 2);
  EXPECT_EQ(rigwire(run("4")).code, 2);
  EXPECT_EQ(rigwire(run("1-0")).code, 2);
  EXPECT_EQ(rigwire({"expand", campaign(), "--index", "0"}).code, 2);
  EXPECT_EQ(rigwire({"collect", folder_.string()}).code, 2);
  EXPECT_EQ(rigwire({"report", folder_.string(), "--axes", "a,b"}).code, 2);
  EXPECT_THAT(rigwire({"colect", campaign()}).output, HasSubstr("did you mean collect?"));
}

}  // namespace
}  // namespace rigwire
