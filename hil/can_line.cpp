#include "hil/can_line.h"

namespace rigwire::hil {

/// Where the frames of one node leave the bus.
class CanLine::NodeExit final : public emulators::FrameOutput {
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

CanLine::CanLine(const emulators::CanBusSettings& settings, drivers::CanBus& endpoint)
    : outlet_(endpoint), bus_(settings) {}

CanLine::~CanLine() = default;

emulators::FrameOutput& CanLine::add_node(WireStatistics& statistics) {
  exits_.push_back(std::make_unique<NodeExit>(outlet_, statistics));
  return bus_.add_node(*exits_.back());
}

void CanLine::attach(emulators::FrameOutput& output, emulators::CanDevice& device) {
  bus_.attach(output, device);
}

}  // namespace rigwire::hil
