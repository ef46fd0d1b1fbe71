#include "hil/configuration/velodyne_fault.h"

namespace rigwire::hil {
namespace {

using emulators::VelodyneFault;
using emulators::VelodyneFaultKind;

struct ToFault {
  VelodyneFault operator()(const LostPacketsFault& p) const {
    return {.kind = VelodyneFaultKind::lost_packets, .probability = p.probability};
  }
  VelodyneFault operator()(const SwappedPacketsFault& p) const {
    return {.kind = VelodyneFaultKind::swapped_packets, .probability = p.probability};
  }
  VelodyneFault operator()(const DuplicatedPacketsFault& p) const {
    return {.kind = VelodyneFaultKind::duplicated_packets, .probability = p.probability};
  }
  VelodyneFault operator()(const DeadLaserFault& p) const {
    return {.kind = VelodyneFaultKind::dead_laser, .first_laser = p.first, .last_laser = p.last};
  }
  VelodyneFault operator()(const DirtyWindowFault& p) const {
    return {.kind = VelodyneFaultKind::dirty_window,
            .sector_start_deg = p.from_deg,
            .sector_end_deg = p.to_deg,
            .transmission = p.transmission};
  }
  VelodyneFault operator()(const MotorStallFault&) const {
    return {.kind = VelodyneFaultKind::motor_stall};
  }
  VelodyneFault operator()(const PulseLossFault&) const {
    return {.kind = VelodyneFaultKind::pulse_loss};
  }
  VelodyneFault operator()(const PulseNoiseFault&) const {
    return {.kind = VelodyneFaultKind::pulse_noise};
  }
  VelodyneFault operator()(const SentenceLossFault&) const {
    return {.kind = VelodyneFaultKind::sentence_loss};
  }
  VelodyneFault operator()(const ClockOffsetFault& p) const {
    return {.kind = VelodyneFaultKind::clock_offset, .seconds = p.offset_s};
  }
  VelodyneFault operator()(const HourOverrunFault& p) const {
    return {.kind = VelodyneFaultKind::hour_overrun, .seconds = p.overrun_s};
  }
  VelodyneFault operator()(const FactoryBytesFault& p) const {
    return {.kind = VelodyneFaultKind::factory_bytes,
            .return_mode_byte = p.return_mode,
            .product_id = p.product};
  }
};

}  // namespace

std::vector<VelodyneFault> velodyne_faults(const std::vector<VelodyneFaultConfiguration>& faults) {
  std::vector<VelodyneFault> result;
  for (const VelodyneFaultConfiguration& configured : faults) {
    VelodyneFault fault = std::visit(ToFault{}, configured.settings);
    fault.begin = configured.at;
    fault.end = configured.at + configured.length;
    result.push_back(fault);
  }
  return result;
}

}  // namespace rigwire::hil
