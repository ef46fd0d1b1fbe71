// Real Modbus RTU masters against two valve drivers on a real pseudo-terminal and the wall clock:
// Debian's mbpoll, libmodbus through our master, pymodbus, and tshark as an independent decoder. A
// client that is not installed is a failure. What the line costs is held from below only: a busy
// host may be late, never early.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "drivers/descriptor.h"
#include "drivers/modbus_master.h"
#include "modbus_programs.h"
#include "modbus_rtu_rig.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using drivers::ModbusMaster;
using protocols::modbus::ExceptionCode;
using ::testing::HasSubstr;
namespace reg = emulators::valve_registers;

class ModbusRtuClients : public ::testing::Test {
 protected:
  static emulators::ModbusRtuSettings line() {
    emulators::ModbusRtuSettings settings;
    settings.line.timing.baud = 38'400;
    return settings;
  }
  static emulators::ValveDriverSettings without_watchdog() {
    emulators::ValveDriverSettings settings;
    settings.amplifier.parameters.watchdog = Duration{0};
    settings.amplifier.spool_fault_delay = Duration{0};
    return settings;
  }
  ModbusMaster master(std::uint8_t unit) const {
    drivers::ModbusMasterSettings settings;
    settings.serial = drivers::ModbusSerialPort{rig_.path(), rig_.timing()};
    settings.unit = unit;
    settings.response_timeout = 60s;
    ModbusMaster result(settings);
    const auto outcome = result.connect();
    EXPECT_TRUE(outcome) << outcome.error;
    return result;
  }
  ProgramResult mbpoll(const std::string& options, const std::string& values = "") const {
    const ProgramResult result = run_program("mbpoll -m rtu -b 38400 -P even -1 -0 -o 10 " +
                                             options + " " + rig_.path() + " " + values);
    EXPECT_NE(result.exit_code, 127) << "mbpoll is not installed: " << result.text;
    return result;
  }

  ModbusRtuRig rig_{line(), without_watchdog()};
};

TEST_F(ModbusRtuClients, MbpollReadsAndWritesBothUnits) {
  EXPECT_THAT(mbpoll("-a 1 -t 4 -r 0", "1 300").text, HasSubstr("Written 2 references"));
  EXPECT_THAT(mbpoll("-a 7 -t 4 -r 0", "1 65136").text, HasSubstr("Written 2 references"));
  EXPECT_EQ(mbpoll_values(mbpoll("-a 1 -t 4 -r 0 -c 2").text).at(1), 300);
  EXPECT_EQ(mbpoll_values(mbpoll("-a 7 -t 4 -r 0 -c 2").text).at(1), -400);
  EXPECT_EQ(mbpoll_values(mbpoll("-a 1 -t 3 -r 0 -c 22").text).at(18), 2400);
  EXPECT_THAT(mbpoll("-a 1 -t 4 -r 1", "1001").text, HasSubstr("Illegal data value"));
  EXPECT_THAT(mbpoll("-a 1 -t 4 -r 500 -c 1").text, HasSubstr("Illegal data address"));
  EXPECT_THAT(mbpoll("-a 9 -o 0.2 -t 4 -r 0 -c 1").text, HasSubstr("timed out"));
}

TEST_F(ModbusRtuClients, LibmodbusFindsTheLineAsSlowAsItIs) {
  auto m = master(1);
  std::array<std::uint16_t, 60> in{};
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = m.read_input_registers(0, in);
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_TRUE(outcome) << outcome.error;
  EXPECT_EQ(in[reg::kSupplyVoltage], 2400);
  const auto& timing = rig_.timing();
  EXPECT_GE(took, timing.characters(8) + timing.frame_silence() + timing.characters(5 + 120));
}

TEST_F(ModbusRtuClients, LibmodbusCyclesAndTheSerialFunctionsAnswer) {
  using namespace protocols::modbus;
  auto m = master(1);
  const std::uint16_t commands[] = {1, 100, 0, 0, 0, 0, 0, 0, 0, 5};
  std::array<std::uint16_t, 22> in{};
  const auto outcome = m.read_write_registers(0, commands, reg::kInputMirror, in);
  EXPECT_TRUE(outcome) << outcome.error;
  EXPECT_EQ(in[reg::kHeartbeatEcho], 5);
  EXPECT_EQ(m.write_register(1, 1001).exception, ExceptionCode::illegal_data_value);
  std::array<std::uint8_t, kPduMaximum> answer{};
  std::size_t size = 0;
  const std::uint8_t query[] = {8, 0, 0, 0xA5, 0x37};
  ASSERT_TRUE(m.transact(query, answer, size));
  EXPECT_THAT(std::span(answer).first(size), ::testing::ElementsAreArray(query));
  const Pdu identification =
      encode_request(ReadDeviceIdentification{IdentificationAccess::basic, 0});
  ASSERT_TRUE(m.transact(identification.view(), answer, size));
  const auto objects = decode_response(std::span(answer).first(size));
  ASSERT_TRUE(objects.ok());
  EXPECT_EQ(std::get<DeviceIdentificationResponse>(*objects).find(1), "RW-HVD8");
}

// With parity "N": glibc refuses pyserial's second attempt at a parity that no pseudo-terminal has.
TEST_F(ModbusRtuClients, PymodbusReadsWritesAndBroadcasts) {
  const auto script = std::filesystem::temp_directory_path() /
                      ("rigwire_modbus_" + std::to_string(::getpid()) + ".py");
  std::ofstream(script) << R"(
import sys
from pymodbus.client import ModbusSerialClient
client = ModbusSerialClient(sys.argv[1], baudrate=38400, timeout=60)
assert client.connect()
assert not client.write_registers(0, [1, 250], slave=1).isError()
assert client.read_holding_registers(1, 1, slave=1).registers == [250]
assert client.read_input_registers(18, 1, slave=7).registers == [2400]
refused = client.write_register(1, 1001, slave=1)
assert refused.isError() and refused.exception_code == 3, refused
client.params.broadcast_enable = True
client.write_registers(0, [1, 100], slave=0)
client.close()
print("all well")
)";
  const auto result = run_program("/usr/bin/python3 " + script.string() + " " + rig_.path());
  std::filesystem::remove(script);
  EXPECT_THAT(result.text, HasSubstr("all well")) << "(package python3-pymodbus)";
}

TEST_F(ModbusRtuClients, TsharkUnderstandsEveryFrameBothWays) {
  using namespace protocols::modbus;
  auto m = master(7);
  const std::uint16_t words[] = {1, 250};
  ASSERT_TRUE(m.write_registers(0, words));
  std::array<std::uint16_t, 62> in{};
  ASSERT_TRUE(m.read_input_registers(0, in));
  EXPECT_FALSE(m.write_register(1, 1001));
  std::array<std::uint8_t, kPduMaximum> answer{};
  std::size_t size = 0;
  // Not function 17: tshark takes no frame of 4 bytes for Modbus.
  ASSERT_TRUE(m.transact(encode_request(MaskWriteRegister{9, 1, 2}).view(), answer, size));
  ASSERT_TRUE(
      m.transact(encode_diagnostics(SubFunction::bus_message_count, 0).view(), answer, size));
  m.close();
  const Capture capture(rig_.segments(), "mbrtu");
  EXPECT_THAT(capture.complaints(), ::testing::IsEmpty());
  const auto fields = capture.tshark(
      "-Y mbrtu -T fields -e mbrtu.unit_id -e modbus.func_code"
      " -e modbus.exception_code");
  EXPECT_THAT(fields.text, HasSubstr("7\t16\t\n7\t16\t\n7\t4\t\n7\t4\t\n7\t6\t\n7\t6\t3\n7\t22\t\n"
                                     "7\t22\t\n7\t8\t\n7\t8\t\n"));
}

TEST_F(ModbusRtuClients, TsharkWouldComplain) {
  auto m = master(1);
  std::array<std::uint16_t, 4> in{};
  ASSERT_TRUE(m.read_input_registers(0, in));
  auto segments = rig_.segments();
  ASSERT_EQ(segments.size(), 2U);
  segments[1].bytes.back() ^= 1;
  EXPECT_THAT(Capture(segments, "mbrtu").complaints(), ::testing::ElementsAre(2));
}

TEST_F(ModbusRtuClients, ARequestInTwoWritesWithGarbageBeforeItIsServed) {
  const drivers::Descriptor port(::open(rig_.path().c_str(), O_RDWR | O_NOCTTY));
  ASSERT_TRUE(port.open());
  const std::uint8_t pdu[] = {6, 0, reg::kHeartbeat, 0, 5};
  const auto request = protocols::modbus::encode_rtu(1, pdu);
  const auto write = [&](std::span<const std::uint8_t> bytes) {
    EXPECT_EQ(::write(port.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    std::this_thread::sleep_for(30ms);  // the gap that must not matter
  };
  write(std::array<std::uint8_t, 3>{0xFF, 0x00, 0x13});
  write(request.view().first(3));
  write(request.view().subspan(3));
  std::vector<std::uint8_t> answer;
  pollfd waiting{port.get(), POLLIN, 0};
  while (answer.size() < request.size && ::poll(&waiting, 1, 60'000) == 1) {
    std::array<std::uint8_t, 64> bytes{};
    const auto got = ::read(port.get(), bytes.data(), bytes.size());
    ASSERT_GT(got, 0);
    answer.insert(answer.end(), bytes.begin(), bytes.begin() + got);
  }
  EXPECT_THAT(answer, ::testing::ElementsAreArray(request.view()));
}

}  // namespace
}  // namespace rigwire::conformance
