#include "hil/wires/rig_can.h"

#include <algorithm>

#include "emulators/can/can_fault_schedule.h"
#include "hil/wires/can_bus_configuration.h"

namespace rigwire::hil {
namespace {

/// The queue, the frame on the wire, and those refused within one look at the endpoint.
std::size_t unsettled_frames(const emulators::CanBusSettings& settings) {
  return 2 * settings.queue_frames + 64;
}

}  // namespace

/// Where the frames of one node leave the bus.
class RigCan::NodeExit final : public emulators::FrameOutput {
 public:
  NodeExit(FrameOutlet& outlet, WireStatistics& statistics)
      : outlet_(outlet), statistics_(statistics) {}

  void send(SimTime due, const protocols::can::Frame& frame) override {
    outlet_.send(due, statistics_, frame);
  }

 private:
  FrameOutlet& outlet_;
  WireStatistics& statistics_;
};

RigCan::RigCan(const emulators::CanBusSettings& settings, drivers::CanBus& endpoint,
               RigCanSettings outside)
    : endpoint_(endpoint),
      outside_settings_(std::move(outside)),
      outlet_(endpoint, unsettled_frames(settings)),
      bus_(settings) {
  bus_.set_outside(*this);
  client(kStart, drivers::CanClient{.open = !outside_settings_.client_is_known});
  if (outside_settings_.acknowledging_node) {
    (void)bus_.add_node(exit_to(intruder_), {.name = "acknowledger"});
  }
}

RigCan::~RigCan() = default;

emulators::FrameOutput& RigCan::exit_to(WireStatistics& statistics) {
  exits_.push_back(std::make_unique<NodeExit>(outlet_, statistics));
  return *exits_.back();
}

void RigCan::begin_device(const std::string& name) {
  device_ = name;
  nodes_of_device_ = 0;
}

emulators::FrameOutput& RigCan::add_node(WireStatistics& statistics) {
  ++nodes_of_device_;
  outside_settings_.node.name = device_;
  if (!device_.empty() && nodes_of_device_ > 1) {
    outside_settings_.node.name += " " + std::to_string(nodes_of_device_);
  }
  return bus_.add_node(exit_to(statistics), outside_settings_.node);
}

void RigCan::attach(emulators::FrameOutput& output, emulators::CanDevice& device) {
  bus_.attach(output, device);
}

void RigCan::set_faults(const emulators::CanBusFaults& faults) {
  bus_.set_faults(faults, exit_to(intruder_));
}

std::unique_ptr<FaultPort> RigCan::fault_port(const std::vector<emulators::CanFault>& configured) {
  auto acts = acted_by<emulators::CanFault>(bus_.faults());
  acts.name = can_fault_name;
  return make_fault_port(configured, std::move(acts));
}

emulators::OutsideController RigCan::controller(const drivers::CanClient& client) const {
  return {.present = client.open,
          .bit_rate_bps = client.bit_rate_bps,
          .listen_only = client.listen_only,
          .one_shot = client.one_shot,
          .restart_after = outside_settings_.client_restart_after};
}

void RigCan::client(SimTime now, const drivers::CanClient& client) {
  bus_.set_client(now, controller(client));
}

drivers::EndpointStatus RigCan::endpoint() const {
  drivers::EndpointStatus status = endpoint_.status();
  for (const auto& port : ports_) {
    const drivers::EndpointStatus other = port->endpoint();
    status.client_present = status.client_present || other.client_present;
    status.readers = std::max(status.readers, other.readers);
  }
  status.further_ports = static_cast<unsigned>(ports_.size());
  return status;
}

RigCan::Port& RigCan::add_port(const std::string& name, drivers::CanBus& endpoint,
                               bool client_is_known) {
  ports_.push_back(std::make_unique<Port>(*this, name, endpoint, client_is_known));
  return *ports_.back();
}

RigCan::Port::Port(RigCan& can, const std::string& name, drivers::CanBus& endpoint,
                   bool client_is_known)
    : can_(can),
      endpoint_(endpoint),
      outlet_(endpoint, unsettled_frames(can.bus_.settings())),
      node_(can.bus_.add_node(can.exit_to(sent_), {.name = name})) {
  can.bus_.attach(node_, static_cast<emulators::CanDevice&>(*this));
  can.bus_.attach(node_, static_cast<emulators::CanOutside&>(*this));
  client(kStart, drivers::CanClient{.open = !client_is_known});
}

void RigCan::Port::client(SimTime now, const drivers::CanClient& client) {
  can_.bus_.set_client(now, node_, can_.controller(client));
}

}  // namespace rigwire::hil
