#include "hil/devices/usb_joystick_line.h"

#include "hil/executive/event_source.h"

namespace rigwire::hil {
namespace {

/// Moves the levers at the rate at which they can be reported.
class LeverMover final : public EventSource {
 public:
  LeverMover(const UsbJoystickConfiguration& configuration, emulators::HidJoystick& levers)
      : script_(lever_script(configuration)),
        source_(configuration.source),
        period_(configuration.joystick.interval),
        levers_(levers) {}

  void follow(const emulators::ValveBackend& valves) { valves_ = &valves; }

  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    for (; next_ <= now; next_ += period_) {
      if (source_ == LeverSource::script) {
        levers_.update(script_.at(next_));
      } else if (valves_ != nullptr) {
        levers_.update(sim::levers_of(valves_->command(), next_));
      }
    }
  }

 private:
  sim::LeverScript script_;
  LeverSource source_;
  Duration period_;
  emulators::HidJoystick& levers_;
  const emulators::ValveBackend* valves_ = nullptr;
  SimTime next_ = kStart;
};

class UsbJoystickLine final : public JoystickLine {
 public:
  UsbJoystickLine(const UsbJoystickConfiguration& configuration, UsbBus& bus, std::string_view name)
      : bus_(bus),
        levers_(configuration.joystick),
        mover_(configuration, levers_),
        socket_(bus.plug(levers_, name)) {
    for (const UnplugConfiguration& unplug : configuration.unplugged) {
      bus.schedule_unplug(socket_, kStart + unplug.at, kStart + unplug.at + unplug.length);
    }
  }

  /// The bus lets the device live; there is nothing to be routed to it, so that it is no station.
  DeviceIndex enlist(Executive& executive) override {
    executive.add(mover_);
    return {};
  }
  void follow(const emulators::ValveBackend& valves) override { mover_.follow(valves); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return {bus_.address(socket_), bus_.imported(socket_)};
  }
  [[nodiscard]] std::uint64_t frames() const override { return levers_.reports_sent(); }
  [[nodiscard]] const emulators::Device& device() const override { return levers_; }

 private:
  UsbBus& bus_;
  emulators::HidJoystick levers_;
  LeverMover mover_;
  UsbBus::Socket socket_;
};

}  // namespace

std::unique_ptr<JoystickLine> make_line(const UsbJoystickConfiguration& configuration, UsbBus& bus,
                                        std::string_view name) {
  return std::make_unique<UsbJoystickLine>(configuration, bus, name);
}

}  // namespace rigwire::hil
