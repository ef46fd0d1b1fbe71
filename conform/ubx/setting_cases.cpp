// Settings: read, written as they were, changed and put back; and what is none: UBX-13003221 R28,
// sections 32.10 and 32.5.1.
//
// Every case that changes something reads it before and writes that back.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

using T = UbxTrial;

std::string hex(const UbxPayload& payload) {
  return hex_text(payload.bytes(), 32);
}

/// Checks that a new poll returns the same payload.
bool unchanged(T& trial, const UbxPayload& before, const UbxBytes& selector) {
  const auto after = trial.poll(before.message().name, selector);
  return after && trial.expect(after->bytes() == before.bytes(), "what it was before",
                               hex(*after) + " after " + hex(before));
}

void written_back(T& trial, const UbxMessage& message) {
  const UbxBytes selector(message.selector.begin(), message.selector.end());
  const auto before = trial.poll(message.name, selector);
  if (before && trial.accepts(message.name, before->bytes())) {
    unchanged(trial, *before, selector);
  }
}

void wrong_length(T& trial, const UbxMessage& message) {
  const UbxBytes selector(message.selector.begin(), message.selector.end());
  const auto before = trial.poll(message.name, selector);
  if (!before) {
    return;
  }
  // Neither what is polled with, nor what can be set.
  UbxBytes longer = before->bytes();
  longer.resize(longer.size() + 3);
  if (!trial.refuses(message.id, longer)) {
    static_cast<void>(trial.acknowledged(message.id, before->bytes()));
    return;
  }
  unchanged(trial, *before, selector);
}

/// A setting with some bytes changed, read back, and put back.
void changed(T& trial, std::string_view name, const std::function<void(UbxBytes&)>& change,
             const std::function<bool(const UbxPayload& before, const UbxPayload& now)>& as_wanted,
             const std::string& wanted) {
  const auto before = trial.poll(name);
  if (!before) {
    return;
  }
  UbxBytes other = before->bytes();
  change(other);
  if (trial.accepts(name, other)) {
    if (const auto now = trial.poll(name)) {
      trial.expect(as_wanted(*before, *now), wanted, now->words());
    }
  }
  if (trial.accepts(name, before->bytes())) {
    unchanged(trial, *before, {});
  }
}

void refused_unchanged(T& trial, std::string_view name,
                       const std::function<void(UbxBytes&)>& change) {
  const auto before = trial.poll(name);
  if (!before) {
    return;
  }
  UbxBytes other = before->bytes();
  change(other);
  if (!trial.refuses(ubx_message(name)->id, other)) {
    static_cast<void>(trial.acknowledged(ubx_message(name)->id, before->bytes()));
    return;
  }
  unchanged(trial, *before, {});
}

void put(UbxBytes& bytes, std::size_t at, const UbxBytes& value) {
  std::ranges::copy(value, bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

void mask_of_nothing(T& trial) {
  const auto before = trial.poll("CFG-NAV5");
  if (!before) {
    return;
  }
  UbxBytes other = before->bytes();
  put(other, 0, u2(0));                                              // mask
  other[12] = static_cast<std::uint8_t>(other[12] == 20 ? 21 : 20);  // minElev
  if (trial.accepts("CFG-NAV5", other)) {
    unchanged(trial, *before, {});
  }
}

void one_of_the_mask(T& trial) {
  changed(
      trial, "CFG-NAV5",
      [](UbxBytes& bytes) {
        put(bytes, 0, u2(0x0002));  // minElev alone
        bytes[2] = static_cast<std::uint8_t>(bytes[2] == 4 ? 3 : 4);
        bytes[12] = static_cast<std::uint8_t>(bytes[12] == 8 ? 9 : 8);
      },
      [](const UbxPayload& before, const UbxPayload& now) {
        return now.value("minElev") == (before.value("minElev") == 8 ? 9 : 8) &&
               now.value("dynModel") == before.value("dynModel");
      },
      "minElev as it was set, dynModel as it was");
}

void port_of_poll(T& trial, std::uint8_t port) {
  if (const auto found = trial.poll("CFG-PRT", {port})) {
    trial.expect(found->value("portID") == port, "port " + std::to_string(port),
                 std::to_string(static_cast<int>(found->value("portID"))));
  }
}

void message_rates(T& trial, UbxId of) {
  if (const auto found = trial.poll("CFG-MSG", {of.message_class, of.message_id})) {
    trial.expect(
        found->value("msgClass") == of.message_class && found->value("msgID") == of.message_id,
        "the message that was asked for", found->words());
  }
}

void gnss_blocks(T& trial) {
  const auto found = trial.poll("CFG-GNSS");
  if (!found) {
    return;
  }
  trial.expect(found->value("msgVer") == 0, "version 0", found->words());
  trial.expect(found->value("numTrkChUse") <= found->value("numTrkChHw"),
               "as many channels used as there are, or fewer", found->words());
  for (std::size_t i = 0; i < found->blocks(); ++i) {
    trial.expect(found->value_in(i, "resTrkCh") <= found->value_in(i, "maxTrkCh"),
                 "reserved channels within the most of each system", found->words());
    trial.expect(found->value_in(i, "gnssId") <= 6, "systems 0 to 6", found->words());
  }
}

void rates_of_a_command(T& trial) {
  const UbxBytes of{0xF0, 0x08};  // ZDA
  const auto before = trial.poll("CFG-MSG", of);
  if (!before) {
    return;
  }
  UbxBytes other = before->bytes();
  for (std::size_t i = 2; i < other.size(); ++i) {
    other[i] = static_cast<std::uint8_t>(other[i] == 7 ? 8 : 7);
  }
  if (trial.accepts("CFG-MSG", other)) {
    if (const auto now = trial.poll("CFG-MSG", of)) {
      trial.expect(now->bytes() == other, "the rates that were set", now->words());
    }
  }
  if (trial.accepts("CFG-MSG", before->bytes())) {
    unchanged(trial, *before, of);
  }
}

struct SettingRow {
  const char* message;
  const char* title;
  Strength strength;
  Danger danger;
  void (*run)(T&);
};

const std::array kSettingRows{
    SettingRow{"CFG-PRT", "A poll without a port is of a port that there is", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-PRT")) {
                   t.expect(found->value("portID") <= 4, "port 0 to 4", found->words());
                 }
               }},
    SettingRow{"CFG-PRT", "A poll of port 1 is of port 1", kMust, kNone,
               [](T& t) { port_of_poll(t, 1); }},
    SettingRow{"CFG-PRT", "A poll of port 3 is of port 3", kMust, kNone,
               [](T& t) { port_of_poll(t, 3); }},
    SettingRow{"CFG-PRT", "A port that there is not is refused", kMust, kNone,
               [](T& t) {
                 t.refuses({0x06, 0x00}, {9});
               }},
    SettingRow{"CFG-PRT", "The line takes and gives UBX", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-PRT", {1})) {
                   t.expect(
                       found->bits("inProtoMask", 0) == 1 && found->bits("outProtoMask", 0) == 1,
                       "bit 0 of inProtoMask and outProtoMask", found->words());
                 }
               }},
    SettingRow{"CFG-MSG", "Rates of RMC are of RMC", kMust, kNone,
               [](T& t) {
                 message_rates(t, {0xF0, 0x04});
               }},
    SettingRow{"CFG-MSG", "Rates of NAV-STATUS are of NAV-STATUS", kMust, kNone,
               [](T& t) {
                 message_rates(t, {0x01, 0x03});
               }},
    SettingRow{"CFG-MSG", "Rates of a message that there is not are refused", kMust, kNone,
               [](T& t) {
                 t.refuses({0x06, 0x01}, {0x01, 0xFE});
               }},
    SettingRow{"CFG-MSG", "Rates of an acknowledgement are refused", kMust, kNone,
               [](T& t) {
                 t.refuses({0x06, 0x01}, {0x05, 0x01});
               }},
    SettingRow{"CFG-MSG", "A rate for a message that there is not is refused", kMust, kWrites,
               [](T& t) {
                 t.refuses({0x06, 0x01}, {0x01, 0xFE, 1});
               }},
    SettingRow{"CFG-MSG", "Rates for all ports are read back, and put back", kMust, kWrites,
               rates_of_a_command},
    SettingRow{"CFG-INF", "A protocol that there is not is refused", kMust, kNone,
               [](T& t) {
                 t.refuses({0x06, 0x02}, {200});
               }},
    SettingRow{"CFG-INF", "A poll of NMEA is of NMEA", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-INF", {1})) {
                   t.expect(found->blocks() == 1 && found->value_in(0, "protocolID") == 1,
                            "one block, of protocol 1", found->words());
                 }
               }},
    SettingRow{"CFG-INF", "A poll of UBX is of UBX", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-INF", {0})) {
                   t.expect(found->blocks() == 1 && found->value_in(0, "protocolID") == 0,
                            "one block, of protocol 0", found->words());
                 }
               }},
    SettingRow{"CFG-RATE", "The period is what is claimed", kMust, kNone,
               [](T& t) {
                 const auto found = t.poll("CFG-RATE");
                 if (found && t.claims().rate_hz > 0.0) {
                   const double rate =
                       1000.0 / (found->value("measRate") * found->value("navRate"));
                   t.expect(std::abs(rate - t.claims().rate_hz) < 0.01 * t.claims().rate_hz,
                            "measRate times navRate as is claimed", found->words());
                 }
               }},
    SettingRow{"CFG-RATE", "The time that it is aligned to is one that there is", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-RATE")) {
                   t.expect(found->value("timeRef") <= 4, "timeRef 0 to 4", found->words());
                 }
               }},
    SettingRow{
        "CFG-RATE", "A period of 0 is refused, nothing changes", kMust, kWrites,
        [](T& t) { refused_unchanged(t, "CFG-RATE", [](UbxBytes& b) { put(b, 0, u2(0)); }); }},
    SettingRow{
        "CFG-RATE", "A time that there is not is refused, nothing changes", kShould, kWrites,
        [](T& t) { refused_unchanged(t, "CFG-RATE", [](UbxBytes& b) { put(b, 4, u2(99)); }); }},
    SettingRow{"CFG-RATE", "Another period is read back, and put back", kMust, kWrites,
               [](T& t) {
                 changed(
                     t, "CFG-RATE", [](UbxBytes& b) { put(b, 0, u2(b[0] == 0xF4 ? 1000 : 500)); },
                     [](const UbxPayload& before, const UbxPayload& now) {
                       return now.value("measRate") == (before.bytes()[0] == 0xF4 ? 1000 : 500);
                     },
                     "the period that was set");
               }},
    SettingRow{"CFG-NAV5", "What is read has a mask of all", kShould, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-NAV5")) {
                   t.expect(found->value("mask") == 0xFFFF, "FFFF hex", found->words());
                 }
               }},
    SettingRow{"CFG-NAV5", "Model, mode and elevation are such", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-NAV5")) {
                   t.expect(found->value("dynModel") <= 12 && found->value("dynModel") != 1,
                            "a dynModel that there is", found->words());
                   t.expect(found->value("fixMode") >= 1 && found->value("fixMode") <= 3,
                            "fixMode 1 to 3", found->words());
                   t.expect(std::abs(found->value("minElev")) <= 90, "minElev up to 90 degrees",
                            found->words());
                 }
               }},
    SettingRow{"CFG-NAV5", "A mask of nothing changes nothing", kMust, kWrites, mask_of_nothing},
    SettingRow{"CFG-NAV5", "What the mask names is changed, and put back", kMust, kWrites,
               one_of_the_mask},
    SettingRow{"CFG-NAV5", "A dynamic model that there is not is refused, nothing changes", kMust,
               kWrites,
               [](T& t) {
                 refused_unchanged(t, "CFG-NAV5", [](UbxBytes& b) {
                   put(b, 0, u2(0x0001));
                   b[2] = 77;
                 });
               }},
    SettingRow{"CFG-NAV5", "A fix mode that there is not is refused, nothing changes", kMust,
               kWrites,
               [](T& t) {
                 refused_unchanged(t, "CFG-NAV5", [](UbxBytes& b) {
                   put(b, 0, u2(0x0004));
                   b[3] = 9;
                 });
               }},
    SettingRow{"CFG-TP5", "A poll of pulse 0 is of pulse 0", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-TP5", {0})) {
                   t.expect(found->value("tpIdx") == 0, "tpIdx 0", found->words());
                 }
               }},
    SettingRow{"CFG-TP5", "A poll of pulse 1 is of pulse 1", kMust, kNone,
               [](T& t) {
                 if (const auto found = t.poll("CFG-TP5", {1})) {
                   t.expect(found->value("tpIdx") == 1, "tpIdx 1", found->words());
                 }
               }},
    SettingRow{"CFG-TP5", "A pulse that there is not is refused", kMust, kNone,
               [](T& t) {
                 t.refuses({0x06, 0x31}, {9});
               }},
    SettingRow{"CFG-TP5", "A cable's delay is read back, and put back", kMust, kWrites,
               [](T& t) {
                 changed(
                     t, "CFG-TP5", [](UbxBytes& b) { put(b, 4, u2(b[4] == 60 ? 61 : 60)); },
                     [](const UbxPayload& before, const UbxPayload& now) {
                       return now.value("antCableDelay") == (before.bytes()[4] == 60 ? 61 : 60);
                     },
                     "the delay that was set");
               }},
    SettingRow{"CFG-GNSS", "Channels and systems are such", kMust, kNone, gnss_blocks},
    SettingRow{"CFG-GNSS", "No system at all is refused, nothing changes", kMust, kWrites,
               [](T& t) {
                 refused_unchanged(t, "CFG-GNSS", [](UbxBytes& b) {
                   for (std::size_t at = 8; at < b.size(); at += 8) {
                     b[at] = static_cast<std::uint8_t>(b[at] & 0xFEU);
                   }
                 });
               }},
    SettingRow{"CFG-GNSS", "More blocks than there are is refused, nothing changes", kMust, kWrites,
               [](T& t) {
                 refused_unchanged(t, "CFG-GNSS",
                                   [](UbxBytes& b) { b[3] = static_cast<std::uint8_t>(b[3] + 1); });
               }},
    SettingRow{"CFG-NMEA", "The version is one that there is", kMust, kNone,
               [](T& t) {
                 static constexpr std::array kVersions{0x21, 0x23, 0x40, 0x41, 0x4B};
                 if (const auto found = t.poll("CFG-NMEA")) {
                   t.expect(
                       std::ranges::find(kVersions, found->value("nmeaVersion")) != kVersions.end(),
                       "21, 23, 40, 41 or 4B hex", found->words());
                 }
               }},
    SettingRow{"CFG-NMEA", "A version that there is not is refused, nothing changes", kMust,
               kWrites,
               [](T& t) { refused_unchanged(t, "CFG-NMEA", [](UbxBytes& b) { b[1] = 0x99; }); }},
    SettingRow{"CFG-SBAS", "The number of satellites to track is read back, and put back", kMust,
               kWrites,
               [](T& t) {
                 changed(
                     t, "CFG-SBAS",
                     [](UbxBytes& b) { b[2] = static_cast<std::uint8_t>(b[2] == 1 ? 2 : 1); },
                     [](const UbxPayload& before, const UbxPayload& now) {
                       return now.value("maxSBAS") == (before.value("maxSBAS") == 1 ? 2 : 1);
                     },
                     "the number that was set");
               }},
    SettingRow{"CFG-RATE", "Clearing, saving and loading nothing is taken (CFG-CFG)", kMust,
               kWrites, [](T& t) { t.accepts("CFG-CFG", UbxBytes(12, 0)); }},
};

constexpr std::array<std::string_view, 3> kNotWrittenAsRead{
    "CFG-DAT",     // 52 bytes are read, 44 are written
    "CFG-VALGET",  // written by CFG-VALSET
    "CFG-RINV"};   // of any length

}  // namespace

std::vector<UbxCase> ubx_setting_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  const auto add = [&](const UbxMessage& message, std::string title, Strength strength,
                       Danger danger) -> UbxCase& {
    UbxCase& made = all.emplace_back();
    Citations& document = message.document == UbxDocument::f9 ? citations.f9 : citations.m8;
    made.identity = document.next(std::string(message.section), std::move(title), strength, danger);
    made.needs = {message.name};
    return made;
  };
  for (const UbxMessage& message : ubx_messages()) {
    const bool written =
        message.id.message_class == 0x06 && message.poll != UbxPoll::none &&
        std::ranges::find(kNotWrittenAsRead, message.name) == kNotWrittenAsRead.end();
    if (written) {
      const std::string name(message.name);
      add(message, name + " is taken as it was read", kMust, kWrites).run = [&message](T& trial) {
        written_back(trial, message);
      };
      add(message, name + " with three bytes too many is refused", kMust, kWrites).run =
          [&message](T& trial) { wrong_length(trial, message); };
    }
  }
  for (const SettingRow& row : kSettingRows) {
    add(*ubx_message(row.message), row.title, row.strength, row.danger).run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
