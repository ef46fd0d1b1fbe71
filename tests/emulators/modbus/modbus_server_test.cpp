#include "emulators/modbus/modbus_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>

#include "modbus_client.h"
#include "small_unit.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;

constexpr SimTime modbus_server_at(Duration since_start) {
  return kStart + since_start;
}

class ModbusServerTest : public ::testing::Test {
 protected:
  ModbusServerTest() {
    server_.add_unit(1, unit_);
    server_.add_unit(7, other_);
    server_.connected(kStart, 1);
  }
  void send(const Bytes& bytes, SimTime now = kStart, ConnectionId connection = 1) {
    server_.receive(now, connection, bytes);
  }
  Response ask(const Request& request) {
    send(adu_of(request), now_);
    now_ += 10ms;
    return output_.latest();
  }
  Response ask(const Bytes& pdu) {
    send(adu_of(pdu), now_);
    now_ += 10ms;
    return output_.latest();
  }

  RecordedStream output_;
  SmallUnit unit_;
  SmallUnit other_;
  ModbusServer server_{ModbusServerSettings{}, output_};
  SimTime now_ = kStart;
};

TEST_F(ModbusServerTest, AnswersAfterTheProcessingDelayWithTheTransactionEchoed) {
  send(adu_of(WriteRegister{2, 77}, 0xBEEF), modbus_server_at(5ms));
  ASSERT_EQ(output_.sent.size(), 1U);
  EXPECT_EQ(output_.sent[0].due, modbus_server_at(5ms + 300us));
  EXPECT_EQ(output_.sent[0].bytes, (Bytes{0xBE, 0xEF, 0, 0, 0, 6, 1, 6, 0, 2, 0, 77}));
  EXPECT_EQ(unit_.holding[2], 77);
}

TEST_F(ModbusServerTest, AClientThatClosedItsSendingHalfGetsTheAnswersThatAreDueThenTheEnd) {
  send(adu_of(WriteRegister{2, 77}, 1) + adu_of(WriteRegister{3, 78}, 2), modbus_server_at(5ms));
  server_.half_closed(modbus_server_at(5ms), 1);
  server_.advance(modbus_server_at(6ms));
  ASSERT_EQ(output_.sent.size(), 2U);
  EXPECT_EQ(unit_.holding[3], 78);
  ASSERT_EQ(output_.closed.size(), 1U);
  EXPECT_EQ(output_.closed[0].connection, 1U);
  EXPECT_GE(output_.closed[0].due, output_.sent[1].due);
  send(adu_of(WriteRegister{2, 1}), modbus_server_at(7ms));
  EXPECT_EQ(unit_.holding[2], 77) << "nothing can come from a closed half";
}

TEST_F(ModbusServerTest, TheEndOfAConnectionIsNotLostWhenTheDeviceIsFullOfAnswers) {
  for (ConnectionId other = 2; other < 40; ++other) {
    server_.connected(modbus_server_at(5ms), other);
    for (int i = 0; i < 64; ++i) {
      send(adu_of(ReadRegisters{RegisterTable::holding, 0, 1}), modbus_server_at(5ms), other);
    }
  }
  server_.half_closed(modbus_server_at(5ms), 1);
  server_.advance(modbus_server_at(1s));
  ASSERT_EQ(output_.closed.size(), 1U);
  EXPECT_EQ(output_.closed[0].connection, 1U);
}

TEST_F(ModbusServerTest, AClientThatClosedItsSendingHalfAndAskedNothingIsClosed) {
  const Bytes request = adu_of(WriteRegister{2, 77});
  send(Bytes(request.begin(), request.begin() + 5), modbus_server_at(5ms));  // and never the rest
  server_.half_closed(modbus_server_at(6ms), 1);
  server_.advance(modbus_server_at(7ms));
  EXPECT_TRUE(output_.sent.empty());
  EXPECT_EQ(output_.closed.size(), 1U);
  server_.half_closed(modbus_server_at(8ms), 1);
  server_.half_closed(modbus_server_at(8ms), 99);
  EXPECT_EQ(output_.closed.size(), 1U);
}

TEST_F(ModbusServerTest, ServesEveryFunction) {
  unit_.holding = {10, 11, 12, 13, 14};
  const std::uint16_t words[] = {5, 6};
  EXPECT_EQ(ask(ReadRegisters{RegisterTable::holding, 1, 2}),
            Response(RegistersResponse{Function::read_holding_registers,
                                       make_registers(std::array<std::uint16_t, 2>{11, 12})}));
  EXPECT_EQ(std::get<RegistersResponse>(ask(ReadRegisters{RegisterTable::input, 0, 1})).function,
            Function::read_input_registers);
  EXPECT_EQ(ask(WriteRegisters{8, make_registers(words)}),
            Response(WriteManyResponse{Function::write_registers, 8, 2}));
  EXPECT_EQ(unit_.holding[9], 6);
  EXPECT_EQ(ask(WriteCoil{3, true}), Response(WriteCoil{3, true}));
  WriteCoils coils{4, {}};
  coils.coils.count = 2;
  coils.coils.set(1, true);
  EXPECT_EQ(ask(coils), Response(WriteManyResponse{Function::write_coils, 4, 2}));
  for (const BitTable table : {BitTable::coils, BitTable::discrete_inputs}) {
    const auto bits = std::get<ReadBitsResponse>(ask(ReadBits{table, 3, 3}));
    EXPECT_EQ(bits.table, table);
    EXPECT_EQ(bits.bits.packed[0], 0b101);
  }
  unit_.holding[4] = 0x12;
  EXPECT_EQ(ask(MaskWriteRegister{4, 0xF2, 0x25}), Response(MaskWriteRegister{4, 0xF2, 0x25}));
  EXPECT_EQ(unit_.holding[4], 0x17);
  const auto id = std::get<ServerIdResponse>(ask(ReportServerId{}));
  EXPECT_THAT(id.view(), ::testing::ElementsAre('s', 'm', 'a', 'l', 'l', 0xFF));
  EXPECT_EQ(server_.received().accepted, 9U);
  EXPECT_EQ(unit_.served_count, 9);
}

TEST_F(ModbusServerTest, ReadWriteRegistersWritesFirst) {
  const std::uint16_t word[] = {99};
  const auto answer =
      std::get<RegistersResponse>(ask(ReadWriteRegisters{0, 2, 1, make_registers(word)}));
  EXPECT_THAT(answer.registers.view(), ::testing::ElementsAre(0, 99));
  EXPECT_EQ(answer.function, Function::read_write_registers);
}

TEST_F(ModbusServerTest, ReadWriteRegistersWritesNothingWhenTheReadIsRefused) {
  const std::uint16_t word[] = {99};
  EXPECT_EQ(ask(ReadWriteRegisters{9, 2, 1, make_registers(word)}),
            Response(ExceptionResponse{23, ExceptionCode::illegal_data_address}));
  EXPECT_EQ(unit_.holding[1], 0);
}

TEST_F(ModbusServerTest, ExceptionsOfTheUnitCarryTheirFunction) {
  const std::uint16_t words[] = {1, 666};
  const auto address = ExceptionCode::illegal_data_address;
  const auto value = ExceptionCode::illegal_data_value;
  EXPECT_EQ(ask(ReadBits{BitTable::coils, 10, 1}), Response(ExceptionResponse{1, address}));
  EXPECT_EQ(ask(ReadBits{BitTable::discrete_inputs, 9, 2}),
            Response(ExceptionResponse{2, address}));
  EXPECT_EQ(ask(ReadRegisters{RegisterTable::holding, 10, 1}),
            Response(ExceptionResponse{3, address}));
  EXPECT_EQ(ask(ReadRegisters{RegisterTable::input, 1, 1}),
            Response(ExceptionResponse{4, address}));
  EXPECT_EQ(ask(WriteCoil{10, true}), Response(ExceptionResponse{5, address}));
  EXPECT_EQ(ask(WriteRegister{10, 0}), Response(ExceptionResponse{6, address}));
  EXPECT_EQ(ask(WriteRegisters{0, make_registers(words)}), Response(ExceptionResponse{16, value}));
  EXPECT_EQ(ask(MaskWriteRegister{10, 0, 0}), Response(ExceptionResponse{22, address}));
  EXPECT_EQ(ask(Bytes{99}), Response(ExceptionResponse{99, ExceptionCode::illegal_function}));
  EXPECT_EQ(unit_.holding, (std::array<std::uint16_t, 10>{}));
  EXPECT_EQ(unit_.served_count, 0);
  EXPECT_EQ(server_.received().ignored, 9U);
}

TEST_F(ModbusServerTest, AnUnknownFunctionIsRefusedWithoutExtraDelay) {
  send(adu_of(Bytes{8, 0, 0, 0, 0}), modbus_server_at(1ms));
  EXPECT_EQ(output_.sent.back().due, modbus_server_at(1ms + 300us));
}

TEST_F(ModbusServerTest, RequestsMayArriveByteByByte) {
  const Bytes request = adu_of(WriteRegister{0, 4});
  for (std::size_t i = 0; i < request.size(); ++i) {
    EXPECT_TRUE(output_.sent.empty());
    send({request[i]}, modbus_server_at(static_cast<std::int64_t>(i) * 90ms));
  }
  ASSERT_EQ(output_.sent.size(), 1U);
  EXPECT_EQ(output_.sent[0].due, modbus_server_at(11 * 90ms + 300us));
}

TEST_F(ModbusServerTest, TwoRequestsInOneSegmentAreAnsweredInOrderAndInOnePiece) {
  send(adu_of(WriteRegister{0, 4}, 1) + adu_of(WriteRegister{0, 5}, 2));
  EXPECT_EQ(output_.pieces, 1U);
  ASSERT_EQ(output_.sent.size(), 2U);
  EXPECT_EQ(output_.sent[0].bytes[1], 1);
  EXPECT_EQ(output_.sent[1].bytes[1], 2);
  EXPECT_LE(output_.sent[0].due, output_.sent[1].due);
  EXPECT_EQ(unit_.holding[0], 5);
}

TEST_F(ModbusServerTest, AGoodRequestBehindABadOneIsServed) {
  send(adu_of(Bytes{3, 0, 0, 0, 126}, 1) + adu_of(Bytes{3, 0, 0}, 2) + adu_of(Bytes{77}, 3) +
       adu_of(WriteRegister{0, 5}, 4));
  ASSERT_EQ(output_.sent.size(), 4U);
  EXPECT_EQ(output_.sent[0].bytes[7], 0x83);
  EXPECT_EQ(output_.sent[1].bytes[7], 0x83);
  EXPECT_EQ(output_.sent[2].bytes[7], 77 | 0x80);
  EXPECT_EQ(output_.latest(), Response(WriteRegister{0, 5}));
  EXPECT_EQ(server_.received().malformed, 1U);
  EXPECT_EQ(server_.received().ignored, 2U);
}

TEST_F(ModbusServerTest, AForeignProtocolIsDroppedAndTheNextRequestServed) {
  send(adu_of(Bytes{6, 0, 0, 0, 9}, 1, 1, 5) + adu_of(WriteRegister{1, 8}, 2));
  ASSERT_EQ(output_.sent.size(), 1U);
  EXPECT_EQ(output_.sent[0].bytes[1], 2);
  EXPECT_EQ(unit_.holding[0], 0);
}

TEST_F(ModbusServerTest, AnImpossibleLengthClosesAfterTheAnswersStillDue) {
  for (const std::uint8_t length : Bytes{0, 1, 255}) {
    const ConnectionId id = 100U + length;
    server_.connected(kStart, id);
    send(adu_of(WriteRegister{0, 1}) + Bytes{0, 2, 0, 0, 0, length, 1}, modbus_server_at(1ms), id);
    EXPECT_EQ(output_.sent.back().connection, id);
    ASSERT_EQ(output_.closed.back().connection, id);
    EXPECT_GE(output_.closed.back().due, output_.sent.back().due);
    const std::size_t answers = output_.sent.size();
    send(adu_of(WriteRegister{0, 2}), modbus_server_at(2ms), id);
    EXPECT_EQ(output_.sent.size(), answers) << "served a connection that is being closed";
    EXPECT_EQ(unit_.holding[0], 1);
  }
}

TEST_F(ModbusServerTest, UnitsZeroAnd255AreTheDeviceItself) {
  for (const std::uint8_t unit : Bytes{0, 1, 255}) {
    send(adu_of(WriteRegister{0, unit}, 1, unit), now_ += 10ms);
    EXPECT_EQ(output_.latest(), Response(WriteRegister{0, unit}));
    EXPECT_EQ(output_.sent.back().bytes[6], unit);
    EXPECT_EQ(unit_.holding[0], unit);
  }
  send(adu_of(WriteRegister{0, 3}, 1, 7), now_ += 10ms);
  EXPECT_EQ(other_.holding[0], 3);
}

TEST_F(ModbusServerTest, AnotherUnitIsAnsweredByTheGatewayException) {
  send(adu_of(WriteRegister{0, 3}, 1, 2));
  EXPECT_EQ(output_.latest(), Response(ExceptionResponse{6, ExceptionCode::gateway_target_failed}));
  EXPECT_EQ(unit_.served_count, 0);
}

TEST_F(ModbusServerTest, TheSeventeenthUnansweredRequestFindsTheServerBusy) {
  Bytes burst;
  for (std::uint16_t i = 0; i < 17; ++i) {
    burst = burst + adu_of(WriteRegister{0, i}, i);
  }
  send(burst, modbus_server_at(1ms));
  ASSERT_EQ(output_.sent.size(), 17U);
  EXPECT_EQ(output_.latest(), Response(ExceptionResponse{6, ExceptionCode::server_device_busy}));
  EXPECT_EQ(unit_.holding[0], 15);
  send(adu_of(WriteRegister{0, 40}), modbus_server_at(1ms + 300us));
  EXPECT_EQ(output_.latest(), Response(WriteRegister{0, 40}));
}

TEST_F(ModbusServerTest, ThirtyTwoClientsDoNotMixTheirHalves) {
  for (ConnectionId id = 2; id <= 33; ++id) {
    server_.connected(kStart, id);
  }
  const auto request = [](ConnectionId id) {
    return adu_of(WriteRegister{0, static_cast<std::uint16_t>(id)}, static_cast<std::uint16_t>(id));
  };
  for (std::size_t i = 0; i < 12; ++i) {
    for (ConnectionId id = 2; id <= 33; ++id) {
      send({request(id)[i]}, kStart, id);
    }
  }
  ASSERT_EQ(output_.sent.size(), 32U);
  for (const auto& sent : output_.sent) {
    EXPECT_EQ(sent.bytes, request(sent.connection));
  }
}

TEST_F(ModbusServerTest, AHalfRequestDiesWithItsConnection) {
  const Bytes request = adu_of(WriteRegister{0, 1});
  send({request.begin(), request.begin() + 5});
  server_.disconnected(kStart, 1);
  send({request.begin() + 5, request.end()});
  EXPECT_TRUE(output_.sent.empty());
  server_.connected(kStart, 2);
  send(request, kStart, 2);
  EXPECT_EQ(output_.sent.size(), 1U);
}

TEST_F(ModbusServerTest, IdentificationStreamsContinueWhereTheyStopped) {
  const auto read = [this](IdentificationAccess access, std::uint8_t object) {
    return std::get<DeviceIdentificationResponse>(ask(ReadDeviceIdentification{access, object}));
  };
  const auto basic = read(IdentificationAccess::basic, 0);
  EXPECT_EQ(basic.count, 3);
  EXPECT_EQ(basic.find(0), "vendor");
  EXPECT_EQ(basic.find(3), std::nullopt);
  EXPECT_FALSE(basic.more_follows);
  const auto first = read(IdentificationAccess::regular, 0);
  EXPECT_TRUE(first.more_follows);
  EXPECT_EQ(first.next_object, 4);
  const auto rest = read(IdentificationAccess::regular, first.next_object);
  EXPECT_EQ(rest.count, 1);
  EXPECT_EQ(rest.find(4), unit_.long_text);
  EXPECT_EQ(read(IdentificationAccess::regular, 200).find(0), "vendor") << "restarts";
  EXPECT_EQ(read(IdentificationAccess::individual, 2).count, 1);
  EXPECT_EQ(ask(ReadDeviceIdentification{IdentificationAccess::individual, 9}),
            Response(ExceptionResponse{43, ExceptionCode::illegal_data_address}));
}

TEST(ModbusServerSettingsTest, OutOfRangeIsRefused) {
  RecordedStream output;
  EXPECT_THROW(ModbusServer({.transactions_max = 0}, output), std::invalid_argument);
  EXPECT_THROW(ModbusServer({.transactions_max = 17}, output), std::invalid_argument);
  EXPECT_THROW(ModbusServer({.idle_timeout = 10ms}, output), std::invalid_argument);
  EXPECT_THROW(ModbusServer({.idle_timeout = 25h}, output), std::invalid_argument);
  ModbusServer server({}, output);
  SmallUnit unit;
  EXPECT_THROW(server.add_unit(0, unit), std::invalid_argument);
  EXPECT_THROW(server.add_unit(248, unit), std::invalid_argument);
  server.add_unit(1, unit);
  EXPECT_THROW(server.add_unit(1, unit), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
