#include "emulators/can/can_bus.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "emulators/can/can_fault_schedule.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using protocols::can::ControllerReport;
using protocols::can::Frame;

namespace {

constexpr std::uint32_t kLeastRate_bps = 10'000;
constexpr std::uint32_t kGreatestRate_bps = 1'000'000;

}  // namespace

void visit(fields::Visitor& v, CanBusSettings& p) {
  v.integer("bitrate", p.bit_rate_bps,
            fields::IntegerRule{kLeastRate_bps, kGreatestRate_bps, fields::unit("bit/s")},
            "Bit rate of the bus.");
  v.integer("queue", p.queue_frames, fields::IntegerRule{1, 65536},
            "Frames that may wait in a node.");
}

void validate(const CanBusSettings& settings) {
  fields::check(settings);
}

void validate(const CanNodeSettings& settings) {
  const std::uint32_t rate = settings.bit_rate_bps;
  fields::require(rate == 0 || (rate >= kLeastRate_bps && rate <= kGreatestRate_bps), "bit_rate",
                  std::to_string(rate) + " bit/s", "0 or 10000 .. 1000000 bit/s");
  fields::require(settings.queue_frames <= 65'536, "queue", std::to_string(settings.queue_frames),
                  "0 .. 65536");
  const Duration restart = settings.restart_after.value_or(Duration{0});
  fields::require(restart >= Duration{0} && restart <= std::chrono::hours{1}, "restart_after",
                  std::to_string(restart.count()) + " ns", "0 .. 1 h");
}

CanBusModel::CanBusModel(const CanBusSettings& settings)
    : settings_((validate(settings), settings)), wire_(settings.bit_rate_bps) {
  CanNodeSettings outside;
  outside.name = kCanOutsideName;
  outside.restart_after = client_.restart_after;
  connect(outside, nullptr);
}

CanBusModel::~CanBusModel() = default;

CanController& CanBusModel::connect(const CanNodeSettings& settings, FrameOutput* exit) {
  validate(settings);
  const bool taken = std::ranges::any_of(nodes_, [&settings](const auto& node) {
    return !settings.name.empty() && node->settings().name == settings.name;
  });
  if (taken) {
    throw std::invalid_argument("CAN node: name is '" + settings.name +
                                "', which another node of the bus has");
  }
  CanNodeSettings complete = settings;
  complete.bit_rate_bps =
      settings.bit_rate_bps != 0 ? settings.bit_rate_bps : settings_.bit_rate_bps;
  complete.queue_frames =
      settings.queue_frames != 0 ? settings.queue_frames : settings_.queue_frames;
  nodes_.push_back(std::make_unique<CanController>(complete, exit));
  wire_.connect(kStart, *nodes_.back());
  return *nodes_.back();
}

FrameOutput& CanBusModel::add_node(FrameOutput& exit, const CanNodeSettings& node) {
  return connect(node, &exit);
}

void CanBusModel::attach(FrameOutput& output, CanDevice& device) {
  node_of(output).attach(device);
}

void CanBusModel::attach(FrameOutput& output, CanOutside& outside) {
  node_of(output).attach(outside);
}

void CanBusModel::set_outside(CanOutside& outside) {
  nodes_.front()->attach(outside);
}

void CanBusModel::set_client(SimTime now, const OutsideController& client) {
  if (client == client_) {
    return;
  }
  client_ = client;
  configure(now, *nodes_.front(), client);
}

void CanBusModel::set_client(SimTime now, FrameOutput& output, const OutsideController& client) {
  configure(now, node_of(output), client);
}

void CanBusModel::configure(SimTime now, CanController& node,
                            const OutsideController& client) const {
  OutsideController allowed = client;
  if (client.bit_rate_bps != 0) {
    allowed.bit_rate_bps = std::clamp(client.bit_rate_bps, kLeastRate_bps, kGreatestRate_bps);
  }
  node.configure(now, allowed, settings_.bit_rate_bps);
}

void CanBusModel::restart_outside(SimTime now) {
  nodes_.front()->restart(now);
}

void CanBusModel::set_faults(const CanBusFaults& faults, FrameOutput& intruder_exit) {
  validate(faults);
  if (faults_ != nullptr) {
    throw std::invalid_argument("CAN bus: faults are set twice");
  }
  std::vector<CanController*> known;
  for (const auto& node : nodes_) {
    known.push_back(node.get());
  }
  faults_ = std::make_unique<CanFaultSchedule>(faults, settings_.bit_rate_bps, known, wire_,
                                               intruder_exit);
}

void CanBusModel::receive(SimTime now, const Frame& frame) {
  nodes_.front()->send(now, frame);
}

SimTime CanBusModel::next_event() const {
  const SimTime next = wire_.next_event();
  return faults_ == nullptr ? next : std::min(next, faults_->next_event());
}

void CanBusModel::advance(SimTime now) {
  for (SimTime next = next_event(); next <= now; next = next_event()) {
    last_event_ = std::max(last_event_, next);
    if (faults_ != nullptr && faults_->next_event() <= wire_.next_event()) {
      faults_->step(last_event_);
    } else {
      wire_.step();
    }
  }
}

CanController& CanBusModel::node_of(const FrameOutput& output) const {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                  [&output](const auto& node) { return node.get() == &output; });
  if (found == nodes_.end()) {
    throw std::invalid_argument("CAN bus: the output is not one of this bus's nodes");
  }
  return **found;
}

CanNodeCounters CanBusModel::counters(const FrameOutput& output) const {
  return node_of(output).counters();
}

const std::optional<CanRequest>& CanBusModel::last_request(const FrameOutput& output) const {
  return node_of(output).last_request();
}

ControllerReport CanBusModel::controller(const FrameOutput& output) const {
  return node_of(output).status();
}

std::vector<CanNodeStatus> CanBusModel::nodes() const {
  std::vector<CanNodeStatus> result;
  const auto add = [&result](const CanController& node) {
    result.push_back({node.settings().name, node.bit_rate_bps(), node.counters(), node.status()});
  };
  for (const auto& node : nodes_) {
    add(*node);
  }
  if (faults_ != nullptr) {
    for (const CanController* intruder : faults_->intruders()) {
      add(*intruder);
    }
  }
  return result;
}

}  // namespace rigwire::emulators
