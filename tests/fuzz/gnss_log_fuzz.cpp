// Any bytes as the log of a satellite receiver: the pieces that are handed out are the log, each
// byte once and in order, whatever the steps in which it comes, and the clock of the log never
// overflows.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "protocols/gnss_stream/splitter.h"
#include "protocols/gnss_stream/time.h"

using namespace rigwire::protocols;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

namespace {

struct Reading {
  std::vector<std::uint8_t> bytes;
  std::vector<gnss_stream::MessageTime> times;
  std::size_t messages = 0;
};

Reading read(std::span<const std::uint8_t> log, std::size_t step) {
  Reading reading;
  const auto use = [&reading](std::span<const std::uint8_t> bytes,
                              const gnss_stream::Splitter::Content& content) {
    reading.bytes.insert(reading.bytes.end(), bytes.begin(), bytes.end());
    std::optional<gnss_stream::MessageTime> time;
    if (const auto* sentence = std::get_if<nmea::SentenceView>(&content)) {
      time = gnss_stream::time_of(*sentence);
    } else if (const auto* frame = std::get_if<ubx::FrameView>(&content)) {
      time = gnss_stream::time_of(*frame);
    }
    if (!std::holds_alternative<std::monostate>(content)) {
      ++reading.messages;
    }
    if (time) {
      require(time->of_day_ns || time->of_week_ns);
      reading.times.push_back(*time);
    }
  };
  gnss_stream::Splitter splitter;
  for (std::size_t at = 0; at < log.size(); at += step) {
    splitter.take(log.subspan(at, std::min(step, log.size() - at)), use);
  }
  splitter.flush(use);
  return reading;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> log(data, size);
  const Reading whole = read(log, std::max<std::size_t>(size, 1));
  require(std::ranges::equal(whole.bytes, log));
  for (const std::size_t step : {1U, 7U}) {
    const Reading pieces = read(log, step);
    require(std::ranges::equal(pieces.bytes, log));
    require(pieces.messages == whole.messages && pieces.times.size() == whole.times.size());
  }
  gnss_stream::LeapSeconds leap_seconds;
  for (const gnss_stream::MessageTime& time : whole.times) {
    leap_seconds.take(time);
  }
  gnss_stream::StreamClock clock(leap_seconds.value());
  for (const gnss_stream::MessageTime& time : whole.times) {
    (void)clock.take(time);
  }
  return 0;
}
