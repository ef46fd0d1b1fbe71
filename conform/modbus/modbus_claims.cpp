#include "conform/modbus/modbus_claims.h"

namespace rigwire::conform {

bool ModbusClaims::claims(protocols::modbus::Table which, std::uint32_t address) const {
  return std::ranges::any_of(table(which),
                             [&](const AddressRange& range) { return range.holds(address); });
}

std::optional<std::uint16_t> ModbusClaims::outside(protocols::modbus::Table which) const {
  const std::vector<AddressRange>& ranges = table(which);
  const std::uint32_t after = ranges.empty() ? 0 : std::uint32_t{ranges.back().last} + 1U;
  for (std::uint32_t i = 0; i < protocols::modbus::kTableSize; ++i) {
    const std::uint32_t address = (after + i) % protocols::modbus::kTableSize;
    if (!claims(which, address)) {
      return static_cast<std::uint16_t>(address);
    }
  }
  return std::nullopt;
}

}  // namespace rigwire::conform
