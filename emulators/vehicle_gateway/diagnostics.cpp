#include "emulators/vehicle_gateway/diagnostics.h"

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;

static_assert(VehicleControl::kFaults <= vehicle::kGreatestCodes);

std::optional<protocols::can::Frame> VehicleDiagnostics::tick(std::uint64_t tick,
                                                              const VehicleControl& control,
                                                              std::uint8_t source) {
  if (next_frame_ < frame_count_) {
    if (tick < next_tick_) {
      return std::nullopt;
    }
    next_tick_ = tick + kPacketTicks;
    return vehicle::report_frame(report_, next_frame_++, source);
  }
  const VehicleControl::Faults faults = control.faults();
  const bool changed =
      faults != reported_ && (!last_change_ || tick - *last_change_ >= kPeriodTicks);
  if (!changed && !asked_ && tick % kPeriodTicks != kPhaseTicks) {
    return std::nullopt;
  }
  if (changed) {
    last_change_ = tick;
  }
  asked_ = false;
  reported_ = faults;
  vehicle::Lamps lamps;
  lamps.amber_warning = faults.count != 0;
  lamps.red_stop = control.stopping();
  report_ = vehicle::make_trouble_report(lamps, std::span(faults.codes).first(faults.count));
  frame_count_ = vehicle::report_frames(report_);
  next_frame_ = 1;
  next_tick_ = tick + kPacketTicks;
  return vehicle::report_frame(report_, 0, source);
}

}  // namespace rigwire::emulators
