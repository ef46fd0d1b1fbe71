// Messages by hand, as V1.1b3, section 6, has them.
#include "hil/stream/modbus_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "emulators/valve_driver/registers.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Bytes = std::vector<std::uint8_t>;

class ModbusReaderTest : public testing::Test {
 protected:
  explicit ModbusReaderTest(ModbusReader::Line line = ModbusReader::Line::tcp)
      : reader_(line, {{"valves", 1, {"swing", "boom"}, emulators::valve_registers::map(2)}}) {}

  std::vector<WireReading> take(bool of_client, const Bytes& bytes, SimTime at = kStart,
                                std::uint64_t connection = 7) {
    std::vector<WireReading> all;
    reader_.take(at, connection, of_client, bytes,
                 [&](std::span<const std::uint8_t> /*message*/, const WireReading& reading) {
                   all.push_back(reading);
                 });
    return all;
  }
  nlohmann::json row(const std::string& name) const {
    const auto told = nlohmann::json::parse(reader_.registers())["registers"];
    const auto found =
        std::ranges::find_if(told, [&](const auto& each) { return each["name"] == name; });
    return found == told.end() ? nlohmann::json() : *found;
  }
  static const WireField* field(const WireReading& reading, const std::string& name) {
    const auto found = std::ranges::find(reading.fields, name, &WireField::name);
    return found == reading.fields.end() ? nullptr : &*found;
  }

  ModbusReader reader_;
};

// Write registers 2 .. 3 of unit 1: -20.0 % and 5.0 % in counts of 0.1 %; the answer.
const Bytes kWrite{0, 5, 0, 0, 0, 11, 1, 16, 0, 1, 0, 2, 4, 0xFF, 0x38, 0, 50};
const Bytes kWritten{0, 5, 0, 0, 0, 6, 1, 16, 0, 1, 0, 2};

TEST_F(ModbusReaderTest, FieldsHaveTheNamesOfTheMapAndTheirPlaces) {
  const auto told = take(true, kWrite);
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(
      told[0].text,
      HasSubstr("write registers 1 .. 2 spool_command[swing]=-20 % spool_command[boom]=5 %"));
  const WireField* const boom = field(told[0], "spool_command[boom]");
  ASSERT_NE(boom, nullptr);
  EXPECT_EQ(boom->value, "5 %");
  EXPECT_EQ(boom->from, 15U);
  EXPECT_EQ(boom->bytes, 2U);
}

TEST_F(ModbusReaderTest, AWriteCountsWhenItIsAnswered) {
  (void)take(true, kWrite);
  EXPECT_FALSE(row("spool_command[swing]").contains("value"));
  (void)take(false, kWritten, kStart + 2s);
  EXPECT_EQ(row("spool_command[swing]")["value"], -20.0);
  EXPECT_EQ(row("spool_command[swing]")["by"], "client 7");
  EXPECT_EQ(row("spool_command[swing]")["written_ns"], 2'000'000'000);
  EXPECT_FALSE(row("heartbeat").contains("by"));
}

TEST_F(ModbusReaderTest, AWriteThatIsRefusedDoesNotCount) {
  (void)take(true, kWrite);
  const auto told = take(false, {0, 5, 0, 0, 0, 3, 1, 0x90, 3});
  EXPECT_THAT(told.at(0).text, HasSubstr("exception 03"));
  EXPECT_FALSE(row("spool_command[swing]").contains("value"));
}

TEST_F(ModbusReaderTest, AnswersOfTwoRequestsAreToldApartByTransaction) {
  // Input registers 18 (supply voltage) and 19 (temperature), asked at once, answered crosswise.
  (void)take(true, {0, 1, 0, 0, 0, 6, 1, 4, 0, 18, 0, 1, 0, 2, 0, 0, 0, 6, 1, 4, 0, 19, 0, 1});
  (void)take(false, {0, 2, 0, 0, 0, 5, 1, 4, 2, 0, 30});
  EXPECT_FALSE(row("supply_voltage").contains("value"));
  EXPECT_TRUE(row("driver_temperature").contains("value"));
  EXPECT_FALSE(row("driver_temperature").contains("by"));
}

TEST_F(ModbusReaderTest, InputRegistersAreReadByTheirMirrorToo) {
  (void)take(true, {0, 1, 0, 0, 0, 6, 1, 3, 0x03, 0xFA, 0, 1});  // 1018
  (void)take(false, {0, 1, 0, 0, 0, 5, 1, 3, 2, 0, 24});
  EXPECT_TRUE(row("supply_voltage").contains("value"));
}

TEST_F(ModbusReaderTest, ReadsInPiecesAndWhatNoRegisterHas) {
  // Holding register 400, of which the map has nothing.
  const Bytes request{0, 1, 0, 0, 0, 6, 1, 3, 1, 0x90, 0, 1};
  for (std::size_t i = 0; i + 1 < request.size(); ++i) {
    EXPECT_THAT(take(true, {request[i]}), IsEmpty());
  }
  EXPECT_THAT(take(true, {request.back()}), SizeIs(1));
  const auto told = take(false, {0, 1, 0, 0, 0, 5, 1, 3, 2, 0x12, 0x34});
  ASSERT_NE(field(told.at(0), "register 400"), nullptr);
  EXPECT_EQ(field(told.at(0), "register 400")->value, "4660");
}

TEST_F(ModbusReaderTest, AfterAWrongLengthTheNextPieceIsAMessageAgain) {
  EXPECT_THAT(take(true, {0, 1, 0, 0, 0xFF, 0xFF, 1, 3}), IsEmpty());
  EXPECT_THAT(take(true, kWrite), SizeIs(1));
}

TEST_F(ModbusReaderTest, AnAnswerThatIsShorterThanAskedEntersNothing) {
  (void)take(true, {0, 1, 0, 0, 0, 6, 1, 4, 0, 18, 0, 2});
  EXPECT_THAT(take(false, {0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 24}), SizeIs(1));
  EXPECT_FALSE(row("supply_voltage").contains("value"));
}

class ModbusReaderRtuTest : public ModbusReaderTest {
 protected:
  ModbusReaderRtuTest() : ModbusReaderTest(ModbusReader::Line::rtu) {}
  static Bytes frame(const Bytes& pdu) {
    const auto encoded = protocols::modbus::encode_rtu(1, pdu);
    return {encoded.view().begin(), encoded.view().end()};
  }
};

TEST_F(ModbusReaderRtuTest, JoinsAnswersByTurns) {
  const Bytes asked = frame({6, 0, 9, 0, 77});
  EXPECT_THAT(take(true, Bytes(asked.begin(), asked.begin() + 3)), IsEmpty());
  EXPECT_THAT(take(true, Bytes(asked.begin() + 3, asked.end())), SizeIs(1));
  EXPECT_THAT(take(false, asked, kStart + 1s), SizeIs(1));
  EXPECT_EQ(row("heartbeat")["value"], 77.0);
  EXPECT_EQ(row("heartbeat")["by"], "the client");
}

TEST_F(ModbusReaderRtuTest, ASpoiltFrameEndsWhenTheOtherOneSpeaks) {
  EXPECT_THAT(take(true, {1, 3, 0, 0}), IsEmpty());
  EXPECT_THAT(take(false, frame({0x83, 2})), SizeIs(1));
  EXPECT_THAT(take(true, frame({6, 0, 9, 0, 77})), SizeIs(1));
}

}  // namespace
}  // namespace rigwire::hil
