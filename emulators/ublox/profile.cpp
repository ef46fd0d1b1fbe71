#include "emulators/ublox/profile.h"

#include <algorithm>

namespace rigwire::emulators {

std::size_t message_index(const UbloxProfile& profile, protocols::ubx::MessageId id) {
  return static_cast<std::size_t>(std::ranges::find(profile.messages, id, &UbloxMessage::id) -
                                  profile.messages.begin());
}

std::size_t message_index(const UbloxProfile& profile, std::string_view name) {
  return name.empty() ? profile.messages.size()
                      : static_cast<std::size_t>(
                            std::ranges::find(profile.messages, name, &UbloxMessage::name) -
                            profile.messages.begin());
}

const UbloxMessage* polled_message(const UbloxProfile& profile, protocols::ubx::MessageId id) {
  const std::size_t index = message_index(profile, id);
  return index < profile.messages.size() && profile.messages[index].polled
             ? &profile.messages[index]
             : nullptr;
}

}  // namespace rigwire::emulators
