// A frame that is read lies within the bytes offered, and a shortage asks for more than there was.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/rtcm3/frame.h"

namespace rtcm3 = rigwire::protocols::rtcm3;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> all(data, size);
  for (std::size_t at = 0; at < size;) {
    const auto rest = all.subspan(at);
    const auto frame = rtcm3::decode_frame(rest);
    if (frame.incomplete()) {
      require(frame.shortage().had == rest.size() && frame.shortage().needed > rest.size());
    }
    if (!frame.ok()) {
      ++at;
      continue;
    }
    require(frame->payload.size() <= rtcm3::kGreatestPayload);
    require(frame.consumed() ==
            rtcm3::kHeaderBytes + frame->payload.size() + rtcm3::kChecksumBytes);
    require(frame.consumed() <= rest.size());
    require(frame->message() < 4096 && frame->second_field() < 4096);
    at += frame.consumed();
  }
  return 0;
}
