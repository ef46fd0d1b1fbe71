#include "protocols/ubx/information.h"

namespace rigwire::protocols::ubx {

std::size_t encode_information(const Information& information, std::span<std::uint8_t> out) {
  const auto* const text = reinterpret_cast<const std::uint8_t*>(information.text.data());
  return encode_frame({kInformationClass, static_cast<std::uint8_t>(information.kind)},
                      {text, information.text.size()}, out);
}

Decoded<Information> decode_information(const FrameView& frame) {
  if (frame.id.message_class != kInformationClass ||
      frame.id.message_id > static_cast<std::uint8_t>(InformationKind::debug)) {
    return Malformed{"another UBX message", 2};
  }
  const auto* const text = reinterpret_cast<const char*>(frame.payload.data());
  return {
      Information{static_cast<InformationKind>(frame.id.message_id), {text, frame.payload.size()}},
      kOverheadBytes + frame.payload.size()};
}

}  // namespace rigwire::protocols::ubx
