#include "hil/stream/wire_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/bytes.h"
#include "protocols/gige_vision/gvsp.h"
#include "protocols/rtcm3/message.h"
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

/// A frame as a station sends it.
template <class Message>
std::vector<std::uint8_t> rtcm_frame(const Message& message) {
  std::vector<std::uint8_t> frame(protocols::rtcm3::kGreatestFrame);
  frame.resize(protocols::rtcm3::encode(message, frame));
  return frame;
}

TEST(WireReading, AStationsPlaceIsWhereItsBitsLie) {
  protocols::rtcm3::AntennaPosition place;
  place.station = 17;
  place.position_m = {4'120'000.1234, -561'000.5, 4'817'000.25};
  place.antenna_height_m = 1.5;
  const auto frame = rtcm_frame(place);
  const WireReading reading = read_serial(frame);
  EXPECT_EQ(reading.text, "RTCM 1006");
  ASSERT_NE(find(reading, "station"), nullptr);
  EXPECT_EQ(find(reading, "station")->value, "17");
  EXPECT_EQ(find(reading, "station")->from, 4U);
  EXPECT_EQ(find(reading, "x")->value, "4120000.1234 m");
  // Bits 58 to 95 of the frame.
  EXPECT_EQ(find(reading, "x")->from, 7U);
  EXPECT_EQ(find(reading, "x")->bytes, 5U);
  EXPECT_EQ(find(reading, "y")->value, "-561000.5 m");
  EXPECT_EQ(find(reading, "z")->value, "4817000.25 m");
  EXPECT_EQ(find(reading, "antenna height")->value, "1.5 m");
  EXPECT_EQ(find(reading, "checksum")->from, frame.size() - 3);
  EXPECT_EQ(find(reading, "content"), nullptr) << "everything has a name";
}

TEST(WireReading, ACorrectionWithoutATableHasItsFrame) {
  const auto frame = rtcm_frame(protocols::rtcm3::StationDescriptors{});
  const WireReading reading = read_serial(frame);
  EXPECT_EQ(reading.text, "RTCM 1033");
  ASSERT_NE(find(reading, "content"), nullptr);
  EXPECT_EQ(find(reading, "content")->from, 6U);
  // A frame cut short or with an empty payload is no reason to look beyond it.
  for (std::size_t size = 0; size < frame.size(); ++size) {
    EXPECT_THAT(read_serial(std::span(frame).first(size)).fields, IsEmpty());
  }
}

TEST(WireReading, APictureHasLeaderPayloadAndTrailer) {
  namespace gige = protocols::gige_vision;
  for (const bool extended : {false, true}) {
    std::array<std::uint8_t, 256> bytes{};
    gige::PacketHeader header{
        .extended_ids = extended, .format = gige::PacketFormat::leader, .block = 7, .packet = 0};
    std::size_t size = gige::write_header(bytes, header);
    const std::size_t of_header = size;
    size += gige::write_image_leader(std::span(bytes).subspan(size),
                                     {.timestamp = 123456789012, .width = 640, .height = 480});
    const WireReading leader = read_stream_packet(std::span(bytes).first(size));
    EXPECT_EQ(leader.text, "GVSP block 7, packet 0, leader");
    EXPECT_EQ(find(leader, "block")->value, "7");
    EXPECT_EQ(find(leader, "timestamp")->value, "123456789012");
    EXPECT_EQ(find(leader, "width")->value, "640");
    EXPECT_EQ(find(leader, "height")->from, of_header + 20);
    EXPECT_LE(unclear(leader, size), 2U) << "reserved bits of a header";
    header.format = gige::PacketFormat::payload;
    header.packet = 1;
    gige::write_header(bytes, header);
    const WireReading payload = read_stream_packet(bytes);
    EXPECT_EQ(payload.text, "GVSP block 7, packet 1, payload");
    EXPECT_EQ(find(payload, "pixels")->from, of_header);
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
      for (const WireField& field : read_stream_packet(std::span(bytes).first(cut)).fields) {
        EXPECT_LE(field.from + field.bytes, cut) << field.name;
      }
    }
  }
}

TEST(WireReading, ARequestOfRegistersHasAddressesAndValues) {
  // The worked example of gvcp.h: Aravis asks for control.
  const std::array<std::uint8_t, 16> asked{0x42, 0x01, 0x00, 0x82, 0x00, 0x08, 0xFF, 0x15,
                                           0x00, 0x00, 0x0A, 0x00, 0x00, 0x00, 0x00, 0x02};
  const WireReading command = read_control_packet(asked);
  EXPECT_EQ(command.text, "GVCP command 0x0082");
  EXPECT_EQ(find(command, "address")->value, "0x00000A00");
  EXPECT_EQ(find(command, "value")->value, "0x00000002");
  EXPECT_EQ(find(command, "value")->from, 12U);
  EXPECT_EQ(unclear(command, asked.size()), 0U);
  const std::array<std::uint8_t, 12> answered{0, 0, 0, 0x83, 0, 4, 0xFF, 0x15, 0, 0, 0, 1};
  const WireReading acknowledge = read_control_packet(answered);
  EXPECT_EQ(acknowledge.text, "GVCP acknowledge 0x0083");
  EXPECT_EQ(find(acknowledge, "request")->value, std::to_string(0xFF15));
  EXPECT_EQ(unclear(acknowledge, answered.size()), 0U);
  EXPECT_THAT(read_control_packet(std::span(asked).first(7)).fields, IsEmpty());
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
