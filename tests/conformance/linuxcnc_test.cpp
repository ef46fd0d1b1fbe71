// Control software that nobody here wrote: LinuxCNC, with its own Modbus master, closes the swing
// loop of the excavator over the valve driver's wire, as examples/linuxcnc has it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "modbus_programs.h"
#include "private_wires.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The values that `show pin` printed of a pin, in order.
std::vector<double> shown(const std::string& text, const std::string& pin) {
  std::vector<double> values;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string owner, type, direction, value, name;
    if (words >> owner >> type >> direction >> value >> name && name == pin) {
      values.push_back(std::strtod(value.c_str(), nullptr));
    }
  }
  return values;
}

TEST(LinuxCnc, ClosesTheSwingLoopOverModbus) {
  const test::PrivateWires wires;
  const fs::path run = wires.folder / "run";
  ChildProcess rig({RIGWIRE_BINARY_DIR "/rigwire", "run", "excavator_pit", "--isolated",
                    run.string(), "--status", "none"},
                   wires.folder / "log");
  ASSERT_TRUE(eventually([&] { return fs::exists(run / "run.json"); })) << rig.output();
  const auto told = nlohmann::json::parse(text_of(run / "run.json"));
  const auto address = told["replaced"]["devices.valves.address"].get<std::string>();

  // A user would do so: the example's files, with the address of this run.
  const fs::path folder = wires.folder / "linuxcnc";
  fs::create_directory(folder);
  fs::permissions(wires.folder, fs::perms::others_read | fs::perms::others_exec,
                  fs::perm_options::add);
  fs::permissions(folder, fs::perms::all);  // it keeps a socket in its home
  const fs::path examples = RIGWIRE_SOURCE_DIR "/examples/linuxcnc";
  fs::copy_file(examples / "swing.hal", folder / "swing.hal");
  std::ofstream(folder / "valves.ini") << std::regex_replace(
      text_of(examples / "valves.ini"), std::regex("TCP_IP = .*"), "TCP_IP = " + address);
  // Waits until a pin has stayed in a range for a second.
  std::ofstream(folder / "stays") << "#!/bin/sh\n"
                                     "times=0\n"
                                     "while [ $times -lt 10 ]; do\n"
                                     "  sleep 0.1\n"
                                     "  halcmd getp $1 | awk -v low=$2 -v high=$3 "
                                     "'{exit !($1 >= low && $1 <= high)}' &&\n"
                                     "    times=$((times + 1)) || times=0\n"
                                     "done\n";
  fs::permissions(folder / "stays", fs::perms::all);
  std::ofstream(folder / "script") << "loadusr -w sleep 0.5\n"
                                      "setp mb2hal.command.02.float 400\n"
                                      "loadusr -w sleep 2.5\n"
                                      "setp mb2hal.command.02.float 0\n"
                                      "setp ramp.in 12\n"
                                      "loadusr -w ./stays degrees.out 11.5 12.5\n"
                                      "show pin degrees.out\n"
                                      "setp ramp.in -8\n"
                                      "loadusr -w ./stays degrees.out -8.5 -7.5\n"
                                      "show pin degrees.out\n"
                                      "show pin mb2hal.read.num_errors\n"
                                      "show pin mb2hal.command.num_errors\n"
                                      "exit\n";
  // Its real-time part refuses to run as root.
  const std::string user =
      ::geteuid() == 0 ? "setpriv --reuid=nobody --regid=nogroup --clear-groups " : "";
  const ProgramResult result =
      run_program(user + "sh -c 'cd " + folder.string() + " && HOME=" + folder.string() +
                  " halrun -I -f swing.hal < script'");
  const std::vector<double> degrees = shown(result.text, "degrees.out");
  ASSERT_EQ(degrees.size(), 2U) << result.text;
  EXPECT_NEAR(degrees[0], 12.0, 0.5) << result.text;
  EXPECT_NEAR(degrees[1], -8.0, 0.5) << result.text;
  EXPECT_EQ(shown(result.text, "mb2hal.read.num_errors"), std::vector<double>{0.0});
  EXPECT_EQ(shown(result.text, "mb2hal.command.num_errors"), std::vector<double>{0.0});
}

}  // namespace
}  // namespace rigwire::conformance
