// An engine's controller fed with any frames, with time going on in between: whatever arrives, it
// asks for a speed that TSC1 can carry and a share between none and all, unasked it asks for
// nothing, frames leave in order, and every frame that came is counted once.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "emulators/engine_controller/engine_controller.h"
#include "frame_output.h"
#include "protocols/bytes.h"

namespace emulators = rigwire::emulators;
using rigwire::fuzz::Output;
using rigwire::fuzz::require;
using rigwire::protocols::can::Frame;

/// Each record is (identifier, format, length, wait in ms, data).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 4 + 1 + 1 + 1 + 8;
  Output output;
  emulators::EngineController engine({}, output);
  rigwire::SimTime now = rigwire::kStart;
  engine.advance(now);
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
    frame.extended = (data[4] & 1U) != 0;
    frame.remote = (data[4] & 2U) != 0;
    frame.length = data[5];
    std::copy_n(data + 7, frame.data.size(), frame.data.begin());
    now += std::chrono::milliseconds(data[6]);
    rigwire::PowerUnitSample sample;
    sample.time = now;
    sample.engine.speed_radps = frame.data[0];
    sample.dial_radps = 200.0;
    engine.update(sample);
    engine.receive(now, frame);
    ++fed;
    require(engine.next_event() > now);
    const rigwire::PowerUnitCommand& command = engine.command();
    require(command.time <= now);
    const double speed_radps = command.speed_radps.value_or(0.0);
    require(speed_radps >= 0.0 && speed_radps < 1000.0);
    require(command.torque_limit_share >= 0.0 && command.torque_limit_share <= 1.0);
    require(engine.received().accepted > 0 || command == rigwire::PowerUnitCommand{});
  }
  const auto counters = engine.received();
  require(counters.accepted + counters.ignored + counters.malformed == fed);
  return 0;
}
