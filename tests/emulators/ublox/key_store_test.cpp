#include "emulators/ublox/key_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/settings.h"
#include "protocols/ubx/key_values.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kRam = kLayerMaskRam;
constexpr std::uint8_t kBattery = kLayerMaskBattery;
constexpr std::uint8_t kFlash = kLayerMaskFlash;

std::uint32_t id(std::string_view name) {
  const std::size_t index = key_index(name);
  EXPECT_LT(index, configuration_keys().size()) << name;
  return configuration_keys()[index].id;
}

struct Item {
  std::string_view name;
  std::uint64_t value;
};

class KeyStore : public testing::Test {
 protected:
  static UbloxSettings f9p() {
    UbloxSettings settings;
    settings.profile = &ublox_zed_f9p();
    settings.baud = 38'400;
    return settings;
  }
  bool valset(std::uint8_t layers, std::initializer_list<Item> items,
              std::optional<Transaction> step = std::nullopt) {
    return set(kCfgValset, layers, step, [&](KeyListWriter& writer) {
      for (const Item& item : items) {
        ASSERT_TRUE(writer.value({id(item.name), item.value}));
      }
    });
  }
  bool valdel(std::uint8_t layers, std::initializer_list<std::uint32_t> keys,
              std::optional<Transaction> step = std::nullopt) {
    return set(kCfgValdel, layers, step, [&](KeyListWriter& writer) {
      for (const std::uint32_t key : keys) {
        ASSERT_TRUE(writer.key(key));
      }
    });
  }
  template <class Fill>
  bool set(MessageId message, std::uint8_t layers, std::optional<Transaction> step, Fill fill) {
    std::array<std::uint8_t, kLongestKeyList> room{};
    KeyListWriter writer(room);
    writer.head(step ? 1 : 0, layers, static_cast<std::uint16_t>(step.value_or(Transaction::none)));
    fill(writer);
    return configuration_.set({message, writer.payload()});
  }
  /// The pairs of the answer; nothing when it is refused.
  std::optional<std::vector<KeyValue>> valget(std::uint8_t layer,
                                              std::initializer_list<std::uint32_t> keys,
                                              std::uint16_t position = 0) {
    std::array<std::uint8_t, kLongestKeyList> room{};
    KeyListWriter writer(room);
    writer.head(0, layer, position);
    for (const std::uint32_t key : keys) {
      writer.key(key);
    }
    const auto reply = configuration_.poll({kCfgValget, writer.payload()});
    if (!reply) {
      return std::nullopt;
    }
    const auto answer = decode_valget_reply({kCfgValget, *reply});
    EXPECT_TRUE(answer.ok());
    EXPECT_EQ(answer->layer, layer);
    EXPECT_EQ(answer->position, position);
    std::vector<KeyValue> pairs;
    KeyValueReader reader(answer->list);
    while (const auto pair = reader.next()) {
      pairs.push_back(*pair);
    }
    return pairs;
  }
  std::uint64_t in_ram(std::string_view name) {
    const auto pairs = valget(kLayerRam, {id(name)});
    return pairs && pairs->size() == 1 ? pairs->front().value : ~std::uint64_t{0};
  }

  UbloxConfiguration configuration_{f9p()};
};

TEST_F(KeyStore, RamBeginsWithTheDocumentedDefaults) {
  for (const ConfigurationKey& key : configuration_keys()) {
    const auto pairs = valget(kLayerRam, {key.id});
    ASSERT_TRUE(pairs && pairs->size() == 1) << key.name;
    EXPECT_EQ(pairs->front().value, key.initial) << key.name;
  }
}

// A ZED-F9P (HPG 1.32, u-center's log of a VALGET of everything in 24 pages) begins with the
// flags of all groups and ends with the items of eight bytes.
TEST_F(KeyStore, WildcardsListByTheWholeKeySizeFirst) {
  std::vector<std::uint32_t> listed;
  for (std::uint16_t position = 0;; position = static_cast<std::uint16_t>(position + 64)) {
    const auto page = valget(kLayerRam, {0x0FFF0000}, position);
    ASSERT_TRUE(page);
    for (const KeyValue& pair : *page) {
      listed.push_back(pair.key);
    }
    if (page->size() < 64) {
      break;
    }
  }
  EXPECT_EQ(listed.size(), configuration_keys().size());
  EXPECT_TRUE(std::ranges::is_sorted(listed));
  EXPECT_EQ(listed.front() >> 28U, 1U);
  EXPECT_EQ(listed.back() >> 28U, 5U);
  // Within a group, too: CFG-NAVSPG has flags, bytes, words and doubles.
  const auto group = valget(kLayerRam, {0x0011FFFF});
  ASSERT_TRUE(group);
  EXPECT_TRUE(std::ranges::is_sorted(*group, {}, &KeyValue::key));
  EXPECT_EQ(group->front().key >> 28U, 1U);
  EXPECT_GE(group->back().key >> 28U, 4U);
}

TEST_F(KeyStore, EachItemIsReadBackAsItWasSetInWhateverMessageItLives) {
  for (const ConfigurationKey& key : configuration_keys()) {
    for (const std::uint64_t value : {std::uint64_t{1}, std::uint64_t{2}, key.initial}) {
      if (!is_allowed(key, value)) {
        continue;
      }
      if (valset(kRam, {{key.name, value}})) {
        EXPECT_EQ(in_ram(key.name), value) << key.name;
      }
    }
    EXPECT_EQ(in_ram(key.name), key.initial) << key.name;
  }
}

TEST_F(KeyStore, ItemsAndOlderMessagesAreTwoViewsOfOneConfiguration) {
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-RATE-TIMEREF", 0}}));
  EXPECT_EQ(configuration_.rate(), (CfgRate{200, 1, 0}));
  Bytes payload(CfgRate::kLength);
  write_payload(CfgRate{100, 2, 1}, payload);
  ASSERT_TRUE(configuration_.set({CfgRate::kId, payload}));
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 100U);
  EXPECT_EQ(in_ram("CFG-RATE-NAV"), 2U);

  const std::array<std::uint8_t, 3> rate{0x01, 0x07, 5};
  ASSERT_TRUE(configuration_.set({CfgMsg::kId, rate}));
  EXPECT_EQ(in_ram("CFG-MSGOUT-UBX_NAV_PVT_UART1"), 5U);
  EXPECT_EQ(in_ram("CFG-MSGOUT-UBX_NAV_PVT_USB"), 0U);

  ASSERT_TRUE(valset(kRam, {{"CFG-UART1OUTPROT-NMEA", 0}, {"CFG-NMEA-HIGHPREC", 1}}));
  EXPECT_EQ(configuration_.uart().output_protocols, 0x0021);
  EXPECT_EQ(configuration_.nmea().flags, 0x0A);
}

TEST_F(KeyStore, OneBadItemRefusesTheWholeList) {
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-NAVSPG-DYNMODEL", 1}})) << "a hole";
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-UART1-BAUDRATE", 12345}}));
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-UART1-PARITY", 1}}));
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-MEAS", 24}}));
  EXPECT_FALSE(valset(0, {{"CFG-RATE-MEAS", 200}})) << "no layer";
  const Bytes unknown{0, kRam, 0, 0, 0x01, 0x00, 0x21, 0x30, 200, 0, 0xFE, 0xFF, 0x21, 0x30, 1, 0};
  EXPECT_FALSE(configuration_.set({kCfgValset, unknown}));
  const Bytes wrong_size{0, kRam, 0, 0, 0x01, 0x00, 0x21, 0x20, 200};
  EXPECT_FALSE(configuration_.set({kCfgValset, wrong_size}));
  EXPECT_EQ(configuration_.rate().measurement_period_ms, 1000);
}

TEST_F(KeyStore, WhatCannotBeHonouredTogetherIsRefused) {
  EXPECT_FALSE(valset(kRam, {{"CFG-SIGNAL-GPS_ENA", 0},
                             {"CFG-SIGNAL-GAL_ENA", 0},
                             {"CFG-SIGNAL-BDS_ENA", 0},
                             {"CFG-SIGNAL-GLO_ENA", 0}}))
      << "no system is left";
  EXPECT_FALSE(valset(kRam, {{"CFG-NMEA-HIGHPREC", 1}, {"CFG-NMEA-COMPAT", 1}}));
  EXPECT_FALSE(valset(kRam, {{"CFG-UART1-ENABLED", 0}})) << "the only line there is";
}

TEST_F(KeyStore, LastValueOfARepeatedItemCounts) {
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-RATE-MEAS", 500}}));
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 500U);
}

TEST_F(KeyStore, SavedItemsComeIntoForceAtResetWithBatteryAboveFlash) {
  ASSERT_TRUE(valset(kFlash, {{"CFG-RATE-MEAS", 500}, {"CFG-NAVSPG-DYNMODEL", 4}}));
  ASSERT_TRUE(valset(kBattery, {{"CFG-RATE-MEAS", 250}}));
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 1000U) << "not before a reset";
  EXPECT_EQ(valget(kLayerFlash, {id("CFG-RATE-MEAS")})->front().value, 500U);
  EXPECT_EQ(valget(kLayerDefault, {id("CFG-RATE-MEAS")})->front().value, 1000U);
  EXPECT_FALSE(valget(kLayerBattery, {id("CFG-NAVSPG-DYNMODEL")})) << "nothing there";

  configuration_.reload();
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 250U);
  EXPECT_EQ(in_ram("CFG-NAVSPG-DYNMODEL"), 4U);

  configuration_.forget();  // the battery is gone, flash is not
  configuration_.reload();
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 500U);
}

TEST_F(KeyStore, DeletingSavedItemsRevertsThemAtTheNextReset) {
  ASSERT_TRUE(valset(kRam | kBattery | kFlash,
                     {{"CFG-RATE-MEAS", 200}, {"CFG-RATE-NAV", 2}, {"CFG-NAVSPG-DYNMODEL", 4}}));
  EXPECT_FALSE(valdel(kRam, {id("CFG-RATE-MEAS")})) << "RAM cannot be deleted from";
  ASSERT_TRUE(valdel(kBattery | kFlash, {0x3021FFFF})) << "the group";
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 200U);
  configuration_.reload();
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 1000U);
  EXPECT_EQ(in_ram("CFG-RATE-NAV"), 1U);
  EXPECT_EQ(in_ram("CFG-NAVSPG-DYNMODEL"), 4U);
  ASSERT_TRUE(valdel(kBattery | kFlash, {0x0FFF0000})) << "everything";
  configuration_.reload();
  EXPECT_EQ(in_ram("CFG-NAVSPG-DYNMODEL"), 0U);
}

TEST_F(KeyStore, TransactionAppliesAllAtOnce) {
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}}, Transaction::start));
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-NAV", 5}}, Transaction::ongoing));
  EXPECT_EQ(configuration_.rate(), (CfgRate{1000, 1, 1}));
  ASSERT_TRUE(valset(kRam, {}, Transaction::apply));
  EXPECT_EQ(configuration_.rate(), (CfgRate{200, 5, 1}));
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply)) << "it is over";
}

TEST_F(KeyStore, TransactionIsDroppedByAWrongStep) {
  const auto begin = [&] {
    ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}}, Transaction::start));
  };
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-NAV", 5}}, Transaction::ongoing)) << "none is open";
  begin();
  EXPECT_FALSE(valset(kBattery, {{"CFG-RATE-NAV", 5}}, Transaction::ongoing)) << "other layers";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  begin();
  EXPECT_FALSE(valset(kRam, {}, Transaction::ongoing)) << "nothing to add";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  begin();
  EXPECT_FALSE(valset(kRam, {{"CFG-RATE-NAV", 0}}, Transaction::ongoing)) << "out of range";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  begin();
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 1000U) << "another message cancels it";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  begin();
  EXPECT_TRUE(configuration_.poll({CfgRate::kId, {}})) << "an older one, too";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  begin();
  EXPECT_FALSE(valdel(kFlash, {id("CFG-RATE-NAV")}, Transaction::apply)) << "not to be mixed";
  EXPECT_FALSE(valset(kRam, {}, Transaction::apply));
  EXPECT_EQ(configuration_.rate(), (CfgRate{1000, 1, 1}));
}

TEST_F(KeyStore, RestartedTransactionForgetsWhatWaited) {
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}}, Transaction::start));
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-NAV", 5}}, Transaction::start));
  ASSERT_TRUE(valset(kRam, {}, Transaction::apply));
  EXPECT_EQ(configuration_.rate(), (CfgRate{1000, 5, 1}));
}

TEST_F(KeyStore, WildcardsArePagedAndEveryItemComesOnce) {
  const std::size_t all = configuration_keys().size();
  std::vector<KeyValue> collected;
  for (std::uint16_t position = 0;; position += kMaximumConfigurationItems) {
    const auto page = valget(kLayerDefault, {0x0FFF0000}, position);
    ASSERT_TRUE(page);
    collected.insert(collected.end(), page->begin(), page->end());
    if (page->size() < kMaximumConfigurationItems) {
      break;
    }
  }
  ASSERT_EQ(collected.size(), all);
  for (std::size_t i = 0; i < all; ++i) {
    EXPECT_EQ(collected[i].key, configuration_keys()[i].id);
  }
  EXPECT_EQ(valget(kLayerRam, {0x3021FFFF})->size(), 3U);
  EXPECT_EQ(valget(kLayerRam, {0x3021FFFF}, 2)->size(), 1U);
  EXPECT_EQ(valget(kLayerRam, {id("CFG-RATE-NAV"), id("CFG-RATE-NAV")})->size(), 2U);
}

TEST_F(KeyStore, QueriesForUnknownItemsAndLayersAreRefused) {
  EXPECT_FALSE(valget(kLayerRam, {0x3FFE0001}));
  EXPECT_FALSE(valget(kLayerRam, {id("CFG-RATE-MEAS"), 0x10210001}));
  EXPECT_FALSE(valget(3, {id("CFG-RATE-MEAS")}));
  EXPECT_FALSE(valget(kLayerFlash, {0x0FFF0000})) << "nothing saved";
}

TEST_F(KeyStore, SavingByTheOlderMessageFillsTheLayers) {
  const auto store = [&](std::uint32_t clear, std::uint32_t save, std::uint32_t load) {
    Bytes payload(CfgCfg::kLength);
    write_payload(CfgCfg{clear, save, load}, payload);
    return configuration_.set({CfgCfg::kId, payload});
  };
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 200}, {"CFG-TMODE-MODE", 1}}));
  ASSERT_TRUE(store(0, 1, 0)) << "any bit saves everything";
  ASSERT_TRUE(valset(kRam, {{"CFG-RATE-MEAS", 500}}));
  ASSERT_TRUE(store(0, 0, 2));
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 200U);
  EXPECT_EQ(in_ram("CFG-TMODE-MODE"), 1U);
  ASSERT_TRUE(store(4, 0, 4));
  EXPECT_EQ(in_ram("CFG-RATE-MEAS"), 1000U);
  EXPECT_EQ(in_ram("CFG-TMODE-MODE"), 0U);
}

TEST_F(KeyStore, OlderReceiversDoNotKnowTheseMessages) {
  for (const UbloxProfile* profile : {&ublox_neo_7p(), &ublox_neo_m8()}) {
    UbloxSettings settings;
    settings.profile = profile;
    UbloxConfiguration old(settings);
    const Bytes set{0, kRam, 0, 0, 0x01, 0x00, 0x21, 0x30, 200, 0};
    EXPECT_FALSE(old.set({kCfgValset, set})) << profile->name;
    const Bytes get{0, 0, 0, 0, 0x01, 0x00, 0x21, 0x30};
    const FrameView query{kCfgValget, get};
    EXPECT_FALSE(old.is_poll(query) ? old.poll(query).has_value() : old.set(query))
        << profile->name;
  }
}

}  // namespace
}  // namespace rigwire::emulators
