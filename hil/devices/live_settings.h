// Keys of a device's configuration that can be changed while it runs: exactly those that its
// emulator takes (emulators/live_setting.h).
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/live_setting.h"

namespace rigwire::hil {

struct LiveKey {
  std::string_view key;
  std::string_view by;  ///< How the device's own configuration software changes it.
};

template <class Emulator, class Settings>
[[nodiscard]] std::vector<LiveKey> live_keys(
    std::span<const emulators::LiveSetting<Emulator, Settings>> rows) {
  std::vector<LiveKey> keys;
  for (const auto& row : rows) {
    keys.push_back({row.key, row.by});
  }
  return keys;
}

/// Changes that key of the emulator to its value in `wanted`. Precondition: one of the rows has it.
template <class Emulator, class Settings>
[[nodiscard]] std::string tell(std::span<const emulators::LiveSetting<Emulator, Settings>> rows,
                               std::string_view key, Emulator& emulator, SimTime now,
                               const Settings& wanted) {
  using Row = emulators::LiveSetting<Emulator, Settings>;
  return std::string(std::ranges::find(rows, key, &Row::key)->tell(emulator, now, wanted));
}

}  // namespace rigwire::hil
