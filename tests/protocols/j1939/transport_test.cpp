#include "protocols/j1939/transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "protocols/j1939/message.h"

namespace rigwire::protocols::j1939 {
namespace {

using testing::ElementsAre;

constexpr std::uint32_t kGroup = 0xFECA;

TEST(TransportFrames, EveryControlHasItsBytes) {
  const TransportManagement request{TransportControl::request_to_send, 14, 2, 16, 0, {}, kGroup};
  const can::Frame frame = make_transport_management(0x27, 0x80, request);
  EXPECT_EQ(frame.id, 0x1CEC8027U);
  EXPECT_THAT(frame.payload(), ElementsAre(16, 14, 0, 2, 16, 0xCA, 0xFE, 0x00));

  const TransportManagement clear{TransportControl::clear_to_send, 0, 3, 0xFF, 5, {}, kGroup};
  EXPECT_THAT(make_transport_management(0x80, 0x27, clear).payload(),
              ElementsAre(17, 3, 5, 0xFF, 0xFF, 0xCA, 0xFE, 0x00));

  const TransportManagement end{TransportControl::end_of_message, 1785, 255, 0xFF, 0, {}, 0x1FFFF};
  EXPECT_THAT(make_transport_management(0x80, 0x27, end).payload(),
              ElementsAre(19, 0xF9, 0x06, 255, 0xFF, 0xFF, 0xFF, 0x01));

  const TransportManagement broadcast{TransportControl::broadcast, 14, 2, 0xFF, 0, {}, kGroup};
  const can::Frame announced = make_transport_management(0x27, kGlobalAddress, broadcast);
  EXPECT_EQ(announced.id, 0x1CECFF27U);
  EXPECT_THAT(announced.payload(), ElementsAre(32, 14, 0, 2, 0xFF, 0xCA, 0xFE, 0x00));

  const TransportManagement abort{TransportControl::abort, 0,     0, 0xFF, 0,
                                  AbortReason::timeout,    kGroup};
  EXPECT_THAT(make_transport_management(0x80, 0x27, abort).payload(),
              ElementsAre(255, 3, 0xFF, 0xFF, 0xFF, 0xCA, 0xFE, 0x00));

  for (const TransportManagement& management : {request, clear, end, broadcast, abort}) {
    const auto back =
        decode_transport_management(make_transport_management(0x27, 0x80, management).payload());
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(make_transport_management(0x27, 0x80, *back),
              make_transport_management(0x27, 0x80, management));
  }
}

TEST(TransportFrames, LastPacketIsFilledWithOnes) {
  const std::vector<std::uint8_t> message{1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_THAT(make_transport_data(0x27, 0xFF, message, 1).payload(),
              ElementsAre(1, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(make_transport_data(0x27, 0xFF, message, 2).payload(),
              ElementsAre(2, 8, 9, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
  EXPECT_EQ(make_transport_data(0x27, 0x80, message, 2).id, 0x1CEB8027U);
}

TEST(TransportFrames, SizesAndPacketsMustBelongTogether) {
  EXPECT_EQ(packets_of(9), 2);
  EXPECT_EQ(packets_of(14), 2);
  EXPECT_EQ(packets_of(15), 3);
  EXPECT_EQ(packets_of(1785), 255);
  const auto announces = [](std::uint16_t size, std::uint8_t packets) {
    TransportManagement management;
    management.size = size;
    management.packets = packets;
    return announces_message(management);
  };
  EXPECT_TRUE(announces(9, 2) && announces(1785, 255));
  EXPECT_FALSE(announces(8, 2) || announces(9, 3) || announces(1786, 255) || announces(0, 0));
}

TEST(TransportFrames, OtherLengthsAndControlsAreMalformed) {
  std::vector<std::uint8_t> bytes(8, 0xFF);
  for (unsigned control = 0; control < 256; ++control) {
    bytes[0] = static_cast<std::uint8_t>(control);
    const bool known =
        control == 16 || control == 17 || control == 19 || control == 32 || control == 255;
    EXPECT_EQ(decode_transport_management(bytes).ok(), known) << control;
  }
  for (std::size_t size = 0; size < 8; ++size) {
    EXPECT_TRUE(decode_transport_management(std::span(bytes).first(size)).malformed());
    EXPECT_TRUE(decode_transport_data(std::span(bytes).first(size)).malformed());
  }
}

TEST(CommandedAddress, NameThenAddress) {
  const auto bytes = encode_commanded_address({0x8000830066E12345, 0x90});
  EXPECT_THAT(bytes, ElementsAre(0x45, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80, 0x90));
  EXPECT_EQ(*decode_commanded_address(bytes), (CommandedAddress{0x8000830066E12345, 0x90}));
  EXPECT_TRUE(decode_commanded_address(std::span(bytes).first(8)).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::j1939
