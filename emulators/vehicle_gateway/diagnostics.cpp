#include "emulators/vehicle_gateway/diagnostics.h"

#include <utility>

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;

namespace {

static_assert(VehicleControl::kFaults <= vehicle::kGreatestCodes);

vehicle::TroubleReport report(const VehicleControl& control, const VehicleControl::Faults& faults) {
  vehicle::Lamps lamps;
  lamps.amber_warning = control.faults().count != 0;
  lamps.red_stop = control.stopping();
  return vehicle::make_trouble_report(lamps, std::span(faults.codes).first(faults.count));
}

}  // namespace

bool VehicleDiagnostics::is_due(std::uint64_t tick, const VehicleControl& control) {
  const VehicleControl::Faults faults = control.faults();
  const bool changed =
      faults != reported_ && (!last_change_ || tick - *last_change_ >= kPeriodTicks);
  const bool again = std::exchange(postponed_, false);
  if (!changed && !again && tick % kPeriodTicks != kPhaseTicks) {
    return false;
  }
  if (changed) {
    last_change_ = tick;
  }
  reported_ = faults;
  return true;
}

vehicle::TroubleReport VehicleDiagnostics::active(const VehicleControl& control) {
  return report(control, control.faults());
}

vehicle::TroubleReport VehicleDiagnostics::previous(const VehicleControl& control) {
  return report(control, control.previous_faults());
}

}  // namespace rigwire::emulators
