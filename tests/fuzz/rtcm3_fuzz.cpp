// A frame that is read lies within the bytes offered, and a shortage asks for more than there was.
// A message that is read is written again to a frame that reads the same: what was rounded once
// stays, but for values of multiple signals that no longer fit beside another rough range. Bytes
// that are no frame are read as a payload, so that the fuzzer need not find checksums.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/rtcm3/frame.h"
#include "protocols/rtcm3/message.h"

namespace rtcm3 = rigwire::protocols::rtcm3;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void read_and_write(std::span<const std::uint8_t> payload) {
  const auto message = rtcm3::decode_message(payload);
  if (!message.ok()) {
    require(message.malformed());
    return;
  }
  require(message.consumed() <= payload.size());
  std::array<std::uint8_t, rtcm3::kGreatestFrame> first{};
  std::array<std::uint8_t, rtcm3::kGreatestFrame> second{};
  const std::size_t size = rtcm3::encode(*message, first);
  const auto frame = rtcm3::decode_frame(std::span(first).first(size));
  require(frame.ok() && frame->message() == rtcm3::number_of(*message));
  const auto again = rtcm3::decode_message(frame->payload);
  require(again.ok());
  require(rtcm3::encode(*again, second) == size);
  const auto* const signals = std::get_if<rtcm3::MultipleSignals>(&*message);
  if (signals == nullptr) {
    require(first == second);
    return;
  }
  const auto& read_again = std::get<rtcm3::MultipleSignals>(*again);
  require(read_again.count == signals->count && read_again.epoch == signals->epoch);
  for (std::size_t i = 0; i < signals->count; ++i) {
    const auto& before = signals->cells[i].observation.range_m;
    const auto& after = read_again.cells[i].observation.range_m;
    constexpr double kStep_m = 0.018;  // 2^-24 ms of light
    require(!after || (before && std::abs(*after - *before) < kStep_m));
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> all(data, size);
  read_and_write(all.first(size < rtcm3::kGreatestPayload ? size : rtcm3::kGreatestPayload));
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
    read_and_write(frame->payload);
    at += frame.consumed();
  }
  return 0;
}
