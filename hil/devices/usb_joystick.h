// An excavator operator's levers on USB, and what moves them.
//
//   levers:
//     type: usb-joystick
//     source: script
//     script:
//       - {at: 0 s}
//       - {at: 2 s, left_x: 1, buttons: [1]}
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "emulators/sample_fault.h"
#include "emulators/usb/hid_joystick.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"
#include "hil/wires/usb_configuration.h"
#include "sim/joystick/lever_script.h"
#include "sim/samples/joystick_sample.h"

namespace rigwire::hil {

enum class LeverSource { script, commands };

struct LeverKeyframeConfiguration {
  Duration at{0};                            ///< From the start of the run.
  std::array<double, kJoystickAxes> axes{};  ///< By JoystickAxis, of full travel.
  std::vector<double> buttons;               ///< Numbers of those that are pressed, 1 .. 16.
};

void visit(fields::Visitor& v, LeverKeyframeConfiguration& p);

struct UsbJoystickConfiguration final : DeviceConfigurationOf<UsbJoystickConfiguration> {
  emulators::HidJoystickSettings joystick;
  LeverSource source = LeverSource::script;
  bool repeat = false;
  std::vector<LeverKeyframeConfiguration> script;
  std::vector<MixedFault<PlugFault, emulators::SupplyFault, emulators::SampleFault<JoystickSample>>>
      faults;

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

/// What moves them by script. Throws std::invalid_argument.
[[nodiscard]] sim::LeverScript lever_script(const UsbJoystickConfiguration& configuration);

}  // namespace rigwire::hil
