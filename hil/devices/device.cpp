#include "hil/devices/device.h"

#include <fmt/format.h>

#include "fields/check.h"
#include "hil/executive/executive.h"

namespace rigwire::hil {

std::string epochs_text(double rate_hz) {
  return fmt::format("{:.3g} epoch{}/s", rate_hz, rate_hz == 1.0 ? "" : "s");
}

void visit(fields::Visitor& v, DeviceConfiguration& p) {
  p.visit(v);
}

void validate(const DeviceConfiguration& p) {
  // A visitor wants something that it could change.
  const std::unique_ptr<DeviceConfiguration> copy = p.copy();
  fields::check_part(fields::Part::of(*copy));
  p.validate();
}

SimTime Device::client_arrived(Executive& executive) {
  const SimTime now = executive.arrive();
  statistics_.last_client_activity = now;
  return now;
}

DeviceStatus Device::status(const std::string& name, SimTime now) const {
  const drivers::EndpointStatus wire = endpoint();
  const WireStatistics& known = statistics();
  DeviceStatus status;
  status.name = name;
  status.wire = wire.address;
  if (wire.further_ports > 0) {
    status.wire += " +" + std::to_string(wire.further_ports);
  }
  status.readers = wire.readers;
  status.client_present = wire.client_present;
  status.frames = frames();
  status.bytes = known.bytes;
  status.dropped = dropped();
  status.nominal_rate_hz = emulator().nominal_rate_hz();
  status.lateness_p50 = known.lateness.percentile(0.5);
  status.lateness_p99 = known.lateness.percentile(0.99);
  status.lateness_max = known.lateness.max();
  status.lateness = classes_of(known.lateness);
  if (known.last_client_activity) {
    status.since_client_activity = now - *known.last_client_activity;
  }
  status.last_request = last_request();
  return status;
}

std::vector<DescribedQuantity> quantities_of(const emulators::Device& emulator) {
  std::vector<DescribedQuantity> result;
  for (const emulators::Quantity& quantity : emulator.quantities()) {
    result.push_back({std::string(quantity.name), std::string(quantity.unit), quantity.lower,
                      quantity.upper, quantity.resolution});
  }
  return result;
}

const Calendar& some_calendar() {
  static const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  return calendar;
}

}  // namespace rigwire::hil
