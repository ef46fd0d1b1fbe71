// Any frame: what the decoder takes it also encodes again, byte for byte.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/bytes.h"
#include "protocols/xsens/messages.h"

namespace xsens = rigwire::protocols::xsens;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 4 + 1 + 1 + 8;  // identifier, format, length, data
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    rigwire::protocols::can::Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
    frame.extended = (data[4] & 1U) != 0;
    frame.remote = (data[4] & 2U) != 0;
    frame.length = data[5];
    std::copy_n(data + 6, frame.data.size(), frame.data.begin());
    const auto reading = xsens::decode(frame);
    if (!reading.ok()) {
      continue;
    }
    const xsens::Message& message = *reading->message;
    const auto again =
        xsens::encode(static_cast<xsens::MessageId>(message.id),
                      std::span(reading->values).first(message.signals.size()), frame.extended);
    require(again.id == frame.id && again.length == message.length);
    require(
        std::equal(again.data.begin(), again.data.begin() + message.length, frame.data.begin()));
  }
  return 0;
}
