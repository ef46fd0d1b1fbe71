#include "protocols/gnss_stream/splitter.h"

#include <utility>

namespace rigwire::protocols::gnss_stream {
namespace {

constexpr std::uint8_t kNmeaStart = '$';

}  // namespace

void Splitter::take(std::span<const std::uint8_t> bytes, const Use& use) {
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
        found(frame.consumed(), *frame);
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

void Splitter::flush(const Use& use) {
  // What follows a beginning without an end can hold whole messages.
  while (!kept_.empty()) {
    const std::vector<std::uint8_t> kept = std::exchange(kept_, {});
    use(std::span(kept).first(1), {});
    take(std::span(kept).subspan(1), use);
  }
}

}  // namespace rigwire::protocols::gnss_stream
