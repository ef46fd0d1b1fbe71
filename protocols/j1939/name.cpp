#include "protocols/j1939/name.h"

namespace rigwire::protocols::j1939 {
namespace {

/// each(member, lowest bit, width) for every field of a NAME.
template <class AnyName, class Each>
constexpr void each_field(AnyName& name, const Each& each) {
  each(name.identity, 0U, 21U);
  each(name.manufacturer, 21U, 11U);
  each(name.ecu_instance, 32U, 3U);
  each(name.function_instance, 35U, 5U);
  each(name.function, 40U, 8U);
  each(name.vehicle_system, 49U, 7U);
  each(name.system_instance, 56U, 4U);
  each(name.industry_group, 60U, 3U);
  each(name.arbitrary_address, 63U, 1U);
}

constexpr std::uint64_t mask(unsigned width) {
  return (std::uint64_t{1} << width) - 1U;
}

}  // namespace

std::uint64_t pack(const Name& name) {
  std::uint64_t bits = 0;
  each_field(name, [&bits](auto value, unsigned lowest, unsigned width) {
    bits |= (std::uint64_t{value} & mask(width)) << lowest;
  });
  return bits;
}

Name unpack_name(std::uint64_t bits) {
  Name name;
  each_field(name, [bits]<class Member>(Member& member, unsigned lowest, unsigned width) {
    member = static_cast<Member>((bits >> lowest) & mask(width));
  });
  return name;
}

}  // namespace rigwire::protocols::j1939
