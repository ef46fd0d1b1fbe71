// The gateway's messages in the common form, for the bus's DBC file.
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "protocols/vehicle/layouts.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::OwnedMessage;
using vehicle::layout;

namespace {

/// With the period of its place in the schedule.
template <class Message>
OwnedMessage scheduled(const vehicle::LayoutEnds& ends,
                       std::span<const VehicleReport::Entry> schedule) {
  for (const VehicleReport::Entry& entry : schedule) {
    if (entry.group.pgn == Message::kGroup.pgn) {
      return layout<Message>(ends, entry.group);
    }
  }
  return layout<Message>(ends);
}

}  // namespace

std::vector<OwnedMessage> VehicleGateway::messages(std::string_view name) const {
  using namespace vehicle;
  std::vector<OwnedMessage> list;
  const LayoutEnds sent{name, node_.address(), j1939::kGlobalAddress};
  append_layouts<Etc1, Vdc2, Sas, Hrw, Eec1, Esc1, Eec2, Hpg, GuidanceMachineInfo,
                 MachineSelectedSpeed, WheelBasedSpeed, Ebc2, Ccvs1, Etc2, Ebc1,
                 MachineFunctionState, Eac1, Eflp1, Et1, Dd1, VehicleFluids, Tire1, Tire2, Tpri,
                 Tp1, Tp2, Tp3, Hours, Eec3, Vep1, Lfe1, Lfc1, RearHitchStatus, FrontHitchStatus,
                 RearPowerTakeOffStatus, FrontPowerTakeOffStatus, LanguageCommand>(list, sent);
  if (settings_.has_ground_radar) {
    append_layouts<GroundBasedSpeed>(list, sent);
  }
  TroubleMemory::append_layouts(list, sent);
  if (settings_.has_position) {
    const auto schedule = VehicleSatellites::schedule();
    list.push_back(scheduled<VehiclePosition>(sent, schedule));
    list.push_back(scheduled<VehicleDirectionSpeed>(sent, schedule));
    list.push_back(scheduled<VehiclePosition2>(sent, schedule));
  }
  const LayoutEnds taken{"", j1939::kNullAddress, node_.address()};
  append_layouts<Tsc1, Tc1, Xbr, GuidanceCommand, MachineSelectedSpeedCommand, Tprs,
                 MachineFunctionCommand, HitchPowerTakeOffCommand, MaintainPower>(list, taken);
  return list;
}

}  // namespace rigwire::emulators
