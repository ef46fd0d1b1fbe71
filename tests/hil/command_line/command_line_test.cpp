// The built program, as a user and a script meet it: exit codes and messages.
#include <fnmatch.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "hil/devices/device_types.h"
#include "hil/files/image_file.h"

namespace {

using rigwire::hil::device_types;
using rigwire::hil::Image;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct Result {
  int code = -1;
  std::string output;  ///< Standard output and error; error alone where output is redirected.
};

/// After what a shell does first. Bounded: `timeout` ends a program that does not.
Result in_shell(const std::string& first, const std::string& arguments) {
  const std::string command = "exec 2>&1 </dev/null; " + first +
                              "exec env NO_COLOR=1 timeout 60 " RIGWIRE_BINARY_DIR "/rigwire " +
                              arguments;
  Result result;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return result;
  }
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), count);
  }
  const int status = ::pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

Result rigwire(const std::string& arguments) {
  return in_shell("", arguments);
}

TEST(CommandLine, help_and_version_are_done) {
  const Result help = rigwire("--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.output, HasSubstr("rigwire run excavator_pit --duration 20s"));
  EXPECT_EQ(rigwire("run --help").code, 0);
  const Result version = rigwire("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.output, StartsWith("rigwire 0."));
}

TEST(CommandLine, picture_writes_one_layer_of_a_camera) {
  const std::string small =
      " --set devices.front_camera.sensor.image_sensor.width=64"
      " --set devices.front_camera.sensor.image_sensor.height=48 --at 100ms";
  const std::string file = testing::TempDir() + "picture_verb.png";
  const Result shown = rigwire("picture unimog_vision --device front_camera -o " + file + small);
  EXPECT_EQ(shown.code, 0) << shown.output;
  EXPECT_THAT(shown.output, HasSubstr("image of front_camera at 0.100 s, 64 x 48"));
  const Image image = rigwire::hil::read_png(file, "picture: ");
  EXPECT_EQ(image.columns, 64U);
  EXPECT_EQ(image.rows, 48U);
  const Result labels = rigwire(
      "picture unimog_vision --device front_camera --layer labels --raw -o " + file + small);
  EXPECT_EQ(labels.code, 0) << labels.output;
  EXPECT_THAT(labels.output, HasSubstr("ground"));
  EXPECT_EQ(rigwire::hil::read_png(file, "picture: ").bits, 16);
}

TEST(CommandLine, picture_says_what_is_allowed) {
  const std::string to = " -o " + testing::TempDir() + "no_picture.png";
  const auto refused = [&](const std::string& arguments) {
    const Result result = rigwire("picture " + arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    return result.output;
  };
  EXPECT_THAT(refused("unimog_vision"), HasSubstr("--output is required"));
  EXPECT_THAT(refused("unimog_vision --layer depht" + to), HasSubstr("did you mean depth?"));
  EXPECT_THAT(refused("unimog_vision --at 0s" + to), HasSubstr("allowed for example 12.5s"));
  EXPECT_THAT(refused("unimog_vision --travel 5kg" + to), HasSubstr("allowed for example 20km/h"));
  EXPECT_THAT(refused("unimog_vision --device front_camera --layer disparity --at 10ms" + to),
              HasSubstr("allowed of this camera image, depth, labels"));
  EXPECT_THAT(refused("unimog_vision --device gnss" + to),
              HasSubstr("allowed front_camera, stereo"));
  EXPECT_THAT(refused("excavator_pit" + to), HasSubstr("no camera"));
}

TEST(CommandLine, mistyped_verb_or_option_is_usage_with_a_suggestion) {
  const Result verb = rigwire("rnu excavator_pit");
  EXPECT_EQ(verb.code, 2);
  EXPECT_THAT(verb.output, HasSubstr("unknown verb, found \"rnu\""));
  EXPECT_THAT(verb.output, HasSubstr("did you mean run?"));
  const Result option = rigwire("run excavator_pit --durration 5s");
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.output, HasSubstr("did you mean --duration?"));
  EXPECT_EQ(rigwire("").code, 2);
  EXPECT_EQ(rigwire("run").code, 2);
}

TEST(CommandLine, options_of_a_replay_that_do_not_go_together_are_usage) {
  for (const char* bad :
       {"--verify --dashboard", "--verify --from 1s", "--verify --clock free", "--verify --loop",
        "--verify --ready-fd 1", "--json", "--dashboard --loop", "--dashboard --speed 2",
        "--dashboard --to 2s", "--dashboard --json", "--dashboard --clock free",
        "--dashboard --clock step", "--dashboard --control nowhere", "--control unix:/tmp/control",
        "--ready-fd 1", "--dashboard --from x"}) {
    const Result result = rigwire(std::string("replay /tmp ") + bad);
    EXPECT_EQ(result.code, 2) << bad << result.output;
    EXPECT_THAT(result.output, HasSubstr("allowed")) << bad;
  }
}

TEST(CommandLine, bad_option_values_are_usage) {
  for (const char* bad :
       {"--clock warp", "--log-level loud", "--clock scaled:0", "--duration -5s", "--duration 0",
        "--duration nan", "--duration 5kg", "--status blinking", "--seed x", "--seed -1"}) {
    EXPECT_EQ(rigwire(std::string("run excavator_pit --dry-run ") + bad).code, 2) << bad;
  }
}

TEST(CommandLine, an_empty_value_is_refused_for_every_option_and_word_of_every_verb) {
  for (const auto& [arguments, name] : std::vector<std::pair<std::string, std::string>>{
           {"run excavator_pit --dry-run --duration ''", "--duration"},
           {"run excavator_pit --dry-run --duration=", "--duration"},
           {"run excavator_pit --dry-run --seed ''", "--seed"},
           {"run excavator_pit --dry-run --seed=", "--seed"},
           {"run excavator_pit --dry-run --set ''", "--set"},
           {"run excavator_pit --dry-run --set seed=2 --set ''", "--set"},
           {"run excavator_pit --dry-run --clock ''", "--clock"},
           {"run excavator_pit --dry-run --status ''", "--status"},
           {"run excavator_pit --dry-run --report ''", "--report"},
           {"run excavator_pit --dry-run --report= --seed 2", "--report"},
           {"run excavator_pit --dry-run --truth ''", "--truth"},
           {"run excavator_pit --dry-run --lidar-truth ''", "--lidar-truth"},
           {"run excavator_pit --dry-run --camera-truth ''", "--camera-truth"},
           {"run ''", "rig"},
           {"check '' --json", "rig"},
           {"check excavator_pit --set ''", "--set"},
           {"list ''", "kind"},
           {"describe ''", "device"},
           {"describe --dbc ''", "--dbc"},
           {"describe --dbc unimog_forest --bus ''", "--bus"},
           {"describe --valve-map ''", "--valve-map"},
           {"schema ''", "of"},
           {"completion ''", "shell"}}) {
    const Result result = rigwire(arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_THAT(result.output, StartsWith("rigwire: " + name + ": empty")) << arguments;
  }
}

TEST(CommandLine, results_that_find_the_disk_full_are_a_failure_that_says_so) {
  for (const char* verb :
       {"list rigs", "check excavator_pit --print", "run excavator_pit --dry-run", "schema"}) {
    const Result result = rigwire(std::string(verb) + " >/dev/full");
    EXPECT_EQ(result.code, 1) << verb;
    EXPECT_THAT(result.output, HasSubstr("standard output is not complete: No space left")) << verb;
  }
}

TEST(CommandLine, what_a_terminal_would_obey_is_never_printed_raw) {
  for (const char* arguments :
       {"run \"$(printf 'pit\\033[2J')\"", "check excavator_pit --set \"$(printf 'a\\033]0;b=1')\"",
        "list \"$(printf 'r\\233igs')\"", "run excavator_pit --duration \"$(printf '\\033[2J')\"",
        "\"$(printf 'r\\033un')\""}) {
    const Result result = rigwire(arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_THAT(result.output, Not(HasSubstr("\x1b")));
    EXPECT_THAT(result.output, Not(HasSubstr("\x9b")));
    EXPECT_THAT(result.output, testing::AnyOf(HasSubstr("\\u001b"), HasSubstr("\\x9b")));
  }
}

TEST(CommandLine, too_few_open_files_is_the_environments_fault_whatever_they_are_for) {
  for (const char* arguments :
       {"run excavator_pit --duration 100ms --clock free", "check excavator_pit"}) {
    const Result result = in_shell("ulimit -n 8; ", arguments);
    EXPECT_EQ(result.code, 3) << result.output;
    EXPECT_THAT(result.output, HasSubstr("open files permitted: found 8, allowed 32 or more"));
  }
}

TEST(CommandLine, a_working_folder_that_is_deleted_is_told_in_words) {
  const std::string gone = "cd $(mktemp -d) && rmdir $PWD && ";
  const Result check = in_shell(gone, "check excavator_pit --set seed=2");
  EXPECT_EQ(check.code, 0) << check.output;
  const Result run = in_shell(gone, "run excavator_pit --set devices.gnss.path=gnss --duration 1s");
  EXPECT_EQ(run.code, 2) << run.output;
  EXPECT_THAT(run.output, HasSubstr("must be an absolute path"));
  EXPECT_THAT(run.output, Not(HasSubstr("filesystem error")));
}

TEST(CommandLine, describe_takes_a_type_or_the_name_of_a_rigs_device) {
  const Result by_type = rigwire("describe velodyne-hdl-32e");
  EXPECT_EQ(by_type.code, 0);
  EXPECT_THAT(by_type.output, HasSubstr("1206"));
  EXPECT_EQ(rigwire("describe lidar").output, by_type.output);
  EXPECT_EQ(rigwire("describe radar").code, 2);
}

TEST(CommandLine, rig_is_found_by_name_and_by_path) {
  const Result by_name = rigwire("check excavator_pit");
  EXPECT_EQ(by_name.code, 0) << by_name.output;
  const Result by_path = rigwire("check " RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml");
  EXPECT_EQ(by_path.code, 0) << by_path.output;
  const Result missing = rigwire("check excavator_pti");
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.output, HasSubstr("did you mean excavator_pit?"));
}

TEST(CommandLine, findings_of_a_rig_are_usage_and_json_holds_them) {
  const Result text = rigwire("check excavator_pit --set devices.gnss.ratte=5");
  EXPECT_EQ(text.code, 2);
  EXPECT_THAT(text.output, HasSubstr("devices.gnss.ratte: unknown key, did you mean rate?"));
  const Result json = rigwire("check excavator_pit --json --set devices.gnss.ratte=5");
  EXPECT_EQ(json.code, 2);
  const auto parsed = nlohmann::json::parse(json.output);
  EXPECT_EQ(parsed["ok"], false);
  EXPECT_EQ(parsed["problems"][0]["suggestion"], "rate");
  const auto good = nlohmann::json::parse(rigwire("check excavator_pit --json").output);
  EXPECT_EQ(good["ok"], true);
  EXPECT_EQ(good["devices"].size(), 9u);
}

TEST(CommandLine, print_says_where_values_came_from) {
  const Result result = rigwire("check excavator_pit --print --set devices.gnss.rate=5");
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.output, testing::ContainsRegex("rate: 5 Hz +# --set devices.gnss.rate=5\n"));
  EXPECT_THAT(result.output, testing::ContainsRegex("excavator_ref18t.yaml:[0-9]+\n"));
  EXPECT_THAT(result.output, testing::ContainsRegex("# default\n"));
}

TEST(CommandLine, dry_run_prints_the_plan_and_opens_nothing) {
  const Result result = rigwire("run excavator_pit --dry-run --clock free --duration 20s");
  EXPECT_EQ(result.code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("1808.4 packets/s"));
  EXPECT_THAT(result.output, HasSubstr("valves"));
}

/// The page's table is the program's: the same pairs of target and kind, with the same sentences.
/// Its second column has the types of devices, with a star for many.
TEST(CommandLine, the_pages_table_of_faults_is_the_programs) {
  std::ifstream page(RIGWIRE_SOURCE_DIR "/docs/faults.md");
  std::set<std::vector<std::string>> rows;  // type, pattern, text
  std::string line;
  while (std::getline(page, line) && !line.starts_with("| `type` | of |")) {
  }
  while (std::getline(page, line) && line.starts_with('|')) {
    static const std::regex row(R"(\| `([a-z_]+)` \| (.*) \| (.*) \|)");
    std::smatch cells;
    if (std::regex_match(line, cells, row)) {
      std::istringstream patterns(cells[2]);
      for (std::string pattern; std::getline(patterns >> std::ws, pattern, ',');) {
        rows.insert({cells[1], pattern.substr(1, pattern.size() - 2), cells[3]});
      }
    }
  }
  EXPECT_GT(rows.size(), 60U);
  std::set<std::vector<std::string>> used;
  for (const auto& fault : nlohmann::json::parse(rigwire("list faults --json").output)) {
    const auto stands = [&](const std::vector<std::string>& row) {
      return row[0] == fault["type"] && row[2] == fault["text"] &&
             ::fnmatch(row[1].c_str(), std::string(fault["on"]).c_str(), 0) == 0;
    };
    const auto found = std::ranges::find_if(rows, stands);
    EXPECT_NE(found, rows.end()) << fault;
    std::ranges::copy_if(rows, std::inserter(used, used.end()), stands);
  }
  for (const std::vector<std::string>& row : rows) {
    EXPECT_TRUE(used.contains(row))
        << "`" << row[0] << "` of " << row[1] << ": the program has none";
  }
}

/// The page's table of what can be set while a device runs is the program's: key, type of device,
/// and how.
TEST(CommandLine, the_pages_table_of_settings_is_the_programs) {
  std::ifstream page(RIGWIRE_SOURCE_DIR "/docs/control.md");
  std::set<std::vector<std::string>> rows;  // key, pattern, by
  std::string line;
  while (std::getline(page, line) && !line.starts_with("| key | of | same as |")) {
  }
  while (std::getline(page, line) && line.starts_with('|')) {
    static const std::regex row(R"(\| `([a-z0-9_.]+)` \| (.*) \| (.*) \|)");
    std::smatch cells;
    if (std::regex_match(line, cells, row)) {
      std::istringstream patterns(cells[2]);
      for (std::string pattern; std::getline(patterns >> std::ws, pattern, ',');) {
        rows.insert({cells[1], pattern.substr(1, pattern.size() - 2), cells[3]});
      }
    }
  }
  EXPECT_GT(rows.size(), 30U);
  std::set<std::vector<std::string>> used;
  for (const auto& type : device_types()) {
    for (const auto& key : type.fresh()->live_keys()) {
      const auto stands = [&](const std::vector<std::string>& row) {
        return row[0] == key.key && row[2] == key.by &&
               ::fnmatch(row[1].c_str(), std::string(type.named.name).c_str(), 0) == 0;
      };
      EXPECT_TRUE(std::ranges::any_of(rows, stands)) << type.named.name << " " << key.key;
      std::ranges::copy_if(rows, std::inserter(used, used.end()), stands);
    }
  }
  for (const std::vector<std::string>& row : rows) {
    EXPECT_TRUE(used.contains(row))
        << "`" << row[0] << "` of " << row[1] << ": the program has none";
  }
  const Result told = rigwire("describe ublox-neo-7p");
  EXPECT_THAT(told.output, HasSubstr("settable  rate, baud, nmea_sentences, ubx_messages, while"));
}

TEST(CommandLine, lists_know_what_there_is) {
  EXPECT_THAT(rigwire("list devices").output, HasSubstr("velodyne-hdl-32e"));
  EXPECT_THAT(rigwire("list rigs").output, HasSubstr("excavator_pit"));
  EXPECT_THAT(rigwire("list machines").output, HasSubstr("excavator_ref18t"));
  EXPECT_THAT(rigwire("list scenes").output, HasSubstr("open_pit"));
  EXPECT_EQ(nlohmann::json::parse(rigwire("list devices --json").output).size(),
            device_types().size());
  const Result typo = rigwire("list rgis");
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.output, HasSubstr("did you mean rigs?"));
}

TEST(CommandLine, describe_writes_the_data_sheet_of_a_canopen_node) {
  const Result eds = rigwire("describe --eds excavator_pit");
  EXPECT_EQ(eds.code, 0) << eds.output;
  EXPECT_THAT(eds.output, testing::StartsWith("[FileInfo]\r\n"));
  EXPECT_THAT(eds.output, testing::HasSubstr("[6001]\r\nParameterName=measuring units per "
                                             "revolution\r\nObjectType=0x7\r\n"));
  EXPECT_THAT(eds.output, testing::HasSubstr("DefaultValue=0x4000\r\n"));  // 14 bits
  EXPECT_EQ(rigwire("describe --eds excavator_pit --device swing_encoder").output, eds.output);
  EXPECT_EQ(rigwire("describe --eds excavator_pit --device gnss").code, 2);
  EXPECT_EQ(rigwire("describe --eds unimog_forest").code, 2);
}

TEST(CommandLine, describe_writes_the_dbc_file_of_a_rigs_bus) {
  const Result dbc = rigwire("describe --dbc unimog_forest");
  EXPECT_EQ(dbc.code, 0) << dbc.output;
  EXPECT_THAT(dbc.output, testing::StartsWith("VERSION \"\"\n"));
  EXPECT_THAT(dbc.output, testing::HasSubstr("BO_ 2364539943 eec1: 8 vehicle\n"));  // 0CF00427
  EXPECT_THAT(dbc.output, testing::HasSubstr(" SG_ latitude : "));  // position_from: gnss
  EXPECT_EQ(rigwire("describe --dbc unimog_forest --bus can").output, dbc.output);
  const Result unknown = rigwire("describe --dbc unimog_forest --bus rear");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.output, testing::HasSubstr("has no CAN bus \"rear\", allowed can"));
  EXPECT_EQ(rigwire("describe").code, 2);
}

TEST(CommandLine, describe_says_whether_faults_can_be_ordered) {
  EXPECT_THAT(rigwire("describe ublox-neo-7p").output, HasSubstr("faults    its key `faults`"));
  for (const char* without : {"usb-passthrough", "replay"}) {
    EXPECT_THAT(rigwire("describe " + std::string(without)).output,
                HasSubstr("faults    none; see those of its wire"))
        << without;
  }
}

TEST(CommandLine, scenes_and_machines_are_described_by_their_names) {
  for (const char* name : {"scene", "open_pit", "unimog_u5023", "wheeled"}) {
    EXPECT_EQ(rigwire("describe " + std::string(name)).code, 0) << name;
  }
}

TEST(CommandLine, an_argument_that_is_not_utf8_is_refused_and_not_shown_as_it_stands) {
  const Result check = rigwire("check \"$(printf 'caf\\351\\033[2J.yaml')\"");
  EXPECT_EQ(check.code, 2);
  EXPECT_THAT(check.output,
              HasSubstr("argument caf\\xe9\\u001b[2J.yaml: not UTF-8, found byte 0xE9"));
}

TEST(CommandLine, every_device_is_described) {
  for (const auto& device : nlohmann::json::parse(rigwire("list devices --json").output)) {
    const std::string type = device["name"];
    const Result text = rigwire("describe " + type);
    EXPECT_EQ(text.code, 0);
    EXPECT_THAT(text.output, HasSubstr("follows"));
    EXPECT_THAT(text.output, HasSubstr("keys in a rig"));
    const auto json = nlohmann::json::parse(rigwire("describe --json " + type).output);
    EXPECT_FALSE(json["messages"].empty()) << type;
    EXPECT_EQ(json["quantities"].empty(), type == "usb-passthrough" || type == "dbc-node" ||
                                              type == "ntrip-caster" || type == "replay")
        << type;
  }
  EXPECT_EQ(rigwire("describe velodyne").code, 2);
}

TEST(CommandLine, described_page_is_a_file) {
  const std::string text = rigwire("describe gige-stereo").output;
  const std::string begin = "page      ";
  const std::size_t from = text.find(begin) + begin.size();
  const std::string page = text.substr(from, text.find('\n', from) - from);
  EXPECT_TRUE(page.ends_with("docs/devices/gige-camera.md")) << page;
  EXPECT_TRUE(std::filesystem::is_regular_file(page)) << page;
}

TEST(CommandLine, described_keys_name_one_type_and_large_limits_all_their_digits) {
  const std::string text = rigwire("describe iso-valves").output;
  EXPECT_THAT(text, HasSubstr("type: choice, default iso-valves"));
  EXPECT_THAT(text, Not(HasSubstr("velodyne-vlp-16")));
  EXPECT_THAT(text, Not(HasSubstr("e+0")));
  EXPECT_THAT(rigwire("describe starfire-3000").output, HasSubstr("0 s .. 31536000 s"));
}

TEST(CommandLine, help_of_a_verb_begins_with_the_program) {
  EXPECT_THAT(rigwire("run --help").output, HasSubstr("Usage: rigwire run [OPTIONS] rig"));
}

TEST(CommandLine, an_address_beyond_loopback_is_refused_with_the_way_that_there_is) {
  const Result run = rigwire("run excavator_pit --control 0.0.0.0:7001");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.output,
              HasSubstr("--control: not an address of a control server, found \"0.0.0.0:7001\", "
                        "allowed unix:FILE, or PORT of this host as 127.X.Y.Z:PORT (from another "
                        "one: ssh -L)"));
}

TEST(CommandLine, plan_names_the_bus_and_counts_one_epoch) {
  const std::string plan = rigwire("run excavator_pit --dry-run").output;
  EXPECT_THAT(plan, HasSubstr("CAN bus can at 250000 bit/s"));
  EXPECT_THAT(plan, Not(HasSubstr("can can")));
  EXPECT_THAT(plan, HasSubstr(" 1 epoch/s"));
}

TEST(CommandLine, cylinder_beyond_its_pins_is_refused_by_its_key) {
  const Result check = rigwire("check excavator_pit --set 'machine.excavator.boom_length=4 m'");
  EXPECT_EQ(check.code, 2);
  EXPECT_THAT(check.output,
              HasSubstr("machine.excavator.stick_cylinder.length_max: not reachable with these "
                        "pins, found "));
  EXPECT_THAT(check.output, Not(HasSubstr("length_max_m")));
}

TEST(CommandLine, doctor_tells_state_and_fix) {
  const Result result = rigwire("doctor --json");
  EXPECT_THAT(result.code, testing::AnyOf(0, 3));
  for (const auto& finding : nlohmann::json::parse(result.output)) {
    EXPECT_EQ(finding["health"] == "good", finding["fix"] == "") << finding;
    EXPECT_THAT(finding.dump(), Not(HasSubstr("@rigwire"))) << "no such group is made";
  }
}

/// Each key that is listed can be set to the value that is listed, and each section has keys.
TEST(CommandLine, keys_of_a_rig_are_those_that_set_takes) {
  const auto keys = [](const std::string& begin) {
    return nlohmann::json::parse(rigwire("list keys excavator_pit '" + begin + "' --json").output);
  };
  std::string sets;
  std::size_t count = 0;
  for (const auto& row : keys("devices.gnss.")) {
    const std::string key = row["key"];
    EXPECT_TRUE(key.starts_with("devices.gnss.")) << row;
    if (key.ends_with('.')) {
      EXPECT_FALSE(keys(key).empty()) << key;
    } else if (row["value"] != "") {
      sets += " --set '" + key + std::string(row["value"]) + "'";
      ++count;
    }
  }
  EXPECT_GT(count, 5U);
  const Result same = rigwire("check excavator_pit" + sets);
  EXPECT_EQ(same.code, 0) << same.output;
  EXPECT_EQ(same.output.substr(same.output.find("config")),
            rigwire("check excavator_pit").output.substr(same.output.find("config")));
  EXPECT_TRUE(keys("devices.nobody.").empty());
  EXPECT_EQ(rigwire("list keys").code, 2);
  EXPECT_EQ(rigwire("list devices excavator_pit").code, 2);
}

TEST(CommandLine, completion_scripts_are_printed) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Result result = rigwire(std::string("completion ") + shell);
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.output, HasSubstr("list rigs"));
    EXPECT_THAT(result.output, HasSubstr("list keys"));
  }
  EXPECT_EQ(rigwire("completion tcsh").code, 2);
}

TEST(CommandLine, bash_completion_completes_verbs_options_and_rigs) {
  const std::string script =
      "bash -c 'PATH=" RIGWIRE_BINARY_DIR
      ":$PATH; source <(rigwire completion bash); "
      "COMP_WORDS=(rigwire ch); COMP_CWORD=1; _rigwire; echo ${COMPREPLY[@]}; "
      "COMP_WORDS=(rigwire run exc); COMP_CWORD=2; _rigwire; echo ${COMPREPLY[@]}; "
      "COMP_WORDS=(rigwire describe velodyne-h); COMP_CWORD=2; _rigwire; echo ${COMPREPLY[@]}; "
      "COMP_WORDS=(rigwire run --clock free excavator_pit --set devices.gnss.ra); COMP_CWORD=6; "
      "_rigwire; echo ${COMPREPLY[@]}; "
      "COMP_WORDS=(rigwire check excavator_pit --set devices.gn); COMP_CWORD=4; "
      "_rigwire; echo ${COMPREPLY[@]}; "
      "COMP_WORDS=(rigwire check --set devices.gn); COMP_CWORD=3; _rigwire; "
      "echo none: ${COMPREPLY[@]}'";
  FILE* pipe = ::popen(("timeout 60 " + script).c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::array<char, 4096> buffer{};
  std::string output;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.append(buffer.data(), count);
  }
  ::pclose(pipe);
  EXPECT_EQ(output,
            "check\nexcavator_can excavator_own_can excavator_pit excavator_tracks excavator_usb "
            "excavator_vision\nvelodyne-hdl-32e "
            "velodyne-hdl-64e "
            "velodyne-hdl-64e-s3\n"
            "devices.gnss.rate=\ndevices.gnss.\nnone:\n");
}

}  // namespace
