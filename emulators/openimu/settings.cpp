#include "emulators/openimu/settings.h"

#include <stdexcept>
#include <string>

#include "emulators/nonvolatile_memory.h"
#include "emulators/openimu/address.h"
#include "protocols/bytes.h"

namespace rigwire::emulators {

namespace openimu = protocols::openimu;
using protocols::load_little;
using protocols::store_little;

namespace {

constexpr Duration kTick = Duration{std::chrono::seconds{1}} / openimu::kTicksPerSecond;
constexpr std::uint32_t kMark = 0x314D494F;  // "OIM1"
constexpr std::size_t kMemoryBytes = 1 + 2 + 1 + 1 + 1 + 2 + 2 + 3 + openimu::kCommands + 1 + 1 +
                                     4 + 1 + 1;  // in the order of visit()

void refuse(const std::string& what) {
  throw std::invalid_argument("OpenIMU: " + what);
}

/// Writes or reads the members one after the other.
template <class Memory, class Step>
void visit(Memory& memory, Step&& step) {
  auto& c = memory.configuration;
  step(memory.address);
  step(c.packet_mask);
  step(c.rate_divider);
  step(c.rate_cut_off_hz);
  step(c.acceleration_cut_off_hz);
  step(c.orientation);
  step(c.behaviour);
  step(c.rate_priority);
  step(c.acceleration_priority);
  step(c.slope_priority);
  for (auto& specific : c.commands) {
    step(specific);
  }
  step(c.trouble.lamps);
  step(c.trouble.flashing);
  step(c.trouble.parameter);
  step(c.trouble.first_failure);
  step(c.trouble.second_failure);
}

}  // namespace

void validate(const OpenImuSettings& settings) {
  const OpenImuConfiguration& configuration = settings.configuration;
  const auto number = [](auto value) { return std::to_string(value); };
  if (settings.source_address < kFirstPoolAddress || settings.source_address > kLastPoolAddress) {
    refuse("source_address is " + number(settings.source_address) + ", allowed is 128 .. 247");
  }
  if (settings.serial == 0 || settings.serial > 0x1FFFFFU) {
    refuse("serial is " + number(settings.serial) + ", allowed is 1 .. 2097151");
  }
  if ((configuration.packet_mask & ~packets_of(settings.variant)) != 0) {
    const bool is_300 = settings.variant == OpenImuVariant::openimu300ri;
    refuse("packet_mask is " + number(configuration.packet_mask) +
           ", allowed are sums of 1 (slope), 2 (angular rate), 4 (acceleration), " +
           (is_300 ? "8 (magnetic field)" : "8 (fine angular rate), 32 (older slope)"));
  }
  if (!openimu::is_rate_divider(configuration.rate_divider)) {
    refuse("rate_divider is " + number(configuration.rate_divider) +
           ", allowed are 0, 1, 2, 4, 5, 10, 20, 25, 50 (rate = 100 Hz / divider, 0 is off)");
  }
  for (const std::uint8_t cut_off :
       {configuration.rate_cut_off_hz, configuration.acceleration_cut_off_hz}) {
    if (!openimu::is_cut_off(cut_off)) {
      refuse("cut-off is " + number(cut_off) + " Hz, allowed are 0 (off), 2, 5, 10, 25, 40, 50");
    }
  }
  if (!openimu::orientation_axes(configuration.orientation)) {
    refuse("orientation is " + number(configuration.orientation) +
           ", allowed are the 24 right-handed codes 0 .. 364");
  }
  if (((configuration.behaviour ^ openimu::Behaviour::kDefault) & ~kChangeableBehaviour) != 0) {
    refuse("behaviour is " + number(configuration.behaviour) +
           ", allowed are 49736 (0xC248) and that with the bits 8, 64, 512, 32768 cleared");
  }
  for (const std::uint8_t priority :
       {configuration.rate_priority, configuration.acceleration_priority,
        configuration.slope_priority}) {
    if (priority > 3) {
      refuse("priority is " + number(priority) + ", allowed is 0 .. 3");
    }
  }
  if (!(settings.rate_range_radps > 0.0) || !(settings.acceleration_range_mps2 > 0.0)) {
    refuse("rate_range_radps and acceleration_range_mps2 must be greater than 0, found " +
           number(settings.rate_range_radps) + " and " + number(settings.acceleration_range_mps2));
  }
  validate(settings.supply);
  if (settings.processing_delay < Duration{0} || settings.processing_delay >= kTick) {
    refuse("processing_delay is " + number(settings.processing_delay.count()) +
           " ns, allowed is 0 .. 4999999");
  }
}

std::vector<std::uint8_t> sealed(const OpenImuMemory& memory) {
  std::vector<std::uint8_t> content(kMemoryBytes);
  std::size_t at = 0;
  visit(memory, [&](auto value) {
    store_little<decltype(value)>(content, at, value);
    at += sizeof(value);
  });
  return seal(kMark, content);
}

std::optional<OpenImuMemory> unsealed(std::span<const std::uint8_t> block, OpenImuVariant variant) {
  const auto content = unseal(kMark, block);
  if (!content || content->size() != kMemoryBytes) {
    return std::nullopt;
  }
  OpenImuMemory memory;
  std::size_t at = 0;
  visit(memory, [&]<class Value>(Value& value) {
    value = load_little<Value>(*content, at);
    at += sizeof(Value);
  });
  OpenImuSettings check;
  check.variant = variant;
  check.source_address = memory.address;
  check.configuration = memory.configuration;
  try {
    validate(check);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  return memory;
}

}  // namespace rigwire::emulators
