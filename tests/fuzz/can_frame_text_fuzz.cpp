// Every text that is a frame is written back to one that is the same frame.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "protocols/can/frame_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace can = rigwire::protocols::can;
  const auto frame = can::parse_frame_text({reinterpret_cast<const char*>(data), size});
  if (frame && (frame->length > 8 || can::parse_frame_text(can::frame_text(*frame)) != frame)) {
    std::abort();
  }
  return 0;
}
