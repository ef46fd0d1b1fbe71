#include "emulators/can/can_fault_schedule.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rigwire::emulators {
namespace {

CanController& node_of(const CanBusFault& fault, std::span<CanController* const> nodes) {
  std::string names;
  for (CanController* node : nodes) {
    const std::string& name = node->settings().name;
    if (name == fault.node) {
      return *node;
    }
    names += name.empty() ? "" : (names.empty() ? "" : ", ") + name;
  }
  throw std::invalid_argument("CAN bus fault: node is '" + fault.node + "', allowed is " + names);
}

}  // namespace

CanFaultSchedule::CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                                   std::span<CanController* const> nodes, CanSegment& wire,
                                   FrameOutput& intruder_exit)
    : wire_(wire), bit_rate_bps_(bit_rate_bps) {
  wire.set_noise(CanNoise(faults));
  for (const CanBusFault& fault : faults.list) {
    const SimTime begin = kStart + fault.begin;
    const SimTime end = kStart + fault.end;
    if (fault.kind == CanBusFaultKind::wrong_rate || fault.kind == CanBusFaultKind::disconnected) {
      CanController& node = node_of(fault, nodes);
      CanSegment* stub = nullptr;
      for (const Change& other : changes_) {
        if (other.begins && other.node == &node && other.kind == fault.kind && other.at < end) {
          const auto other_end = std::ranges::find_if(changes_, [&](const Change& change) {
            return !change.begins && change.node == &node && change.kind == fault.kind &&
                   change.at > other.at;
          });
          if (other_end != changes_.end() && other_end->at > begin) {
            throw std::invalid_argument("CAN bus fault: two of one kind on node '" + fault.node +
                                        "' overlap, allowed is one at a time");
          }
        }
      }
      if (fault.kind == CanBusFaultKind::disconnected) {
        stubs_.push_back(std::make_unique<CanSegment>(node.bit_rate_bps()));
        stub = stubs_.back().get();
        stub->reserve(1);
      }
      changes_.push_back({begin, &node, fault.kind, true, fault.bit_rate_bps, stub});
      changes_.push_back({end, &node, fault.kind, false, fault.bit_rate_bps, stub});
    } else if (fault.kind == CanBusFaultKind::intruder) {
      CanNodeSettings settings;
      settings.name = "intruder " + std::to_string(intruders_.size() + 1);
      settings.bit_rate_bps = bit_rate_bps;
      settings.queue_frames = 1;
      intruders_.push_back({std::make_unique<CanController>(settings, &intruder_exit), fault.frame,
                            begin, end, fault.period});
      CanController& node = *intruders_.back().node;
      node.configure(kStart, {.present = false}, bit_rate_bps);
      wire.connect(kStart, node);
      intruder_nodes_.push_back(&node);
    }
  }
  std::ranges::stable_sort(changes_, {}, &Change::at);
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
  if (change.kind == CanBusFaultKind::wrong_rate) {
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
