// Any identifier and eight bytes: what is understood as an error frame is written to one that is
// understood the same.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/can/error_frame.h"

namespace can = rigwire::protocols::can;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  can::ErrorFrame frame;
  constexpr std::size_t kSize = 4 /*identifier*/ + 8 /*data*/;
  for (auto rest = std::span(data, size); rest.size() >= kSize; rest = rest.subspan(kSize)) {
    frame.id = static_cast<std::uint32_t>(rest[0]) << 24U |
               static_cast<std::uint32_t>(rest[1]) << 16U |
               static_cast<std::uint32_t>(rest[2]) << 8U | rest[3];
    std::copy_n(rest.begin() + 4, frame.data.size(), frame.data.begin());
    const auto report = can::from_error_frame(frame);
    if (!report.ok()) {
      require(report.malformed());
      continue;
    }
    const auto again = can::from_error_frame(can::to_error_frame(*report));
    require(again.ok() && *again == *report);
  }
  return 0;
}
