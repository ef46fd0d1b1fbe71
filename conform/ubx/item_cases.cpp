// Configuration items: CFG-VALGET, VALSET and VALDEL, UBXDOC-963802114-12815, sections 3.10.23 to
// 3.10.25, and "Configuration interface".
#include <algorithm>
#include <array>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

using T = UbxTrial;

constexpr UbxId kGet{0x06, 0x8B};
constexpr UbxId kSet{0x06, 0x8A};
constexpr UbxId kDelete{0x06, 0x8C};
constexpr std::uint32_t kPeriod = 0x3021'0001;     // CFG-RATE-MEAS, U2, ms
constexpr std::uint32_t kRatio = 0x3021'0002;      // CFG-RATE-NAV, U2
constexpr std::uint32_t kReference = 0x2021'0003;  // CFG-RATE-TIMEREF, E1
constexpr std::uint32_t kElevation = 0x2011'00A4;  // CFG-NAVSPG-INFIL_MINELEV, I1
constexpr std::uint32_t kUnknown = 0x3021'0FFE;    // Group RATE, not assigned.
constexpr std::uint8_t kRam = 0;
constexpr std::uint8_t kDefaults = 7;
constexpr std::uint8_t kToRam = 1;

UbxBytes request(std::uint8_t layer, unsigned position, const std::vector<std::uint32_t>& keys) {
  UbxBytes bytes{0, layer};
  bytes = bytes + u2(position);
  for (const std::uint32_t key : keys) {
    bytes = bytes + u4(key);
  }
  return bytes;
}

UbxBytes setting(std::uint8_t layers, const UbxBytes& items, std::uint8_t transaction = 0) {
  return UbxBytes{static_cast<std::uint8_t>(transaction > 0 ? 1 : 0), layers, transaction, 0} +
         items;
}

std::size_t bytes_of(std::uint32_t key) {
  static constexpr std::array<std::size_t, 8> kSizes{0, 1, 1, 2, 4, 8, 0, 0};
  return kSizes[key >> 28U & 7U];
}

struct Item {
  std::uint32_t key = 0;
  std::uint64_t value = 0;
};

std::string words(const std::vector<Item>& items) {
  std::string text;
  for (const Item& item : items) {
    text +=
        (text.empty() ? "" : ", ") +
        hex_text({static_cast<std::uint8_t>(item.key >> 24U),
                  static_cast<std::uint8_t>(item.key >> 16U),
                  static_cast<std::uint8_t>(item.key >> 8U), static_cast<std::uint8_t>(item.key)}) +
        " = " + std::to_string(item.value);
  }
  return text.empty() ? "no item" : text;
}

/// Items of a layer; nothing where it failed.
std::optional<std::vector<Item>> items(T& trial, std::uint8_t layer,
                                       const std::vector<std::uint32_t>& keys,
                                       unsigned position = 0) {
  const auto found = trial.poll("CFG-VALGET", request(layer, position, keys));
  if (!found ||
      !trial.demand(found->value("version") == 1, "version 1 of the answer", found->words()) ||
      !trial.expect(found->value("layer") == layer && found->value("position") == position,
                    "layer and position of the request", found->words())) {
    return std::nullopt;
  }
  std::vector<Item> all;
  const UbxBytes& bytes = found->bytes();
  for (std::size_t at = 4; at < bytes.size();) {
    Item item;
    for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
      item.key |= std::uint32_t{bytes[at + i]} << (8 * i);
    }
    const std::size_t size = bytes_of(item.key);
    at += 4;
    if (!trial.demand(size > 0 && at + size <= bytes.size(),
                      "keys, each with as many bytes as it says", hex_text(bytes))) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < size; ++i) {
      item.value |= std::uint64_t{bytes[at + i]} << (8 * i);
    }
    at += size;
    all.push_back(item);
  }
  return all;
}

std::optional<std::uint64_t> item(T& trial, std::uint8_t layer, std::uint32_t key) {
  const auto all = items(trial, layer, {key});
  if (!all || !trial.expect(all->size() == 1 && all->front().key == key,
                            "the item that was asked for alone", words(*all))) {
    return std::nullopt;
  }
  return all->front().value;
}

void same_as_message(T& trial) {
  const auto message = trial.poll("CFG-RATE");
  const auto period = message ? item(trial, kRam, kPeriod) : std::nullopt;
  if (period) {
    trial.expect(static_cast<double>(*period) == message->value("measRate"),
                 "CFG-RATE-MEAS as measRate of CFG-RATE", std::to_string(*period));
  }
}

void several(T& trial, const std::vector<std::uint32_t>& keys) {
  if (const auto all = items(trial, kRam, keys)) {
    trial.expect(std::ranges::equal(*all, keys, {}, &Item::key),
                 "the items in the order of the keys", words(*all));
  }
}

void whole_group(T& trial, std::uint32_t group) {
  const auto all = items(trial, kRam, {group | 0xFFFFU});
  if (!all) {
    return;
  }
  const auto of_group = [&](const Item& each) {
    return (each.key >> 16U & 0xFFU) == (group >> 16U & 0xFFU);
  };
  trial.expect(all->size() >= 3 && std::ranges::all_of(*all, of_group),
               "items of the group alone, three at least", words(*all));
  const auto behind = items(trial, kRam, {group | 0xFFFFU}, 1);
  if (behind && trial.fine()) {
    trial.expect(behind->size() + 1 == all->size() && behind->front().key == (*all)[1].key,
                 "with position 1 the same without the first", words(*behind));
  }
}

/// The period set to another one by `set`, read back, and put back.
void changed(T& trial, const std::function<bool(T&, std::uint64_t other)>& set) {
  const auto before = item(trial, kRam, kPeriod);
  if (!before) {
    return;
  }
  const std::uint64_t other = *before == 500 ? 1000 : 500;
  if (set(trial, other)) {
    const auto now = item(trial, kRam, kPeriod);
    if (now) {
      trial.expect(*now == other, std::to_string(other), std::to_string(*now));
    }
  }
  trial.accepts("CFG-VALSET", setting(kToRam, u4(kPeriod) + u2(static_cast<unsigned>(*before))));
}

/// A refused setting that would have changed the period leaves it.
void refused(T& trial, const std::function<UbxBytes(const UbxBytes& period)>& make) {
  const auto before = item(trial, kRam, kPeriod);
  if (!before) {
    return;
  }
  const unsigned other = *before == 500 ? 1000 : 500;
  const bool refused_it = trial.refuses(kSet, make(u4(kPeriod) + u2(other)));
  const auto now = item(trial, kRam, kPeriod);
  if (now && refused_it) {
    trial.expect(*now == *before, "the period that it was", std::to_string(*now));
  }
  if (now && *now != *before) {
    static_cast<void>(trial.acknowledged(
        kSet, setting(kToRam, u4(kPeriod) + u2(static_cast<unsigned>(*before)))));
  }
}

struct ItemRow {
  const char* section;
  const char* title;
  Strength strength;
  Danger danger;
  void (*run)(T&);
};

const std::array kItemRows{
    ItemRow{"3.10.24", "An item of RAM is read", kMust, kNone,
            [](T& t) { static_cast<void>(item(t, kRam, kPeriod)); }},
    ItemRow{"3.10.24", "An item's default is read", kMust, kNone,
            [](T& t) { static_cast<void>(item(t, kDefaults, kPeriod)); }},
    ItemRow{"3.10.24", "An item is what the message says", kMust, kNone, same_as_message},
    ItemRow{"3.10.24", "Several items come in the order of their keys", kMust, kNone,
            [](T& t) {
              several(t, {kReference, kPeriod, kRatio, kElevation});
            }},
    ItemRow{"3.10.24", "An item asked for twice comes twice", kMust, kNone,
            [](T& t) {
              several(t, {kPeriod, kPeriod});
            }},
    ItemRow{"3.10.24", "All items of a group, and those behind a position", kMust, kNone,
            [](T& t) { whole_group(t, kPeriod & 0x0FFF'0000U); }},
    ItemRow{"3.10.24", "A key that there is not is refused", kMust, kNone,
            [](T& t) { t.refuses(kGet, request(kRam, 0, {kUnknown})); }},
    ItemRow{"3.10.24", "A key that there is not among others is refused", kMust, kNone,
            [](T& t) {
              t.refuses(kGet, request(kRam, 0, {kPeriod, kUnknown}));
            }},
    ItemRow{"3.10.24", "A layer that there is not is refused", kMust, kNone,
            [](T& t) { t.refuses(kGet, request(5, 0, {kPeriod})); }},
    ItemRow{"3.10.24", "64 keys are answered", kMust, kNone,
            [](T& t) { several(t, std::vector<std::uint32_t>(64, kPeriod)); }},
    ItemRow{
        "3.10.24", "65 keys are refused", kMust, kNone,
        [](T& t) { t.refuses(kGet, request(kRam, 0, std::vector<std::uint32_t>(65, kPeriod))); }},
    ItemRow{"3.10.24", "A request that ends within a key is refused", kMust, kNone,
            [](T& t) {
              t.refuses(kGet, UbxBytes{0, 0, 0, 0, 0x01, 0x00});
            }},
    ItemRow{"3.10.25", "An item of RAM is set and read back", kMust, kWrites,
            [](T& t) {
              changed(t, [](T& trial, std::uint64_t other) {
                return trial.accepts(
                    "CFG-VALSET", setting(kToRam, u4(kPeriod) + u2(static_cast<unsigned>(other))));
              });
            }},
    ItemRow{"3.10.25", "What is set by CFG-RATE is read as an item", kMust, kWrites,
            [](T& t) {
              changed(t, [](T& trial, std::uint64_t other) {
                const auto now = trial.poll("CFG-RATE");
                UbxBytes bytes = now ? now->bytes() : UbxBytes();
                if (!now) {
                  return false;
                }
                bytes[0] = static_cast<std::uint8_t>(other);
                bytes[1] = static_cast<std::uint8_t>(other >> 8U);
                return trial.accepts("CFG-RATE", bytes);
              });
            }},
    ItemRow{"3.10.25", "A transaction acts at its end", kMust, kWrites,
            [](T& t) {
              changed(t, [](T& trial, std::uint64_t other) {
                const UbxBytes period = u4(kPeriod) + u2(static_cast<unsigned>(other));
                return trial.accepts("CFG-VALSET", setting(kToRam, {}, 1)) &&
                       trial.accepts("CFG-VALSET", setting(kToRam, period, 2)) &&
                       trial.accepts("CFG-VALSET", setting(kToRam, {}, 3));
              });
            }},
    ItemRow{"3.10.25", "Another request cancels a transaction, nothing of it is set", kMust,
            kWrites,
            [](T& t) {
              refused(t, [&](const UbxBytes& period) {
                static_cast<void>(t.accepts("CFG-VALSET", setting(kToRam, period, 1)));
                const auto meanwhile = item(t, kRam, kPeriod);
                t.expect(meanwhile != std::uint64_t{period[4]} + 256U * period[5],
                         "nothing before the end", "the period that was set");
                return setting(kToRam, {}, 3);
              });
            }},
    ItemRow{"3.10.25", "A transaction does not begin in its middle", kMust, kWrites,
            [](T& t) {
              refused(t, [](const UbxBytes& period) { return setting(kToRam, period, 2); });
            }},
    ItemRow{"3.10.25", "A layer has to be named", kMust, kWrites,
            [](T& t) { refused(t, [](const UbxBytes& period) { return setting(0, period); }); }},
    ItemRow{"3.10.25", "A key that there is not is refused, and all with it", kMust, kWrites,
            [](T& t) {
              refused(t, [](const UbxBytes& period) {
                return setting(kToRam, period + u4(kUnknown) + u2(1));
              });
            }},
    ItemRow{"3.10.25", "A value cut short is refused, and all with it", kMust, kWrites,
            [](T& t) {
              refused(t, [](const UbxBytes& period) {
                return setting(kToRam, period + u4(kRatio) + UbxBytes{1});
              });
            }},
    ItemRow{"3.10.25", "A version that there is not is refused", kMust, kWrites,
            [](T& t) {
              refused(t, [](const UbxBytes& period) { return UbxBytes{9, kToRam, 0, 0} + period; });
            }},
    ItemRow{"3.10.25", "More than 64 items are refused", kMust, kWrites,
            [](T& t) {
              refused(t, [](const UbxBytes& period) {
                UbxBytes all;
                for (int i = 0; i < 65; ++i) {
                  all = all + period;
                }
                return setting(kToRam, all);
              });
            }},
    ItemRow{"3.10.23", "A key that there is not cannot be deleted", kMust, kWrites,
            [](T& t) {
              t.refuses(kDelete, UbxBytes{0, 2, 0, 0} + u4(kUnknown));
            }},
    ItemRow{"3.10.23", "Nothing is deleted from RAM", kMust, kWrites,
            [](T& t) {
              t.refuses(kDelete, UbxBytes{0, kToRam, 0, 0} + u4(kPeriod));
            }},
};

}  // namespace

std::vector<UbxCase> ubx_item_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const ItemRow& row : kItemRows) {
    UbxCase& made = all.emplace_back();
    made.identity = citations.f9.next(row.section, row.title, row.strength, row.danger);
    made.needs = {"CFG-VALGET", "CFG-RATE"};
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
