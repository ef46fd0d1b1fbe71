// Every command that the documents show is run as it is written there, or is named with the reason
// why it cannot be (document_commands.py has the table).
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;

// What runs beside the commands, see there.
constexpr std::array kGroups{"alone",       "excavator_pit", "unimog_forest",    "gator_campus",
                             "roller_road", "gator_heading", "lidar_park",       "modbus_rtu",
                             "socketcand",  "gpsd",          "excavator_vision", "unimog_vision",
                             "gator_rtk"};

std::string script(const test::PrivateWires& wires, const std::string& task) {
  return "/usr/bin/python3 " RIGWIRE_SOURCE_DIR
         "/tests/conformance/document_commands.py " RIGWIRE_SOURCE_DIR " " RIGWIRE_BINARY_DIR " " +
         (wires.folder / "scratch").string() + " " + task;
}

TEST(DocumentCommands, EachIsRunOrNamedWithTheReasonWhyNot) {
  const test::PrivateWires wires;
  std::string task = "table";
  for (const char* group : kGroups) {
    task += std::string(" ") + group;
  }
  ChildProcess table({"bash", "-c", script(wires, task)}, wires.folder / "table.log");
  EXPECT_EQ(table.wait(), 0) << table.output();
}

class DocumentCommands : public testing::TestWithParam<const char*> {};

TEST_P(DocumentCommands, WorkAsTheyAreWritten) {
  const test::PrivateWires wires;
  // Ports and paths are the documents': in namespaces of its own they collide with nobody's.
  const std::string root = ::geteuid() == 0 ? "" : "--map-root-user ";
  const std::string own = "unshare " + root + "--net --mount ";
  ChildProcess permitted({"bash", "-c", own + "true"}, wires.folder / "permitted.log");
  if (permitted.wait() != 0) {
    GTEST_SKIP() << "this host permits no namespaces: " << permitted.output();
  }
  const std::string inside =
      "ip link set lo up; mkdir -p /tmp/rigwire; mount -t tmpfs tmpfs /tmp/rigwire; exec " +
      script(wires, std::string("run ") + GetParam());
  ChildProcess all({"bash", "-c", own + "bash -euc '" + inside + "'"}, wires.folder / "all.log");
  EXPECT_EQ(all.wait(290s), 0) << all.output();
}

INSTANTIATE_TEST_SUITE_P(Beside, DocumentCommands, testing::ValuesIn(kGroups),
                         [](const auto& group) { return std::string(group.param); });

}  // namespace
}  // namespace rigwire
