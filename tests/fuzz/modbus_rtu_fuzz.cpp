// A Modbus RTU line fed with any bytes in any lumps at any times, strict and forgiving, with noise
// and without: it answers whole frames of its own units, never before the silence, never two bytes
// at once, and moves on.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "protocols/modbus/rtu.h"

namespace {

using namespace rigwire;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

struct CheckedLine final : emulators::ByteOutput {
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    require(bytes.size() == 1 && due >= latest);
    const bool goes_on = due - latest <= character + Duration{1};
    require(goes_on || due - latest >= silence);
    if (!goes_on) {
      finish();
    }
    frame.push_back(bytes[0]);
    latest = due;
  }
  void finish() {
    if (!frame.empty()) {
      const auto answer = protocols::modbus::decode_rtu(frame);
      require(answer.ok() && (answer->address == 1 || answer->address == 7));
    }
    frame.clear();
  }
  Duration character{};
  Duration silence{};
  SimTime latest = kStart;
  std::vector<std::uint8_t> frame;
};

}  // namespace

/// The first byte chooses the line; each lump is (length, wait in units of 50 us, bytes). A lump
/// whose length has its highest bit set gets a right check.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  emulators::ModbusRtuSettings settings;
  settings.line.timing.baud = (data[0] & 1U) != 0 ? 9600 : 115'200;
  settings.line.strict_gaps = (data[0] & 2U) != 0;
  settings.response_delay.typical = Duration{0};
  CheckedLine output;
  output.character = settings.line.timing.characters(1);
  output.silence = settings.line.timing.frame_silence();
  emulators::ModbusRtuServer server(settings, output);
  static const emulators::ValveDriverSettings valves;
  emulators::ValveDriver first(valves);
  emulators::ValveDriver second(valves);
  server.add_unit(1, first.unit());
  server.add_unit(7, second.unit());
  SimTime now = kStart;
  std::span rest(data + 1, size - 1);
  while (rest.size() > 2) {
    const std::size_t length = std::min<std::size_t>(rest[0] & 0x7FU, rest.size() - 2);
    const bool checked = (rest[0] & 0x80U) != 0 && length > 1;
    now += std::chrono::microseconds(50) * rest[1];
    const auto bytes = rest.subspan(2, length);
    if (checked) {
      server.receive(now, protocols::modbus::encode_rtu(bytes[0], bytes.subspan(1)).view());
    } else {
      server.receive(now, bytes);
    }
    require(server.next_event() > now);
    rest = rest.subspan(2 + length);
  }
  server.advance(now + std::chrono::hours(1));
  require(server.next_event() == kNever);
  output.finish();
  return 0;
}
