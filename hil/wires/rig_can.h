// One CAN bus of the rig at run time: the bus model, its devices, and its endpoint.
//
// Nodes are added device by device, in the order of the devices' names; faults come last. The bus
// goes to the executive first, then its outlets: a frame is due on the wire only when the bus has
// sent it. Owns model, nodes and outlets. The endpoints must outlive it; devices and their
// statistics must live to its last advance().
//
// The bus has one endpoint, and further ports as wanted: each is a node of its own with its own
// client, bit rate, error counters and acknowledgement, like a second adapter on the bus. What one
// port's client sends, all others receive.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/can/can_bus.h"
#include "hil/configuration/fault_port.h"
#include "hil/executive/event_source.h"
#include "hil/wires/outlets.h"
#include "hil/wires/wire_statistics.h"

namespace rigwire::hil {

/// What a RigCan has besides the bus model's own settings.
struct RigCanSettings {
  /// For every node of a device; its name is begin_device()'s.
  emulators::CanNodeSettings node{};
  /// Restart delay of the client's controller after bus-off; nullopt: the client requests the
  /// restart.
  std::optional<Duration> client_restart_after = std::chrono::milliseconds{100};
  /// The endpoint reports whether a client is there (CanBus::on_client). False: there always is
  /// one.
  bool client_is_known = false;
  /// One node more that sends nothing and acknowledges everything, as the rest of a machine does.
  bool acknowledging_node = false;
};

/// Joins bus model and endpoint. Every frame that a device of the bus has sent goes to the endpoint
/// at its end of frame, in the device's own statistics. The client's frames enter as those of the
/// outside node; their confirmations, and the reports of its controller, go back in due time and in
/// order. The client's settings of its controller are the outside node's.
class RigCan final : public EventSource, private emulators::CanOutside {
 public:
  /// `endpoint` must outlive it. Throws std::invalid_argument.
  RigCan(const emulators::CanBusSettings& settings, drivers::CanBus& endpoint,
         RigCanSettings outside = {});
  ~RigCan() override;
  RigCan(const RigCan&) = delete;
  RigCan& operator=(const RigCan&) = delete;

  /// Starts the nodes of the device of this name: faults know its first node by it, further ones as
  /// "NAME 2" and so on.
  void begin_device(const std::string& name);
  /// Adds a node; the returned output is what its device must be constructed with. `statistics`
  /// must live to the last advance(). Throws std::invalid_argument for settings of nodes out of
  /// range.
  [[nodiscard]] emulators::FrameOutput& add_node(WireStatistics& statistics);
  /// Attaches the device that was constructed with `output`; it must live to the last advance().
  void attach(emulators::FrameOutput& output, emulators::CanDevice& device);
  /// To be called after the last add_node(), before the run. Throws std::invalid_argument.
  void set_faults(const emulators::CanBusFaults& faults);
  /// Returns the port for the faults that were set, and for more. It must outlive the port.
  [[nodiscard]] std::unique_ptr<FaultPort> fault_port(
      const std::vector<emulators::CanFault>& configured);

  /// Adds a further port, before the first device; `name` is its node's, by which faults know it.
  /// `client_is_known`: as in RigCanSettings, of this endpoint. Throws std::invalid_argument.
  class Port;
  [[nodiscard]] Port& add_port(const std::string& name, drivers::CanBus& endpoint,
                               bool client_is_known);

  /// Takes a frame that came in from the endpoint.
  void receive(SimTime now, const protocols::can::Frame& frame) { bus_.receive(now, frame); }
  /// Takes what the endpoint's on_client() reports.
  void client(SimTime now, const drivers::CanClient& client);

  [[nodiscard]] FrameOutlet& outlet() { return outlet_; }
  /// Returns the status of the first endpoint; a client is present when any port has one.
  [[nodiscard]] drivers::EndpointStatus endpoint() const;
  [[nodiscard]] const emulators::CanBusModel& bus() const { return bus_; }
  /// Returns the statistics of what the client is sent besides frames of devices.
  [[nodiscard]] const WireStatistics& controller_statistics() const {
    return outlet_.controller_statistics();
  }

  [[nodiscard]] SimTime next_event() const override { return bus_.next_event(); }
  [[nodiscard]] SimTime next_wakeup() const override { return bus_.next_event(); }
  void advance(SimTime now) override { bus_.advance(now); }

 private:
  class NodeExit;
  void confirm(SimTime now, bool sent) override { outlet_.confirm(now, sent); }
  void report(SimTime now, const protocols::can::ControllerReport& report) override {
    outlet_.report(now, report);
  }
  [[nodiscard]] emulators::FrameOutput& exit_to(WireStatistics& statistics);
  [[nodiscard]] emulators::OutsideController controller(const drivers::CanClient& client) const;

  drivers::CanBus& endpoint_;
  RigCanSettings outside_settings_;
  std::string device_;
  int nodes_of_device_ = 0;
  FrameOutlet outlet_;
  WireStatistics intruder_;
  std::vector<std::unique_ptr<NodeExit>> exits_;
  emulators::CanBusModel bus_;
  std::vector<std::unique_ptr<Port>> ports_;
};

/// A further port of the bus, with its endpoint.
class RigCan::Port final : private emulators::CanDevice, private emulators::CanOutside {
 public:
  Port(RigCan& can, const std::string& name, drivers::CanBus& endpoint, bool client_is_known);

  void receive_from_client(SimTime now, const protocols::can::Frame& frame) {
    node_.send(now, frame);
  }
  void client(SimTime now, const drivers::CanClient& client);
  [[nodiscard]] FrameOutlet& outlet() { return outlet_; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const { return endpoint_.status(); }
  /// Returns the statistics of the other nodes' frames that its client was given.
  [[nodiscard]] const WireStatistics& statistics() const { return heard_; }

 private:
  void receive(SimTime now, const protocols::can::Frame& frame) override {
    outlet_.send(now, heard_, frame);
  }
  void confirm(SimTime now, bool sent) override { outlet_.confirm(now, sent); }
  void report(SimTime now, const protocols::can::ControllerReport& report) override {
    outlet_.report(now, report);
  }
  // It is no device: it does nothing by itself.
  void advance(SimTime /*now*/) override {}
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view /*name*/) const override {
    return {};
  }

  RigCan& can_;
  drivers::CanBus& endpoint_;
  FrameOutlet outlet_;
  WireStatistics heard_;
  WireStatistics sent_;  ///< Its client's frames, at the first endpoint.
  emulators::FrameOutput& node_;
};

}  // namespace rigwire::hil
