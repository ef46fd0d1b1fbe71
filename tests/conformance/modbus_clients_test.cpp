// Real Modbus clients against the valve driver, on a real loopback port and the wall clock:
// Debian's mbpoll, libmodbus through our master, and tshark as an independent decoder of everything
// said. A client that is not installed is a failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <sstream>
#include <string>

#include "child_process.h"
#include "drivers/modbus_master.h"
#include "modbus_programs.h"
#include "modbus_rig.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;
using drivers::ModbusMaster;
using drivers::ModbusMasterSettings;
using protocols::modbus::ExceptionCode;
using ::testing::HasSubstr;
namespace reg = emulators::valve_registers;

class ModbusClients : public ::testing::Test {
 protected:
  static emulators::ValveDriverSettings without_watchdog() {
    emulators::ValveDriverSettings settings;
    settings.amplifier.parameters.watchdog = Duration{0};  // mbpoll speaks once per run
    settings.amplifier.spool_fault_delay = Duration{0};
    return settings;
  }
  ModbusMaster master(std::uint8_t unit = 1) const {
    ModbusMasterSettings settings;
    settings.port = rig_.port();
    settings.unit = unit;
    settings.response_timeout = 60s;
    ModbusMaster result(settings);
    const auto outcome = result.connect();
    EXPECT_TRUE(outcome) << outcome.error;
    return result;
  }
  ProgramResult mbpoll(const std::string& options, const std::string& values = "") const {
    const ProgramResult result =
        run_program("mbpoll -m tcp -1 -0 -o 10 -p " + std::to_string(rig_.port()) + " " + options +
                    " 127.0.0.1 " + values);
    EXPECT_NE(result.exit_code, 127) << "mbpoll is not installed: " << result.text;
    return result;
  }
  static bool wait_for(const std::function<bool()>& condition) {
    return test::eventually(condition);
  }

  ModbusRig rig_{without_watchdog()};
};

ValveSample sample() {
  ValveSample sample;
  sample.spool_position = {0.1, -0.25, 0, 0, 0, 0, 0, 0};
  sample.port_a_pressure_pa[1] = 1.5e7;
  sample.swing_angle_rad = -0.5;
  return sample;
}

TEST_F(ModbusClients, MbpollReadsTheInputs) {
  rig_.measure(sample());
  auto probe = master();
  ASSERT_TRUE(wait_for([&] {
    std::uint16_t count = 0;
    return probe.read_input_registers(reg::kMeasurementCount, std::span(&count, 1)) && count > 0;
  }));
  const auto result = mbpoll("-t 3 -r 0 -c 62");
  EXPECT_EQ(result.exit_code, 0) << result.text;
  const auto values = mbpoll_values(result.text);
  ASSERT_EQ(values.size(), 62U) << result.text;
  EXPECT_EQ(values.at(0), reg::kStatusReady);
  EXPECT_EQ(values.at(2), 100);
  EXPECT_EQ(values.at(3), -250);
  EXPECT_EQ(values.at(18), 2400);
  EXPECT_EQ(values.at(41), 1500);
  const auto angle = mbpoll("-t 3:int -B -r 30 -c 1");
  EXPECT_EQ(mbpoll_values(angle.text).at(30), -28648) << angle.text;
  const auto mirror = mbpoll("-t 4 -r 1000 -c 22");
  EXPECT_EQ(mbpoll_values(mirror.text).at(1003), -250) << mirror.text;
}

TEST_F(ModbusClients, MbpollWritesCommandsAndReadsThemBack) {
  // mbpoll 1.4 takes 16-bit values as 0 .. 65535 only: 65136 is -400.
  const auto written = mbpoll("-t 4 -r 0", "1 300 65136");
  EXPECT_EQ(written.exit_code, 0) << written.text;
  EXPECT_THAT(written.text, HasSubstr("Written 3 references"));
  ASSERT_TRUE(wait_for([&] { return rig_.command().opening[1] == -0.4; }));
  EXPECT_DOUBLE_EQ(rig_.command().opening[0], 0.3);
  const auto values = mbpoll_values(mbpoll("-t 4 -r 0 -c 10").text);
  EXPECT_EQ(values.at(0), 1);
  EXPECT_EQ(values.at(2), -400);
}

TEST_F(ModbusClients, MbpollShowsOurExceptions) {
  EXPECT_THAT(mbpoll("-t 4 -r 1", "1001").text, HasSubstr("Illegal data value"));
  EXPECT_THAT(mbpoll("-t 4 -r 500 -c 1").text, HasSubstr("Illegal data address"));
  EXPECT_THAT(mbpoll("-t 0 -r 0 -c 1").text, HasSubstr("Illegal function"));
  EXPECT_THAT(mbpoll("-a 9 -t 4 -r 0 -c 1").text, HasSubstr("Target device failed to respond"));
}

TEST_F(ModbusClients, LibmodbusReadsWritesAndCycles) {
  auto m = master();
  const std::uint16_t commands[] = {1, 100, 200, 0, 0, 0, 0, 0, 0, 5};
  auto outcome = m.write_registers(0, commands);
  EXPECT_TRUE(outcome) << outcome.error;
  EXPECT_TRUE(m.write_register(3, static_cast<std::uint16_t>(-700)));
  std::array<std::uint16_t, 22> in{};
  const std::uint16_t next[] = {6};
  outcome = m.read_write_registers(reg::kHeartbeat, next, reg::kInputMirror, in);
  EXPECT_TRUE(outcome) << outcome.error;
  EXPECT_EQ(in[reg::kHeartbeatEcho], 6) << "the write comes before the read";
  EXPECT_EQ(in[reg::kStatus], reg::kStatusReady | reg::kStatusEnabled);
  std::array<std::uint16_t, 10> back{};
  EXPECT_TRUE(m.read_holding_registers(0, back));
  EXPECT_EQ(back[3], static_cast<std::uint16_t>(-700));
  EXPECT_EQ(m.write_register(1, 1001).exception, ExceptionCode::illegal_data_value);
  std::uint16_t one = 0;
  EXPECT_EQ(m.read_input_registers(62, std::span(&one, 1)).exception,
            ExceptionCode::illegal_data_address);
  EXPECT_TRUE(m.connected());
}

TEST_F(ModbusClients, UnitsZeroAnd255AreServed) {
  for (const int unit : {0, 255}) {
    auto m = master(static_cast<std::uint8_t>(unit));
    std::uint16_t status = 0;
    const auto outcome = m.read_input_registers(0, std::span(&status, 1));
    EXPECT_TRUE(outcome) << outcome.error;
  }
}

TEST_F(ModbusClients, IdentificationIsReadOverTheWire) {
  using namespace protocols::modbus;
  auto m = master();
  std::array<std::uint8_t, kPduMaximum> answer{};
  std::size_t size = 0;
  const Pdu id = encode_request(ReportServerId{});
  ASSERT_TRUE(m.transact(id.view(), answer, size));
  const auto server_id = decode_response(std::span(answer).first(size));
  ASSERT_TRUE(server_id.ok());
  EXPECT_EQ(std::get<ServerIdResponse>(*server_id).data[0], 'R');
  const Pdu identification =
      encode_request(ReadDeviceIdentification{IdentificationAccess::regular, 0});
  ASSERT_TRUE(m.transact(identification.view(), answer, size));
  const auto objects = decode_response(std::span(answer).first(size));
  ASSERT_TRUE(objects.ok());
  EXPECT_EQ(std::get<DeviceIdentificationResponse>(*objects).find(1), "RW-HVD8");
}

TEST_F(ModbusClients, TheWatchdogStopsTheMachineWhenTheMasterIsKilled) {
  auto m = master();
  const std::uint16_t watchdog[] = {2000};  // ms: more than a busy machine takes for two writes
  ASSERT_TRUE(m.write_registers(reg::kWatchdog, watchdog));
  const std::uint16_t commands[] = {1, 1000};
  ASSERT_TRUE(m.write_registers(0, commands));
  ASSERT_TRUE(wait_for([&] { return rig_.command().opening[0] == 1.0; }));
  const SimTime begun = rig_.command().time;
  m.close();
  ASSERT_TRUE(wait_for([&] { return rig_.command().opening[0] == 0.0; }));
  EXPECT_EQ(rig_.command().time - begun, 2s);
}

TEST_F(ModbusClients, TsharkUnderstandsEveryMessageBothWays) {
  using namespace protocols::modbus;
  auto m = master();
  const std::uint16_t words[] = {1, 250, 0};
  ASSERT_TRUE(m.write_registers(0, words));
  std::array<std::uint16_t, 62> in{};
  ASSERT_TRUE(m.read_input_registers(0, in));
  ASSERT_TRUE(m.read_write_registers(1, words, 1000, std::span(in).first(22)));
  EXPECT_FALSE(m.write_register(1, 1001));
  std::array<std::uint8_t, kPduMaximum> answer{};
  std::size_t size = 0;
  for (const Request& request :
       {Request(ReportServerId{}), Request(MaskWriteRegister{9, 0xFFF0, 0x0003}),
        Request(ReadDeviceIdentification{IdentificationAccess::regular, 0}),
        Request(ReadBits{BitTable::coils, 0, 1})}) {
    ASSERT_TRUE(m.transact(encode_request(request).view(), answer, size));
  }
  m.close();
  const Capture capture(rig_.segments());
  const auto fields = capture.tshark(
      "-Y mbtcp -T fields -e mbtcp.trans_id -e modbus.func_code -e modbus.exception_code"
      " -e mbtcp.unit_id");
  ASSERT_EQ(fields.exit_code, 0) << "tshark is not installed or failed: " << fields.text;
  EXPECT_THAT(capture.complaints(), ::testing::IsEmpty());
  std::vector<std::string> rows;
  std::istringstream lines(fields.text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find('\t') != std::string::npos) {
      rows.push_back(line.substr(line.find('\t') + 1));
    }
  }
  EXPECT_THAT(
      rows, ::testing::ElementsAre("16\t\t1", "16\t\t1", "4\t\t1", "4\t\t1", "23\t\t1", "23\t\t1",
                                   "6\t\t1", "6\t3\t1", "17\t\t1", "17\t\t1", "22\t\t1", "22\t\t1",
                                   "43\t\t1", "43\t\t1", "1\t\t1", "1\t1\t1"))
      << fields.text;
}

TEST_F(ModbusClients, TsharkWouldComplain) {
  auto m = master();
  std::array<std::uint16_t, 4> in{};
  ASSERT_TRUE(m.read_input_registers(0, in));
  auto segments = rig_.segments();
  ASSERT_EQ(segments.size(), 2U);
  segments[1].bytes[3] = 5;  // protocol identifier: no longer Modbus
  EXPECT_THAT(Capture(segments).complaints(), ::testing::ElementsAre(2));
}

}  // namespace
}  // namespace rigwire::conformance
