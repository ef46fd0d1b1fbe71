#include "protocols/modbus/register_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>

namespace rigwire::protocols::modbus {

std::optional<RegisterPlace> find_register(std::span<const RegisterEntry> map, Table table,
                                           std::uint16_t address) {
  for (const RegisterEntry& entry : map) {
    if (entry.table != table || address < entry.address) {
      continue;
    }
    const int offset = address - entry.address;
    const int index = offset / entry.stride;
    const int word = offset % entry.stride;
    if (index < entry.count && word < words_of(entry.format)) {
      return RegisterPlace{&entry, static_cast<std::uint16_t>(index),
                           static_cast<std::uint16_t>(word)};
    }
  }
  return std::nullopt;
}

const RegisterEntry* find_register(std::span<const RegisterEntry> map, std::string_view name) {
  const auto found = std::ranges::find(map, name, &RegisterEntry::name);
  return found == map.end() ? nullptr : &*found;
}

std::int32_t to_counts(const RegisterEntry& entry, double value) {
  assert(std::isfinite(value));
  const double counts = std::round(value / entry.scale);
  return static_cast<std::int32_t>(
      std::clamp(counts, static_cast<double>(entry.lower), static_cast<double>(entry.upper)));
}

std::int32_t signed_value(const RegisterEntry& entry, std::uint16_t raw) {
  return entry.format == Format::s16 ? static_cast<std::int16_t>(raw) : raw;
}

double to_physical(const RegisterEntry& entry, std::int32_t counts) {
  return counts * entry.scale;
}

std::string markdown_row(const RegisterEntry& entry) {
  std::string place = std::to_string(entry.address);
  if (entry.count > 1 && entry.stride == 1) {
    place.append("-").append(std::to_string(entry.address + entry.count - 1));
  } else if (entry.count > 1) {
    place.append(" + ").append(std::to_string(entry.stride)).append(" k");
  } else if (entry.format == Format::s32) {
    place.append("-").append(std::to_string(entry.address + 1));
  }
  char scale[32] = "";
  if (!entry.unit.empty()) {
    std::snprintf(scale, sizeof scale, "%g ", entry.scale);
  }
  constexpr std::string_view kFormats[] = {"bit", "u16", "s16", "s32"};
  std::string row = "|";
  const auto cell = [&row](std::string_view text) {
    row.append(text.empty() ? "" : " ").append(text).append(" |");
  };
  cell(place);
  cell(std::string("`").append(entry.name).append("`"));
  cell(kFormats[static_cast<std::size_t>(entry.format)]);
  cell(std::string(scale).append(entry.unit));
  cell(std::to_string(entry.lower).append(" .. ").append(std::to_string(entry.upper)));
  cell(std::to_string(entry.initial));
  cell(entry.text);
  return row;
}

}  // namespace rigwire::protocols::modbus
