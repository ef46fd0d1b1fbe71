#include "emulators/ublox/key_map.h"

#include "protocols/ubx/configuration_keys.h"

namespace rigwire::emulators {

namespace ubx = protocols::ubx;

UbloxKeyMap::UbloxKeyMap(const UbloxProfile& profile) : entries_(ubx::configuration_keys().size()) {
  for (const UbloxKeyBinding& binding : ublox_key_bindings()) {
    entries_[ubx::key_index(binding.key)].field = &binding;
  }
  for (const ubx::MessageRateKeys& keys : ubx::message_rate_keys()) {
    const std::size_t message = message_index(profile, keys.message);
    const bool known = message < profile.messages.size() && profile.messages[message].periodic;
    for (std::uint8_t port = 0; port < ubx::kMessageRatePorts; ++port) {
      Entry& entry = entries_[ubx::key_index(keys.first + port)];
      entry.message = known ? static_cast<std::int16_t>(message) : std::int16_t{-1};
      entry.port = port;
    }
  }
}

bool UbloxKeyMap::bound(std::size_t index) const {
  return entries_[index].field != nullptr || entries_[index].message >= 0;
}

std::uint64_t UbloxKeyMap::read(const UbloxConfigurationState& state, std::size_t index) const {
  const Entry& entry = entries_[index];
  return entry.field != nullptr ? entry.field->read(state)
                                : state.rates[static_cast<std::size_t>(entry.message)][entry.port];
}

void UbloxKeyMap::write(UbloxConfigurationState& state, std::size_t index,
                        std::uint64_t value) const {
  const Entry& entry = entries_[index];
  if (entry.field != nullptr) {
    entry.field->write(state, value);
  } else {
    state.rates[static_cast<std::size_t>(entry.message)][entry.port] =
        static_cast<std::uint8_t>(value);
  }
}

}  // namespace rigwire::emulators
