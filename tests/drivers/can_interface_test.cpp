#include "drivers/can_interface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace rigwire::drivers {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

// Messages put together by hand from rtnetlink(7), in this machine's (little-endian) order.
void put(Bytes& out, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}
void append(Bytes& out, const Bytes& more) {
  out.insert(out.end(), more.begin(), more.end());
}
Bytes attribute(unsigned type, const Bytes& content) {
  Bytes out;
  put(out, static_cast<std::uint32_t>(4 + content.size()), 2);
  put(out, type, 2);
  append(out, content);
  out.resize((out.size() + 3) / 4 * 4);
  return out;
}
Bytes text(std::string_view value) {
  Bytes out(value.begin(), value.end());
  out.push_back(0);
  return out;
}
Bytes link(unsigned hardware, std::uint32_t index, std::uint32_t flags, const Bytes& attributes) {
  Bytes body;
  put(body, 0, 2);  // family, padding
  put(body, hardware, 2);
  put(body, index, 4);
  put(body, flags, 4);
  put(body, 0, 4);  // change mask
  append(body, attributes);
  Bytes message;
  put(message, static_cast<std::uint32_t>(16 + body.size()), 4);
  put(message, 16, 2);  // RTM_NEWLINK
  put(message, 2, 2);   // one of several
  put(message, 1, 4);
  put(message, 77, 4);
  append(message, body);
  return message;
}

constexpr unsigned kName = 3;
constexpr unsigned kLinkInformation = 18;
constexpr unsigned kKind = 1;
constexpr unsigned kData = 2;
constexpr unsigned kNested = 0x8000;
constexpr unsigned kCan = 280;
constexpr unsigned kEthernet = 1;

Bytes controller(std::uint32_t bit_rate_bps) {
  Bytes timing;
  put(timing, bit_rate_bps, 4);
  timing.resize(32);
  Bytes information = attribute(kKind, text("can"));
  append(information, attribute(kData | kNested, attribute(1, timing)));
  return attribute(kLinkInformation | kNested, information);
}

Bytes everything() {
  Bytes answer = link(kEthernet, 1, 1, attribute(kName, text("eth0")));
  Bytes virtual_link = attribute(kName, text("vcan0"));
  append(virtual_link, attribute(kLinkInformation, attribute(kKind, text("vcan"))));
  append(answer, link(kCan, 2, 0xC1, virtual_link));
  Bytes real_link = attribute(kName, text("can0"));
  append(real_link, controller(250'000));
  append(answer, link(kCan, 3, 0, real_link));
  Bytes unknown = attribute(kName, text("slcan0"));
  append(unknown, controller(0xFFFF'FFFF));
  append(answer, link(kCan, 4, 1, unknown));
  return answer;
}

TEST(CanInterfaces, KindStateAndBitRateOutOfADump) {
  EXPECT_THAT(parse_links(everything()), ElementsAre(CanInterface{"vcan0", 2, true, "vcan", 0},
                                                     CanInterface{"can0", 3, false, "can", 250'000},
                                                     CanInterface{"slcan0", 4, true, "can", 0}));
}

TEST(CanInterfaces, AnswersCutShortAnywhereAreReadAsFarAsTheyGo) {
  const Bytes whole = everything();
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    EXPECT_LE(parse_links(std::span(whole).first(size)).size(), 3U);
  }
  Bytes broken = whole;
  for (std::size_t i = 0; i < broken.size(); ++i) {
    broken[i] = 0xFF;
    EXPECT_LE(parse_links(broken).size(), 3U);
    broken[i] = whole[i];
  }
}

TEST(CanInterfaces, OnlyVirtualKindsAreVirtual) {
  EXPECT_TRUE((CanInterface{"vcan0", 2, true, "vcan", 0}).is_virtual());
  EXPECT_TRUE((CanInterface{"vxcan1", 2, true, "vxcan", 0}).is_virtual());
  EXPECT_FALSE((CanInterface{"can0", 3, true, "can", 250'000}).is_virtual());
}

TEST(CanInterfaces, LoopbackIsNone) {
  EXPECT_FALSE(find_can_interface("lo"));
}

}  // namespace
}  // namespace rigwire::drivers
