#include "protocols/foxglove/frames.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace rigwire::protocols::foxglove {
namespace {

using namespace std::string_literals;
using namespace std::string_view_literals;

// Bytes worked by hand from the layouts of docs/spec.md.

TEST(FoxgloveFrames, AMessageHasSubscriptionAndTimeInFront) {
  EXPECT_EQ(message_frame(0x0102, 0x1122334455667788, "{}"),
            "\x01\x02\x01\x00\x00\x88\x77\x66\x55\x44\x33\x22\x11{}"s);
}

TEST(FoxgloveFrames, TimeIsNineBytes) {
  EXPECT_EQ(time_frame(1), "\x02\x01\x00\x00\x00\x00\x00\x00\x00"s);
}

TEST(FoxgloveFrames, AnAnswerNamesServiceCallAndEncoding) {
  EXPECT_EQ(service_response_frame(1, 2, "json", "[]"),
            "\x03\x01\x00\x00\x00\x02\x00\x00\x00\x04\x00\x00\x00json[]"s);
}

TEST(FoxgloveFrames, AnAssetIsThereOrWhyNot) {
  EXPECT_EQ(asset_frame(7, "abc"), "\x04\x07\x00\x00\x00\x00\x00\x00\x00\x00\x61\x62\x63"s);
  EXPECT_EQ(asset_error_frame(7, "no"), "\x04\x07\x00\x00\x00\x01\x02\x00\x00\x00no"s);
}

TEST(FoxgloveFrames, PlaybackStateHasItsSpeedAsAFloat) {
  EXPECT_EQ(playback_state_frame(PlaybackStatus::paused, 3, 1.0F, false, "x"),
            "\x05\x01\x03\x00\x00\x00\x00\x00\x00\x00\x00\x00\x80\x3F\x00\x01\x00\x00\x00x"s);
}

constexpr std::string_view kRequest =
    "\x02\x05\x00\x00\x00\x06\x00\x00\x00\x04\x00\x00\x00json{}"sv;
constexpr std::string_view kControl =
    "\x03\x01\x00\x00\x00\x40\x01\x09\x00\x00\x00\x00\x00\x00\x00\x02\x00\x00\x00id"sv;

TEST(FoxgloveFrames, AServiceRequestIsRead) {
  const auto frame = decode_client_frame(kRequest);
  ASSERT_TRUE(frame.ok());
  const auto& request = std::get<ServiceRequest>(*frame);
  EXPECT_EQ(request.service, 5U);
  EXPECT_EQ(request.call, 6U);
  EXPECT_EQ(request.encoding, "json");
  EXPECT_EQ(request.payload, "{}");
}

TEST(FoxgloveFrames, PlaybackControlIsRead) {
  const auto frame = decode_client_frame(kControl);
  ASSERT_TRUE(frame.ok());
  const auto& control = std::get<PlaybackControl>(*frame);
  EXPECT_FALSE(control.plays);
  EXPECT_EQ(control.speed, 2.0F);
  EXPECT_EQ(control.seek_ns, 9U);
  EXPECT_EQ(control.request, "id");
}

TEST(FoxgloveFrames, EveryTruncationIsMalformed) {
  for (std::size_t size = 0; size < kControl.size(); ++size) {
    EXPECT_TRUE(decode_client_frame(kControl.substr(0, size)).malformed()) << size;
  }
  // The payload of a request may be empty: what is cut off there is not missed.
  for (std::size_t size = 0; size < kRequest.size() - 2; ++size) {
    EXPECT_TRUE(decode_client_frame(kRequest.substr(0, size)).malformed()) << size;
  }
}

TEST(FoxgloveFrames, WhatIsNoFrameOfAClientIsMalformed) {
  EXPECT_TRUE(decode_client_frame("").malformed());
  EXPECT_TRUE(decode_client_frame("\x07").malformed());
  EXPECT_TRUE(decode_client_frame(std::string(kControl) + "x").malformed());
  std::string other(kControl);
  other[1] = 2;  // neither plays nor pauses
  EXPECT_TRUE(decode_client_frame(other).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::foxglove
