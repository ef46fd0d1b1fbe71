#include "emulators/can/can_fault_schedule.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rigwire::emulators {
namespace {

CanController& find_node(const std::string& name, std::span<CanController* const> nodes) {
  std::string names;
  for (CanController* node : nodes) {
    const std::string& other = node->settings().name;
    if (other == name) {
      return *node;
    }
    names += other.empty() ? "" : (names.empty() ? "" : ", ") + other;
  }
  throw std::invalid_argument("CAN bus fault: node is '" + name + "', allowed is " + names);
}

}  // namespace

CanFaultSchedule::CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                                   std::span<CanController* const> nodes, CanSegment& wire,
                                   FrameOutput& intruder_exit)
    : wire_(wire), bit_rate_bps_(bit_rate_bps) {
  wire.set_noise(CanNoise(faults));
  for (const CanFault& fault : faults.list) {
    if (const auto* wrong = std::get_if<WrongRateFault>(&fault.what)) {
      change_node(fault.when, find_node(wrong->device, nodes), wrong->bit_rate_bps, nullptr);
    } else if (const auto* broken = std::get_if<DisconnectedFault>(&fault.what)) {
      CanController& node = find_node(broken->device, nodes);
      stubs_.push_back(std::make_unique<CanSegment>(node.bit_rate_bps()));
      stubs_.back()->reserve(1);
      change_node(fault.when, node, 0, stubs_.back().get());
    } else if (const auto* intruder = std::get_if<IntruderFault>(&fault.what)) {
      add_intruder(fault.when, frame_of(*intruder), intruder->period, intruder_exit);
    } else if (const auto* claim = std::get_if<DuplicateAddressFault>(&fault.what)) {
      add_intruder(fault.when, frame_of(*claim), claim->period, intruder_exit);
    }
  }
  std::ranges::stable_sort(changes_, {}, &Change::at);
}

void CanFaultSchedule::change_node(const FaultPeriod& when, CanController& node,
                                   std::uint32_t bit_rate_bps, CanSegment* stub) {
  // Begin and end of a fault stand one after the other.
  for (std::size_t i = 0; i + 1 < changes_.size(); i += 2) {
    const Change& other = changes_[i];
    const bool same_kind = (other.stub == nullptr) == (stub == nullptr);
    if (other.node == &node && same_kind && other.at < when.end() &&
        changes_[i + 1].at > when.begin()) {
      throw std::invalid_argument("CAN bus fault: two of one kind on node '" +
                                  node.settings().name + "' overlap, allowed is one at a time");
    }
  }
  changes_.push_back({when.begin(), &node, true, bit_rate_bps, stub});
  changes_.push_back({when.end(), &node, false, bit_rate_bps, stub});
}

void CanFaultSchedule::add_intruder(const FaultPeriod& when, const protocols::can::Frame& frame,
                                    Duration period, FrameOutput& exit) {
  CanNodeSettings settings;
  settings.name = "intruder " + std::to_string(intruders_.size() + 1);
  settings.bit_rate_bps = bit_rate_bps_;
  settings.queue_frames = 1;
  intruders_.push_back(
      {std::make_unique<CanController>(settings, &exit), frame, when.begin(), when.end(), period});
  CanController& node = *intruders_.back().node;
  node.configure(kStart, {.present = false}, bit_rate_bps_);
  wire_.connect(kStart, node);
  intruder_nodes_.push_back(&node);
}

SimTime CanFaultSchedule::next_change() const {
  if (next_change_ == changes_.size()) {
    return kNever;
  }
  const Change& change = changes_[next_change_];
  const bool waits = wire_.busy() || (change.stub != nullptr && change.stub->busy());
  return waits ? kNever : change.at;
}

SimTime CanFaultSchedule::next_event() const {
  SimTime next = next_change();
  for (const auto& stub : stubs_) {
    next = std::min(next, stub->next_event());
  }
  for (const Intruder& intruder : intruders_) {
    next = std::min(next, intruder.next);
  }
  return next;
}

void CanFaultSchedule::step(SimTime now) {
  if (next_change() <= now) {
    change(now, changes_[next_change_++]);
    return;
  }
  for (Intruder& intruder : intruders_) {
    if (intruder.next <= now) {
      intrude(now, intruder);
      return;
    }
  }
  for (const auto& stub : stubs_) {
    if (stub->next_event() <= now) {
      stub->step();
      return;
    }
  }
}

void CanFaultSchedule::change(SimTime now, const Change& change) {
  if (change.stub == nullptr) {
    change.node->override_rate(change.begins ? std::optional(change.bit_rate_bps) : std::nullopt);
  } else if (change.begins) {
    wire_.disconnect(*change.node);
    change.stub->connect(now, *change.node);
  } else {
    change.stub->disconnect(*change.node);
    wire_.connect(now, *change.node);
  }
}

void CanFaultSchedule::intrude(SimTime now, Intruder& intruder) {
  if (intruder.next >= intruder.end) {
    intruder.node->configure(now, {.present = false}, bit_rate_bps_);
    intruder.next = kNever;
    return;
  }
  if (!intruder.node->is_open()) {
    intruder.node->configure(now, {}, bit_rate_bps_);
  }
  intruder.node->send(intruder.next, intruder.frame);
  intruder.next = std::min(intruder.next + intruder.period, intruder.end);
}

}  // namespace rigwire::emulators
