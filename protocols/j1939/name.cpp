#include "protocols/j1939/name.h"

namespace rigwire::protocols::j1939 {
namespace {

struct Slot {
  unsigned position;
  unsigned width;
};
constexpr Slot kIdentity{0, 21};
constexpr Slot kManufacturer{21, 11};
constexpr Slot kEcuInstance{32, 3};
constexpr Slot kFunctionInstance{35, 5};
constexpr Slot kFunction{40, 8};
constexpr Slot kVehicleSystem{49, 7};
constexpr Slot kSystemInstance{56, 4};
constexpr Slot kIndustryGroup{60, 3};
constexpr Slot kArbitraryAddress{63, 1};

constexpr std::uint64_t put(Slot slot, std::uint64_t value) {
  return (value & ((std::uint64_t{1} << slot.width) - 1U)) << slot.position;
}

template <class Integer>
constexpr Integer get(Slot slot, std::uint64_t bits) {
  return static_cast<Integer>((bits >> slot.position) & ((std::uint64_t{1} << slot.width) - 1U));
}

}  // namespace

std::uint64_t pack(const Name& name) {
  return put(kIdentity, name.identity) | put(kManufacturer, name.manufacturer) |
         put(kEcuInstance, name.ecu_instance) | put(kFunctionInstance, name.function_instance) |
         put(kFunction, name.function) | put(kVehicleSystem, name.vehicle_system) |
         put(kSystemInstance, name.system_instance) | put(kIndustryGroup, name.industry_group) |
         put(kArbitraryAddress, name.arbitrary_address ? 1U : 0U);
}

Name unpack_name(std::uint64_t bits) {
  Name name;
  name.identity = get<std::uint32_t>(kIdentity, bits);
  name.manufacturer = get<std::uint16_t>(kManufacturer, bits);
  name.ecu_instance = get<std::uint8_t>(kEcuInstance, bits);
  name.function_instance = get<std::uint8_t>(kFunctionInstance, bits);
  name.function = get<std::uint8_t>(kFunction, bits);
  name.vehicle_system = get<std::uint8_t>(kVehicleSystem, bits);
  name.system_instance = get<std::uint8_t>(kSystemInstance, bits);
  name.industry_group = get<std::uint8_t>(kIndustryGroup, bits);
  name.arbitrary_address = get<std::uint8_t>(kArbitraryAddress, bits) != 0;
  return name;
}

}  // namespace rigwire::protocols::j1939
