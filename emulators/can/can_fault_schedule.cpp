#include "emulators/can/can_fault_schedule.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rigwire::emulators {

CanFaultSchedule::CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                                   std::span<CanController* const> nodes, CanSegment& wire,
                                   FrameOutput& intruder_exit)
    : noise_(book_, faults.seed),
      nodes_(nodes.begin(), nodes.end()),
      wire_(wire),
      intruder_exit_(intruder_exit),
      bit_rate_bps_(bit_rate_bps) {
  for (const CanFault& fault : faults.list) {
    begin(fault);
  }
  wire.set_noise(noise_);
}

CanController& CanFaultSchedule::find_node(const CanFault& fault) const {
  const std::string name = node_of(fault);
  std::string names;
  for (CanController* node : nodes_) {
    const std::string& other = node->settings().name;
    if (other == name) {
      return *node;
    }
    names += other.empty() ? "" : (names.empty() ? "" : ", ") + other;
  }
  throw std::invalid_argument("CAN bus fault: node is '" + name + "', allowed is " + names);
}

CanSegment& CanFaultSchedule::stub_of(CanController& node) {
  const auto found = std::ranges::find(stubs_, &node, &Stub::node);
  if (found != stubs_.end()) {
    return *found->wire;
  }
  stubs_.push_back({&node, std::make_unique<CanSegment>(node.settings().bit_rate_bps)});
  stubs_.back().wire->reserve(1);
  return *stubs_.back().wire;
}

CanFaultSchedule::Book::Id CanFaultSchedule::begin(const CanFault& fault) {
  validate(fault);
  const bool cuts = std::holds_alternative<DisconnectedFault>(fault.what);
  const bool of_node = cuts || std::holds_alternative<WrongRateFault>(fault.what);
  CanController* const node = of_node ? &find_node(fault) : nullptr;
  for (const Book::Entry& entry : book_.list()) {
    const CanFault& other = entry.fault;
    // A fault that repeats or waits for a condition counts with its whole possible extent.
    const SimTime both = std::max(other.when.earliest_begin(), fault.when.earliest_begin());
    if (of_node && other.what.index() == fault.what.index() && node_of(other) == node_of(fault) &&
        both < std::min(other.when.latest_end(), fault.when.latest_end())) {
      throw std::invalid_argument("CAN bus fault: two of one kind on node '" + node_of(fault) +
                                  "' overlap, allowed is one at a time");
    }
  }
  const Book::Id id = book_.add(fault);
  std::erase_if(node_faults_, [&](const NodeFault& old) { return !book_.has(old.id); });
  find_due();
  noise_.add_newest();
  if (of_node) {
    node_faults_.push_back({id, node, cuts ? &stub_of(*node) : nullptr});
    due_ = std::min(due_, fault.when.begin());
    find_due();
  } else if (const auto* intruder = std::get_if<IntruderFault>(&fault.what)) {
    add_intruder(id, frame_of(*intruder), intruder->period);
  } else if (const auto* claim = std::get_if<DuplicateAddressFault>(&fault.what)) {
    add_intruder(id, frame_of(*claim), claim->period);
  } else {
    wire_.reconsider();
  }
  return id;
}

bool CanFaultSchedule::end(Book::Id id, SimTime now) {
  if (!book_.end(id, now)) {
    return false;
  }
  due_ = std::min(due_, now);
  find_due();
  const auto intruder = std::ranges::find(intruders_, id, &Intruder::id);
  if (intruder != intruders_.end()) {
    intruder->next = std::min(intruder->next, now);
  }
  if (is_of_wire(book_.find(id))) {
    wire_.reconsider();
  }
  return true;
}

void CanFaultSchedule::add_intruder(Book::Id id, const protocols::can::Frame& frame,
                                    Duration period) {
  const SimTime begin = book_.find(id).when.begin();
  const auto over = [this](const Intruder& old) {
    const bool waits = book_.has(old.id) && book_.find(old.id).when.waits();
    return old.next == kNever && !old.node->is_open() && !waits;
  };
  if (const auto free = std::ranges::find_if(intruders_, over); free != intruders_.end()) {
    free->id = id;
    free->frame = frame;
    free->period = period;
    free->next = begin;
    return;
  }
  CanNodeSettings settings;
  settings.name = "intruder " + std::to_string(intruders_.size() + 1);
  settings.bit_rate_bps = bit_rate_bps_;
  settings.queue_frames = 1;
  intruders_.push_back(
      {id, std::make_unique<CanController>(settings, &intruder_exit_), frame, period, begin});
  CanController& node = *intruders_.back().node;
  node.configure(kStart, {.present = false}, bit_rate_bps_);
  wire_.connect(kStart, node);
  intruder_nodes_.push_back(&node);
}

/// The next instant at which the book says otherwise of a node than is acted out. What ends goes
/// first: the same node may have the next one at once.
void CanFaultSchedule::find_due() {
  for (pending_ = kNone; due_ != kNever;
       due_ = book_.next_change<WrongRateFault, DisconnectedFault>(due_)) {
    for (std::size_t i = 0; i < node_faults_.size(); ++i) {
      const NodeFault& fault = node_faults_[i];
      if (book_.find(fault.id).when.holds(due_) != fault.acts &&
          (pending_ == kNone || (fault.acts && !node_faults_[pending_].acts))) {
        pending_ = i;
      }
    }
    if (pending_ != kNone) {
      return;
    }
  }
}

SimTime CanFaultSchedule::next_change() const {
  if (pending_ == kNone) {
    return kNever;
  }
  const CanSegment* stub = node_faults_[pending_].stub;
  return wire_.busy() || (stub != nullptr && stub->busy()) ? kNever : due_;
}

SimTime CanFaultSchedule::next_event() const {
  SimTime next = next_change();
  for (const Stub& stub : stubs_) {
    next = std::min(next, stub.wire->next_event());
  }
  for (const Intruder& intruder : intruders_) {
    next = std::min(next, intruder.next);
  }
  return next;
}

void CanFaultSchedule::step(SimTime now) {
  if (next_change() <= now) {
    change(now, node_faults_[pending_]);
    find_due();
    return;
  }
  for (Intruder& intruder : intruders_) {
    if (intruder.next <= now) {
      intrude(now, intruder);
      return;
    }
  }
  for (const Stub& stub : stubs_) {
    if (stub.wire->next_event() <= now) {
      stub.wire->step();
      return;
    }
  }
}

void CanFaultSchedule::change(SimTime now, NodeFault& fault) {
  fault.acts = !fault.acts;
  if (fault.stub == nullptr) {
    const auto& wrong = std::get<WrongRateFault>(book_.find(fault.id).what);
    fault.node->override_rate(fault.acts ? std::optional(wrong.bit_rate_bps) : std::nullopt);
  } else if (fault.acts) {
    wire_.disconnect(*fault.node);
    fault.stub->connect(now, *fault.node);
  } else {
    fault.stub->disconnect(*fault.node);
    wire_.connect(now, *fault.node);
  }
}

void CanFaultSchedule::intrude(SimTime now, Intruder& intruder) {
  const FaultPeriod& when = book_.find(intruder.id).when;
  if (!when.holds(intruder.next)) {
    if (intruder.node->is_open()) {
      intruder.node->configure(now, {.present = false}, bit_rate_bps_);
    }
    intruder.next = when.next_edge(intruder.next);
    return;
  }
  if (!intruder.node->is_open()) {
    intruder.node->configure(now, {}, bit_rate_bps_);
  }
  intruder.node->send(intruder.next, intruder.frame);
  intruder.next = std::min(intruder.next + intruder.period, when.next_edge(intruder.next));
}

}  // namespace rigwire::emulators
