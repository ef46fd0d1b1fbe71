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
#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/frame.h"

namespace rigwire::protocols::gnss_stream {

class Splitter {
 public:
  /// Most bytes that are kept of a message that is not whole yet.
  static constexpr std::size_t kMostKept = 8192;

  /// std::monostate: bytes that are of no message.
  using Content =
      std::variant<std::monostate, ubx::FrameView, nmea::SentenceView, rtcm3::FrameView>;
  using Use = std::function<void(std::span<const std::uint8_t> bytes, const Content& content)>;
  /// The next piece of one direction; what is given holds during the call.
  void take(std::span<const std::uint8_t> bytes, const Use& use);
  /// Hands out what is kept, at the end of a stream: the beginning of a message without its end.
  void flush(const Use& use);

 private:
  std::vector<std::uint8_t> kept_;
};

}  // namespace rigwire::protocols::gnss_stream
