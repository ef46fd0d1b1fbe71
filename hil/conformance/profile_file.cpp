#include "hil/conformance/profile_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "fields/visitor.h"
#include "hil/configuration/outline.h"
#include "hil/conformance/read_structure.h"

namespace rigwire::hil {

using conform::AddressRange;
using fields::Choice;
using fields::plain;
using protocols::modbus::SerialCharacter;
using protocols::modbus::Table;

namespace {

constexpr fields::DurationRule kSoon{1'000'000, 60'000'000'000};

/// Auxiliary valves of ISO 11783 have the numbers from 0 to this.
constexpr unsigned kLastValve = 15;

constexpr std::array<Choice<SerialCharacter>, 4> kCharacters{
    {{SerialCharacter::even_8e1, "8E1", "Even parity."},
     {SerialCharacter::odd_8o1, "8O1", "Odd parity."},
     {SerialCharacter::none_8n2, "8N2", "No parity, two stop bits."},
     {SerialCharacter::none_8n1, "8N1", "No parity, one stop bit."}}};

/// Keys of the tables, by Table.
constexpr std::array<std::string_view, 4> kTables{"coils", "discrete_inputs", "holding_registers",
                                                  "input_registers"};

std::chrono::milliseconds in_milliseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time);
}

/// "RMC, VTG, GGA", on lines of a hundred characters at most behind `indent`.
std::string names_text(const std::vector<std::string>& names, std::size_t indent) {
  constexpr std::size_t kWidth = 100;
  std::string text;
  std::size_t column = indent;
  for (const std::string& name : names) {
    const bool first = &name == names.data();
    if (!first && column + name.size() + 3 > kWidth) {
      text += ",\n" + std::string(indent, ' ');
      column = indent;
    } else if (!first) {
      text += ", ";
      column += 2;
    }
    text += name;
    column += name.size();
  }
  return text;
}

/// Returns the first line of a generated profile; empty without an endpoint.
std::string begin_of(const std::string& endpoint) {
  return endpoint.empty() ? ""
                          : "# What " + endpoint +
                                " answered to. Look through it: a claim is what the maker says, "
                                "not what was found.\n";
}

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

std::string text_of(const conform::RecordRange& range) {
  const AddressRange& records = range.records;
  return fmt::format("{}:{}", range.file, records.first) +
         (records.last > records.first ? fmt::format("-{}", records.last) : "");
}

/// "4:0-9", "4:0".
std::vector<conform::RecordRange> records_in(const std::string& key,
                                             const std::vector<std::string>& texts) {
  constexpr std::uint16_t kLastRecord = 9999;
  std::vector<conform::RecordRange> all;
  for (const std::string& text : texts) {
    conform::RecordRange range;
    const char* const end = text.data() + text.size();
    const auto [colon, error] = std::from_chars(text.data(), end, range.file);
    if (error != std::errc() || range.file == 0 || colon == end || *colon != ':') {
      throw std::invalid_argument(key + ": found \"" + text +
                                  "\", allowed a file, 1 to 65535, and its records, \"4:0-9\"");
    }
    range.records = ranges_in(key, {std::string(colon + 1, end)}).front();
    if (range.records.last > kLastRecord) {
      throw std::invalid_argument(fmt::format("{}: found record {}, allowed 0 .. {}", key,
                                              range.records.last, kLastRecord));
    }
    all.push_back(range);
  }
  return all;
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

conform::CanopenClaims claims_of(const CanopenProfile& p) {
  conform::CanopenClaims claims;
  claims.node = p.node;
  claims.patience = in_milliseconds(p.patience);
  for (const std::string& text : p.objects) {
    conform::ObjectName object;
    const char* const end = text.data() + text.size();
    const auto [colon, error] = std::from_chars(text.data(), end, object.index, 16);
    const bool indexed =
        error == std::errc() && colon == text.data() + 4 && colon != end && *colon == ':';
    const auto [after, wrong] = std::from_chars(indexed ? colon + 1 : end, end, object.sub);
    if (!indexed || wrong != std::errc() || after != end) {
      throw std::invalid_argument("objects: found \"" + text +
                                  "\", allowed an index of four hexadecimal digits and a "
                                  "sub-index, \"1018:1\"");
    }
    claims.objects.push_back(object);
  }
  return claims;
}

/// "0xA104 = 1", or "0xA104" for 1; nothing for an empty text.
std::optional<conform::GigeRegister> register_in(const std::string& key, const std::string& text) {
  if (text.empty()) {
    return std::nullopt;
  }
  conform::GigeRegister made;
  const char* const end = text.data() + text.size();
  bool read = text.starts_with("0x");
  const char* at = text.data() + (read ? 2 : 0);
  const auto [after, error] = std::from_chars(at, end, made.address, 16);
  read = read && error == std::errc() && made.address % 4 == 0;
  if (read && after != end) {
    constexpr std::string_view kIs = " = ";
    const bool is = std::string_view(after, static_cast<std::size_t>(end - after)).starts_with(kIs);
    const auto [behind, wrong] = std::from_chars(is ? after + kIs.size() : end, end, made.value);
    read = is && wrong == std::errc() && behind == end;
  }
  if (!read) {
    throw std::invalid_argument(key + ": found \"" + text +
                                "\", allowed an address of whole words and a value, "
                                "\"0xA104 = 1\"");
  }
  return made;
}

conform::GigeVisionClaims claims_of(const GigeVisionProfile& p) {
  conform::GigeVisionClaims claims;
  claims.start = register_in("acquisition_start", p.acquisition_start);
  claims.stop = register_in("acquisition_stop", p.acquisition_stop);
  if (const auto size = register_in("payload_size", p.payload_size)) {
    claims.payload_size = size->address;
  }
  claims.rate_hz = p.rate_hz;
  claims.answer_within = in_milliseconds(p.answer_within);
  claims.patience = in_milliseconds(p.patience);
  return claims;
}

constexpr std::uint32_t kGreatestGroup = 0x3FFFF;

conform::J1939Claims claims_of(const J1939Profile& p) {
  conform::J1939Claims claims;
  claims.address = p.address;
  claims.patience = in_milliseconds(p.patience);
  for (const std::string& text : p.periodic) {
    // "61444 every 20 ms": the group's number (PGN) and its period.
    constexpr std::string_view kBetween = " every ";
    constexpr std::string_view kBehind = " ms";
    conform::PeriodicGroup group;
    std::uint32_t period_ms = 0;
    const std::size_t between = text.find(kBetween);
    const char* const end = text.data() + text.size();
    bool read = between != std::string::npos && text.ends_with(kBehind);
    if (read) {
      const auto [after, error] = std::from_chars(text.data(), end, group.pgn);
      const auto [behind, wrong] =
          std::from_chars(text.data() + between + kBetween.size(), end, period_ms);
      read = error == std::errc() && after == text.data() + between && wrong == std::errc() &&
             behind == end - kBehind.size() && group.pgn <= kGreatestGroup && period_ms > 0 &&
             period_ms <= 60'000;
    }
    if (!read) {
      throw std::invalid_argument("periodic: found \"" + text +
                                  "\", allowed a group up to 262143 and its period up to 60000, "
                                  "\"61444 every 20 ms\"");
    }
    group.period = std::chrono::milliseconds(period_ms);
    claims.periodic.push_back(group);
  }
  for (const double group : p.requested) {
    claims.requested.push_back(static_cast<std::uint32_t>(group));
    if (claims.requested.back() != group) {
      throw std::invalid_argument(fmt::format("requested: found {}, allowed whole numbers, 0 .. {}",
                                              group, kGreatestGroup));
    }
  }
  return claims;
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
  claims.files = records_in("files", p.files);
  claims.writable_files = records_in("writable_files", p.writable_files);
  for (const conform::RecordRange& range : claims.writable_files) {
    const bool readable = std::ranges::any_of(claims.files, [&](const conform::RecordRange& each) {
      return each.file == range.file && each.records.holds(range.records.first) &&
             each.records.holds(range.records.last);
    });
    if (!readable) {
      throw std::invalid_argument(
          fmt::format("writable_files: found \"{}\", allowed records of files", text_of(range)));
    }
  }
  for (const double address : p.queues) {
    claims.queues.push_back(static_cast<std::uint16_t>(address));
    if (claims.queues.back() != address) {
      throw std::invalid_argument(
          fmt::format("queues: found {}, allowed whole numbers, 0 .. 65535", address));
    }
  }
  // What a function is needed for.
  const auto needs = [&](const char* key, bool claimed, std::uint8_t function) {
    if (claimed && !claims.has(function)) {
      throw std::invalid_argument(
          fmt::format("{}: found some, allowed with function {}", key, function));
    }
  };
  needs("files", !claims.files.empty(), 20);
  needs("writable_files", !claims.writable_files.empty(), 21);
  needs("queues", !claims.queues.empty(), 24);
  claims.answer_within = in_milliseconds(p.answer_within);
  claims.patience = in_milliseconds(p.patience);
  claims.character = p.character;
  return claims;
}

}  // namespace

void visit(fields::Visitor& v, ModbusProfile& p) {
  v.integer("unit", p.unit, {0, 255}, "Unit identifier; on a serial line the address, 1 to 247.");
  v.number_list("functions", p.functions, plain().between(1, 127), "Function codes that it has.");
  v.texts("coils", p.coils, "Coils, by their addresses as on the wire, from 0: \"0-15\", \"20\".");
  v.texts("discrete_inputs", p.discrete_inputs, "Discrete inputs, written like coils.");
  v.texts("holding_registers", p.holding_registers, "Holding registers, written like coils.");
  v.texts("input_registers", p.input_registers, "Input registers, written like coils.");
  v.texts("writable_coils", p.writable_coils,
          "Coils that may be turned over and back without anything moving.");
  v.texts(
      "writable_registers", p.writable_registers,
      "Holding registers whose lowest bit may be turned over and back without anything moving.");
  v.texts("files", p.files, "Records that function 20 reads, of a file: \"4:0-9\".");
  v.texts("writable_files", p.writable_files,
          "Records of files that may be changed and put back without anything moving.");
  v.number_list("queues", p.queues, plain().between(0, 65'535),
                "Addresses of queues that function 24 reads.");
  v.duration("answer_within", p.answer_within, kSoon, "99 of 100 answers come within this.");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
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

void visit(fields::Visitor& v, UbxProfile& p) {
  v.texts("messages", p.claims.messages,
          "Messages that a poll is answered with: NAV-PVT, MON-VER, CFG-RATE.");
  v.number("rate", p.claims.rate_hz, fields::in("Hz").between(0, 100),
           "Navigation epochs per second as it is set; 0 = not claimed.");
  v.duration("answer_within", p.answer_within, kSoon, "99 of 100 answers come within this.");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
}

void validate(const UbxProfile& p) {
  for (const std::string& name : p.claims.messages) {
    const conform::UbxMessage* const known = conform::ubx_message(name);
    if (known == nullptr || known->poll == conform::UbxPoll::none) {
      throw std::invalid_argument("messages: found \"" + name +
                                  "\", allowed messages that can be polled, NAV-PVT");
    }
  }
}

void visit(fields::Visitor& v, CanopenProfile& p) {
  v.integer("node", p.node, {1, 127}, "Node-ID.");
  v.texts("objects", p.objects,
          "Objects that can be read: index in hexadecimal, sub-index, \"1018:1\".");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
}

void validate(const CanopenProfile& p) {
  static_cast<void>(claims_of(p));
}

void visit(fields::Visitor& v, J1939Profile& p) {
  v.integer("address", p.address, {0, 253}, "Source address.");
  v.texts("periodic", p.periodic, "Groups that come by themselves: \"61444 every 20 ms\".");
  v.number_list("requested", p.requested, plain().between(0, kGreatestGroup),
                "Groups that a request is answered with.");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
}

void validate(const J1939Profile& p) {
  static_cast<void>(claims_of(p));
}

void visit(fields::Visitor& v, IsoValveProfile& p) {
  v.integer("address", p.address, {0, 253}, "Source address.");
  v.integer("first_valve", p.first_valve, {0, kLastValve}, "Number of the first auxiliary valve.");
  v.integer("valves", p.valves, {1, kLastValve + 1}, "Auxiliary valves, numbered one by one.");
  v.integer("function", p.function, {-1, 255}, "Function in the NAME; -1 = not claimed.");
  v.boolean("measured_flow", p.measured_flow, "It sends measured flow.");
  v.duration("command_timeout", p.command_timeout, {0, kSoon.upper_ns},
             "Without a command for this long a valve goes to neutral; 0 = not claimed.");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
}

void validate(const IsoValveProfile& p) {
  if (p.first_valve + p.valves > kLastValve + 1) {
    throw std::invalid_argument(fmt::format("valves: found {} from {} on, allowed up to valve {}",
                                            p.valves, p.first_valve, kLastValve));
  }
}

void visit(fields::Visitor& v, VelodyneProfile& p) {
  v.text("model", p.claims.model, "Name in its data sheet: HDL-32E; empty = by its packets.");
  v.text("return_mode", p.claims.return_mode, "strongest, last or dual; empty = not claimed.");
  v.number("rotor_speed", p.claims.rotor_rpm, fields::in("rpm").stored_as("rpm").between(0, 1200),
           "Speed that the rotor is set to; 0 = not claimed.");
  v.integer("view_start", p.claims.view_start_deg, {0, 359}, "Begin of the view, degrees.");
  v.integer("view_end", p.claims.view_end_deg, {0, 359},
            "End of the view, degrees, included; from 0 to 359 all round.");
  v.integer("position_port", p.claims.position_port, {0, 65535},
            "UDP port that position packets are sent to; 0 = they are not listened to.");
  v.text("pulse", p.claims.pulse,
         "State of the pulse per second: absent, synchronizing or locked; empty = not claimed.");
}

void validate(const VelodyneProfile& p) {
  const auto among = [](const char* key, const std::string& found,
                        const std::vector<std::string>& allowed) {
    std::string all;
    for (const std::string& each : allowed) {
      all += (all.empty() ? "" : ", ") + each;
    }
    if (!found.empty() && std::ranges::find(allowed, found) == allowed.end()) {
      throw std::invalid_argument(fmt::format("{}: found \"{}\", allowed {}", key, found, all));
    }
  };
  std::vector<std::string> models;
  for (const protocols::velodyne::Model& model : protocols::velodyne::models()) {
    if (std::ranges::find(models, model.name) == models.end()) {
      models.emplace_back(model.name);
    }
  }
  among("model", p.claims.model, models);
  among("return_mode", p.claims.return_mode, {"strongest", "last", "dual"});
  among("pulse", p.claims.pulse, {"absent", "synchronizing", "locked"});
}

void visit(fields::Visitor& v, GigeVisionProfile& p) {
  v.text("acquisition_start", p.acquisition_start,
         "Register that begins the acquisition, and what is written there: \"0xA104 = 1\".");
  v.text("acquisition_stop", p.acquisition_stop, "Register that ends it, likewise.");
  v.text("payload_size", p.payload_size, "Register of the bytes of a block: \"0xA03C\".");
  v.number("rate", p.rate_hz, fields::in("Hz").between(0, 10'000),
           "Pictures per second while it acquires; 0: not claimed.");
  v.duration("answer_within", p.answer_within, kSoon, "99 of 100 answers come within this.");
  v.duration("patience", p.patience, kSoon, "Longest wait for an answer.");
}

void validate(const GigeVisionProfile& p) {
  static_cast<void>(claims_of(p));
}

conform::ModbusClaims read_modbus_profile(const std::string& file) {
  return claims_of(read_structure<ModbusProfile>(file));
}

conform::NmeaClaims read_nmea_profile(const std::string& file) {
  return read_structure<NmeaProfile>(file).claims;
}

conform::UbxClaims read_ubx_profile(const std::string& file) {
  const auto profile = read_structure<UbxProfile>(file);
  conform::UbxClaims claims = profile.claims;
  claims.answer_within = in_milliseconds(profile.answer_within);
  claims.patience = in_milliseconds(profile.patience);
  return claims;
}

conform::CanopenClaims read_canopen_profile(const std::string& file) {
  return claims_of(read_structure<CanopenProfile>(file));
}

conform::J1939Claims read_j1939_profile(const std::string& file) {
  return claims_of(read_structure<J1939Profile>(file));
}

conform::IsoValveClaims read_iso_valve_profile(const std::string& file) {
  const auto p = read_structure<IsoValveProfile>(file);
  conform::IsoValveClaims claims;
  claims.address = p.address;
  claims.first_valve = p.first_valve;
  claims.valves = p.valves;
  if (p.function >= 0) {
    claims.function = static_cast<std::uint8_t>(p.function);
  }
  claims.measured_flow = p.measured_flow;
  claims.command_timeout = in_milliseconds(p.command_timeout);
  claims.patience = in_milliseconds(p.patience);
  return claims;
}

conform::VelodyneClaims read_velodyne_profile(const std::string& file) {
  return read_structure<VelodyneProfile>(file).claims;
}

conform::GigeVisionClaims read_gige_vision_profile(const std::string& file) {
  return claims_of(read_structure<GigeVisionProfile>(file));
}

std::string hash_of(const std::string& profile_text) {
  return fmt::format("{:016x}", fnv1a(profile_text));
}

std::string profile_text(const conform::NmeaClaims& claims, const std::string& endpoint) {
  return begin_of(endpoint) + fmt::format("sentences: [{}]\nrate: {} Hz\n",
                                          names_text(claims.sentences, 12), claims.rate_hz);
}

std::string profile_text(const conform::UbxClaims& claims, const std::string& endpoint) {
  return begin_of(endpoint) +
         fmt::format("messages: [{}]\nrate: {} Hz\nanswer_within: {} ms\npatience: {} ms\n",
                     names_text(claims.messages, 11), claims.rate_hz, claims.answer_within.count(),
                     claims.patience.count());
}

std::string profile_text(const conform::VelodyneClaims& claims, const std::string& endpoint) {
  return begin_of(endpoint) +
         fmt::format(
             "model: \"{}\"\nreturn_mode: \"{}\"\nrotor_speed: {} rpm\nview_start: {}\n"
             "view_end: {}\nposition_port: {}\npulse: \"{}\"\n",
             claims.model, claims.return_mode, claims.rotor_rpm, claims.view_start_deg,
             claims.view_end_deg, claims.position_port, claims.pulse);
}

std::string profile_text(const conform::GigeVisionClaims& claims, const std::string& endpoint) {
  const auto line = [](const char* key, const std::optional<conform::GigeRegister>& each) {
    return each ? fmt::format("{}: \"0x{:04X} = {}\"\n", key, each->address, each->value) : "";
  };
  std::string text = begin_of(endpoint) + line("acquisition_start", claims.start) +
                     line("acquisition_stop", claims.stop);
  if (claims.payload_size) {
    text += fmt::format("payload_size: \"0x{:04X}\"\n", *claims.payload_size);
  }
  return text + fmt::format("rate: {} Hz\nanswer_within: {} ms\npatience: {} ms\n", claims.rate_hz,
                            claims.answer_within.count(), claims.patience.count());
}

std::string profile_text(const conform::CanopenClaims& claims, const std::string& endpoint) {
  std::vector<std::string> objects;
  for (const conform::ObjectName object : claims.objects) {
    objects.push_back("\"" + text_of(object) + "\"");
  }
  return begin_of(endpoint) + fmt::format("node: {}\nobjects: [{}]\npatience: {} ms\n", claims.node,
                                          names_text(objects, 10), claims.patience.count());
}

std::string profile_text(const conform::J1939Claims& claims, const std::string& endpoint) {
  std::vector<std::string> periodic;
  for (const conform::PeriodicGroup& group : claims.periodic) {
    periodic.push_back(fmt::format("\"{} every {} ms\"", group.pgn, group.period.count()));
  }
  std::vector<std::string> requested;
  for (const std::uint32_t group : claims.requested) {
    requested.push_back(std::to_string(group));
  }
  return begin_of(endpoint) +
         fmt::format("address: {}\nperiodic: [{}]\nrequested: [{}]\npatience: {} ms\n",
                     claims.address, names_text(periodic, 11), names_text(requested, 12),
                     claims.patience.count());
}

std::string profile_text(const conform::IsoValveClaims& claims, const std::string& endpoint) {
  return begin_of(endpoint) +
         (endpoint.empty() ? ""
                           : "# The time-out of commands was not asked for: name it yourself.\n") +
         fmt::format(
             "address: {}\nfirst_valve: {}\nvalves: {}\nfunction: {}\nmeasured_flow: {}\n"
             "command_timeout: {} ms\npatience: {} ms\n",
             claims.address, claims.first_valve, claims.valves,
             claims.function ? int{*claims.function} : -1, claims.measured_flow,
             claims.command_timeout.count(), claims.patience.count());
}

std::string profile_text(const conform::ModbusClaims& claims, const std::string& endpoint) {
  std::string text = begin_of(endpoint);
  if (!endpoint.empty()) {
    text += "# Nothing may be written: name writable_coils and writable_registers yourself.\n";
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
  const auto put_records = [&](std::string_view key,
                               const std::vector<conform::RecordRange>& ranges) {
    for (const conform::RecordRange& range : ranges) {
      text += &range == ranges.data() ? fmt::format("{}: [", key) : std::string(", ");
      text += "\"" + text_of(range) + "\"" + (&range == &ranges.back() ? "]\n" : "");
    }
  };
  put_records("files", claims.files);
  put_records("writable_files", claims.writable_files);
  if (!claims.queues.empty()) {
    text += fmt::format("queues: [{}]\n", fmt::join(claims.queues, ", "));
  }
  text += fmt::format("answer_within: {} ms\npatience: {} ms\n", claims.answer_within.count(),
                      claims.patience.count());
  const auto* const character =
      std::ranges::find(kCharacters, claims.character, &Choice<SerialCharacter>::value);
  return text + fmt::format("character: {}\n", character->name);
}

}  // namespace rigwire::hil
