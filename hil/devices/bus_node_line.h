// A device that is a node of a CAN bus, whatever it measures: the emulator between its bus and its
// station, and the memory that outlives its supply.
#pragma once

#include <memory>
#include <utility>

#include "emulators/nonvolatile_memory.h"
#include "hil/devices/device_line.h"
#include "hil/executive/station.h"

namespace rigwire::hil {

using NodeMemory = std::unique_ptr<emulators::NonvolatileMemory>;

template <class Emulator, class StationType>
class BusNodeLine : public DeviceLine {
 public:
  /// The emulator is made of `arguments` and the node's output.
  template <class... Arguments>
  explicit BusNodeLine(CanLine& bus, const Arguments&... arguments)
      : bus_(bus),
        node_(bus.add_node(own_statistics())),
        emulator_(arguments..., node_),
        station_(emulator_, emulator_) {
    bus_.attach(node_, emulator_);
  }
  /// For an emulator that remembers: it is made of settings, memory and output.
  template <class Settings>
  BusNodeLine(CanLine& bus, const Settings& settings, NodeMemory memory)
      : bus_(bus),
        node_(bus.add_node(own_statistics())),
        memory_(std::move(memory)),
        emulator_(settings, *memory_, node_),
        station_(emulator_, emulator_) {
    bus_.attach(node_, emulator_);
  }

  DeviceIndex enlist(Executive& executive) override { return executive.add(station_); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return bus_.endpoint(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    const emulators::CanNodeCounters counters = bus_.bus().counters(node_);
    return statistics().dropped + counters.overflowed + counters.abandoned;
  }
  [[nodiscard]] const emulators::Device& device() const override { return emulator_; }

 protected:
  [[nodiscard]] Emulator& emulator() { return emulator_; }

 private:
  CanLine& bus_;
  emulators::FrameOutput& node_;
  NodeMemory memory_;  ///< Null when the emulator has none.
  Emulator emulator_;
  StationType station_;
};

}  // namespace rigwire::hil
