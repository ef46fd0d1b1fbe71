// Every decoder of the vehicle messages fed with any frame: what it accepts returns to the same
// bytes, but for bits that no row names and values beyond the valid range.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/bytes.h"
#include "protocols/vehicle/brake.h"
#include "protocols/vehicle/condition.h"
#include "protocols/vehicle/diagnostics.h"
#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/engine_configuration.h"
#include "protocols/vehicle/implement.h"
#include "protocols/vehicle/joystick.h"
#include "protocols/vehicle/machine.h"
#include "protocols/vehicle/position.h"
#include "protocols/vehicle/speed.h"
#include "protocols/vehicle/steering.h"
#include "protocols/vehicle/transmission.h"
#include "protocols/vehicle/tyre.h"

namespace vehicle = rigwire::protocols::vehicle;
using rigwire::protocols::can::Frame;

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Under the message's own identifier, so that every input reaches every table.
template <class Message>
void check(Frame frame) {
  frame.id = vehicle::encode(Message{}, 0x00).id;
  const auto decoded = vehicle::decode<Message>(frame);
  require(decoded.ok() == (frame.extended && !frame.remote && frame.length == 8));
  if (!decoded.ok()) {
    return;
  }
  const Frame again = vehicle::encode(*decoded, 0x00);
  const auto second = vehicle::decode<Message>(again);
  require(second.ok());
  require(vehicle::encode(*second, 0x00) == again);
  for (const auto& row : Message::parameters()) {
    if (row.number == nullptr) {
      continue;
    }
    const double value = (*decoded).*row.number;
    require(!std::isfinite(value) || (value >= row.signal.lower - std::abs(row.signal.scale) &&
                                      value <= row.signal.upper + std::abs(row.signal.scale)));
  }
}

template <class... Messages>
void check_all(const Frame& frame) {
  (check<Messages>(frame), ...);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)vehicle::decode_trouble_report(std::span(data, size));
  (void)vehicle::decode_engine_configuration(std::span(data, size));
  constexpr std::size_t kRecord = 1 + 1 + 8;  // format, length, data
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    Frame frame;
    frame.extended = (data[0] & 1U) != 0;
    frame.remote = (data[0] & 2U) != 0;
    frame.length = data[1];
    std::copy_n(data + 2, frame.data.size(), frame.data.begin());
    using namespace vehicle;
    check_all<Ebc1, Ebc2, Hrw, Ccvs1, WheelBasedSpeed, MachineSelectedSpeed,
              MachineSelectedSpeedCommand, Eec1, Eec2, Tsc1, Etc1, Etc2, Tc1, Eac1, Xbr, Vdc2, Esc1,
              GuidanceMachineInfo, GuidanceCommand, Tire1, Tire2, Tpri, Tprs, Hpg,
              MachineFunctionCommand, MachineFunctionState, Sas, GroundBasedSpeed, Tp1, Tp2, Tp3,
              Eflp1, Et1, Dd1, VehicleFluids, Hours, Bjm1, Bjm2, Ejm1, Ejm2, VehiclePosition,
              VehicleDirectionSpeed, VehiclePosition2, Eec3, Vep1, Lfe1, Lfc1, RearHitchStatus,
              FrontHitchStatus, RearPowerTakeOffStatus, FrontPowerTakeOffStatus,
              HitchPowerTakeOffCommand, MaintainPower, LanguageCommand>(frame);
  }
  return 0;
}
