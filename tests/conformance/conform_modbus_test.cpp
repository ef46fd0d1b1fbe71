// `rigwire conform` against our valve driver, against it with each fault of its line, and against a
// server that nobody here wrote (pymodbus of Debian): the test of the checks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <string>

#include "child_process.h"
#include "modbus_programs.h"
#include "private_wires.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing::AnyOf;
using testing::Contains;
using testing::IsSupersetOf;
using testing::Not;

const std::string kConform = RIGWIRE_BINARY_DIR "/rigwire conform ";
const std::string kProfile = RIGWIRE_SOURCE_DIR "/configs/profiles/valve_driver";
// All but timing, which is the host's on a busy machine.
const std::string kTcpChapters =
    "modbus-tcp modbus/4.1 modbus/5.1 modbus/6.1 modbus/6.2 modbus/6.3 modbus/6.4 modbus/6.5 "
    "modbus/6.6 modbus/6.11 modbus/6.12 modbus/6.13 modbus/6.16 modbus/6.17 modbus/6.20 "
    "modbus/6.21 modbus/robustness ";
const std::string kRtuChapters =
    "modbus-rtu modbus/5.1 modbus/6.3 modbus/6.4 modbus/6.6 modbus/6.7 modbus/6.8 modbus/6.9 "
    "modbus/6.12 modbus/6.16 modbus/6.17 modbus/6.21 modbus/robustness ";

class ConformModbus : public testing::Test {
 protected:
  /// A valve driver alone, on a TCP server of its own or on a line of wire rtu.
  std::string rig(const std::string& fault = "", bool rtu = false) {
    const std::filesystem::path file = wires_.folder / "rig.yaml";
    std::ofstream text(file);
    text << "machine: {type: excavator, digs: false}\n";
    const std::string faults = fault.empty() ? "" : ", faults: [{at: 0 s, " + fault + "}]";
    if (rtu) {
      text << "modbus:\n  line: {wire: rtu" << faults << "}\n"
           << "devices:\n  valves: {type: valve-driver, line: line}\n";
    } else {
      text << "devices:\n  valves: {type: valve-driver" << faults << "}\n";
    }
    return "'rig:" + file.string() + "#valves' ";
  }

  /// Runs it with --json, and reads that.
  Json conform(const std::string& suite, const std::string& endpoint, const std::string& profile,
               const std::string& more, int exit_code) {
    const std::filesystem::path file = wires_.folder / "result.json";
    const ProgramResult ran = run_program(kConform + suite + " " + endpoint + "--profile " +
                                              profile + " --json " + file.string() + " " + more,
                                          120);
    EXPECT_EQ(ran.exit_code, exit_code) << ran.text;
    std::ifstream stream(file);
    return stream ? Json::parse(stream) : Json();
  }

  static std::set<std::string> with_verdict(const Json& result, const std::string& verdict) {
    std::set<std::string> ids;
    for (const Json& each : result.at("cases")) {
      if (each.at("verdict") == verdict) {
        ids.insert(each.at("id").get<std::string>());
      }
    }
    return ids;
  }

  test::PrivateWires wires_;
};

TEST_F(ConformModbus, OurValveDriverOnTcpPassesWhatItClaims) {
  const Json result =
      conform("modbus-tcp", rig(), kProfile + ".yaml", "--writes --robustness " + kTcpChapters, 0);
  EXPECT_EQ(result.at("counts").at("fail"), 0);
  EXPECT_EQ(result.at("counts").at("lenient"), 0);
  EXPECT_EQ(result.at("counts").at("error"), 0);
  EXPECT_GT(result.at("counts").at("pass"), 90);
}

TEST_F(ConformModbus, OurValveDriverOnALinePassesWhatItClaims) {
  const Json result = conform("modbus-rtu", rig("", true), kProfile + "_rtu.yaml",
                              "--writes --robustness " + kRtuChapters, 0);
  EXPECT_EQ(result.at("counts").at("fail"), 0);
  EXPECT_EQ(result.at("counts").at("lenient"), 0);
  EXPECT_EQ(result.at("counts").at("error"), 0);
  EXPECT_GT(result.at("counts").at("pass"), 75);
}

struct Mutant {
  const char* name;
  const char* fault;
  bool rtu;
};
void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.fault;
}

class EachMutant : public ConformModbus, public testing::WithParamInterface<Mutant> {};

// A suite that passes a broken device is none.
TEST_P(EachMutant, FailsInAtLeastOneCase) {
  const auto& [name, fault, rtu] = GetParam();
  std::ofstream(wires_.folder / "profile.yaml")
      << std::ifstream(kProfile + (rtu ? "_rtu.yaml" : ".yaml")).rdbuf();
  const std::string profile = (wires_.folder / "profile.yaml").string();
  run_program("sed -i 's/^patience: .*/patience: 300 ms/' " + profile);
  const Json result =
      conform(rtu ? "modbus-rtu" : "modbus-tcp", rig(fault, rtu), profile,
              "--writes modbus/6.3/1 modbus/6.3/4 modbus/6.3/11 modbus/6.12/1 modbus/6.21/1", 5);
  EXPECT_FALSE(with_verdict(result, "fail").empty());
}

INSTANTIATE_TEST_SUITE_P(
    OfALine, EachMutant,
    testing::Values(Mutant{"delayed", "type: delayed, delay: 1 s", false},
                    Mutant{"exception", "type: exception", false},
                    Mutant{"silent", "type: silent", false}, Mutant{"lost", "type: lost", false},
                    Mutant{"junk", "type: junk", false},
                    Mutant{"split", "type: split, pause: 1 s", false},
                    Mutant{"truncated", "type: truncated", false},
                    Mutant{"frozen", "type: frozen, table: holding, first: 0, last: 43", false},
                    Mutant{"wrong_transaction", "type: wrong_transaction", false},
                    Mutant{"disconnect", "type: disconnect", false},
                    Mutant{"off", "type: 'off'", false},
                    Mutant{"wrong_check", "type: wrong_check", true},
                    Mutant{"noise", "type: noise, bit_error_rate: 5 %", true},
                    Mutant{"parity_mismatch", "type: parity_mismatch", true}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

constexpr const char* kServer = R"py(
import sys
from pymodbus.server import StartTcpServer
from pymodbus.datastore import ModbusSequentialDataBlock as Block
from pymodbus.datastore import ModbusSlaveContext, ModbusServerContext
from pymodbus.device import ModbusDeviceIdentification
tables = ModbusSlaveContext(di=Block(0, [1] * 101), co=Block(0, [0] * 101),
                            hr=Block(0, list(range(101))), ir=Block(0, list(range(101))),
                            zero_mode=True)
names = ModbusDeviceIdentification(info_name={'VendorName': 'pymodbus', 'ProductCode': 'PM',
                                              'MajorMinorRevision': '3.0.0'})
StartTcpServer(context=ModbusServerContext(slaves=tables, single=True), identity=names,
               address=('127.0.0.1', int(sys.argv[1])))
)py";

constexpr const char* kServersProfile = R"yaml(
unit: 1
functions: [1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 16, 17, 20, 21, 22, 23, 24, 43]
coils: ["0-100"]
discrete_inputs: ["0-100"]
holding_registers: ["0-100"]
input_registers: ["0-100"]
writable_coils: ["0-30"]
writable_registers: ["0-20"]
)yaml";

// What it finds in pymodbus 3.0.0, read by a person (docs/conformance.md), and the page of both.
TEST_F(ConformModbus, AServerOfOthersIsFoundWhereItIsWrong) {
  const auto port = std::to_string(test::free_port(SOCK_STREAM));
  std::ofstream(wires_.folder / "server.py") << kServer;
  std::ofstream(wires_.folder / "profile.yaml") << kServersProfile;
  test::ChildProcess server({"/usr/bin/python3", (wires_.folder / "server.py").string(), port},
                            wires_.folder / "log");
  ASSERT_TRUE(test::eventually([&] {
    return run_program("bash -c '</dev/tcp/127.0.0.1/" + port + "'").exit_code == 0;
  })) << server.output();
  const std::string endpoint = "tcp:127.0.0.1:" + port + " ";
  const Json ours = conform("modbus-tcp", rig(), kProfile + ".yaml", "--writes " + kTcpChapters, 0);
  std::filesystem::copy(wires_.folder / "result.json", wires_.folder / "ours.json");
  const std::string page = (wires_.folder / "page.html").string();
  const Json theirs = conform("modbus-tcp", endpoint, (wires_.folder / "profile.yaml").string(),
                              "--writes --html " + page + " --beside " +
                                  (wires_.folder / "ours.json").string() + " " + kTcpChapters,
                              5);
  const std::set<std::string> wrong = with_verdict(theirs, "fail");
  EXPECT_THAT(wrong,
              IsSupersetOf({"modbus-tcp/3.1.3/5", "modbus-tcp/3.1.3/6", "modbus-tcp/3.1.3/7"}));
  EXPECT_THAT(wrong, Not(Contains(AnyOf("modbus/6.3/1", "modbus/6.3/7", "modbus/6.3/9"))));
  std::ifstream stream(page);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(text, testing::HasSubstr("modbus-tcp/3.1.3/6"));
  EXPECT_THAT(text, testing::HasSubstr("tcp:127.0.0.1:" + port));
}

/// One thing that is wrong in what a script beside this file serves.
struct Defect {
  const char* name;
  const char* found_by;
  const char* of = nullptr;  ///< What the script calls it, where that is not the name.
  const char* verdict = "fail";
};
void PrintTo(const Defect& defect, std::ostream* out) {
  *out << defect.name;
}
const auto kNameOfDefect = [](const auto& defect) { return std::string(defect.param.name); };
const std::string kScripts = RIGWIRE_SOURCE_DIR "/tests/conformance/";

// No third-party server of files and queues was found: pymodbus answers with nothing.
class ConformModbusFiles : public ConformModbus, public testing::WithParamInterface<Defect> {
 protected:
  Json judge(const std::string& defect, const std::string& wanted, int exit_code) {
    const auto port = std::to_string(test::free_port(SOCK_STREAM));
    const test::ChildProcess server(
        {"/usr/bin/python3", kScripts + "modbus_files.py", port, defect}, wires_.folder / "log");
    EXPECT_TRUE(test::eventually([&] {
      return run_program("bash -c '</dev/tcp/127.0.0.1/" + port + "'").exit_code == 0;
    })) << server.output();
    std::ofstream(wires_.folder / "profile.yaml")
        << "functions: [20, 21, 24]\nfiles: ['4:0-199']\nwritable_files: ['4:0-3']\n"
           "queues: [1246]\npatience: 5 s\n";
    return conform("modbus-tcp", "tcp:127.0.0.1:" + port + " ",
                   (wires_.folder / "profile.yaml").string(), "--writes " + wanted, exit_code);
  }
};

TEST_F(ConformModbusFiles, FilesAndAQueuePass) {
  const Json result = judge("", "modbus/6.14 modbus/6.15 modbus/6.18", 0);
  EXPECT_EQ(result.at("counts").at("pass"), 22);
}

TEST_P(ConformModbusFiles, WhatIsWrongIsNoticed) {
  const auto& [name, found_by, of, verdict] = GetParam();
  const Json result =
      judge(of != nullptr ? of : name, found_by, verdict == std::string("fail") ? 5 : 0);
  EXPECT_THAT(with_verdict(result, verdict), Contains(found_by));
}

INSTANTIATE_TEST_SUITE_P(
    , ConformModbusFiles,
    testing::Values(
        Defect{"counts_registers", "modbus/6.14/1"}, Defect{"changes", "modbus/6.14/2"},
        Defect{"groups_turned", "modbus/6.14/3"}, Defect{"blocks_turned", "modbus/6.14/4"},
        Defect{"any_type", "modbus/6.14/5"}, Defect{"any_file", "modbus/6.14/7"},
        Defect{"wraps_records", "modbus/6.14/9"}, Defect{"any_length", "modbus/6.14/11"},
        Defect{"forgets", "modbus/6.15/1"}, Defect{"does_not_repeat", "modbus/6.15/1"},
        Defect{"writes_what_it_refuses", "modbus/6.15/3"},
        Defect{"queue_too_long", "modbus/6.18/1"}, Defect{"counts_values_alone", "modbus/6.18/1"},
        Defect{"empties_the_queue", "modbus/6.18/2"}, Defect{"queues_anywhere", "modbus/6.18/3"},
        Defect{"file_0_is_read", "modbus/6.14/6", "any_file"},
        Defect{"record_10000_is_read", "modbus/6.14/8", "wraps_records"},
        Defect{"six_bytes_are_a_group", "modbus/6.14/10", "any_length"},
        Defect{"half_a_group_is_one", "modbus/6.14/12", "any_length", "lenient"},
        Defect{"any_type_is_written", "modbus/6.15/2", "any_type"},
        Defect{"record_10000_is_written", "modbus/6.15/4", "wraps_records"},
        Defect{"nothing_is_written", "modbus/6.15/5", "any_length"},
        Defect{"less_is_written", "modbus/6.15/6", "any_length", "lenient"},
        Defect{"half_an_address_is_one", "modbus/6.18/4", "any_length", "lenient"}),
    kNameOfDefect);

struct BadClaim {
  const char* name;
  const char* profile;
  const char* told;
};
void PrintTo(const BadClaim& claim, std::ostream* out) {
  *out << claim.name;
}

class ConformModbusClaims : public ConformModbus, public testing::WithParamInterface<BadClaim> {};

TEST_P(ConformModbusClaims, AreRefusedBeforeAnybodyIsAsked) {
  std::ofstream(wires_.folder / "profile.yaml") << GetParam().profile;
  const ProgramResult ran = run_program(kConform + "modbus-tcp tcp:127.0.0.1:1 --profile " +
                                        (wires_.folder / "profile.yaml").string());
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_THAT(ran.text, testing::HasSubstr(GetParam().told));
}

INSTANTIATE_TEST_SUITE_P(
    , ConformModbusClaims,
    testing::Values(BadClaim{"files_without_their_function", "functions: [24]\nfiles: ['4:0-9']\n",
                             "with function 20"},
                    BadClaim{"record_10000", "functions: [20]\nfiles: ['4:0-10000']\n",
                             "found record 10000, allowed 0 .. 9999"},
                    BadClaim{"file_0", "functions: [20]\nfiles: ['0:1']\n",
                             "found \"0:1\", allowed a file, 1 to 65535"},
                    BadClaim{"no_records", "functions: [20]\nfiles: ['4']\n",
                             "found \"4\", allowed a file, 1 to 65535"},
                    BadClaim{"written_and_not_read",
                             "functions: [20, 21]\nfiles: ['4:0-9']\n"
                             "writable_files: ['4:8-12']\n",
                             "found \"4:8-12\", allowed records of files"},
                    BadClaim{"half_a_queue", "functions: [24]\nqueues: [1.5]\n",
                             "found 1.5, allowed whole numbers"}),
    [](const auto& claim) { return std::string(claim.param.name); });

class ConformModbusSerial : public ConformModbus, public testing::WithParamInterface<Defect> {
 protected:
  Json judge(const std::string& defect, const std::string& wanted, int exit_code) {
    const std::string line = (wires_.folder / "line").string();
    const test::ChildProcess server(
        {"/usr/bin/python3", kScripts + "modbus_serial_server.py", line, defect},
        wires_.folder / "log");
    EXPECT_TRUE(test::eventually([&] { return std::filesystem::is_symlink(line); }))
        << server.output();
    std::ofstream(wires_.folder / "profile.yaml")
        << "functions: [3, 6, 8, 11, 12]\nholding_registers: ['0-100']\n"
           "writable_registers: ['0-20']\npatience: 3 s\n";
    return conform("modbus-rtu", "serial:" + line + " ", (wires_.folder / "profile.yaml").string(),
                   "--writes " + wanted, exit_code);
  }
};

// What it finds in pymodbus 3.0.0 on a line, read by a person (docs/conformance.md).
TEST_F(ConformModbusSerial, AServerOfOthersIsFoundWhereItIsWrong) {
  const Json result =
      judge("", "modbus/6.3/1 modbus/6.6/1 modbus/6.8 modbus/6.9 modbus/6.10 modbus-rtu/2.2", 5);
  EXPECT_THAT(with_verdict(result, "fail"), IsSupersetOf({"modbus/6.8/2", "modbus/6.8/4"}));
  EXPECT_THAT(with_verdict(result, "pass"),
              IsSupersetOf({"modbus/6.3/1", "modbus/6.6/1", "modbus/6.8/1", "modbus/6.10/1",
                            "modbus/6.10/2", "modbus/6.10/3"}));
  EXPECT_THAT(with_verdict(result, "lenient"), Contains("modbus/6.10/4"));
}

TEST_F(ConformModbusSerial, AMessageThatIsCountedIsRight) {
  const Json result = judge("counts_its_message", "modbus/6.10/4", 0);
  EXPECT_EQ(result.at("counts").at("pass"), 1);
}

TEST_P(ConformModbusSerial, WhatIsWrongInItsLogIsNoticed) {
  const Json result = judge(GetParam().name, GetParam().found_by, 5);
  EXPECT_THAT(with_verdict(result, "fail"), Contains(GetParam().found_by));
}

INSTANTIATE_TEST_SUITE_P(, ConformModbusSerial,
                         testing::Values(Defect{"too_many_events", "modbus/6.10/1"},
                                         Defect{"an_event_of_no_type", "modbus/6.10/2"},
                                         Defect{"counts_other_events", "modbus/6.10/3"}),
                         kNameOfDefect);

TEST_F(ConformModbus, WhatIsExpectedToDeviateIsNoFailureAndASurpriseIs) {
  std::ofstream(wires_.folder / "expect.yaml")
      << "deviations:\n  - {id: modbus/6.3/1, verdict: fail, reason: answers only exceptions}\n";
  const std::string expect = "--expect " + (wires_.folder / "expect.yaml").string() + " ";
  conform("modbus-tcp", rig("type: exception"), kProfile + ".yaml", expect + "modbus/6.3/1", 0);
  conform("modbus-tcp", rig(), kProfile + ".yaml", expect + "modbus/6.3/1", 5);
}

TEST_F(ConformModbus, WithoutTheOptionNothingIsWritten) {
  const Json result =
      conform("modbus-tcp", rig(), kProfile + ".yaml", "modbus/6.6 modbus/6.12 modbus/6.3/1", 0);
  for (const Json& each : result.at("cases")) {
    if (each.at("danger") == "writes" && each.at("verdict") != "not applicable") {
      EXPECT_EQ(each.at("verdict"), "skipped") << each;
      EXPECT_TRUE(each.at("steps").empty()) << each;
    }
  }
}

TEST_F(ConformModbus, TsharkReadsTheCaptureOfACase) {
  const std::string folder = (wires_.folder / "captures").string();
  conform("modbus-tcp", rig(), kProfile + ".yaml", "--captures " + folder + " modbus/6.3/7", 0);
  const ProgramResult read = run_program("tshark -r " + folder +
                                         "/modbus_6.3_7.pcapng -d tcp.port==1502,mbtcp -Y modbus "
                                         "-T fields -e modbus.func_code -e modbus.exception_code "
                                         "2>/dev/null");
  EXPECT_THAT(read.text, testing::HasSubstr("3\t\n3\t3\n"));
}

TEST_F(ConformModbus, WhatCannotBeReachedIsNoFailureOfADevice) {
  const auto port = std::to_string(test::free_port(SOCK_STREAM));
  conform("modbus-tcp", "tcp:127.0.0.1:" + port + " ", kProfile + ".yaml", "modbus/6.3", 3);
  conform("modbus-tcp", "tcp:192.0.2.1 ", kProfile + ".yaml", "modbus/6.3", 2);
  conform("modbus-tcp", "serial:/dev/null ", kProfile + ".yaml", "modbus/6.3", 2);
  conform("modbus-tcp", rig(), kProfile + ".yaml", "modbus/6.99", 2);
}

TEST_F(ConformModbus, AProfileThatWasAskedForIsOneThatPasses) {
  const ProgramResult asked =
      run_program(kConform + "modbus-tcp " + rig() + "--make-profile --addresses 64", 80);
  ASSERT_EQ(asked.exit_code, 0) << asked.text;
  EXPECT_THAT(asked.text, testing::HasSubstr("functions: [3, 4, 6, 16, 17, 22, 23, 43]"));
  EXPECT_THAT(asked.text, testing::HasSubstr("holding_registers: [\"0-43\"]"));
  EXPECT_THAT(asked.text, testing::HasSubstr("input_registers: [\"0-61\"]"));
  std::ofstream(wires_.folder / "profile.yaml") << asked.text;
  conform("modbus-tcp", rig(), (wires_.folder / "profile.yaml").string(),
          "modbus/6.3/1 modbus/6.3/2 modbus/6.4/2 modbus/6.3/9", 0);
}

}  // namespace
}  // namespace rigwire::conformance
