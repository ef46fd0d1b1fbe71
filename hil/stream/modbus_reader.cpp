#include "hil/stream/modbus_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <type_traits>
#include <variant>

#include "protocols/bytes.h"
#include "protocols/modbus/function_names.h"
#include "protocols/modbus/mbap.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::hil {
namespace {

namespace modbus = protocols::modbus;
using emulators::ModbusTable;
using emulators::ValveRegister;
using Bytes = std::span<const std::uint8_t>;

// Offsets within a PDU (protocols/modbus/pdu.h).
constexpr std::size_t kAddress = 1;
constexpr std::size_t kQuantity = 3;
constexpr std::size_t kWriteByteCount = 5;
constexpr std::size_t kWriteData = 6;
constexpr std::size_t kReadWriteByteCount = 9;
constexpr std::size_t kReadWriteData = 10;
constexpr std::size_t kAnswerData = 2;
constexpr std::uint16_t kSerialTransaction = 0;

ModbusTable table_of(modbus::RegisterTable table) {
  return table == modbus::RegisterTable::holding ? ModbusTable::holding_registers
                                                 : ModbusTable::input_registers;
}
ModbusTable table_of(modbus::BitTable table) {
  return table == modbus::BitTable::coils ? ModbusTable::coils : ModbusTable::discrete_inputs;
}
bool has_bits(ModbusTable table) {
  return table == ModbusTable::coils || table == ModbusTable::discrete_inputs;
}

std::string words_of(std::uint8_t code) {
  const modbus::FunctionName* const name = modbus::find_function_name(code);
  return name == nullptr
             ? fmt::format("function {}", code)
             : fmt::format("{}{}{}", name->verb, name->items.empty() ? "" : " ", name->items);
}

/// With its name in the row where there are several: that of a section, or a number.
std::string name_of(const ValveRegister& entry, std::size_t index,
                    const std::vector<std::string>& sections) {
  const bool whole = entry.format == emulators::RegisterFormat::text;
  if (whole || (entry.count <= 1 && !emulators::info(entry.signal).per_section)) {
    return entry.name;
  }
  const std::size_t section = entry.section + index;
  return emulators::info(entry.signal).per_section && section < sections.size()
             ? fmt::format("{}[{}]", entry.name, sections[section])
             : fmt::format("{}[{}]", entry.name, index + 1);
}

std::string value_text(const ValveRegister& entry, double value) {
  return fmt::format("{:.6g}{}{}", value, entry.unit.empty() ? "" : " ", entry.unit);
}

}  // namespace

ModbusReader::ModbusReader(Line line, std::vector<NamedUnit> units) : line_(line) {
  for (NamedUnit& unit : units) {
    add_rows(units_.emplace_back(std::move(unit)));
  }
}

void ModbusReader::add_rows(Unit& unit) {
  for (const ValveRegister& entry : unit.about.map.registers) {
    if (entry.format == emulators::RegisterFormat::text) {
      continue;
    }
    for (std::uint16_t index = 0; index < entry.count; ++index) {
      unit.rows[{&entry, index}] = rows_.size();
      rows_.push_back({&unit,
                       &entry,
                       static_cast<std::uint16_t>(entry.address + index * entry.step()),
                       entry.section + index,
                       name_of(entry, index, unit.about.sections),
                       {},
                       {},
                       {},
                       {}});
    }
  }
}

ModbusReader::Unit* ModbusReader::find(std::uint8_t number) {
  // On TCP the first unit is also the server itself (emulators/modbus/modbus_server.h).
  const bool itself = line_ == Line::tcp && (number == 0 || number == 0xFF);
  const auto found = std::ranges::find_if(
      units_, [&](const Unit& unit) { return itself || unit.about.number == number; });
  return found == units_.end() ? nullptr : &*found;
}

void ModbusReader::take(SimTime at, std::uint64_t connection, bool of_client,
                        std::span<const std::uint8_t> bytes, const Use& use) {
  if (line_ == Line::rtu) {
    kept_.erase({connection, !of_client});  // who speaks now ends what the other one said
  }
  auto& kept = kept_[{connection, of_client}];
  kept.insert(kept.end(), bytes.begin(), bytes.end());
  std::size_t at_byte = 0;
  while (at_byte < kept.size()) {
    const auto rest = Bytes(kept).subspan(at_byte);
    const std::size_t used = line_ == Line::tcp ? take_tcp(at, connection, of_client, rest, use)
                                                : take_rtu(at, of_client, rest, use);
    if (used == 0) {
      break;
    }
    at_byte += used;
  }
  kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(at_byte));
  if (kept_.size() > 2 * kMostConnections) {
    kept_.erase(kept_.begin());
  }
}

std::size_t ModbusReader::take_tcp(SimTime at, std::uint64_t connection, bool of_client,
                                   std::span<const std::uint8_t> bytes, const Use& use) {
  const auto adu = modbus::decode_adu(bytes);
  if (!adu.ok()) {
    // Nothing behind a wrong length can be trusted; a new piece begins a message again.
    return adu.incomplete() ? 0 : bytes.size();
  }
  const modbus::MbapHeader& header = adu->header;
  WireReading reading{{},
                      {{"transaction", std::to_string(header.transaction), 0, 2},
                       {"protocol", std::to_string(header.protocol), 2, 2},
                       {"length", std::to_string(1 + adu->pdu.size()), 4, 2},
                       {"unit", std::to_string(header.unit), 6, 1}}};
  read(at, {connection, header.transaction}, of_client, header.unit, adu->pdu,
       modbus::kMbapHeaderSize, reading);
  use(bytes.first(adu.consumed()), reading);
  return adu.consumed();
}

std::size_t ModbusReader::take_rtu(SimTime at, bool of_client, std::span<const std::uint8_t> bytes,
                                   const Use& use) {
  const auto frame = modbus::decode_rtu(bytes);
  if (!frame.ok()) {
    return bytes.size() > modbus::kRtuFrameMaximum ? bytes.size() : 0;
  }
  WireReading reading{{}, {{"address", std::to_string(frame->address), 0, 1}}};
  read(at, {0, kSerialTransaction}, of_client, frame->address, frame->pdu, modbus::kRtuAddressSize,
       reading);
  reading.fields.push_back(
      {"check", "", bytes.size() - modbus::kRtuCheckSize, modbus::kRtuCheckSize});
  use(bytes, reading);
  return bytes.size();
}

void ModbusReader::read(SimTime at, Exchange exchange, bool of_client, std::uint8_t number,
                        std::span<const std::uint8_t> pdu, std::size_t from, WireReading& reading) {
  Unit* const unit = find(number);
  const auto code = static_cast<std::uint8_t>(pdu[0] & ~modbus::kExceptionFlag);
  reading.text =
      fmt::format("unit {}: {}{}", number, of_client ? "" : "answer to ", words_of(code));
  reading.fields.push_back({"function", words_of(code), from, 1});
  if (of_client) {
    read_request(exchange, unit, pdu, from, reading);
  } else {
    read_answer(at, exchange, unit, pdu, from, reading);
  }
}

void ModbusReader::read_request(Exchange exchange, Unit* unit, std::span<const std::uint8_t> pdu,
                                std::size_t from, WireReading& reading) {
  const auto decoded = modbus::decode_request(pdu);
  if (const auto* const refusal = std::get_if<modbus::Refusal>(&decoded)) {
    reading.text += fmt::format(", to be refused: {}", modbus::exception_text(refusal->code));
    return;
  }
  const modbus::Request& request = std::get<modbus::Request>(decoded);
  const auto word = [&](std::string name, std::size_t place) {
    reading.fields.push_back({std::move(name),
                              std::to_string(protocols::load_big<std::uint16_t>(pdu, place)),
                              from + place, 2});
  };
  const auto written = [&](ModbusTable table, std::size_t address, std::size_t count,
                           std::size_t place) {
    read_values(unit, {table, address, count}, pdu.subspan(place), from + place, {}, reading);
  };
  const auto range = [&](std::size_t address, std::size_t count) {
    reading.text += count == 1 ? fmt::format(" {}", address)
                               : fmt::format(" {} .. {}", address, address + count - 1);
  };
  std::visit(
      [&]<class Each>(const Each& each) {
        if constexpr (requires { each.read_address; }) {
          range(each.read_address, each.read_quantity);
          word("first address to read", kAddress);
          word("quantity to read", kQuantity);
          word("first address to write", kAddress + 4);
          word("quantity to write", kQuantity + 4);
          reading.fields.push_back({"bytes that follow", std::to_string(pdu[kReadWriteByteCount]),
                                    from + kReadWriteByteCount, 1});
          written(ModbusTable::holding_registers, each.write_address, each.registers.count,
                  kReadWriteData);
        } else if constexpr (requires { each.and_mask; }) {
          range(each.address, 1);
          word("address", kAddress);
          word("and mask", kQuantity);
          word("or mask", kQuantity + 2);
        } else if constexpr (requires { each.quantity; }) {
          range(each.address, each.quantity);
          word("first address", kAddress);
          word("quantity", kQuantity);
        } else if constexpr (std::is_same_v<Each, modbus::WriteCoil>) {
          range(each.address, 1);
          word("address", kAddress);
          written(ModbusTable::coils, each.address, 1, kQuantity);
        } else if constexpr (std::is_same_v<Each, modbus::WriteRegister>) {
          range(each.address, 1);
          word("address", kAddress);
          written(ModbusTable::holding_registers, each.address, 1, kQuantity);
        } else if constexpr (requires { each.address; }) {
          const std::size_t count = protocols::load_big<std::uint16_t>(pdu, kQuantity);
          constexpr bool kBits = std::is_same_v<Each, modbus::WriteCoils>;
          range(each.address, count);
          word("first address", kAddress);
          word("quantity", kQuantity);
          reading.fields.push_back({"bytes that follow", std::to_string(pdu[kWriteByteCount]),
                                    from + kWriteByteCount, 1});
          written(kBits ? ModbusTable::coils : ModbusTable::holding_registers, each.address, count,
                  kWriteData);
        }
      },
      request);
  if (pending_.size() >= kMostPending) {
    pending_.erase(pending_.begin());
  }
  pending_[exchange] = request;
}

void ModbusReader::read_answer(SimTime at, Exchange exchange, Unit* unit,
                               std::span<const std::uint8_t> pdu, std::size_t from,
                               WireReading& reading) {
  const auto asked = pending_.extract(exchange);
  const auto decoded = modbus::decode_response(pdu);
  if (!decoded.ok()) {
    return;
  }
  if (const auto* const exception = std::get_if<modbus::ExceptionResponse>(&*decoded)) {
    const char* const text = modbus::exception_text(exception->code);
    reading.text += fmt::format(": exception {:02}, {}", static_cast<int>(exception->code), text);
    reading.fields.push_back({"exception", text, from + 1, 1});
    return;
  }
  if (asked.empty() || unit == nullptr) {
    return;
  }
  const modbus::Request& request = asked.mapped();
  const auto values = [&](Span span) {
    reading.fields.push_back({"bytes that follow", std::to_string(pdu[1]), from + 1, 1});
    read_values(unit, span, pdu.subspan(kAnswerData), from + kAnswerData, at, reading);
  };
  const auto* const registers = std::get_if<modbus::RegistersResponse>(&*decoded);
  if (const auto* const read = std::get_if<modbus::ReadRegisters>(&request);
      read != nullptr && registers != nullptr && registers->registers.count == read->quantity) {
    values({table_of(read->table), read->address, read->quantity});
  } else if (const auto* const both = std::get_if<modbus::ReadWriteRegisters>(&request);
             both != nullptr && registers != nullptr &&
             registers->registers.count == both->read_quantity) {
    note_written(at, exchange, *unit, request);
    values({ModbusTable::holding_registers, both->read_address, both->read_quantity});
  } else if (const auto* const bits = std::get_if<modbus::ReadBits>(&request);
             bits != nullptr && std::holds_alternative<modbus::ReadBitsResponse>(*decoded)) {
    values({table_of(bits->table), bits->address, bits->quantity});
  } else if (pdu[0] == modbus::encode_request(request).view().front() &&
             std::visit(
                 [](const auto& answer) {
                   return requires {
                     answer.address;
                   };
                 },
                 *decoded)) {
    const auto address = protocols::load_big<std::uint16_t>(pdu, kAddress);
    reading.fields.push_back({"address", std::to_string(address), from + kAddress, 2});
    reading.fields.push_back({"as in the request", "", from + kQuantity, pdu.size() - kQuantity});
    note_written(at, exchange, *unit, request);
  }
}

void ModbusReader::read_values(Unit* unit, Span span, std::span<const std::uint8_t> data,
                               std::size_t from, std::optional<SimTime> seen,
                               WireReading& reading) {
  const bool bits = has_bits(span.table);
  const bool mirrored = unit != nullptr && span.table == ModbusTable::holding_registers &&
                        unit->about.map.input_mirror &&
                        span.address >= *unit->about.map.input_mirror;
  const ModbusTable table = mirrored ? ModbusTable::input_registers : span.table;
  const std::size_t first = mirrored ? span.address - *unit->about.map.input_mirror : span.address;
  std::size_t next = 0;
  while (next < span.count) {
    const std::size_t place = bits ? next / 8 : 2 * next;
    if (place + (bits ? 1 : 2) > data.size()) {
      return;
    }
    const auto found = unit == nullptr ? std::nullopt : unit->image.find(table, first + next);
    const std::size_t words = found && !bits ? found->entry->words() : 1;
    const bool whole = found && found->word == 0 && next + words <= span.count &&
                       place + (bits ? 1 : 2 * words) <= data.size();
    if (!whole) {
      const unsigned raw =
          bits ? data[place] >> (next % 8) & 1U : protocols::load_big<std::uint16_t>(data, place);
      reading.fields.push_back(
          {fmt::format("{} {}", bits ? "bit" : "register", span.address + next),
           std::to_string(raw), from + place, bits ? 1U : 2U});
      ++next;
      continue;
    }
    emulators::RegisterWords told{};
    for (std::size_t word = 0; word < words; ++word) {
      told[word] = bits ? static_cast<std::uint16_t>(data[place] >> (next % 8) & 1U)
                        : protocols::load_big<std::uint16_t>(data, place + 2 * word);
    }
    const ValveRegister& entry = *found->entry;
    const auto count = emulators::decode_count(entry, told);
    const std::string name = name_of(entry, found->index, unit->about.sections);
    std::string text = "no number";
    if (count) {
      const double value = *count * entry.scale + entry.offset;
      text = value_text(entry, value);
      if (const auto row = unit->rows.find({&entry, found->index});
          seen && row != unit->rows.end()) {
        rows_[row->second].value = value;
        rows_[row->second].seen = *seen;
      }
    }
    reading.text += fmt::format(" {}={}", name, text);
    reading.fields.push_back({name, text, from + place, bits ? 1U : 2U * words});
    next += words;
  }
}

void ModbusReader::note_written(SimTime at, Exchange exchange, Unit& unit,
                                const modbus::Request& request) {
  // Encode the request again to read the written values from its bytes.
  const modbus::Pdu pdu = modbus::encode_request(request);
  const auto mark = [&](Span span) {
    for (std::size_t i = 0; i < span.count; ++i) {
      const auto found = unit.image.find(span.table, span.address + i);
      const auto row = found ? unit.rows.find({found->entry, found->index}) : unit.rows.end();
      if (row != unit.rows.end()) {
        rows_[row->second].by =
            line_ == Line::tcp ? fmt::format("client {}", exchange.first) : "the client";
        rows_[row->second].written = at;
      }
    }
  };
  const auto enter = [&](Span span, std::size_t place) {
    WireReading unused;
    read_values(&unit, span, pdu.view().subspan(place), place, at, unused);
    mark(span);
  };
  if (const auto* const one = std::get_if<modbus::WriteRegister>(&request)) {
    enter({ModbusTable::holding_registers, one->address, 1}, kQuantity);
  } else if (const auto* const many = std::get_if<modbus::WriteRegisters>(&request)) {
    enter({ModbusTable::holding_registers, many->address, many->registers.count}, kWriteData);
  } else if (const auto* const both = std::get_if<modbus::ReadWriteRegisters>(&request)) {
    enter({ModbusTable::holding_registers, both->write_address, both->registers.count},
          kReadWriteData);
  } else if (const auto* const mask = std::get_if<modbus::MaskWriteRegister>(&request)) {
    mark({ModbusTable::holding_registers, mask->address, 1});  // what came of it a read will show
  } else if (const auto* const coil = std::get_if<modbus::WriteCoil>(&request)) {
    enter({ModbusTable::coils, coil->address, 1}, kQuantity);
  } else if (const auto* const coils = std::get_if<modbus::WriteCoils>(&request)) {
    enter({ModbusTable::coils, coils->address, coils->coils.count}, kWriteData);
  }
}

std::string ModbusReader::registers() const {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows_) {
    auto& told = list.emplace_back(
        nlohmann::ordered_json{{"device", row.unit->about.device},
                               {"table", emulators::name_of(row.entry->table)},
                               {"address", row.address},
                               {"name", row.name},
                               {"unit", row.entry->unit},
                               {"signal", emulators::info(row.entry->signal).name},
                               {"text", row.entry->text}});
    if (const auto& sections = row.unit->about.sections;
        emulators::info(row.entry->signal).per_section && row.section < sections.size()) {
      told["section"] = sections[row.section];
    }
    if (row.value) {
      told["value"] = *row.value;
      told["seen_ns"] = row.seen.time_since_epoch().count();
    }
    if (!row.by.empty()) {
      told["by"] = row.by;
      told["written_ns"] = row.written.time_since_epoch().count();
    }
  }
  return nlohmann::ordered_json{{"registers", std::move(list)}}.dump(
      -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace rigwire::hil
