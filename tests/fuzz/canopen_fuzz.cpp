// An encoder fed with any frames between its readings: at most two answers to a frame (an SDO
// answer and a PDO that it set off), only identifiers of its own, and every frame is counted once.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/canopen/rotary_encoder.h"
#include "protocols/bytes.h"

namespace emulators = rigwire::emulators;
using rigwire::protocols::can::Frame;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

namespace {

struct Output final : emulators::FrameOutput {
  void send(rigwire::SimTime due, const Frame& frame) override {
    require(due >= last);
    last = due;
    require(frame.length <= 8 && !frame.extended && frame.id <= 0x7FFU);
    ++count;
  }
  rigwire::SimTime last = rigwire::kStart;
  std::uint64_t count = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 2 + 1 + 1 + 8;  // identifier, format, length, data
  constexpr std::uint64_t kAnswers = 1 + 2;       // SDO answer, both PDOs
  Output output;
  emulators::VolatileMemory memory;
  emulators::RotaryEncoder encoder({}, memory, output);
  rigwire::SimTime now = rigwire::kStart + std::chrono::milliseconds{250};
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord, now += std::chrono::milliseconds{2}) {
    encoder.update({now, 0.01 * static_cast<double>(fed), 5.0});
    Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint16_t>(std::span(data, size), 0) & 0x7FFU;
    frame.extended = (data[2] & 1U) != 0;
    frame.remote = (data[2] & 2U) != 0;
    frame.length = data[3];
    std::copy_n(data + 4, frame.data.size(), frame.data.begin());
    const std::uint64_t before = output.count;
    encoder.receive(now, frame);
    require(output.count <= before + kAnswers);
    ++fed;
  }
  const auto counters = encoder.received();
  require(counters.accepted + counters.ignored + counters.malformed == fed);
  return 0;
}
