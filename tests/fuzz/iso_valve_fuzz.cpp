// A block of ISO 11783 valves fed with any frames, with time going on in between: its openings stay
// within travel, without an address it is in neutral, frames leave in order, and every frame that
// came is counted once.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/iso_valve/iso_valves.h"
#include "frame_output.h"
#include "protocols/bytes.h"

namespace emulators = rigwire::emulators;
using rigwire::protocols::can::Frame;

namespace {

using rigwire::fuzz::Output;
using rigwire::fuzz::require;

emulators::IsoValveSettings settings() {
  emulators::IsoValveSettings settings;
  settings.general_purpose_section = 2;
  settings.first_valve = 3;
  settings.levers[static_cast<std::size_t>(emulators::JoystickAxis::x1)] = "swing";
  settings.levers[static_cast<std::size_t>(emulators::JoystickAxis::theta2)] = "-bucket";
  settings.amplifier.defects = {
      {{std::chrono::seconds(2), std::chrono::seconds(1)}, emulators::OpenCoilDefect{1}},
      {{std::chrono::seconds(5), std::chrono::seconds(1)}, emulators::SupplyVoltageDefect{3.0}}};
  return settings;
}

}  // namespace

/// Each record is (identifier, format, length, wait in ms, data).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 4 + 1 + 1 + 1 + 8;
  static const emulators::IsoValveSettings kSettings = settings();
  Output output;
  emulators::IsoValves valves(kSettings, output);
  rigwire::SimTime now = rigwire::kStart;
  valves.advance(now);
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
    frame.extended = (data[4] & 1U) != 0;
    frame.remote = (data[4] & 2U) != 0;
    frame.length = data[5];
    std::copy_n(data + 7, frame.data.size(), frame.data.begin());
    now += std::chrono::milliseconds(data[6]);
    rigwire::ValveSample sample;
    sample.time = now;
    sample.spool_position = valves.command().opening;
    valves.update(sample);
    valves.receive(now, frame);
    ++fed;
    require(valves.next_event() > now);
    require(valves.command().time <= now);
    for (std::size_t i = 0; i < rigwire::kValveSections; ++i) {
      const double opening = valves.command().opening[i];
      require(std::abs(opening) <= 1.0);
      require(opening == 0.0 || valves.address_held());
    }
    const emulators::ReceiveCounters& counted = valves.received();
    require(counted.accepted + counted.ignored + counted.malformed == fed);
  }
  return 0;
}
