// A unit small enough to know by heart, for tests of lines.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/modbus/modbus_unit.h"

namespace rigwire::emulators {

/// Ten coils and ten holding registers at 0, one input register; refuses the value 666.
class SmallUnit final : public ModbusUnit {
  using RegisterTable = protocols::modbus::RegisterTable;
  using BitTable = protocols::modbus::BitTable;
  using BitBlock = protocols::modbus::BitBlock;
  using ExceptionCode = protocols::modbus::ExceptionCode;

 public:
  Outcome read_registers(RegisterTable table, std::uint16_t address,
                         std::span<std::uint16_t> values) const override {
    if (address + values.size() > (table == RegisterTable::input ? 1U : holding.size())) {
      return ExceptionCode::illegal_data_address;
    }
    std::copy_n(holding.begin() + address, values.size(), values.begin());
    return std::nullopt;
  }
  Outcome write_registers(SimTime /*now*/, std::uint16_t address,
                          std::span<const std::uint16_t> values) override {
    if (address + values.size() > holding.size()) {
      return ExceptionCode::illegal_data_address;
    }
    if (std::ranges::count(values, 666) > 0) {
      return ExceptionCode::illegal_data_value;
    }
    std::ranges::copy(values, holding.begin() + address);
    return std::nullopt;
  }
  Outcome read_bits(BitTable /*table*/, std::uint16_t address, BitBlock& bits) const override {
    if (address + bits.count > coils.size()) {
      return ExceptionCode::illegal_data_address;
    }
    for (std::size_t i = 0; i < bits.count; ++i) {
      bits.set(i, coils[address + i]);
    }
    return std::nullopt;
  }
  Outcome write_coils(SimTime /*now*/, std::uint16_t address, const BitBlock& values) override {
    if (address + values.count > coils.size()) {
      return ExceptionCode::illegal_data_address;
    }
    for (std::size_t i = 0; i < values.count; ++i) {
      coils[address + i] = values.test(i);
    }
    return std::nullopt;
  }
  std::string_view server_id() const override { return "small"; }
  std::span<const IdentificationObject> identification() const override { return objects; }
  void served(SimTime now) override {
    ++served_count;
    served_at = now;
  }
  std::uint8_t exception_status() const override { return 0x6D; }

  std::array<std::uint16_t, 10> holding{};
  std::array<bool, 10> coils{};
  std::string long_text = std::string(150, 'n');
  std::vector<IdentificationObject> objects = {
      {0, "vendor"}, {1, "code"}, {2, "1.0"}, {3, long_text}, {4, long_text}};
  int served_count = 0;
  SimTime served_at{};
};

}  // namespace rigwire::emulators
