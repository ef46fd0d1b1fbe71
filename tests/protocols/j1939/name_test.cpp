#include "protocols/j1939/name.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::j1939 {
namespace {

TEST(Name, OpenImuWithSerial12345) {
  Name name;
  name.identity = 0x12345;
  name.manufacturer = 823;
  name.function = 131;
  name.arbitrary_address = true;
  EXPECT_EQ(pack(name), 0x8000'8300'66E1'2345ULL);  // on the wire 45 23 E1 66 00 83 00 80
}

TEST(Name, EachPartHasItsOwnBits) {
  const Name every{0x1FFFFF, 0x7FF, 7, 31, 255, 127, 15, 7, true};
  EXPECT_EQ(pack(every), ~(1ULL << 48U));
  EXPECT_EQ(unpack_name(pack(every)), every);
  for (unsigned bit = 0; bit < 64; ++bit) {
    const std::uint64_t one = bit == 48 ? 0 : 1ULL << bit;
    EXPECT_EQ(pack(unpack_name(one)), one) << bit;
  }
}

}  // namespace
}  // namespace rigwire::protocols::j1939
