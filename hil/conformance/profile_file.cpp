#include "hil/conformance/profile_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

using conform::AddressRange;
using fields::Choice;
using fields::plain;
using protocols::modbus::SerialCharacter;
using protocols::modbus::Table;

namespace {

constexpr std::array<Choice<SerialCharacter>, 4> kCharacters{
    {{SerialCharacter::even_8e1, "8E1", "Even parity."},
     {SerialCharacter::odd_8o1, "8O1", "Odd parity."},
     {SerialCharacter::none_8n2, "8N2", "No parity, two stop bits."},
     {SerialCharacter::none_8n1, "8N1", "No parity, one stop bit."}}};

/// Keys of the tables, by Table.
constexpr std::array<std::string_view, 4> kTables{"coils", "discrete_inputs", "holding_registers",
                                                  "input_registers"};

std::optional<AddressRange> range_in(std::string_view text) {
  AddressRange range;
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, range.first);
  if (error != std::errc()) {
    return std::nullopt;
  }
  range.last = range.first;
  if (after == end) {
    return range;
  }
  const auto [last, wrong] = std::from_chars(after + 1, end, range.last);
  return *after == '-' && wrong == std::errc() && last == end && range.first <= range.last
             ? std::optional(range)
             : std::nullopt;
}

std::vector<AddressRange> ranges_in(const std::string& key, const std::vector<std::string>& texts) {
  std::vector<AddressRange> ranges;
  for (const std::string& text : texts) {
    const auto range = range_in(text);
    if (!range) {
      throw std::invalid_argument(key + ": found \"" + text +
                                  "\", allowed for example \"0-15\" or \"7\", 0 .. 65535");
    }
    ranges.push_back(*range);
  }
  std::ranges::sort(ranges, {}, &AddressRange::first);
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    if (ranges[i].first <= ranges[i - 1].last) {
      throw std::invalid_argument(
          fmt::format("{}: found address {} twice, allowed once", key, ranges[i].first));
    }
  }
  return ranges;
}

/// What may be written must be readable, so that it can be put back.
void within(const std::string& key, const std::vector<AddressRange>& writable, Table table,
            const conform::ModbusClaims& claims) {
  for (const AddressRange& range : writable) {
    for (std::uint32_t address = range.first; address <= range.last; ++address) {
      if (!claims.claims(table, address)) {
        throw std::invalid_argument(fmt::format("{}: found address {}, allowed those of {}", key,
                                                address, kTables[static_cast<std::size_t>(table)]));
      }
    }
  }
}

conform::ModbusClaims claims_of(const ModbusProfile& p) {
  conform::ModbusClaims claims;
  claims.unit = p.unit;
  for (const double code : p.functions) {
    claims.functions.push_back(static_cast<std::uint8_t>(code));
    if (claims.functions.back() != code) {
      throw std::invalid_argument(
          fmt::format("functions: found {}, allowed whole numbers, 1 .. 127", code));
    }
  }
  const std::array tables{&p.coils, &p.discrete_inputs, &p.holding_registers, &p.input_registers};
  for (std::size_t i = 0; i < tables.size(); ++i) {
    claims.tables[i] = ranges_in(std::string(kTables[i]), *tables[i]);
    const auto function = static_cast<std::uint8_t>(i + 1);  // 1 to 4 read them, in this order.
    if (claims.has(function) == claims.tables[i].empty()) {
      throw std::invalid_argument(
          fmt::format("{}: found {}, allowed addresses with function {}, "
                      "none without it",
                      kTables[i], tables[i]->size(), function));
    }
  }
  claims.writable_coils = ranges_in("writable_coils", p.writable_coils);
  claims.writable_registers = ranges_in("writable_registers", p.writable_registers);
  within("writable_coils", claims.writable_coils, Table::coils, claims);
  within("writable_registers", claims.writable_registers, Table::holding_registers, claims);
  using std::chrono::milliseconds;
  claims.answer_within = std::chrono::duration_cast<milliseconds>(p.answer_within);
  claims.patience = std::chrono::duration_cast<milliseconds>(p.patience);
  claims.character = p.character;
  return claims;
}

template <class Profile>
Profile read_profile(const std::string& file) {
  Problems problems;
  Origins origins;
  Profile profile;
  const Value document = load_document(file, problems);
  if (problems.empty()) {
    read(document, profile, problems, origins);
  }
  problems.throw_if_any();
  return profile;
}

}  // namespace

void visit(fields::Visitor& v, ModbusProfile& p) {
  static constexpr fields::DurationRule kSoon{1'000'000, 60'000'000'000};
  v.integer("unit", p.unit, {0, 255}, "Unit identifier; on a serial line the address, 1 to 247.");
  v.number_list("functions", p.functions, plain().between(1, 127), "Function codes that it has.");
  v.texts("coils", p.coils, "Addresses as on the wire, from 0: \"0-15\", \"20\".");
  v.texts("discrete_inputs", p.discrete_inputs, "The same of discrete inputs.");
  v.texts("holding_registers", p.holding_registers, "The same of holding registers.");
  v.texts("input_registers", p.input_registers, "The same of input registers.");
  v.texts("writable_coils", p.writable_coils,
          "Coils that may be turned over and back without anything moving.");
  v.texts(
      "writable_registers", p.writable_registers,
      "Holding registers whose lowest bit may be turned over and back without anything moving.");
  v.duration("answer_within", p.answer_within, kSoon, "99 of 100 answers come within this.");
  v.duration("patience", p.patience, kSoon, "Who has not answered by then does not.");
  v.choice("character", p.character, kCharacters, "How a character lies on a serial line.");
}

void validate(const ModbusProfile& p) {
  static_cast<void>(claims_of(p));
}

void visit(fields::Visitor& v, NmeaProfile& p) {
  v.texts("sentences", p.claims.sentences,
          "Types that come in every epoch, without the talker: RMC, GGA; empty = not claimed.");
  v.number("rate", p.claims.rate_hz, fields::in("Hz").between(0, 100),
           "Epochs per second; 0 = not claimed.");
}

void validate(const NmeaProfile& p) {
  for (const std::string& type : p.claims.sentences) {
    const bool right = type.size() == 3 && std::ranges::all_of(type, [](char c) {
                         return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
                       });
    if (!right) {
      throw std::invalid_argument("sentences: found \"" + type +
                                  "\", allowed three capital letters, RMC");
    }
  }
}

conform::ModbusClaims read_modbus_profile(const std::string& file) {
  return claims_of(read_profile<ModbusProfile>(file));
}

conform::NmeaClaims read_nmea_profile(const std::string& file) {
  return read_profile<NmeaProfile>(file).claims;
}

std::string hash_of(const std::string& profile_text) {
  return fmt::format("{:016x}", fnv1a(profile_text));
}

std::string profile_text(const conform::NmeaClaims& claims, const std::string& endpoint) {
  std::string text =
      endpoint.empty()
          ? ""
          : "# What " + endpoint + " said. Look through it: a claim is what the maker says.\n";
  text += "sentences: [";
  for (const std::string& type : claims.sentences) {
    text += (&type == claims.sentences.data() ? "" : ", ") + type;
  }
  return text + fmt::format("]\nrate: {} Hz\n", claims.rate_hz);
}

std::string profile_text(const conform::ModbusClaims& claims, const std::string& endpoint) {
  std::string text;
  if (!endpoint.empty()) {
    text += "# What " + endpoint +
            " answered to. Look through it: a claim is what the maker says, not what was found.\n"
            "# Nothing may be written: name writable_coils and writable_registers yourself.\n";
  }
  text += fmt::format("unit: {}\nfunctions: [", claims.unit);
  for (std::size_t i = 0; i < claims.functions.size(); ++i) {
    text += fmt::format("{}{}", i > 0 ? ", " : "", claims.functions[i]);
  }
  text += "]\n";
  const auto put = [&](std::string_view key, const std::vector<AddressRange>& ranges) {
    if (ranges.empty()) {
      return;
    }
    text += fmt::format("{}: [", key);
    for (const AddressRange& range : ranges) {
      text += fmt::format("{}\"{}", &range == ranges.data() ? "" : ", ", range.first);
      text += range.last > range.first ? fmt::format("-{}\"", range.last) : "\"";
    }
    text += "]\n";
  };
  for (std::size_t i = 0; i < kTables.size(); ++i) {
    put(kTables[i], claims.tables[i]);
  }
  put("writable_coils", claims.writable_coils);
  put("writable_registers", claims.writable_registers);
  text += fmt::format("answer_within: {} ms\npatience: {} ms\n", claims.answer_within.count(),
                      claims.patience.count());
  const auto* const character =
      std::ranges::find(kCharacters, claims.character, &Choice<SerialCharacter>::value);
  return text + fmt::format("character: {}\n", character->name);
}

}  // namespace rigwire::hil
