#include "hil/wires/rig_can.h"

namespace rigwire::hil {

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
               RigCanSettings line)
    : endpoint_(endpoint),
      line_(std::move(line)),
      // The queue, the frame on the wire, and those refused within one look at the endpoint.
      outlet_(endpoint, 2 * settings.queue_frames + 64),
      bus_(settings) {
  bus_.set_outside(*this);
  client(kStart, drivers::CanClient{.open = !line_.client_is_known});
  if (line_.acknowledging_node) {
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
  line_.node.name = device_;
  if (!device_.empty() && nodes_of_device_ > 1) {
    line_.node.name += " " + std::to_string(nodes_of_device_);
  }
  return bus_.add_node(exit_to(statistics), line_.node);
}

void RigCan::attach(emulators::FrameOutput& output, emulators::CanDevice& device) {
  bus_.attach(output, device);
}

void RigCan::set_faults(const emulators::CanBusFaults& faults) {
  bus_.set_faults(faults, exit_to(intruder_));
}

void RigCan::client(SimTime now, const drivers::CanClient& client) {
  bus_.set_client(now, {.present = client.open,
                        .bit_rate_bps = client.bit_rate_bps,
                        .listen_only = client.listen_only,
                        .one_shot = client.one_shot,
                        .restart_after = line_.client_restart_after});
}

}  // namespace rigwire::hil
