#include "emulators/modbus/modbus_rtu_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>

#include "rtu_line.h"
#include "small_unit.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr SimTime modbus_rtu_server_at(Duration since_start) {
  return kStart + since_start;
}

ModbusRtuSettings settings_of(std::uint32_t baud, bool strict = false) {
  ModbusRtuSettings settings;
  settings.line.timing = {baud, SerialCharacter::even_8e1};
  settings.line.strict_gaps = strict;
  settings.response_delay.typical = Duration{0};
  return settings;
}

class RtuServerTest : public ::testing::Test {
 protected:
  explicit RtuServerTest(const ModbusRtuSettings& settings = settings_of(9600))
      : settings_(settings), server_(settings, output_) {
    server_.add_unit(1, unit_);
    server_.add_unit(7, other_);
  }
  void write(SimTime now, const Bytes& bytes) { server_.receive(now, bytes); }
  /// The answer's PDU, its time long over; empty when there was none.
  Bytes ask(const Bytes& frame) {
    now_ += 1s;
    output_.sent.clear();
    write(now_, frame);
    server_.advance(now_ + 900ms);
    const Bytes bytes = output_.bytes();
    const auto answer = decode_rtu(bytes);
    return answer.ok() ? Bytes(answer->pdu.begin(), answer->pdu.end()) : Bytes{};
  }
  Bytes ask(std::uint8_t address, const Bytes& pdu) { return ask(frame_of(address, pdu)); }
  std::uint16_t counter(std::uint8_t address, std::uint8_t sub_function) {
    const Bytes answer = ask(address, {8, 0, sub_function, 0, 0});
    EXPECT_EQ(answer.size(), 5U);
    return answer.size() == 5 ? static_cast<std::uint16_t>(answer[3] << 8U | answer[4]) : 0;
  }

  ModbusRtuSettings settings_;
  RecordedLine output_;
  SmallUnit unit_;
  SmallUnit other_;
  ModbusRtuServer server_;
  SimTime now_ = kStart;
};

struct StrictRtuServerTest : RtuServerTest {
  StrictRtuServerTest() : RtuServerTest(settings_of(9600, true)) {}
};

TEST_F(RtuServerTest, TheLineCostsItsExactTime) {
  // 9600 bit/s, 11 bits: 1.1458333 ms a character. Request 8, silence 3.5, answer 25 characters.
  unit_.holding = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  write(modbus_rtu_server_at(5ms), frame_of(1, ReadRegisters{RegisterTable::holding, 0, 10}));
  const SimTime request_ends = modbus_rtu_server_at(5ms + 9'166'666ns);
  EXPECT_EQ(server_.next_event(), request_ends + 4'010'416ns);
  server_.advance(request_ends + 4'010'415ns);
  EXPECT_THAT(output_.sent, IsEmpty()) << "answered before 3.5 characters of silence";
  server_.advance(request_ends + 4'010'416ns);
  ASSERT_EQ(output_.sent.size(), 25U);
  EXPECT_EQ(unit_.served_at, request_ends + 4'010'416ns);
  for (std::size_t i = 0; i < 25; ++i) {
    const Duration characters{static_cast<std::int64_t>((i + 1) * 11 * 1'000'000'000ULL / 9600)};
    EXPECT_EQ(output_.sent[i].due, request_ends + 4'010'416ns + characters) << i;
  }
  EXPECT_TRUE(decode_rtu(output_.bytes()).ok());
}

TEST_F(RtuServerTest, TheResponseDelayComesAfterTheSilence) {
  ModbusRtuSettings settings = settings_of(115'200);
  settings.response_delay.typical = 2ms;
  ModbusRtuServer server(settings, output_);
  server.add_unit(1, unit_);
  server.receive(kStart, frame_of(1, WriteRegister{0, 5}));
  server.advance(modbus_rtu_server_at(1s));
  const Duration request{8 * 11 * 1'000'000'000LL / 115'200};
  const Duration byte{11 * 1'000'000'000LL / 115'200};
  EXPECT_EQ(unit_.served_at, kStart + request + 1750us);
  EXPECT_EQ(output_.sent[0].due, kStart + request + 1750us + 2ms + byte);
}

TEST_F(RtuServerTest, ServesTheFunctionsOfTcp) {
  EXPECT_THAT(ask(1, {6, 0, 2, 0, 77}), ElementsAre(6, 0, 2, 0, 77));
  EXPECT_THAT(ask(1, {3, 0, 2, 0, 1}), ElementsAre(3, 2, 0, 77));
  EXPECT_THAT(ask(7, {3, 0, 2, 0, 1}), ElementsAre(3, 2, 0, 0)) << "the other unit's registers";
  EXPECT_THAT(ask(1, {3, 0, 0, 0, 126}), ElementsAre(0x83, 3));
  EXPECT_THAT(ask(1, {3, 0, 10, 0, 1}), ElementsAre(0x83, 2));
  EXPECT_THAT(ask(1, {0x63}), ElementsAre(0xE3, 1));
  EXPECT_THAT(ask(1, {17}), ElementsAre(17, 6, 's', 'm', 'a', 'l', 'l', 0xFF));
}

TEST_F(RtuServerTest, WhatIsNotForUsIsPassedOverInSilence) {
  for (const int address : {2, 8, 247, 248, 255}) {
    EXPECT_THAT(ask(static_cast<std::uint8_t>(address), {3, 0, 0, 0, 1}), IsEmpty()) << address;
  }
  EXPECT_EQ(server_.received().ignored, 5U);
  EXPECT_EQ(unit_.served_count + other_.served_count, 0);
}

TEST_F(RtuServerTest, AWrongCheckIsPassedOverAndTheNextFrameServed) {
  Bytes bad = frame_of(1, {6, 0, 2, 0, 77});
  bad.back() ^= 1;
  EXPECT_THAT(ask(bad), IsEmpty());
  EXPECT_EQ(unit_.holding[2], 0);
  EXPECT_THAT(ask(1, {6, 0, 2, 0, 78}), ElementsAre(6, 0, 2, 0, 78));
  EXPECT_EQ(server_.received().malformed, 1U);
}

TEST_F(RtuServerTest, BroadcastsActOnEveryUnitAndAreNotAnswered) {
  EXPECT_THAT(ask(0, {6, 0, 3, 0, 9}), IsEmpty());
  EXPECT_EQ(unit_.holding[3], 9);
  EXPECT_EQ(other_.holding[3], 9);
  EXPECT_THAT(ask(0, {16, 0, 4, 0, 2, 4, 0, 1, 0, 2}), IsEmpty());
  EXPECT_EQ(other_.holding[5], 2);
  EXPECT_THAT(ask(0, {3, 0, 0, 0, 1}), IsEmpty());
  EXPECT_THAT(ask(0, {23, 0, 0, 0, 1, 0, 3, 0, 1, 2, 0, 4}), IsEmpty());
  EXPECT_EQ(unit_.holding[3], 9) << "function 23 asks for an answer and cannot be a broadcast";
  EXPECT_EQ(unit_.served_count, 2);
}

TEST_F(RtuServerTest, AnotherUnitsFrameFollowedAtOnceByOurs) {
  // One write each, no silence between them: what a program on a pseudo-terminal does.
  write(kStart, frame_of(9, {3, 0, 0, 0, 1}));
  write(modbus_rtu_server_at(1ms), frame_of(1, {6, 0, 0, 0, 5}));
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 5);
  EXPECT_EQ(output_.bytes(), frame_of(1, {6, 0, 0, 0, 5}));
  EXPECT_EQ(server_.received().ignored, 1U);
  EXPECT_EQ(server_.received().malformed, 0U);
  // Both in one write.
  output_.sent.clear();
  write(modbus_rtu_server_at(2s), frame_of(9, {3, 0, 0, 0, 1}) + frame_of(1, {6, 0, 0, 0, 6}));
  server_.advance(modbus_rtu_server_at(3s));
  EXPECT_EQ(unit_.holding[0], 6);
}

TEST_F(StrictRtuServerTest, AnotherUnitsFrameNeedsItsSilenceBeforeOurs) {
  const Bytes theirs = frame_of(9, {3, 0, 0, 0, 1});
  const Duration line{8 * 11 * 1'000'000'000LL / 9600};
  write(kStart, theirs);
  write(kStart + line + 4'010'417ns, frame_of(1, {6, 0, 0, 0, 5}));
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 5);
  write(modbus_rtu_server_at(1s), theirs);
  write(modbus_rtu_server_at(1s), frame_of(1, {6, 0, 0, 0, 6}));
  server_.advance(modbus_rtu_server_at(2s));
  EXPECT_EQ(unit_.holding[0], 5) << "two frames without a silence are one bad frame";
  EXPECT_EQ(server_.received().malformed, 1U);
}

TEST_F(RtuServerTest, NoiseBeforeAGoodFrame) {
  const Bytes noise{0x13, 0x00, 0xFF, 0x55, 0xAA, 0x01, 0x03};
  write(kStart, noise);
  write(modbus_rtu_server_at(1ms), frame_of(1, {6, 0, 0, 0, 5}));  // its own write, no silence
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 5);
  EXPECT_EQ(server_.received().malformed, 1U);
  write(modbus_rtu_server_at(2s), noise);
  write(modbus_rtu_server_at(2s + 50ms),
        frame_of(1, {6, 0, 0, 0, 6}));  // while the noise might still go on
  server_.advance(modbus_rtu_server_at(3s));
  EXPECT_EQ(unit_.holding[0], 6);
}

TEST_F(StrictRtuServerTest, NoiseNeedsASilenceBeforeAGoodFrame) {
  write(kStart, Bytes{0x13, 0x00, 0xFF});
  write(modbus_rtu_server_at(20ms), frame_of(1, {6, 0, 0, 0, 5}));
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 5);
  write(modbus_rtu_server_at(1s), Bytes{0x13, 0x00, 0xFF} + frame_of(1, {6, 0, 0, 0, 6}));
  server_.advance(modbus_rtu_server_at(2s));
  EXPECT_EQ(unit_.holding[0], 5);
}

TEST_F(StrictRtuServerTest, AGapOfMoreThan1Point5CharactersInsideSpoilsTheFrame) {
  const Bytes request = frame_of(1, {6, 0, 0, 0, 5});
  const auto write_with_gap = [&](SimTime now, Duration gap) {
    const Duration half{4 * 11 * 1'000'000'000LL / 9600};
    write(now, {request.begin(), request.begin() + 4});
    write(now + half + gap, {request.begin() + 4, request.end()});
    server_.advance(now + 500ms);
  };
  write_with_gap(modbus_rtu_server_at(1s), 1'718'750ns);  // exactly t1.5
  EXPECT_EQ(unit_.served_count, 1);
  write_with_gap(modbus_rtu_server_at(2s), 1'718'752ns);
  EXPECT_EQ(unit_.served_count, 1);
  EXPECT_EQ(server_.received().malformed, 1U);
  write_with_gap(modbus_rtu_server_at(3s), 5ms);  // more than 3.5: two bad frames
  EXPECT_EQ(unit_.served_count, 1);
  EXPECT_EQ(server_.received().malformed, 3U);
}

TEST_F(RtuServerTest, ARequestInPiecesIsPutTogetherWithinTheTolerance) {
  const Bytes request = frame_of(1, {6, 0, 0, 0, 5});
  SimTime now = kStart;
  for (const std::uint8_t byte : request) {
    write(now, {byte});
    now += 125ms;  // eight bytes over a second
  }
  server_.advance(now);
  EXPECT_EQ(unit_.holding[0], 5);
  EXPECT_EQ(unit_.served_at, now - 125ms + 1'145'833ns + 4'010'416ns)
      << "served at its own silence, not after the tolerance";
  write(modbus_rtu_server_at(10s), {request.begin(), request.begin() + 4});
  write(modbus_rtu_server_at(10s + 300ms), {request.begin() + 4, request.end()});
  server_.advance(modbus_rtu_server_at(11s));
  EXPECT_EQ(unit_.served_count, 1) << "beyond the tolerance";
}

TEST_F(RtuServerTest, AnAbandonedHalfRequestDoesNotHurtTheNext) {
  const Bytes request = frame_of(1, {6, 0, 0, 0, 5});
  write(kStart, {request.begin(), request.begin() + 5});
  write(modbus_rtu_server_at(100ms), request);
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 5);
}

TEST_F(RtuServerTest, RequestsWhileAnAnswerIsOnTheLineAreServedAfterIt) {
  write(kStart, frame_of(1, {3, 0, 0, 0, 10}));
  server_.advance(modbus_rtu_server_at(14ms));
  ASSERT_EQ(output_.sent.size(), 25U);
  const SimTime first_ends = output_.sent.back().due;
  write(modbus_rtu_server_at(20ms), frame_of(1, {6, 0, 0, 0, 5}));
  server_.advance(modbus_rtu_server_at(1s));
  ASSERT_EQ(output_.sent.size(), 33U);
  EXPECT_GE(output_.sent[25].due - first_ends, 8 * 1'145'833ns + 4'010'416ns);
}

TEST_F(StrictRtuServerTest, ARequestThatCollidesWithAnAnswerIsLost) {
  write(kStart, frame_of(1, {3, 0, 0, 0, 10}));
  server_.advance(modbus_rtu_server_at(14ms));
  write(modbus_rtu_server_at(20ms), frame_of(1, {6, 0, 0, 0, 5}));
  server_.advance(modbus_rtu_server_at(1s));
  EXPECT_EQ(unit_.holding[0], 0);
  EXPECT_EQ(server_.received().malformed, 1U);
}

TEST_F(RtuServerTest, FramesLongerThan256BytesAreNone) {
  const Bytes longest = frame_of(1, Bytes(253, 0x63));
  EXPECT_THAT(ask(longest), ElementsAre(0xE3, 1));
  EXPECT_THAT(ask(longest + Bytes{0}), IsEmpty());
  EXPECT_THAT(ask(Bytes(5000, 0x01)), IsEmpty());
  now_ += 20s;  // 4096 characters and more were held back
  EXPECT_THAT(ask(1, {6, 0, 2, 0, 78}), ElementsAre(6, 0, 2, 0, 78));
}

TEST_F(RtuServerTest, AClientAtAnotherSpeedIsNotUnderstood) {
  server_.set_client(kStart, {true, 19'200});
  EXPECT_THAT(ask(1, {6, 0, 2, 0, 78}), IsEmpty());
  server_.set_client(modbus_rtu_server_at(10s), {true, 9600});
  now_ = modbus_rtu_server_at(10s);
  EXPECT_THAT(ask(1, {6, 0, 2, 0, 78}), ElementsAre(6, 0, 2, 0, 78));
}

TEST_F(RtuServerTest, SerialFunctions) {
  EXPECT_THAT(ask(1, {7}), ElementsAre(7, 0x6D));
  EXPECT_THAT(ask(1, {8, 0, 0, 0xA5, 0x37, 1, 2}), ElementsAre(8, 0, 0, 0xA5, 0x37, 1, 2));
  EXPECT_THAT(ask(1, {8, 0, 3, 0, 0}), ElementsAre(0x88, 1));
  EXPECT_THAT(ask(1, {8, 0, 11, 0, 1}), ElementsAre(0x88, 3));
  EXPECT_THAT(ask(1, {11}), ElementsAre(11, 0, 0, 0, 2)) << "7 and 8/0 were carried out";
  EXPECT_THAT(ask(1, {11}), ElementsAre(11, 0, 0, 0, 2)) << "11 itself does not count";
  EXPECT_THAT(ask(1, {11, 0}), ElementsAre(0x8B, 3));
}

TEST_F(RtuServerTest, CountersOfTheLineAndOfTheUnit) {
  ask(1, {3, 0, 0, 0, 1});
  ask(7, {3, 0, 0, 0, 1});
  ask(9, {3, 0, 0, 0, 1});
  ask(1, {3, 0, 99, 0, 1});  // exception
  ask(0, {6, 0, 0, 0, 1});   // broadcast
  Bytes bad = frame_of(1, {7});
  bad[0] = 2;
  ask(bad);
  EXPECT_EQ(counter(1, 11), 6) << "five good frames and this one";
  EXPECT_EQ(counter(1, 12), 1);
  EXPECT_EQ(counter(1, 13), 1);
  EXPECT_EQ(counter(1, 14), 3 + 4) << "two, the broadcast, and four of these";
  EXPECT_EQ(counter(1, 15), 1);
  EXPECT_EQ(counter(7, 14), 2 + 1);
  EXPECT_EQ(counter(1, 18), 0);
  ask(1, {8, 0, 10, 0, 0});
  EXPECT_EQ(counter(1, 13), 0);
  EXPECT_EQ(counter(7, 12), 1) << "only the counters of the unit that was asked are cleared";
}

TEST_F(RtuServerTest, ListenOnlyUntilRestarted) {
  EXPECT_THAT(ask(1, {8, 0, 4, 0, 0}), IsEmpty());
  EXPECT_THAT(ask(1, {6, 0, 0, 0, 5}), IsEmpty());
  EXPECT_THAT(ask(0, {6, 0, 0, 0, 5}), IsEmpty());
  EXPECT_THAT(ask(1, {8, 0, 0, 1, 2}), IsEmpty());
  EXPECT_EQ(unit_.holding[0], 0);
  EXPECT_EQ(other_.holding[0], 5);
  EXPECT_THAT(ask(1, {8, 0, 1, 0, 0}), IsEmpty()) << "the restart itself is not answered";
  EXPECT_THAT(ask(1, {6, 0, 0, 0, 6}), ElementsAre(6, 0, 0, 0, 6));
  EXPECT_THAT(ask(1, {8, 0, 1, 0xFF, 0}), ElementsAre(8, 0, 1, 0xFF, 0));
  EXPECT_EQ(counter(1, 14), 1) << "restarting clears the counters";
}

TEST(ModbusRtuSettingsTest, OutOfRangeIsRefused) {
  RecordedLine output;
  EXPECT_THROW(ModbusRtuServer(settings_of(299), output), std::invalid_argument);
  EXPECT_THROW(ModbusRtuServer(settings_of(1'000'001), output), std::invalid_argument);
  ModbusRtuSettings settings;
  settings.line.gap_tolerance = 6s;
  EXPECT_THROW(ModbusRtuServer(settings, output), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
