#include "protocols/ubx/key_values.h"
#include "protocols/ubx/configuration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <set>
#include <string>
#include <vector>

namespace rigwire::protocols::ubx {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kRateMeas = 0x30210001;
constexpr std::uint32_t kUart1Baudrate = 0x40520001;

FrameView frame(MessageId id, const Bytes& payload) {
  return {id, payload};
}
const ConfigurationKey& key(std::string_view name) {
  const std::size_t index = key_index(name);
  EXPECT_LT(index, configuration_keys().size()) << name;
  return configuration_keys()[index];
}

// PX4's and ArduPilot's sources give these numbers, too.
TEST(ConfigurationKeys, NumbersThatClientsWriteAreThoseOfTheTable) {
  EXPECT_EQ(key("CFG-RATE-MEAS").id, kRateMeas);
  EXPECT_EQ(key("CFG-RATE-NAV").id, 0x30210002U);
  EXPECT_EQ(key("CFG-UART1-BAUDRATE").id, kUart1Baudrate);
  EXPECT_EQ(key("CFG-UART1INPROT-RTCM3X").id, 0x10730004U);
  EXPECT_EQ(key("CFG-MSGOUT-UBX_NAV_PVT_UART1").id, 0x20910007U);
  EXPECT_EQ(key("CFG-MSGOUT-UBX_NAV_PVT_USB").id, 0x20910009U);
  EXPECT_EQ(key("CFG-MSGOUT-UBX_RXM_RAWX_UART1").id, 0x209102A5U);
  EXPECT_EQ(key("CFG-MSGOUT-RTCM_3X_TYPE1005_UART1").id, 0x209102BEU);
  EXPECT_EQ(key("CFG-NAVSPG-DYNMODEL").id, 0x20110021U);
  EXPECT_EQ(key("CFG-NAVHPG-DGNSSMODE").id, 0x20140011U);
  EXPECT_EQ(key("CFG-SIGNAL-GPS_ENA").id, 0x1031001FU);
  EXPECT_EQ(key("CFG-TMODE-MODE").id, 0x20030001U);
  EXPECT_EQ(key("CFG-MSGOUT-UBX_NAV_PVT_I2C").id, 0x20910006U);
}

TEST(ConfigurationKeys, EachKeyIsFoundByNumberAndNameAndItsSizeFitsItsType) {
  std::set<std::uint32_t> ids;
  std::set<std::string_view> names;
  const auto keys = configuration_keys();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_TRUE(ids.insert(keys[i].id).second) << keys[i].name;
    EXPECT_TRUE(names.insert(keys[i].name).second) << keys[i].name;
    EXPECT_EQ(key_index(keys[i].id), i);
    EXPECT_EQ(key_index(keys[i].name), i);
    std::size_t bytes = 0;
    switch (keys[i].type) {
      case KeyType::l:
      case KeyType::u1:
      case KeyType::x1:
      case KeyType::e1:
      case KeyType::i1:
        bytes = 1;
        break;
      case KeyType::u2:
      case KeyType::x2:
      case KeyType::i2:
        bytes = 2;
        break;
      case KeyType::u4:
      case KeyType::i4:
      case KeyType::r4:
        bytes = 4;
        break;
      case KeyType::x8:
      case KeyType::r8:
        bytes = 8;
        break;
    }
    EXPECT_EQ(value_bytes(keys[i].id), bytes) << keys[i].name;
    EXPECT_EQ(keys[i].id >> 28U == 1, keys[i].type == KeyType::l) << keys[i].name;
    EXPECT_TRUE(is_allowed(keys[i], keys[i].initial)) << keys[i].name;
  }
}

TEST(ConfigurationKeys, LimitsHoldForSignedNumbersEnumerationsAndFloatingPoint) {
  EXPECT_FALSE(is_allowed(key("CFG-RATE-MEAS"), 24));
  EXPECT_TRUE(is_allowed(key("CFG-RATE-MEAS"), 25));
  EXPECT_FALSE(is_allowed(key("CFG-NAVSPG-DYNMODEL"), 1)) << "a hole of the enumeration";
  EXPECT_TRUE(is_allowed(key("CFG-NAVSPG-DYNMODEL"), 8));
  EXPECT_FALSE(is_allowed(key("CFG-NAVSPG-DYNMODEL"), 200));
  EXPECT_TRUE(is_allowed(key("CFG-NAVSPG-INFIL_MINELEV"), 0xA6)) << "-90 degrees";
  EXPECT_FALSE(is_allowed(key("CFG-NAVSPG-INFIL_MINELEV"), 0xA5));
  EXPECT_FALSE(is_allowed(key("CFG-UART1INPROT-UBX"), 2));
  EXPECT_FALSE(is_allowed(key("CFG-NAVSPG-USRDAT_DX"), 0x7FC00000)) << "not a number";
  EXPECT_TRUE(is_allowed(key("CFG-SBAS-PRNSCANMASK"), ~std::uint64_t{0}));
}

TEST(ConfigurationKeys, WildcardsNameAGroupOrEverything) {
  const auto named = [](std::uint32_t wanted) {
    return static_cast<std::size_t>(std::ranges::count_if(
        configuration_keys(),
        [wanted](const ConfigurationKey& key) { return names(wanted, key.id); }));
  };
  EXPECT_EQ(named(0x3021FFFF), 3U);
  EXPECT_EQ(named(0x0FFF0000), configuration_keys().size());
  EXPECT_EQ(named(0x0FFFFFFF), configuration_keys().size());
  EXPECT_EQ(named(0x3FFE0001), 0U);
  EXPECT_EQ(named(0x10210001), 0U) << "CFG-RATE-MEAS with another size";
  EXPECT_EQ(named(0x30210001), 1U);
}

TEST(KeyValues, ValsetByHandDecodes) {
  const Bytes payload{0x00, 0x07, 0x00, 0x00,              // version, RAM + BBR + flash
                      0x01, 0x00, 0x21, 0x30, 0xC8, 0x00,  // CFG-RATE-MEAS 200
                      0x01, 0x00, 0x52, 0x40, 0x00, 0xC2, 0x01, 0x00};  // 115200
  const auto change = decode_valset(frame(kCfgValset, payload));
  ASSERT_TRUE(change.ok());
  EXPECT_EQ(change->layers, kLayerMaskRam | kLayerMaskBattery | kLayerMaskFlash);
  EXPECT_EQ(change->count, 2U);
  KeyValueReader reader(change->list);
  EXPECT_EQ(reader.next(), (KeyValue{kRateMeas, 200}));
  EXPECT_EQ(reader.next(), (KeyValue{kUart1Baudrate, 115200}));
  EXPECT_EQ(reader.next(), std::nullopt);
  EXPECT_TRUE(reader.finished());
}

TEST(KeyValues, EveryTruncationIsMalformedOrAShorterList) {
  const Bytes whole{0x00, 0x01, 0x00, 0x00, 0x01, 0x00, 0x21, 0x30, 0xC8,
                    0x00, 0x01, 0x00, 0x52, 0x40, 0x00, 0xC2, 0x01, 0x00};
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto change = decode_valset(frame(kCfgValset, part));
    EXPECT_EQ(change.ok(), size == 4 || size == 10) << size;
  }
}

TEST(KeyValues, VersionsSizesAndCountsBeyondTheDocumentAreRefused) {
  EXPECT_TRUE(decode_valset(frame(kCfgValset, {2, 1, 0, 0})).malformed());
  EXPECT_TRUE(decode_valget(frame(kCfgValget, {1, 0, 0, 0})).malformed());
  EXPECT_TRUE(decode_valdel(frame(kCfgValset, {0, 2, 0, 0})).malformed()) << "another message";
  EXPECT_TRUE(decode_valset(frame(kCfgValset, {0, 1, 0, 0, 1, 0, 0x21, 0x00, 1})).malformed())
      << "a key of no size";
  Bytes keys{0, 0, 0, 0};
  for (std::size_t i = 0; i < kMaximumConfigurationItems; ++i) {
    keys.insert(keys.end(), {0x01, 0x00, 0x21, 0x30});
  }
  EXPECT_TRUE(decode_valget(frame(kCfgValget, keys)).ok());
  keys.insert(keys.end(), {0x01, 0x00, 0x21, 0x30});
  EXPECT_TRUE(decode_valget(frame(kCfgValget, keys)).malformed());
}

TEST(KeyValues, WriterAndReaderAgreeOnEveryKeyAtItsExtremes) {
  for (const ConfigurationKey& item : configuration_keys()) {
    const std::size_t bytes = value_bytes(item.id);
    const std::uint64_t ones = bytes == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * bytes) - 1;
    for (const std::uint64_t value : {std::uint64_t{0}, item.initial, ones}) {
      std::array<std::uint8_t, kLongestKeyList> room{};
      KeyListWriter writer(room);
      ASSERT_TRUE(writer.head(1, 0, 0));
      ASSERT_TRUE(writer.value({item.id, value}));
      const auto answer = decode_valget_reply({kCfgValget, writer.payload()});
      ASSERT_TRUE(answer.ok());
      KeyValueReader reader(answer->list);
      EXPECT_EQ(reader.next(), (KeyValue{item.id, value})) << item.name;
    }
  }
}

TEST(KeyValues, WriterRefusesWhatDoesNotFitAndKeepsTheRest) {
  std::array<std::uint8_t, kKeyListHeadBytes + 5> room{};
  KeyListWriter writer(room);
  ASSERT_TRUE(writer.head(0, 1, 0));
  EXPECT_FALSE(writer.value({kRateMeas, 1000})) << "six bytes into five";
  EXPECT_EQ(writer.payload().size(), kKeyListHeadBytes);
  EXPECT_TRUE(writer.key(kRateMeas));
  EXPECT_FALSE(writer.key(kRateMeas));
}

}  // namespace
}  // namespace rigwire::protocols::ubx
