// Every function at its limit and one beyond, with the exact exception and the order of the checks,
// on TCP and on a serial line alike. Sources: V1.1b3, sections 6 and 7.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/modbus/modbus_server.h"
#include "rtu_line.h"

namespace rigwire::emulators {

/// For test names.
inline void PrintTo(ModbusWire wire, std::ostream* out) {
  *out << (wire == ModbusWire::tcp ? "tcp" : "rtu");
}

namespace {

using namespace protocols::modbus;
using ::testing::ElementsAre;

/// All four tables, whole.
class WholeUnit final : public ModbusUnit {
 public:
  Outcome read_registers(RegisterTable /*table*/, std::uint16_t address,
                         std::span<std::uint16_t> values) const override {
    std::copy_n(words.begin() + address, values.size(), values.begin());
    return std::nullopt;
  }
  Outcome write_registers(SimTime /*now*/, std::uint16_t address,
                          std::span<const std::uint16_t> values) override {
    std::ranges::copy(values, words.begin() + address);
    return std::nullopt;
  }
  Outcome read_bits(BitTable /*table*/, std::uint16_t /*address*/,
                    BitBlock& /*bits*/) const override {
    return std::nullopt;
  }
  Outcome write_coils(SimTime /*now*/, std::uint16_t /*address*/,
                      const BitBlock& /*coils*/) override {
    return std::nullopt;
  }
  std::string_view server_id() const override { return "whole"; }
  std::span<const IdentificationObject> identification() const override { return {}; }
  void served(SimTime /*now*/) override { ++served_count; }
  std::vector<std::uint16_t> words = std::vector<std::uint16_t>(65536);
  int served_count = 0;
};

class ModbusConformance : public ::testing::TestWithParam<ModbusWire> {
 protected:
  ModbusConformance() {
    tcp_.add_unit(1, unit_);
    rtu_.add_unit(1, unit_);
    tcp_.connected(kStart, 1);
  }
  /// The answer's PDU.
  Bytes ask(const Bytes& pdu) {
    now_ += std::chrono::seconds(1);
    if (GetParam() == ModbusWire::tcp) {
      tcp_.receive(now_, 1, adu_of(pdu));
      const Bytes& adu = stream_.sent.back().bytes;
      return {adu.begin() + kMbapHeaderSize, adu.end()};
    }
    line_.sent.clear();
    rtu_.receive(now_, frame_of(1, pdu));
    rtu_.advance(now_ + std::chrono::milliseconds(900));
    const Bytes bytes = line_.bytes();
    const auto frame = decode_rtu(bytes);
    return frame.ok() ? Bytes(frame->pdu.begin(), frame->pdu.end()) : Bytes{};
  }
  /// 0 when it was done.
  int exception(const Bytes& pdu) {
    const Bytes answer = ask(pdu);
    EXPECT_FALSE(answer.empty());
    return answer.size() == 2 && answer[0] == (pdu[0] | 0x80) ? answer[1] : 0;
  }
  static Bytes plain(int function, int address, int second) {
    const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
    return {byte(function), byte(address >> 8), byte(address), byte(second >> 8), byte(second)};
  }
  static Bytes many(int function, int address, int quantity, int byte_count, int data) {
    Bytes pdu = plain(function, address, quantity);
    pdu.push_back(static_cast<std::uint8_t>(byte_count));
    pdu.resize(pdu.size() + static_cast<std::size_t>(data), 1);
    return pdu;
  }
  static Bytes both(int read_address, int read, int write_address, int write) {
    const Bytes second = many(0, write_address, write, 2 * write, 2 * write);
    return plain(23, read_address, read) + Bytes(second.begin() + 1, second.end());
  }

  WholeUnit unit_;
  RecordedStream stream_;
  RecordedLine line_;
  ModbusServer tcp_{ModbusServerSettings{}, stream_};
  ModbusRtuServer rtu_{ModbusRtuSettings{{{115'200, SerialCharacter::even_8e1}}, {}, {}, 1}, line_};
  SimTime now_ = kStart;
};
INSTANTIATE_TEST_SUITE_P(, ModbusConformance, ::testing::Values(ModbusWire::tcp, ModbusWire::rtu),
                         ::testing::PrintToStringParamName());

TEST_P(ModbusConformance, ReadsAtTheLimitAndOneMore) {
  for (const auto& [function, limit] : {std::pair{1, 2000}, {2, 2000}, {3, 125}, {4, 125}}) {
    EXPECT_EQ(ask(plain(function, 0, limit)).size(),
              2U + static_cast<std::size_t>(function <= 2 ? limit / 8 : 2 * limit));
    EXPECT_EQ(exception(plain(function, 0, limit + 1)), 3) << function;
    EXPECT_EQ(exception(plain(function, 0, 0)), 3) << function;
    EXPECT_EQ(exception(plain(function, 65535, 1)), 0) << function;
    EXPECT_EQ(exception(plain(function, 65535, 2)), 2) << "wraps at 65535";
    EXPECT_EQ(exception(plain(function, 65535, limit + 1)), 3) << "quantity before address";
    EXPECT_EQ(exception(plain(function, 0, 1) + Bytes{0}), 3) << "longer than its function says";
  }
}

TEST_P(ModbusConformance, SingleWrites) {
  EXPECT_EQ(ask(plain(5, 65535, 0xFF00)), plain(5, 65535, 0xFF00));
  EXPECT_EQ(ask(plain(5, 0, 0)), plain(5, 0, 0));
  for (const int odd : {1, 0x00FF, 0xFF01, 0xFFFF}) {
    EXPECT_EQ(exception(plain(5, 0, odd)), 3) << odd;
  }
  EXPECT_EQ(ask(plain(6, 65535, 0xBEEF)), plain(6, 65535, 0xBEEF));
  EXPECT_EQ(unit_.words[65535], 0xBEEF);
}

TEST_P(ModbusConformance, MultipleWritesAtTheLimitAndOneMore) {
  EXPECT_EQ(ask(many(15, 0, 1968, 246, 246)), plain(15, 0, 1968));
  EXPECT_EQ(exception(many(15, 0, 1969, 247, 247)), 3);
  EXPECT_EQ(exception(many(15, 0, 9, 1, 1)), 3) << "byte count too small";
  EXPECT_EQ(exception(many(15, 0, 8, 2, 2)), 3) << "byte count too large";
  EXPECT_EQ(exception(many(15, 65535, 2, 1, 1)), 2);
  EXPECT_EQ(ask(many(16, 0, 123, 246, 246)), plain(16, 0, 123));
  EXPECT_EQ(exception(many(16, 0, 124, 248, 247)), 3);
  EXPECT_EQ(exception(many(16, 0, 2, 3, 3)), 3);
  EXPECT_EQ(exception(many(16, 0, 2, 4, 3)), 3) << "shorter than its byte count";
  EXPECT_EQ(exception(many(16, 0, 0, 0, 0)), 3);
  EXPECT_EQ(exception(many(16, 65535, 2, 4, 4)), 2);
  EXPECT_EQ(exception(many(16, 65535, 124, 248, 247)), 3) << "quantity before address";
}

TEST_P(ModbusConformance, MaskWriteFollowsItsFormula) {
  unit_.words[4] = 0x12;
  EXPECT_THAT(ask(Bytes{22, 0, 4, 0, 0xF2, 0, 0x25}), ElementsAre(22, 0, 4, 0, 0xF2, 0, 0x25));
  EXPECT_EQ(unit_.words[4], 0x17);  // the example of section 6.16
  EXPECT_EQ(exception(Bytes{22, 0, 4, 0, 0xF2, 0}), 3);
}

TEST_P(ModbusConformance, ReadWriteWritesFirstAndKnowsItsLimits) {
  EXPECT_EQ(ask(both(0, 125, 65535, 1)).size(), 252U);
  EXPECT_EQ(exception(both(0, 126, 0, 1)), 3);
  EXPECT_EQ(exception(both(0, 0, 0, 1)), 3);
  EXPECT_EQ(exception(both(0, 1, 0, 121)), 0);
  EXPECT_EQ(exception(both(65535, 2, 0, 1)), 2);
  EXPECT_EQ(exception(both(0, 1, 65535, 2)), 2);
  EXPECT_THAT(ask(both(7, 2, 8, 1)), ElementsAre(23, 4, 1, 1, 1, 1)) << "8 was just written";
}

TEST_P(ModbusConformance, FunctionsThatNobodyHasAreRefusedFirst) {
  for (int function = 0; function < 128; ++function) {
    const bool known = (function >= 1 && function <= 6) || function == 15 || function == 16 ||
                       function == 17 || function == 22 || function == 23 || function == 43;
    const bool serial =
        GetParam() == ModbusWire::rtu && (function == 7 || function == 8 || function == 11);
    if (!known && !serial) {
      EXPECT_EQ(exception(Bytes{static_cast<std::uint8_t>(function), 1, 2}), 1) << function;
    }
  }
  EXPECT_EQ(exception(Bytes{43, 13, 1, 0}), 1) << "another encapsulated interface";
  EXPECT_EQ(exception(Bytes{43, 14, 5, 0}), 3);
  EXPECT_EQ(exception(Bytes{43, 14, 4, 9}), 2);
  EXPECT_EQ(unit_.served_count, 0);
}

}  // namespace
}  // namespace rigwire::emulators
