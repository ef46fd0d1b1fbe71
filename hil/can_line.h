// One CAN bus of the rig at run time: the bus model, its devices, and the way outside.
#pragma once

#include <memory>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/can/can_bus.h"
#include "hil/event_source.h"
#include "hil/outlet.h"
#include "hil/wire_statistics.h"

namespace rigwire::hil {

/// Every frame that a device of the bus has sent goes to the endpoint at its end of frame, in the
/// device's own statistics.
class CanLine final : public EventSource {
 public:
  /// `endpoint` must outlive the line.
  CanLine(const emulators::CanBusSettings& settings, drivers::CanBus& endpoint);
  ~CanLine() override;

  /// A new node; the output is what its device must be constructed with. `statistics` must outlive
  /// the line.
  [[nodiscard]] emulators::FrameOutput& add_node(WireStatistics& statistics);
  /// The device that was constructed with `output`.
  void attach(emulators::FrameOutput& output, emulators::CanDevice& device);

  /// A frame that came in from the endpoint.
  void receive(SimTime now, const protocols::can::Frame& frame) { bus_.receive(now, frame); }

  [[nodiscard]] Outlet& outlet() { return outlet_; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const { return endpoint_.status(); }
  [[nodiscard]] const emulators::CanBusModel& bus() const { return bus_; }

  [[nodiscard]] SimTime next_event() const override { return bus_.next_event(); }
  [[nodiscard]] SimTime next_wakeup() const override { return bus_.next_event(); }
  void advance(SimTime now) override { bus_.advance(now); }

 private:
  class NodeExit;
  drivers::CanBus& endpoint_;
  FrameOutlet outlet_;
  std::vector<std::unique_ptr<NodeExit>> exits_;
  emulators::CanBusModel bus_;
};

}  // namespace rigwire::hil
