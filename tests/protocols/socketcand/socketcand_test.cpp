#include "protocols/socketcand/socketcand.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::socketcand {
namespace {

using can::Frame;
using namespace std::chrono_literals;

TEST(SocketcandCommands, TheProtocolsOwnExamplesAreUnderstood) {
  const Command add = parse_command("< add 1 0 123 8 11 22 33 44 55 66 77 88 >");
  EXPECT_EQ(add.verb, Verb::add);
  EXPECT_EQ(add.interval, 1s);
  EXPECT_EQ(add.frame,
            (Frame{0x123, false, false, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}}));
  EXPECT_EQ(parse_command("< add 0 20000 123 4 42 42 42 42 >").interval, 20ms);
  EXPECT_EQ(parse_command("< update 123 3 11 22 33 >").frame,
            (Frame{0x123, false, false, 3, {0x11, 0x22, 0x33}}));
  EXPECT_EQ(parse_command("< delete 123 >").verb, Verb::remove);
  EXPECT_EQ(parse_command("< send 123 0 >").frame, (Frame{0x123, false, false, 0, {}}));
  EXPECT_EQ(parse_command("< send 1AAAAAAA 2 1 f1 >").frame,
            (Frame{0x1AAAAAAA, true, false, 2, {0x01, 0xF1}}));
  const Command filter = parse_command("< filter 1 500000 123 8 FF 00 F8 00 00 00 00 00 >");
  EXPECT_EQ(filter.verb, Verb::filter);
  EXPECT_EQ(filter.interval, 1500ms);
  EXPECT_EQ(filter.masks, (std::vector<Mask>{{0xFF, 0, 0xF8, 0, 0, 0, 0, 0}}));
  const Command mux =
      parse_command("< muxfilter 0 0 123 2 FF 00 00 00 00 00 00 00 33 FF FF FF FF FF FF FF >");
  EXPECT_EQ(mux.verb, Verb::mux_filter);
  EXPECT_EQ(mux.masks.size(), 2U);
  EXPECT_EQ(mux.masks[1][0], 0x33);
  EXPECT_EQ(parse_command("< subscribe 0 0 123 >").verb, Verb::subscribe);
  EXPECT_EQ(parse_command("< unsubscribe 123 >").verb, Verb::unsubscribe);
  EXPECT_EQ(parse_command("< open can0 >").bus, "can0");
  EXPECT_EQ(parse_command("<open can0>").bus, "can0");
  EXPECT_EQ(parse_command("< statistics 1000 >").interval, 1s);
  for (const auto& [text, verb] :
       std::vector<std::pair<std::string, Verb>>{{"< rawmode >", Verb::raw_mode},
                                                 {"< bcmmode >", Verb::bcm_mode},
                                                 {"< controlmode >", Verb::control_mode},
                                                 {"< echo >", Verb::echo},
                                                 {"< isotpmode >", Verb::unknown},
                                                 {"< can0 B 250000 1 1 1 1 1 1 1 >", Verb::unknown},
                                                 {"< >", Verb::unknown}}) {
    EXPECT_EQ(parse_command(text).verb, verb) << text;
  }
}

TEST(SocketcandCommands, EightDigitsAreAnIdentifierOf29Bits) {
  EXPECT_TRUE(parse_command("< send 00000123 0 >").frame.extended);
  EXPECT_FALSE(parse_command("< send 123 0 >").frame.extended);
  EXPECT_FALSE(parse_command("< send 7FF 0 >").frame.extended);
  // python-can 4.1 writes 0CF00400 like this, and it has no other meaning.
  EXPECT_EQ(parse_command("< send CF00400 0 >").frame, (Frame{0x0CF00400, true, false, 0, {}}));
  EXPECT_EQ(parse_command("< send 40000123 2 0 0 >").frame, (Frame{0x123, true, true, 2, {}}));
}

// SavvyCAN prints a byte as Qt does a signed char: of 64 bits, or with a minus sign.
TEST(SocketcandCommands, BytesAreReadAsTheDaemonReadsThem) {
  for (const char* text : {"< send 123 3 1 2 80 >", "< send 123 3 1 2 ffffffffffffff80 >",
                           "< send 123 3 01 2 ffffff80 >", "< send 123 3 1 2 -80 >",
                           "< send 123 3 0x1 +2 0X80 >", "< send 123 3 1 102 80 >"}) {
    EXPECT_EQ(parse_command(text).frame, (Frame{0x123, false, false, 3, {0x01, 0x02, 0x80}}))
        << text;
  }
}

TEST(SocketcandCommands, WhatMakesNoSenseIsMalformed) {
  for (const std::string text : {"< send >",
                                 "< send 123 >",
                                 "< send 123 9 1 2 3 4 5 6 7 8 9 >",
                                 "< send 123 2 1 >",
                                 "< send 123 1 1 2 >",
                                 "< send 123 1 1g >",
                                 "< send 123 1 - >",
                                 "< send 123 1 1ffffffffffffff80 >",
                                 "< send 1234567890 0 >",
                                 "< send xyz 0 >",
                                 "< send 20000004 0 >",
                                 "< add 1 0 >",
                                 "< add 1 123 0 >",
                                 "< add -1 0 123 0 >",
                                 "< delete >",
                                 "< delete 1 2 >",
                                 "< subscribe 0 123 >",
                                 "< statistics >",
                                 "< statistics x >",
                                 "< muxfilter 0 0 123 1 FF 00 00 00 00 00 00 00 >",
                                 "< muxfilter 0 0 123 258 FF >",
                                 "< muxfilter 0 0 123 2 FF >",
                                 "< filter 0 0 123 2 FF >",
                                 "< open >"}) {
    EXPECT_EQ(parse_command(text).verb, Verb::malformed) << text;
  }
}

std::vector<std::string> elements(const std::string& stream) {
  ElementSplitter splitter;
  std::vector<std::string> found;
  for (const char byte : stream) {
    if (const auto element = splitter.push(byte)) {
      found.emplace_back(*element);
    }
  }
  return found;
}

TEST(SocketcandElements, AreTakenOutOfAStreamWhereverItIsCut) {
  EXPECT_EQ(elements("noise < open can0 >\n< rawmode >< ec"),
            (std::vector<std::string>{"< open can0 >", "< rawmode >"}));
}

TEST(SocketcandElements, OnesThatNeverEndAreNotKept) {
  ElementSplitter splitter;
  EXPECT_FALSE(splitter.push('<'));
  for (std::size_t i = 0; i < kLongestElement; ++i) {
    EXPECT_FALSE(splitter.push('x'));
  }
  EXPECT_TRUE(splitter.overflowed());
}

TEST(SocketcandElements, FramesLookAsTheDaemonsDo) {
  const Frame frame{0x123, false, false, 4, {0x1A, 0x22, 0x03, 0x44}};
  EXPECT_EQ(frame_element(frame, 23'424'242us, DataStyle::together),
            "< frame 123 23.424242 1A220344 >");
  EXPECT_EQ(frame_element(frame, 23'424'242us, DataStyle::apart),
            "< frame 123 23.424242 1A 22 03 44  >");
  EXPECT_EQ(frame_element({0xCF00400, true, false, 0, {}}, 1'000'001us, DataStyle::together),
            "< frame 0CF00400 1.000001  >");
  EXPECT_EQ(error_element(0x4, 2s), "< error 004 2.000000 >");
  EXPECT_EQ(statistics_element({80, 10, 16, 2}), "< stat 80 10 16 2 >");
}

TEST(SocketcandBeacon, NamesServerAndBuses) {
  EXPECT_EQ(beacon("pit & \"co\"", "rigwire", "127.0.0.1", 29536, {"can", "vcan0"}),
            "<CANBeacon name=\"pit &amp; &quot;co&quot;\" type=\"SocketCAN\" "
            "description=\"rigwire\">\n<URL>can://127.0.0.1:29536</URL><Bus name=\"can\"/>"
            "<Bus name=\"vcan0\"/></CANBeacon>");
}

}  // namespace
}  // namespace rigwire::protocols::socketcand
