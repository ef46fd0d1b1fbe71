#include "emulators/can/can_node.h"

#include <stdexcept>

namespace rigwire::emulators {

void validate(const CanNodeSettings& settings) {
  const auto require = [](bool holds, const char* quantity, const std::string& found,
                          const char* allowed) {
    if (!holds) {
      throw std::invalid_argument(std::string("CAN node: ") + quantity + " is " + found +
                                  ", allowed is " + allowed);
    }
  };
  const std::uint32_t rate = settings.bit_rate_bps;
  require(rate == 0 || (rate >= 10'000 && rate <= 1'000'000), "bit_rate_bps", std::to_string(rate),
          "0 or 10000 .. 1000000");
  require(settings.queue_frames <= 65'536, "queue_frames", std::to_string(settings.queue_frames),
          "0 .. 65536");
  if (settings.restart_after) {
    require(
        *settings.restart_after >= Duration{0} && *settings.restart_after <= std::chrono::hours{1},
        "restart_after", std::to_string(settings.restart_after->count()) + " ns", "0 .. 1 h");
  }
}

}  // namespace rigwire::emulators
