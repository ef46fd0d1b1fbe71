#include "protocols/slcan/slcan.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace rigwire::protocols::slcan {
namespace {

std::vector<std::uint8_t> bytes(std::string_view text) {
  return {text.begin(), text.end()};
}
std::string string(const Text& text) {
  return {text.span().begin(), text.span().end()};
}
Decoded<Command> command(std::string_view text) {
  return parse_command(bytes(text));
}
Decoded<Reply> reply(std::string_view text) {
  return parse_reply(bytes(text));
}

TEST(SlcanFrame, LinesThatPythonCanSends) {
  const auto request = command("T18EAFFFE300EE00");
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request->frame, (can::Frame{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}}));
  EXPECT_EQ(command("t12320102")->frame, (can::Frame{0x123, false, false, 2, {1, 2}}));
  EXPECT_EQ(command("r1234")->frame, (can::Frame{0x123, false, true, 4, {}}));
  EXPECT_EQ(command("R1ABCDEF08")->frame, (can::Frame{0x1ABCDEF0, true, true, 8, {}}));
}

TEST(SlcanFrame, UpperCaseOutEitherCaseIn) {
  const can::Frame frame{0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}};
  EXPECT_EQ(string(write_frame(frame)), "T0CF02980800007D00007DCC00\r");
  EXPECT_EQ(command("T0cf02980800007d00007dcc00")->frame, frame);
}

TEST(SlcanFrame, TimeStampOnlyFromTheAdapter) {
  const can::Frame frame{0x123, false, false, 1, {0xAB}};
  EXPECT_EQ(string(write_frame(frame, 59'999)), "t1231ABEA5F\r");
  const auto received = reply("t1231ABEA5F");
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received->frame, frame);
  EXPECT_EQ(received->time_stamp_ms, 59'999);
  EXPECT_TRUE(command("t1231ABEA5F").malformed());
}

TEST(SlcanFrame, MalformedOnes) {
  for (const char* line : {"t", "t12", "t123", "t1239", "t123A", "t8000", "t12G0", "t1232AB",
                           "t1231ABC", "t1231AG", "T200000000", "T1234567", "r1239", "r123400"}) {
    EXPECT_TRUE(command(line).malformed()) << line;
  }
}

TEST(SlcanCommand, EveryVerbSurvivesTheRoundTrip) {
  for (const char* line :
       {"O\r",         "L\r",  "C\r",  "S0\r", "S8\r",    "s031C\r",     "F\r", "V\r",
        "v\r",         "N\r",  "Z0\r", "Z1\r", "X1\r",    "P\r",         "A\r", "M0123ABCD\r",
        "mFFFFFFFF\r", "W1\r", "U6\r", "S9\r", "t7FF0\r", "R1FFFFFFF8\r"}) {
    const std::string_view text(line);
    const auto parsed = command(text.substr(0, text.size() - 1));
    ASSERT_TRUE(parsed.ok()) << line;
    EXPECT_EQ(string(write_command(*parsed)), text);
  }
}

TEST(SlcanCommand, WrongArgumentsAreMalformed) {
  for (const char* line : {"", "O1", "S", "S:", "S55", "Z2", "Z", "s12", "s12345", "Q", "m0000000",
                           "M000000000", "P1", "W2", "U7", "\x80", "C C"}) {
    EXPECT_TRUE(command(line).malformed()) << line;
  }
}

TEST(SlcanReply, KindsOfTheAdapter) {
  EXPECT_EQ(reply("")->kind, ReplyKind::done);
  EXPECT_EQ(reply("\x07")->kind, ReplyKind::refused);
  EXPECT_EQ(reply("z")->kind, ReplyKind::frame_taken);
  EXPECT_EQ(reply("Z")->kind, ReplyKind::frame_taken);
  EXPECT_EQ(reply("F08")->number, 8);
  EXPECT_EQ(reply("V1013")->kind, ReplyKind::information);
  EXPECT_EQ(reply("A")->kind, ReplyKind::all_polled);
  EXPECT_EQ(reply("e2ac")->number, kNoAcknowledge | kCrcError);
  EXPECT_EQ(string(write_reply(*reply("e3sab"))), "e3abs\r");
  EXPECT_TRUE(reply("e2a").malformed());
  EXPECT_TRUE(reply("e1x").malformed());
}

TEST(SlcanReply, BusStateAsTheKernelReadsIt) {
  const auto state = reply("sp128000");
  ASSERT_TRUE(state.ok());
  EXPECT_EQ(state->state, can::ErrorState::passive);
  EXPECT_EQ(state->receive_errors, 128);
  EXPECT_EQ(state->transmit_errors, 0);
  EXPECT_EQ(string(write_reply(*state)), "sp128000\r");
  EXPECT_TRUE(reply("sx128000").malformed());
  EXPECT_TRUE(reply("sp12800").malformed());
}

TEST(LineSplitter, OneMegabyteWithoutEndIsOneTooLongLine) {
  LineSplitter splitter;
  for (int i = 0; i < 1'000'000; ++i) {
    ASSERT_FALSE(splitter.push('t'));
  }
  const auto line = splitter.push(kEnd);
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->too_long);
  EXPECT_TRUE(line->text.empty());
  (void)splitter.push('O');
  const auto next = splitter.push(kEnd);
  ASSERT_TRUE(next);
  EXPECT_FALSE(next->too_long);
  EXPECT_EQ(next->text.size(), 1U);
}

TEST(LineSplitter, BellIsALineOfItsOwn) {
  LineSplitter splitter;
  (void)splitter.push('z');
  const auto bell = splitter.push(kBell);
  ASSERT_TRUE(bell);
  ASSERT_EQ(bell->text.size(), 1U);
  EXPECT_EQ(bell->text[0], kBell);
}

TEST(LineSplitter, LongestLegalLineFits) {
  LineSplitter splitter;
  const Text longest = write_frame({0x1FFFFFFF, true, false, 8, {}}, 0);
  EXPECT_EQ(longest.size, kLongestLine + 1);
  std::optional<LineSplitter::Line> line;
  for (const std::uint8_t byte : longest.span()) {
    line = splitter.push(byte);
  }
  ASSERT_TRUE(line);
  EXPECT_EQ(line->text.size(), kLongestLine);
}

}  // namespace
}  // namespace rigwire::protocols::slcan
