#include "protocols/can/bits.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace rigwire::protocols::can {
namespace {

Frame frame(std::uint32_t id, bool extended, std::initializer_list<std::uint8_t> data) {
  Frame result{id, extended, false, static_cast<std::uint8_t>(data.size()), {}};
  std::copy(data.begin(), data.end(), result.data.begin());
  return result;
}

struct Golden {
  Frame frame;
  unsigned unstuffed;
  unsigned exact;
  unsigned worst;
};

// Lengths computed by an independent tool (canframelen of can-utils).
const std::vector<Golden>& goldens() {
  static const std::vector<Golden> list = {
      {frame(0x0CF02980, true, {0x00, 0x00, 0x7D, 0x00, 0x00, 0x7D, 0xCC, 0x00}), 131, 144, 160},
      {frame(0x0CF02A80, true, {0x00, 0x7D, 0x00, 0x7D, 0x00, 0x7D, 0x3F, 0x00}), 131, 143, 160},
      {frame(0x08F02D80, true, {0x00, 0x7D, 0x00, 0x7D, 0xD5, 0x80, 0xBF, 0x00}), 131, 141, 160},
      {frame(0x18FEBF0B, true, {0x00, 0x12, 0x7D, 0x7D, 0x7D, 0x7D, 0x7D, 0x7D}), 131, 141, 160},
      {frame(0x0CF00400, true, {0xFF, 0xFF, 0xFF, 0x40, 0x38, 0xFF, 0xFF, 0xFF}), 131, 145, 160},
      {frame(0x18EAFFFE, true, {0x00, 0xEE, 0x00}), 91, 98, 110},
      {frame(0x034, false, {0x00, 0x00, 0x00, 0x00, 0x09, 0xCF}), 95, 105, 115},
      {frame(0x123, false, {}), 47, 48, 55},
      {frame(0x00000000, true, {0, 0, 0, 0, 0, 0, 0, 0}), 131, 150, 160},
      {frame(0x000, false, {0, 0, 0, 0, 0, 0, 0, 0}), 111, 127, 135},
  };
  return list;
}

TEST(FrameBits, EqualCanframelenOfCanUtils) {
  for (const Golden& golden : goldens()) {
    SCOPED_TRACE(testing::Message() << std::hex << golden.frame.id);
    EXPECT_EQ(unstuffed_bits(golden.frame), golden.unstuffed);
    EXPECT_EQ(exact_bits(golden.frame), golden.exact);
    EXPECT_EQ(worst_case_bits(golden.frame), golden.worst);
  }
}

TEST(FrameBits, LieBetweenUnstuffedAndWorstForEveryLength) {
  for (std::uint8_t length = 0; length <= 8; ++length) {
    for (unsigned pattern = 0; pattern < 256; ++pattern) {
      Frame any{0x15555555, (pattern & 1U) != 0, false, length, {}};
      any.id = any.extended ? any.id : any.id & 0x7FFU;
      any.data.fill(static_cast<std::uint8_t>(pattern));
      EXPECT_GE(exact_bits(any), unstuffed_bits(any));
      EXPECT_LE(exact_bits(any), worst_case_bits(any));
    }
  }
}

TEST(FrameBits, RemoteFrameCarriesNoData) {
  Frame remote{0x123, false, true, 8, {}};
  EXPECT_EQ(unstuffed_bits(remote), 47U);
}

TEST(Arbitration, FollowsTheWireNotTheNumber) {
  // Base identifier 0x100 with 29 bits is numerically far above 0x101, and still wins against it.
  const Frame extended = frame(0x100U << 18U, true, {});
  const Frame base_after = frame(0x101, false, {});
  EXPECT_LT(arbitration_field(extended), arbitration_field(base_after));
}

TEST(Arbitration, AmongOneBaseIdentifierDataBeatsRemoteBeatsExtended) {
  const Frame data = frame(0x100, false, {});
  Frame remote = data;
  remote.remote = true;
  const Frame extended = frame(0x100U << 18U, true, {});
  Frame extended_remote = extended;
  extended_remote.remote = true;
  EXPECT_LT(arbitration_field(data), arbitration_field(remote));
  EXPECT_LT(arbitration_field(remote), arbitration_field(extended));
  EXPECT_LT(arbitration_field(extended), arbitration_field(extended_remote));
}

}  // namespace
}  // namespace rigwire::protocols::can
