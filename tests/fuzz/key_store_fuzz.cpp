// The item store of a ZED-F9P fed arbitrary VALSET, VALGET, VALDEL and CFG-CFG payloads: every
// answer is sound, and what is in force is always what an older message could have set.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/settings.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/key_values.h"

namespace {

using namespace rigwire;
using namespace rigwire::protocols::ubx;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

/// Input: pieces of { message 0 .. 3, length, payload }.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const emulators::UbloxSettings settings = [] {
    emulators::UbloxSettings f9p;
    f9p.profile = &emulators::ublox_zed_f9p();
    f9p.baud = 38'400;
    return f9p;
  }();
  emulators::UbloxConfiguration configuration(settings);
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() >= 2) {
    constexpr MessageId kMessages[]{kCfgValset, kCfgValget, kCfgValdel, CfgCfg::kId};
    const MessageId id = kMessages[rest[0] & 3U];
    const std::size_t length = std::min<std::size_t>(rest[1], rest.size() - 2);
    const FrameView frame{id, rest.subspan(2, length)};
    rest = rest.subspan(2 + length);
    if (configuration.is_poll(frame)) {
      if (const auto reply = configuration.poll(frame)) {
        const auto answer = decode_valget_reply({id, *reply});
        require(answer.ok() && answer->count <= kMaximumConfigurationItems);
      }
    } else if (configuration.set(frame) && (rest.size() & 1U) != 0) {
      configuration.reload();
    }
    require(configuration.uart().baud >= 4800 && configuration.uart().baud <= 921'600);
    require(configuration.rate().measurement_period_ms >= 25);
    require(configuration.rate().navigation_ratio >= 1);
    require(configuration.navigation().dynamic_model <= 12);
  }
  return 0;
}
