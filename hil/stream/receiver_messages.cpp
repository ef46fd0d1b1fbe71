#include "hil/stream/receiver_messages.h"

#include <utility>

#include "protocols/rtcm3/frame.h"

namespace rigwire::hil {
namespace {

namespace nmea = protocols::nmea;
namespace rtcm3 = protocols::rtcm3;
namespace ubx = protocols::ubx;

constexpr std::uint8_t kNmeaStart = '$';

}  // namespace

void ReceiverMessages::take(std::span<const std::uint8_t> bytes, const Use& use) {
  kept_.insert(kept_.end(), bytes.begin(), bytes.end());
  const auto all = std::span(std::as_const(kept_));
  std::size_t at = 0;
  std::size_t other = 0;  // from here on to `at`: of no message
  const auto found = [&](std::size_t size, const Content& content) {
    if (other < at) {
      use(all.subspan(other, at - other), {});
    }
    use(all.subspan(at, size), content);
    at += size;
    other = at;
  };
  // What cannot begin a message is passed over, byte by byte.
  while (at < all.size()) {
    const auto rest = all.subspan(at);
    bool more_needed = false;
    if (rest.front() == ubx::kSync1) {
      const auto frame = ubx::decode_frame(rest, kMostKept / 2);
      more_needed = frame.incomplete();
      if (frame.ok()) {
        found(frame.consumed(), *frame);
        continue;
      }
    } else if (rest.front() == kNmeaStart) {
      const auto sentence = nmea::decode_sentence(rest);
      more_needed = sentence.incomplete();
      if (sentence.ok()) {
        found(sentence.consumed(), *sentence);
        continue;
      }
    } else if (rest.front() == rtcm3::kPreamble) {
      const auto frame = rtcm3::decode_frame(rest);
      more_needed = frame.incomplete();
      if (frame.ok()) {
        found(frame.consumed(), {});
        continue;
      }
    }
    if (more_needed) {
      break;
    }
    ++at;
  }
  const std::size_t left = all.size() - at;
  at += left > kMostKept ? left - kMostKept : 0;
  if (other < at) {
    use(all.subspan(other, at - other), {});
  }
  kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace rigwire::hil
