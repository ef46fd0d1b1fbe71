#include "emulators/openimu/settings.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "emulators/j1939/j1939_address.h"
#include "emulators/nonvolatile_memory.h"
#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/bytes.h"

namespace rigwire::emulators {

namespace openimu = protocols::openimu;
using fields::in;
using fields::IntegerRule;
using protocols::load_little;
using protocols::store_little;

namespace {

constexpr Duration kTick = Duration{std::chrono::seconds{1}} / openimu::kTicksPerSecond;
constexpr std::uint32_t kMark = 0x314D494F;  // "OIM1"
constexpr std::size_t kMemoryBytes = 1 + 2 + 1 + 1 + 1 + 2 + 2 + 3 + openimu::kCommands + 1 + 1 +
                                     4 + 1 + 1;  // in the order of for_each_value()

/// Rates that the device's divider can give.
constexpr std::array<fields::Choice<std::uint8_t>, 9> kRates{{{0, "0 Hz", "Silent."},
                                                              {50, "2 Hz", ""},
                                                              {25, "4 Hz", ""},
                                                              {20, "5 Hz", ""},
                                                              {10, "10 Hz", ""},
                                                              {5, "20 Hz", ""},
                                                              {4, "25 Hz", ""},
                                                              {2, "50 Hz", ""},
                                                              {1, "100 Hz", ""}}};

/// Low-pass filters of the device.
constexpr std::array<fields::Choice<std::uint8_t>, 7> kCutOffs{{{0, "off", "No filter."},
                                                                {2, "2 Hz", ""},
                                                                {5, "5 Hz", ""},
                                                                {10, "10 Hz", ""},
                                                                {25, "25 Hz", ""},
                                                                {40, "40 Hz", ""},
                                                                {50, "50 Hz", ""}}};

/// The largest of the 24 axes codes.
constexpr std::int64_t kLastOrientation = 0b101'101'100;

void refuse(const std::string& what) {
  throw std::invalid_argument("OpenIMU: " + what);
}

bool has_packets(std::uint16_t mask, OpenImuVariant variant) {
  return (mask & ~packets_of(variant)) == 0;
}

bool has_behaviour(std::uint16_t behaviour) {
  return ((behaviour ^ openimu::Behaviour::kDefault) & ~kChangeableBehaviour) == 0;
}

bool has_priorities(const OpenImuConfiguration& c) {
  return std::max({c.rate_priority, c.acceleration_priority, c.slope_priority}) <= 3;
}

/// What the rules and validate() say of a configuration, for one that comes from the memory while
/// the device runs: neither throws nor allocates.
bool is_of(const OpenImuConfiguration& c, OpenImuVariant variant) {
  return has_packets(c.packet_mask, variant) && openimu::is_rate_divider(c.rate_divider) &&
         openimu::is_cut_off(c.rate_cut_off_hz) && openimu::is_cut_off(c.acceleration_cut_off_hz) &&
         openimu::orientation_axes(c.orientation).has_value() && has_behaviour(c.behaviour) &&
         has_priorities(c);
}

/// Writes or reads the members one after the other.
template <class Memory, class Step>
void for_each_value(Memory& memory, Step&& step) {
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

void visit(fields::Visitor& v, OpenImuSettings& p) {
  OpenImuConfiguration& c = p.configuration;
  v.integer("source_address", p.source_address,
            IntegerRule{kFirstArbitraryAddress, kLastArbitraryAddress},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.serial, IntegerRule{1, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  v.choice("rate", c.rate_divider, kRates, "Rate of the data messages at power-on.");
  v.integer("packets", c.packet_mask, IntegerRule{0, packets_of(p.variant)},
            "Messages sent, summed: 1 slope, 2 angular rate, 4 acceleration; 8 magnetic field "
            "(300RI) or fine angular rate, 32 older slope (335RI).");
  v.check(
      has_packets(c.packet_mask, p.variant), "packets", "the device has no such message",
      std::to_string(c.packet_mask),
      p.variant == OpenImuVariant::openimu300ri ? "sums of 1, 2, 4, 8" : "sums of 1, 2, 4, 8, 32");
  v.choice("rate_filter", c.rate_cut_off_hz, kCutOffs, "Low pass of the angular rates.");
  v.choice("acceleration_filter", c.acceleration_cut_off_hz, kCutOffs,
           "Low pass of the accelerations.");
  v.integer("orientation", c.orientation, IntegerRule{0, kLastOrientation},
            "Axes code of the device, one of 24.");
  v.check(openimu::orientation_axes(c.orientation).has_value(), "orientation",
          "not an axes code of the device", std::to_string(c.orientation),
          "the 24 right-handed codes 0 .. 364");
  v.number("rate_range", p.rate_range_radps, in("deg/s").above(0).at_most(2000),
           "Angular rate beyond which the reading is clamped and marked.");
  v.number("acceleration_range", p.acceleration_range_mps2, in("m/s2").above(0).at_most(1000),
           "Acceleration beyond which the reading is clamped and marked.");
  visit(v, p.supply);
  v.duration("processing_delay", p.processing_delay, {0, kTick.count() - 1},
             "From a sample or request to the frame; less than a tick.");
}

void validate(const OpenImuSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  const OpenImuConfiguration& configuration = settings.configuration;
  if (!has_behaviour(configuration.behaviour)) {
    refuse("behaviour is " + std::to_string(configuration.behaviour) +
           ", allowed are 49736 (0xC248) and that with the bits 8, 64, 512, 32768 cleared");
  }
  if (!has_priorities(configuration)) {
    refuse("priorities are " + std::to_string(configuration.rate_priority) + ", " +
           std::to_string(configuration.acceleration_priority) + ", " +
           std::to_string(configuration.slope_priority) + ", allowed is 0 .. 3");
  }
}

std::vector<std::uint8_t> sealed(const OpenImuMemory& memory) {
  std::vector<std::uint8_t> content(kMemoryBytes);
  std::size_t at = 0;
  for_each_value(memory, [&](auto value) {
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
  for_each_value(memory, [&]<class Value>(Value& value) {
    value = load_little<Value>(*content, at);
    at += sizeof(Value);
  });
  const bool of_pool =
      memory.address >= kFirstArbitraryAddress && memory.address <= kLastArbitraryAddress;
  if (!of_pool || !is_of(memory.configuration, variant)) {
    return std::nullopt;
  }
  return memory;
}

}  // namespace rigwire::emulators
