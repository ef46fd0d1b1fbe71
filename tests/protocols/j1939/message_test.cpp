#include "protocols/j1939/message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::protocols::j1939 {
namespace {

using testing::ElementsAre;

TEST(Request, ForTheAddressClaimIsTheOneEveryToolSends) {
  const can::Frame frame = make_request(0xFE, kGlobalAddress, kAddressClaimedPgn);
  EXPECT_EQ(frame.id, 0x18EAFFFEU);
  EXPECT_THAT(frame.payload(), ElementsAre(0x00, 0xEE, 0x00));
  EXPECT_EQ(*decode_request(frame), kAddressClaimedPgn);
}

TEST(Request, OnlyThreeBytesAreARequest) {
  can::Frame frame = make_request(0xFE, 0x80, 61481);
  for (std::uint8_t length = 0; length <= 8; ++length) {
    frame.length = length;
    EXPECT_EQ(decode_request(frame).ok(), length == 3) << int{length};
  }
  frame.length = 3;
  frame.remote = true;
  EXPECT_TRUE(decode_request(frame).malformed());
  frame.remote = false;
  frame.extended = false;
  EXPECT_TRUE(decode_request(frame).malformed());
}

TEST(AddressClaim, CarriesTheNameLittleEndian) {
  const can::Frame frame = make_address_claim(0x50, 0x1122334455667788ULL);
  EXPECT_EQ(frame.id, 0x18EEFF50U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11));
  EXPECT_EQ(*decode_address_claim(frame), 0x1122334455667788ULL);
}

TEST(AddressClaim, OtherLengthsAreMalformed) {
  can::Frame frame = make_address_claim(0x50, 1);
  for (std::uint8_t length = 0; length < 8; ++length) {
    frame.length = length;
    EXPECT_TRUE(decode_address_claim(frame).malformed());
  }
  frame.length = 200;  // nothing on a wire is, but the parser must not trust it
  EXPECT_TRUE(decode_address_claim(frame).malformed());
}

TEST(Acknowledgement, RoundTripAndBytes) {
  const Acknowledgement refusal{Acknowledge::negative, 0xFF, 0x21, 65242};
  const can::Frame frame = make_acknowledgement(0x80, kGlobalAddress, refusal);
  EXPECT_EQ(frame.id, 0x18E8FF80U);
  EXPECT_THAT(frame.payload(), ElementsAre(1, 0xFF, 0xFF, 0xFF, 0x21, 0xDA, 0xFE, 0x00));
  EXPECT_EQ(*decode_acknowledgement(frame), refusal);
}

}  // namespace
}  // namespace rigwire::protocols::j1939
