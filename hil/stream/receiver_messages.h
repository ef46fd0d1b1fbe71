// The messages in the bytes between a satellite receiver and its client, NMEA, UBX and RTCM 3, put
// together from what passed the line a few bytes at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "protocols/nmea/sentence.h"
#include "protocols/ubx/frame.h"

namespace rigwire::hil {

class ReceiverMessages {
 public:
  /// Most bytes that are kept of a message that is not whole yet.
  static constexpr std::size_t kMostKept = 4096;

  /// std::monostate: an RTCM 3 message, or bytes that are of no message.
  using Content =
      std::variant<std::monostate, protocols::ubx::FrameView, protocols::nmea::SentenceView>;
  using Use = std::function<void(std::span<const std::uint8_t> bytes, const Content& content)>;
  /// The next piece of one direction; what is given holds during the call.
  void take(std::span<const std::uint8_t> bytes, const Use& use);

 private:
  std::vector<std::uint8_t> kept_;
};

}  // namespace rigwire::hil
