#include "emulators/modbus/modbus_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "emulators/modbus/modbus_server.h"
#include "fault_period.h"
#include "rtu_line.h"
#include "small_unit.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr SimTime at(Duration since_start) {
  return kStart + since_start;
}

/// Holds from the second on for ten.
ModbusFault fault_of(decltype(ModbusFault::what) what, const ModbusFaultScope& scope = {}) {
  return {between(1s, 11s), scope, what};
}

/// A TCP server with one fault, and its client.
struct FaultyServer {
  explicit FaultyServer(const ModbusFault& fault) : FaultyServer(std::vector{fault}) {}
  explicit FaultyServer(std::vector<ModbusFault> faults)
      : server({{}, 16, Duration{0}, std::move(faults), 5}, output) {
    server.add_unit(1, unit);
    server.add_unit(7, other);
    server.connected(kStart, 1);
  }
  /// Everything that comes back within a minute.
  const std::vector<RecordedStream::Sent>& ask(SimTime now, const Request& request,
                                               std::uint8_t number = 1) {
    output.sent.clear();
    server.receive(now, 1, adu_of(request, 9, number));
    server.advance(now + 1min);
    return output.sent;
  }
  RecordedStream output;
  SmallUnit unit;
  SmallUnit other;
  ModbusServer server;
};

struct FaultyRtu {
  explicit FaultyRtu(const ModbusFault& fault) : server(settings(fault), output) {
    server.add_unit(1, unit);
  }
  static ModbusRtuSettings settings(const ModbusFault& fault) {
    ModbusRtuSettings settings;
    settings.response_delay.typical = Duration{0};
    settings.faults = {fault};
    return settings;
  }
  Bytes ask(SimTime now, const Request& request) {
    output.sent.clear();
    server.receive(now, frame_of(1, request));
    server.advance(now + 900ms);
    return output.bytes();
  }
  RecordedLine output;
  SmallUnit unit;
  ModbusRtuServer server;
};

const Request kWrite = WriteRegister{2, 77};
const Request kRead = ReadRegisters{RegisterTable::holding, 2, 1};

TEST(ModbusFaults, ADelayHoldsInItsStretchOnlyAndKeepsTheOrder) {
  FaultyServer rig(fault_of(ModbusDelayFault{250ms}));
  EXPECT_EQ(rig.ask(at(999ms), kRead)[0].due, at(999ms + 300us));
  EXPECT_EQ(rig.ask(at(1s), kRead)[0].due, at(1s + 250ms + 300us));
  rig.output.sent.clear();
  rig.server.receive(at(11s - 1ms), 1, adu_of(kRead, 1));
  rig.server.receive(at(11s), 1, adu_of(kRead, 2));
  rig.server.advance(at(12s));
  ASSERT_EQ(rig.output.sent.size(), 2U);
  EXPECT_EQ(rig.output.sent[0].bytes[1], 1);
  EXPECT_EQ(rig.output.sent[1].due, rig.output.sent[0].due) << "overtook the one before";
}

TEST(ModbusFaults, EveryExceptionCanBeGivenAndNothingActs) {
  for (const int code : {0x01, 0x02, 0x03, 0x04, 0x06, 0x08, 0x0A, 0x0B}) {
    const auto exception = static_cast<ExceptionCode>(code);
    FaultyServer rig(fault_of(ModbusExceptionFault{exception}));
    rig.ask(at(2s), kWrite);
    EXPECT_EQ(rig.output.latest(), Response(ExceptionResponse{6, exception}));
    EXPECT_EQ(rig.unit.served_count, 0);
  }
}

TEST(ModbusFaults, AcknowledgeIsGivenAndTheRequestCarriedOut) {
  FaultyServer rig(fault_of(ModbusExceptionFault{ExceptionCode::acknowledge}));
  rig.ask(at(2s), kWrite);
  EXPECT_EQ(rig.output.latest(), Response(ExceptionResponse{6, ExceptionCode::acknowledge}));
  EXPECT_EQ(rig.unit.holding[2], 77);
}

TEST(ModbusFaults, SilenceAndALostAnswerDifferInWhatTheDeviceDid) {
  FaultyServer deaf(fault_of(ModbusSilenceFault{}));
  EXPECT_THAT(deaf.ask(at(2s), kWrite), IsEmpty());
  EXPECT_EQ(deaf.unit.holding[2], 0);
  FaultyServer mute(fault_of(ModbusLostAnswerFault{}));
  EXPECT_THAT(mute.ask(at(2s), kWrite), IsEmpty());
  EXPECT_EQ(mute.unit.holding[2], 77);
}

TEST(ModbusFaults, AUnitAndRegistersNarrowAFaultDown) {
  FaultyServer rig(fault_of(ModbusSilenceFault{}, {7, ModbusFaultTable::holding, 3, 4}));
  const auto silent = [&](const Request& request, std::uint8_t unit) {
    return rig.ask(at(2s), request, unit).empty();
  };
  EXPECT_FALSE(silent(WriteRegister{3, 1}, 1));
  EXPECT_TRUE(silent(WriteRegister{3, 1}, 7));
  EXPECT_FALSE(silent(WriteRegister{2, 1}, 7));
  EXPECT_FALSE(silent(WriteRegister{5, 1}, 7));
  EXPECT_TRUE(silent(ReadRegisters{RegisterTable::holding, 4, 5}, 7));
  EXPECT_FALSE(silent(ReadRegisters{RegisterTable::input, 0, 1}, 7));
  EXPECT_TRUE(
      silent(ReadWriteRegisters{0, 1, 4, make_registers(std::array<std::uint16_t, 1>{})}, 7));
  EXPECT_FALSE(silent(ReportServerId{}, 7));
}

TEST(ModbusFaults, JunkComesRightBeforeTheAnswer) {
  FaultyServer rig(fault_of(ModbusJunkFault{5}));
  rig.server.receive(at(2s), 1, adu_of(kRead));
  const Bytes good = adu_of(Bytes{3, 2, 0, 0});
  Bytes all;
  for (const auto& sent : rig.output.sent) {
    all.insert(all.end(), sent.bytes.begin(), sent.bytes.end());
  }
  ASSERT_EQ(all.size(), 5 + good.size());
  EXPECT_EQ(Bytes(all.begin() + 5, all.end()), good);
}

TEST(ModbusFaults, ASplitAnswerIsWholeAfterItsPauses) {
  FaultyServer rig(fault_of(ModbusSplitFault{3, 40ms}));
  const auto& sent = rig.ask(at(2s), kRead);
  ASSERT_EQ(sent.size(), 3U);
  Bytes all;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sent[i].due, at(2s + 300us + 40ms * static_cast<int>(i)));
    all = all + sent[i].bytes;
  }
  EXPECT_EQ(all, adu_of(Bytes{3, 2, 0, 0}, 9));
}

TEST(ModbusFaults, TruncatedAndWrongTransaction) {
  FaultyServer cut(fault_of(ModbusTruncatedFault{3}));
  EXPECT_EQ(cut.ask(at(2s), kRead)[0].bytes.size(), 11U - 3U);
  FaultyServer gone(fault_of(ModbusTruncatedFault{260}));
  EXPECT_THAT(gone.ask(at(2s), kRead), IsEmpty());
  FaultyServer wrong(fault_of(ModbusWrongTransactionFault{}));
  EXPECT_EQ(wrong.ask(at(2s), kRead)[0].bytes[1], 10);
}

TEST(ModbusFaults, DisconnectClosesInsteadOfAnAnswer) {
  FaultyServer rig(fault_of(ModbusDisconnectFault{}));
  EXPECT_THAT(rig.ask(at(2s), kRead), IsEmpty());
  ASSERT_EQ(rig.output.closed.size(), 1U);
  EXPECT_EQ(rig.output.closed[0].due, at(2s + 300us));
}

TEST(ModbusFaults, AStuckRegisterReadsAsItFirstDidWhileTheDeviceGoesOn) {
  const ModbusFaultScope registers{.table = ModbusFaultTable::holding, .first = 2, .last = 3};
  FaultyServer rig(fault_of(ModbusStuckFault{}, registers));
  rig.unit.holding = {1, 2, 3, 4, 5};
  const Request read = ReadRegisters{RegisterTable::holding, 1, 4};
  rig.ask(at(2s), read);
  rig.ask(at(3s), WriteRegisters{1, make_registers(std::array<std::uint16_t, 4>{9, 9, 9, 9})});
  rig.ask(at(4s), read);
  EXPECT_THAT(std::get<RegistersResponse>(rig.output.latest()).registers.view(),
              ElementsAre(9, 3, 4, 9));
  EXPECT_EQ(rig.unit.holding[2], 9);
  rig.ask(at(12s), read);
  EXPECT_THAT(std::get<RegistersResponse>(rig.output.latest()).registers.view(),
              ElementsAre(9, 9, 9, 9));
  FaultyServer fixed(fault_of(ModbusStuckFault{500}, registers));
  fixed.ask(at(2s), ReadWriteRegisters{2, 2, 2, make_registers(std::array<std::uint16_t, 1>{8})});
  EXPECT_THAT(std::get<RegistersResponse>(fixed.output.latest()).registers.view(),
              ElementsAre(500, 500));
}

TEST(ModbusFaults, AProbabilityIsDrawnFromTheSeed) {
  const ModbusFault fault = fault_of(ModbusSilenceFault{}, {.share = 0.25});
  FaultyServer rig(fault);
  FaultyServer twin(fault);
  int silent = 0;
  for (int i = 0; i < 4000; ++i) {
    const SimTime now = at(2s + i * 1ms);
    const bool here = rig.ask(now, kRead).empty();
    EXPECT_EQ(twin.ask(now, kRead).empty(), here);
    silent += here ? 1 : 0;
  }
  EXPECT_NEAR(silent, 1000, 5 * 27);  // five standard deviations of the binomial distribution
}

TEST(ModbusFaults, RtuWithAWrongCheck) {
  FaultyRtu rig(fault_of(ModbusWrongCheckFault{}));
  EXPECT_TRUE(decode_rtu(rig.ask(kStart, kRead)).ok());
  const Bytes answer = rig.ask(at(2s), kRead);
  EXPECT_EQ(answer.size(), 7U);
  EXPECT_TRUE(decode_rtu(answer).malformed());
}

TEST(ModbusFaults, RtuWithAnotherParityUnderstandsNothing) {
  FaultyRtu rig(fault_of(ModbusParityFault{}));
  EXPECT_THAT(rig.ask(at(2s), kWrite), IsEmpty());
  EXPECT_EQ(rig.unit.holding[2], 0);
  EXPECT_EQ(rig.server.received().malformed, 1U);
  EXPECT_EQ(rig.ask(at(12s), kWrite).size(), 8U);
}

TEST(ModbusFaults, RtuNoiseSpoilsAboutAsManyTransactionsAsItShould) {
  FaultyRtu rig({between(1s, 1h), {}, ModbusNoiseFault{1e-3}});
  int answered = 0;
  constexpr int kTries = 1000;
  for (int i = 0; i < kTries; ++i) {
    answered += decode_rtu(rig.ask(at(2s + i * 1s), kWrite)).ok() ? 1 : 0;
  }
  // Request and answer have 8 bytes each: 128 bits must all be right, (1 - 0.001)^128 = 0.880.
  EXPECT_NEAR(answered, 880, 5 * 10.3);
}

TEST(ModbusFaults, WhatHasNoMeaningIsRefused) {
  using Table = ModbusFaultTable;
  const auto refused = [](const ModbusFault& fault, ModbusWire wire) {
    EXPECT_THROW(validate(fault, wire), std::invalid_argument) << fields::chosen_name(fault.what);
  };
  refused(fault_of(ModbusWrongCheckFault{}), ModbusWire::tcp);
  refused(fault_of(ModbusNoiseFault{}), ModbusWire::tcp);
  refused(fault_of(ModbusParityFault{}), ModbusWire::tcp);
  refused(fault_of(ModbusWrongTransactionFault{}), ModbusWire::rtu);
  refused(fault_of(ModbusDisconnectFault{}), ModbusWire::rtu);
  refused({between(1s, 1s), {}, ModbusSilenceFault{}}, ModbusWire::tcp);
  refused(fault_of(ModbusSilenceFault{}, {.unit = 248}), ModbusWire::tcp);
  refused(fault_of(ModbusSilenceFault{}, {.share = 0}), ModbusWire::tcp);
  refused(fault_of(ModbusSilenceFault{}, {.first = 5}), ModbusWire::tcp);  // of which table?
  refused(fault_of(ModbusSilenceFault{}, {.table = Table::coils, .first = 5, .last = 4}),
          ModbusWire::tcp);
  refused(fault_of(ModbusDelayFault{0s}), ModbusWire::tcp);
  refused(fault_of(ModbusJunkFault{65}), ModbusWire::tcp);
  refused(fault_of(ModbusSplitFault{1}), ModbusWire::tcp);
  refused(fault_of(ModbusNoiseFault{}, {.unit = 1}), ModbusWire::rtu);
  refused(fault_of(ModbusStuckFault{}), ModbusWire::tcp);  // which registers?
  refused(fault_of(ModbusStuckFault{}, {.table = Table::coils, .last = 1}), ModbusWire::tcp);
  refused(fault_of(ModbusStuckFault{}, {.table = Table::input, .last = 125}), ModbusWire::tcp);
  validate(fault_of(ModbusStuckFault{}, {.table = Table::input, .last = 124}), ModbusWire::tcp);
  const decltype(ModbusFault::what) both[] = {
      ModbusDelayFault{}, ModbusExceptionFault{}, ModbusSilenceFault{},  ModbusLostAnswerFault{},
      ModbusJunkFault{},  ModbusSplitFault{},     ModbusTruncatedFault{}};
  for (const auto& what : both) {
    validate(fault_of(what), ModbusWire::tcp);
    validate(fault_of(what), ModbusWire::rtu);
  }
}

TEST(ModbusFaults, OneBegunInTheRunChangesNoOthersDraws) {
  const ModbusFault half = fault_of(ModbusSilenceFault{}, {.share = 0.5});
  ModbusFaultSchedule alone({half}, ModbusWire::tcp, 5);
  ModbusFaultSchedule with_another({half}, ModbusWire::tcp, 5);
  const auto id = with_another.begin({between(3s, 4s), {}, ModbusJunkFault{}});
  for (int i = 0; i < 200; ++i) {
    const SimTime now = at(2s + i * 5ms);
    EXPECT_EQ(alone.effects(now, 1, nullptr).silence, with_another.effects(now, 1, nullptr).silence)
        << i;
  }
  EXPECT_TRUE(with_another.end(id, at(3s)));
  EXPECT_EQ(with_another.effects(at(3500ms), 1, nullptr).junk_bytes, 0U);
  EXPECT_THROW(with_another.begin({between(3s, 4s), {}, ModbusNoiseFault{}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
