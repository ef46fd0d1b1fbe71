// What the control reports as trouble codes.
#include "emulators/vehicle_gateway/control.h"
#include "protocols/j1939/identifier.h"

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::FailureMode;

namespace {

struct Fault {
  std::uint32_t spn;
  FailureMode mode;
};
/// The parameters whose absence is reported, in the order of VehicleRequest, then the gear.
constexpr std::array<Fault, VehicleControl::kFaults> kFaultCodes{
    {{695, FailureMode::abnormal_update_rate},
     {525, FailureMode::abnormal_update_rate},
     {2920, FailureMode::abnormal_update_rate},
     {5237, FailureMode::abnormal_update_rate},
     {4310, FailureMode::abnormal_update_rate},
     {1874, FailureMode::abnormal_update_rate},
     {525, FailureMode::received_data_in_error}}};

}  // namespace

bool VehicleControl::is_active(std::size_t fault) const {
  return fault < kVehicleRequests ? lost_[fault] : gear_refused_;
}

VehicleControl::Faults VehicleControl::select(bool active) const {
  Faults faults;
  for (std::size_t i = 0; i < kFaults; ++i) {
    if (is_active(i) == active && occurrences_[i] != 0) {
      faults.codes[faults.count++] = {
          kFaultCodes[i].spn, static_cast<std::uint8_t>(kFaultCodes[i].mode), occurrences_[i]};
    }
  }
  return faults;
}

VehicleControl::Faults VehicleControl::faults() const {
  return select(true);
}

VehicleControl::Faults VehicleControl::previous_faults() const {
  return select(false);
}

void VehicleControl::clear_previous_faults() {
  for (std::size_t i = 0; i < kFaults; ++i) {
    occurrences_[i] = is_active(i) ? occurrences_[i] : std::uint8_t{0};
  }
}

void VehicleControl::clear_active_faults() {
  for (std::size_t i = 0; i < kFaults; ++i) {
    occurrences_[i] = is_active(i) ? std::uint8_t{1} : occurrences_[i];
  }
}

void VehicleControl::note_requester(VehicleRequest source, std::uint8_t address) {
  requester_[index(source)] = address;
}

std::uint8_t VehicleControl::requester(VehicleRequest source) const {
  return in_force(source) ? requester_[index(source)] : protocols::j1939::kGlobalAddress;
}

}  // namespace rigwire::emulators
