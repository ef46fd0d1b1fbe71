// Any bytes as a binary frame of a viewer: what is read lies within them.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "protocols/foxglove/frames.h"

namespace foxglove = rigwire::protocols::foxglove;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto frame = foxglove::decode_client_frame(bytes);
  require(!frame.incomplete());
  if (!frame.ok()) {
    require(frame.fault().offset <= size);
    return 0;
  }
  if (const auto* request = std::get_if<foxglove::ServiceRequest>(&*frame)) {
    require(1 + 4 + 4 + 4 + request->encoding.size() + request->payload.size() == size);
  } else if (const auto* control = std::get_if<foxglove::PlaybackControl>(&*frame)) {
    require(1 + 1 + 4 + 1 + 8 + 4 + control->request.size() == size);
  }
  return 0;
}
