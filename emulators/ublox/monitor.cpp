#include "emulators/ublox/monitor.h"

#include <algorithm>

#include "protocols/ubx/configuration.h"
#include "protocols/ubx/layout.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

MonHw hardware(const UbloxMonitorView& view) {
  MonHw m;
  m.noise_per_ms = 90;
  m.gain_control = 4000;
  m.antenna_status = view.antenna.status;
  m.antenna_power = view.antenna.power;
  m.flags = 0x01;
  return m;
}

template <class Message>
std::size_t put(const Message& message, std::span<std::uint8_t> out) {
  const auto frame = encode(message);
  std::ranges::copy(frame, out.begin());
  return frame.size();
}

}  // namespace

std::size_t encode_monitor(const UbloxMonitorView& view, MessageId id,
                           std::span<std::uint8_t> out) {
  if (id == MonHw::kId) return put(hardware(view), out);
  return 0;
}

}  // namespace rigwire::emulators
