#include "emulators/valve_driver/register_image.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rigwire::emulators {

std::uint16_t in_order(const ValveRegister& entry, std::uint16_t word) {
  return entry.bytes == ByteOrder::high_first
             ? word
             : static_cast<std::uint16_t>((word << 8U) | (word >> 8U));
}

RegisterWords encode_count(const ValveRegister& entry, double count) {
  std::uint32_t raw = 0;
  if (entry.format == RegisterFormat::f32) {
    raw = std::bit_cast<std::uint32_t>(static_cast<float>(
        std::isnan(count) ? count : std::clamp(count, entry.least(), entry.greatest())));
  } else if (!std::isnan(count)) {
    const double whole = std::round(count);
    const double held = std::ranges::find(entry.also, whole) != entry.also.end()
                            ? whole
                            : std::clamp(whole, entry.least(), entry.greatest());
    raw = static_cast<std::uint32_t>(static_cast<std::int64_t>(held));
  }
  const std::uint16_t high = in_order(entry, static_cast<std::uint16_t>(raw >> 16U));
  const std::uint16_t low = in_order(entry, static_cast<std::uint16_t>(raw & 0xFFFFU));
  if (entry.words() == 1) {
    return {low, 0};
  }
  return entry.order == WordOrder::high_first ? RegisterWords{high, low} : RegisterWords{low, high};
}

std::optional<double> decode_count(const ValveRegister& entry, const RegisterWords& words) {
  const bool high_first = entry.order == WordOrder::high_first;
  const std::uint32_t first = in_order(entry, words[0]);
  const std::uint32_t second = in_order(entry, words[1]);
  const std::uint32_t raw = entry.words() == 1 ? first
                            : high_first       ? first << 16U | second
                                               : second << 16U | first;
  switch (entry.format) {
    case RegisterFormat::s16:
      return static_cast<std::int16_t>(raw);
    case RegisterFormat::s32:
      return static_cast<std::int32_t>(raw);
    case RegisterFormat::f32: {
      const auto value = static_cast<double>(std::bit_cast<float>(raw));
      return std::isfinite(value) ? std::optional(value) : std::nullopt;
    }
    default:
      return raw;
  }
}

RegisterImage::RegisterImage(const ValveMap& map) {
  for (const ValveRegister& entry : map.registers) {
    auto& cells = cells_[static_cast<std::size_t>(entry.table)];
    for (std::uint16_t index = 0; index < entry.count; ++index) {
      for (std::uint16_t word = 0; word < entry.words(); ++word) {
        const auto address =
            static_cast<std::uint16_t>(entry.address + index * entry.step() + word);
        cells.push_back({address, index, word, &entry, 0});
      }
    }
  }
  for (auto& cells : cells_) {
    std::ranges::sort(cells, {}, &Cell::address);
  }
}

const RegisterImage::Cell* RegisterImage::cell_at(ModbusTable table, std::size_t address) const {
  const auto& of = cells(table);
  const auto found = std::ranges::lower_bound(of, address, {}, &Cell::address);
  return found == of.end() || found->address != address ? nullptr : &*found;
}

std::optional<RegisterImage::Place> RegisterImage::find(ModbusTable table,
                                                        std::size_t address) const {
  const Cell* cell = cell_at(table, address);
  if (cell == nullptr) {
    return std::nullopt;
  }
  const auto at = static_cast<std::size_t>(cell - cells(table).data());
  return Place{cell->entry, cell->index, cell->word, at - cell->word};
}

bool RegisterImage::within(ModbusTable table, std::size_t address, std::size_t count) const {
  return address + count <= end(table);
}

std::size_t RegisterImage::end(ModbusTable table) const {
  return has(table) ? cells(table).back().address + 1U : 0U;
}

std::size_t RegisterImage::cell_of(const ValveRegister& entry, std::size_t index) const {
  const Cell* cell = cell_at(entry.table, entry.address + index * entry.step());
  return static_cast<std::size_t>(cell - cells(entry.table).data());
}

RegisterWords RegisterImage::words(const Place& place) const {
  const auto& of = cells(place.entry->table);
  return {of[place.cell].value,
          place.entry->words() == 2 ? of[place.cell + 1].value : std::uint16_t{0}};
}

RegisterWords RegisterImage::words(const ValveRegister& entry, std::size_t index) const {
  return words(Place{&entry, static_cast<std::uint16_t>(index), 0, cell_of(entry, index)});
}

void RegisterImage::set(const ValveRegister& entry, std::size_t index, const RegisterWords& words) {
  auto& of = cells_[static_cast<std::size_t>(entry.table)];
  const std::size_t cell = cell_of(entry, index);
  of[cell].value = words[0];
  if (entry.words() == 2) {
    of[cell + 1].value = words[1];
  }
}

double RegisterImage::count(const ValveRegister& entry, std::size_t index) const {
  return decode_count(entry, words(entry, index)).value_or(0.0);
}

}  // namespace rigwire::emulators
