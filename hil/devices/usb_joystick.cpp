#include "hil/devices/usb_joystick.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/devices/valve_source.h"
#include "hil/executive/event_source.h"

namespace rigwire::hil {

using fields::Choice;
using fields::NumberRule;
using fields::plain;

namespace {

constexpr std::array<Choice<LeverSource>, 2> kLeverSources{
    {{LeverSource::script, "script", "The keyframes of `script`."},
     {LeverSource::commands, "commands",
      "The commands of the rig's valves, as an operator with the ISO pattern would give them."}}};

using SampleFault = emulators::SampleFault<JoystickSample>;

/// Moves the levers at the rate at which they can be reported.
class LeverMover final : public EventSource {
 public:
  LeverMover(const UsbJoystickConfiguration& configuration, std::uint64_t seed,
             emulators::HidJoystick& levers)
      : script_(lever_script(configuration)),
        source_(configuration.source),
        period_(configuration.joystick.interval),
        levers_(levers),
        faults_(those_of<SampleFault>(configuration.faults), seed) {}

  [[nodiscard]] emulators::FaultySamples<JoystickSample>& faults() { return faults_; }
  void follow(std::vector<const ValveSource*> valves) { valves_ = std::move(valves); }

  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    for (; next_ <= now; next_ += period_) {
      JoystickSample sample;
      if (source_ == LeverSource::script) {
        sample = script_.at(next_);
      } else {
        for (const ValveSource* valves : valves_) {
          valves->lay_over(command_);
        }
        sample = sim::levers_of(command_, next_);
      }
      sample.time = next_;
      faults_.lay_over(sample);
      levers_.update(sample);
    }
  }

 private:
  sim::LeverScript script_;
  LeverSource source_;
  Duration period_;
  emulators::HidJoystick& levers_;
  emulators::FaultySamples<JoystickSample> faults_;
  std::vector<const ValveSource*> valves_;
  ValveCommand command_;  ///< Command of all valve sources together, by the machine's actuators.
  SimTime next_ = kStart;
};

class UsbJoystickDevice final : public Device {
 public:
  UsbJoystickDevice(const UsbJoystickConfiguration& configuration, Site& site)
      : bus_(site.usb()),
        levers_(configuration.joystick),
        mover_(configuration, site.stream_seed("faults/samples"), levers_),
        socket_(bus_.plug(levers_, site.name())) {
    offer(begin_plug_faults(those_of<PlugFault>(configuration.faults), bus_, socket_));
    offer(
        begin_supply_faults(those_of<emulators::SupplyFault>(configuration.faults), bus_, socket_));
    offer(make_fault_port(those_of<SampleFault>(configuration.faults),
                          acted_by<SampleFault>(mover_.faults())));
    // The bus lets the device live; there is nothing to be routed to it, so that it is no station.
    site.executive().add(mover_);
  }

  void connect(const Neighbours& neighbours) override { mover_.follow(neighbours.valves()); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return {bus_.address(socket_), bus_.imported(socket_)};
  }
  [[nodiscard]] std::uint64_t frames() const override { return levers_.reports_sent(); }
  [[nodiscard]] const emulators::Device& emulator() const override { return levers_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return client_request(levers_.last_request());
  }

 private:
  UsbBus& bus_;
  emulators::HidJoystick levers_;
  LeverMover mover_;
  UsbBus::Socket socket_;
};

}  // namespace

sim::LeverScript lever_script(const UsbJoystickConfiguration& p) {
  std::vector<sim::LeverKeyframe> keyframes;
  for (const LeverKeyframeConfiguration& from : p.script) {
    sim::LeverKeyframe keyframe{from.at, from.axes, {}};
    for (const double button : from.buttons) {
      if (button != std::floor(button)) {
        throw std::invalid_argument("lever script buttons: found " + std::to_string(button) +
                                    ", allowed whole numbers 1 .. 16");
      }
      keyframe.buttons.set(static_cast<std::size_t>(std::lround(button)) - 1);
    }
    keyframes.push_back(keyframe);
  }
  return {std::move(keyframes), p.repeat};
}

void visit(fields::Visitor& v, LeverKeyframeConfiguration& p) {
  const auto axis = [&](JoystickAxis which) -> double& {
    return p.axes[static_cast<std::size_t>(which)];
  };
  const NumberRule full = plain().between(-1, 1);
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns},
             "Instant at which it begins, from the start of the run.");
  v.number("left_x", axis(JoystickAxis::left_x), full,
           "Left stick, of full travel, right positive.");
  v.number("left_y", axis(JoystickAxis::left_y), full,
           "Left stick, of full travel, back positive.");
  v.number("right_x", axis(JoystickAxis::right_x), full,
           "Right stick, of full travel, right positive.");
  v.number("right_y", axis(JoystickAxis::right_y), full,
           "Right stick, of full travel, back positive.");
  v.number("left_pedal", axis(JoystickAxis::left_pedal), full,
           "Left pedal, of full travel, forward positive.");
  v.number("right_pedal", axis(JoystickAxis::right_pedal), full,
           "Right pedal, of full travel, forward positive.");
  v.number("dial", axis(JoystickAxis::dial), plain().between(0, 1),
           "Dial of the engine's speed, of full travel.");
  v.number_list("buttons", p.buttons, plain().between(1, 16),
                "Numbers of the buttons that are pressed, 1 .. 16.");
}

void UsbJoystickConfiguration::visit(fields::Visitor& v) {
  emulators::visit(v, joystick);
  v.choice("source", source, kLeverSources, "What moves the levers.");
  v.only_if(source == LeverSource::script, "source", "source: script", [this](fields::Visitor& w) {
    w.boolean("repeat", repeat, "The script begins again at its last keyframe.");
    w.list("script", script, "Keyframes; linear between them.");
  });
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

void UsbJoystickConfiguration::validate() const {
  emulators::validate(joystick);
  static_cast<void>(lever_script(*this));
}

void UsbJoystickConfiguration::check(const std::string& at, RigCheck& check) const {
  check.usb();
  if (source == LeverSource::commands && check.rig().actuators.empty()) {
    check.report(at + ".source", "the machine has no valve block", "commands", "script");
  }
}

void UsbJoystickConfiguration::each_fault(const FaultEar& take) {
  show_faults(faults, take);
}

std::vector<fields::Named> UsbJoystickConfiguration::fault_kinds() const {
  return mixed_kinds(faults);
}

DevicePlan UsbJoystickConfiguration::plan(const RigView& rig) const {
  return {
      usb_wire(rig),
      fmt::format("when moved, each {} at most", fields::print_duration(joystick.interval.count())),
      "",
      source == LeverSource::script ? fmt::format("{} keyframes", script.size())
                                    : "as the valves are commanded"};
}

std::optional<BusShare> UsbJoystickConfiguration::bus_share(std::string_view /*name*/) const {
  return std::nullopt;
}

DeviceDescription UsbJoystickConfiguration::describe() const {
  DeviceDescription description;
  description.quantities = quantities_of(emulators::HidJoystick(joystick));
  description.wire = "USB full speed, HID, by USB/IP, default 127.0.0.1:3240";
  description.document =
      "Universal Serial Bus 2.0; Device Class Definition for HID 1.11; layout in "
      "docs/devices/usb-joystick.md";
  description.messages = {
      {"input report", "when moved, every 10 ms at most", "7 axes, 16 buttons, 16 bytes"},
      {"GET_REPORT, GET_IDLE", "on request", "the present report, the idle time"},
      {"SET_IDLE", "received", "repeats the report while nothing moves"}};
  return description;
}

std::unique_ptr<Device> UsbJoystickConfiguration::make(Site& site) const {
  return std::make_unique<UsbJoystickDevice>(*this, site);
}

}  // namespace rigwire::hil
