// A device that is a node of a CAN bus, whatever it measures: the emulator between its bus and its
// station, and the memory that outlives its supply.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "emulators/nonvolatile_memory.h"
#include "emulators/null_output.h"
#include "hil/devices/device.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"

namespace rigwire::hil {

using NodeMemory = std::unique_ptr<emulators::NonvolatileMemory>;

/// `Backend` is the face of the emulator that takes its samples (emulators/backends.h).
template <class Emulator, class Backend>
class CanDeviceOf : public Device {
 public:
  /// The emulator is made of `arguments` and the node's output.
  template <class... Arguments>
  explicit CanDeviceOf(RigCan& bus, const Arguments&... arguments)
      : bus_(bus),
        node_(bus.add_node(own_statistics())),
        emulator_(arguments..., node_),
        station_(emulator_, emulator_) {
    bus_.attach(node_, emulator_);
  }
  /// For an emulator that remembers: it is made of settings, memory and output.
  template <class Settings>
  CanDeviceOf(RigCan& bus, const Settings& settings, NodeMemory memory)
      : bus_(bus),
        node_(bus.add_node(own_statistics())),
        memory_(std::move(memory)),
        emulator_(settings, *memory_, node_),
        station_(emulator_, emulator_) {
    bus_.attach(node_, emulator_);
  }

  /// Once, after construction.
  [[nodiscard]] StationIndex enlist(Executive& executive) { return executive.add(station_); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return bus_.endpoint(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    const emulators::CanNodeCounters counters = bus_.bus().counters(node_);
    return statistics().dropped + counters.overflowed + counters.abandoned;
  }
  [[nodiscard]] const Emulator& emulator() const override { return emulator_; }

 protected:
  [[nodiscard]] Emulator& emulated() { return emulator_; }

 private:
  RigCan& bus_;
  emulators::FrameOutput& node_;
  NodeMemory memory_;  ///< Null when the emulator has none.
  Emulator emulator_;
  StationOf<Backend> station_;
};

/// What an emulator answers that is built of `arguments` and an output that leads nowhere: `ask` is
/// given the emulator.
template <class Emulator, class Ask, class... Arguments>
[[nodiscard]] auto asked(const Ask& ask, const Arguments&... arguments) {
  emulators::NullFrameOutput nowhere;
  return ask(Emulator(arguments..., nowhere));
}
/// The same for an emulator that remembers.
template <class Emulator, class Ask, class Settings>
[[nodiscard]] auto asked_with_memory(const Ask& ask, const Settings& settings) {
  emulators::VolatileMemory memory;
  emulators::NullFrameOutput nowhere;
  return ask(Emulator(settings, memory, nowhere));
}

/// What a device on a CAN bus does there, asked of its emulator.
[[nodiscard]] inline auto bus_share_of(const std::string& bus, std::string_view name) {
  return [bus, name](const emulators::CanDevice& emulator) {
    return BusShare{bus, emulator.nominal_rate_hz(), emulator.messages(name)};
  };
}

/// "can NAME at 250000 bit/s, WHO".
[[nodiscard]] std::string can_wire(const RigView& rig, const std::string& bus,
                                   const std::string& who);
/// A J1939 node that sends frames of 8 bytes.
[[nodiscard]] DevicePlan j1939_plan(const RigView& rig, const std::string& bus, unsigned address,
                                    double frames_hz, const std::string& with);

}  // namespace rigwire::hil
