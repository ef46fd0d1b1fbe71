#include "hil/stream/wire_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/bytes.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const WireField* find(const WireReading& reading, std::string_view name) {
  const auto found = std::ranges::find(reading.fields, name, &WireField::name);
  return found == reading.fields.end() ? nullptr : &*found;
}

/// Bytes of the message that belong to no field or to several.
std::size_t unclear(const WireReading& reading, std::size_t size) {
  std::vector<int> owners(size);
  for (const WireField& field : reading.fields) {
    for (std::size_t i = field.from; i < std::min(size, field.from + field.bytes); ++i) {
      ++owners[i];
    }
  }
  return static_cast<std::size_t>(std::ranges::count_if(owners, [](int n) { return n != 1; }));
}

TEST(WireReading, FieldsOfASentenceAreWhereTheirTextIs) {
  constexpr std::string_view kText =
      "$GPGGA,080001.00,4925.4820,N,00745.1020,E,1,08,1.0,200.0,M,48.0,M,,*63\r\n";
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(kText.data()), kText.size());
  const WireReading reading = read_serial(bytes);
  EXPECT_EQ(reading.text, kText.substr(0, kText.size() - 2));
  for (const WireField& field : reading.fields) {
    EXPECT_EQ(kText.substr(field.from, field.bytes), field.value) << field.name;
  }
  ASSERT_NE(find(reading, "longitude"), nullptr);
  EXPECT_EQ(find(reading, "longitude")->value, "00745.1020");
  ASSERT_NE(find(reading, "horizontal dilution"), nullptr);
  EXPECT_EQ(find(reading, "horizontal dilution")->value, "1.0");
}

TEST(WireReading, FieldsOfNavPvtAreAllThere) {
  protocols::ubx::NavPvt92 pvt;
  pvt.latitude_e7deg = 494247000;
  pvt.velocity_ned_mmps = {1, -2, 3};
  pvt.declination_e2deg = -250;
  const auto frame = protocols::ubx::encode(pvt);
  const WireReading reading = read_serial(frame);
  EXPECT_THAT(reading.text, HasSubstr("0x01 0x07"));
  ASSERT_NE(find(reading, "latitude, 1e-7 deg"), nullptr);
  EXPECT_EQ(find(reading, "latitude, 1e-7 deg")->value, "494247000");
  EXPECT_EQ(find(reading, "latitude, 1e-7 deg")->from, 6U + 28U);
  EXPECT_EQ(find(reading, "velocity north, east, down, mm/s")->value, "1 -2 3");
  EXPECT_EQ(find(reading, "declination, 0.01 deg")->value, "-250");
  EXPECT_EQ(find(reading, "declination, 0.01 deg")->from, 6U + 88U);
  EXPECT_EQ(unclear(reading, frame.size()), 4U) << "its reserved bytes";
}

TEST(WireReading, AMessageWithoutATableHasItsFrame) {
  protocols::ubx::NavDop dop;
  const auto frame = protocols::ubx::encode(dop);
  const WireReading reading = read_serial(frame);
  ASSERT_NE(find(reading, "payload"), nullptr);
  EXPECT_EQ(unclear(reading, frame.size()), 0U);
}

TEST(WireReading, WhatBeginsInTheMiddleHasNoFields) {
  const std::array<std::uint8_t, 5> bytes{1, 2, 3, 4, 5};
  EXPECT_THAT(read_serial(bytes).fields, IsEmpty());
  EXPECT_THAT(read_serial({}).fields, IsEmpty());
}

TEST(WireReading, ALidarPacketHasBlocksAndChannels) {
  std::array<std::uint8_t, protocols::velodyne::kDataPacketSize> bytes{};
  protocols::velodyne::DataPacketWriter writer(bytes);
  for (std::size_t block = 0; block < protocols::velodyne::kBlocksPerPacket; ++block) {
    writer.flag(block, protocols::velodyne::kFlagLasers0To31);
    writer.azimuth(block, static_cast<std::uint16_t>(100 * block));
  }
  protocols::store_little(std::span(bytes), 4 + 3 * 2, std::uint16_t{1234});
  const WireReading reading = read_datagram(bytes);
  ASSERT_NE(find(reading, "block 0, channel 2, distance"), nullptr);
  EXPECT_EQ(find(reading, "block 0, channel 2, distance")->value, "1234 counts");
  EXPECT_EQ(find(reading, "block 1, azimuth")->value, "1.00 deg");
  EXPECT_EQ(find(reading, "block 1, azimuth")->from, 102U);
  EXPECT_EQ(unclear(reading, kShownBytes), 0U);
}

TEST(WireReading, ASignalHasTheBytesThatItsBitsLieIn) {
  protocols::can::OwnedMessage message;
  message.name = "EEC1";
  message.id = 0x0CF00400;
  message.extended = true;
  auto& signal = message.signals.emplace_back();
  signal.name = "engine_speed";
  signal.unit = "rpm";
  signal.bit = 24;
  signal.width = 16;
  signal.scale = 0.125;
  signal.upper = 8031.875;
  protocols::can::Frame frame;
  frame.id = message.id;
  frame.extended = true;
  frame.length = 8;
  frame.data = {0, 0, 0, 0x68, 0x13, 0, 0, 0};
  const WireReading reading = read_frame(frame, {&message, 1});
  ASSERT_NE(find(reading, "engine_speed"), nullptr);
  EXPECT_EQ(find(reading, "engine_speed")->value, "621 rpm");
  EXPECT_EQ(find(reading, "engine_speed")->from, 3U);
  EXPECT_EQ(find(reading, "engine_speed")->bytes, 2U);
  frame.remote = true;
  EXPECT_THAT(read_frame(frame, {&message, 1}).fields, IsEmpty());
}

}  // namespace
}  // namespace rigwire::hil
