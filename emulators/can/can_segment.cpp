#include "emulators/can/can_segment.h"

#include <algorithm>

#include "protocols/can/wire_frame.h"

namespace rigwire::emulators {

using protocols::can::kInterframeBits;
using protocols::can::WireFrame;

namespace {

constexpr unsigned kSuspendBits = 8;
/// Recessive bits at the end of a good frame: acknowledge delimiter, end of frame, intermission.
constexpr unsigned kQuietEndBits = 1 + 7 + kInterframeBits;

}  // namespace

void CanBusLoad::occupy(SimTime begin, SimTime end) {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  while (begin < end) {
    const std::int64_t bucket = begin.time_since_epoch() / kBucket;
    newest_ = std::max(newest_, bucket - size);
    while (newest_ < bucket) {
      ++newest_;
      busy_ns_[static_cast<std::size_t>(newest_ % size)] = 0;
    }
    const SimTime until = std::min(end, SimTime{(bucket + 1) * kBucket});
    // An occupied span is divided over the hundredths that it touches.
    busy_ns_[static_cast<std::size_t>(bucket % size)] += (until - begin).count();
    begin = until;
  }
}

double CanBusLoad::share(SimTime now) const {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  const std::int64_t current = now.time_since_epoch() / kBucket;
  std::int64_t busy = 0;
  for (std::int64_t bucket = std::max<std::int64_t>(current - kBuckets, 0); bucket < current;
       ++bucket) {
    if (bucket <= newest_ && bucket > newest_ - size) {
      busy += busy_ns_[static_cast<std::size_t>(bucket % size)];
    }
  }
  return static_cast<double>(busy) * 1e-9;
}

void CanSegment::reserve(std::size_t nodes) {
  nodes_.reserve(nodes);
  contenders_.reserve(nodes);
  losers_.reserve(nodes);
  bits_.reserve(nodes);
}

void CanSegment::connect(SimTime now, CanController& node) {
  reserve(nodes_.size() + 1);
  nodes_.push_back(&node);
  node.connect(now, &stale_);
}

void CanSegment::disconnect(CanController& node) {
  std::erase(nodes_, &node);
  stale_ = true;
}

SimTime CanSegment::start_of(const CanController& node) const {
  const SimTime wanted = node.next_start();
  return std::max(wanted, node.suspended() ? clock_.after(kSuspendBits) : clock_.now());
}

SimTime CanSegment::first_start() const {
  SimTime start = kNever;
  for (const CanController* node : nodes_) {
    start = std::min(start, start_of(*node));
  }
  return start;
}

SimTime CanSegment::recovered_at(const CanController& node) const {
  // ISO 11898-1, 12.1.4.4: bus-off ends after 128 sequences of 11 recessive bits.
  return node.recessive_since() + clock_.span(static_cast<std::uint64_t>(node.sequences_left()) *
                                              CanController::kSequenceBits);
}

void CanSegment::find_next() const {
  stale_ = false;
  next_ = kNever;
  for (const CanController* node : nodes_) {
    next_ = std::min(next_, node->restart_at());
  }
  if (attempt_ == Attempt::good) {
    next_ = std::min(next_, clock_.after(contenders_.front().bits - kInterframeBits));
  } else if (attempt_ == Attempt::bit_by_bit) {
    next_ = std::min(next_, clock_.after(bits_.bit() + 1));
  } else {
    const SimTime start = first_start();
    for (const CanController* node : nodes_) {
      if (node->recovering() && recovered_at(*node) <= start) {
        next_ = std::min(next_, recovered_at(*node));
      }
    }
    if (start != kNever) {
      // A node that becomes ready within the first bit sees the start of frame and joins.
      next_ = std::min(next_, start + clock_.span(1));
    }
  }
}

void CanSegment::step() {
  const SimTime now = next_event();
  stale_ = true;
  const SimTime start = attempt_ == Attempt::none ? first_start() : kStart;
  for (CanController* node : nodes_) {
    if (node->restart_at() <= now) {
      node->begin_recovery(now);
      return;
    }
    if (attempt_ == Attempt::none && node->recovering() &&
        recovered_at(*node) <= std::min(start, now)) {
      node->recover(now);
      return;
    }
  }
  switch (attempt_) {
    case Attempt::none:
      arbitrate(start);
      break;
    case Attempt::good:
      complete();
      break;
    case Attempt::bit_by_bit:
      happen(now);
      go_on_bit_by_bit();
      break;
  }
}

void CanSegment::synchronise(SimTime start) {
  if (start == clock_.after(kSuspendBits)) {
    clock_.advance(kSuspendBits);
  } else if (start != clock_.now()) {
    clock_.synchronise(start);
  }
}

void CanSegment::arbitrate(SimTime start) {
  const SimTime offered_at = start + clock_.span(1) - Duration{1};
  choose_winners(offered_at);
  synchronise(start);
  for (CanController* node : nodes_) {
    if (node->recovering() && start > node->recessive_since()) {
      node->end_recessive_run(clock_.bits_in(start - node->recessive_since()));
    }
  }
  for (const Contender& contender : contenders_) {
    contender.node->begin(start, offered_at);
  }
  for (const Contender& loser : losers_) {
    loser.node->begin(start, offered_at);
  }
  const unsigned bits = contenders_.front().bits - kInterframeBits;
  begin_attempt(noise_ != nullptr ? noise_->attempt(clock_, bits) : CanLineState{});
}

void CanSegment::begin_attempt(const CanLineState& line) {
  told_ = false;
  if (goes_well(line)) {
    attempt_ = Attempt::good;
    occupy(contenders_.front().bits);
  } else {
    begin_bit_by_bit(line);
  }
}

void CanSegment::reconsider() {
  if (noise_ != nullptr && attempt_ != Attempt::none && !told_) {
    error_frames_ -= attempt_ == Attempt::bit_by_bit ? 1U : 0U;
    stale_ = true;
    begin_attempt(noise_->attempt_again(clock_, contenders_.front().bits - kInterframeBits));
  }
}

void CanSegment::occupy(unsigned bits) {
  const SimTime end = clock_.after(bits);
  load_.occupy(std::max(clock_.now(), loaded_until_), end);
  loaded_until_ = std::max(loaded_until_, end);
}

/// All that start in the same bit; of those only the most urgent, where all read each other.
void CanSegment::choose_winners(SimTime offered_at) {
  contenders_.clear();
  losers_.clear();
  std::uint32_t lowest = ~0U;
  bool one_rate = true;
  for (CanController* node : nodes_) {
    if (start_of(*node) <= offered_at) {
      const CanWaitingFrame& offered = node->offered(offered_at);
      contenders_.push_back({node, offered.frame, offered.arbitration_field, offered.bits});
      // Dominant bits win: the lowest arbitration field is the most urgent.
      lowest = std::min(lowest, offered.arbitration_field);
      one_rate = one_rate && keeps_rate(*node);
    }
  }
  if (contenders_.size() > 1 && one_rate) {
    std::erase_if(contenders_, [&](const Contender& contender) {
      if (contender.arbitration_field == lowest) {
        return false;
      }
      if (contender.node->settings().one_shot) {
        losers_.push_back(contender);
      } else {
        contender.node->lose_arbitration();
      }
      return true;
    });
  }
  collisions_ += contenders_.size() > 1 ? 1U : 0U;
}

bool CanSegment::goes_well(const CanLineState& line) const {
  if (contenders_.size() > 1 || !line.clean()) {
    return false;
  }
  bool acknowledged = false;
  for (const CanController* node : nodes_) {
    if (node->takes_part()) {
      if (!keeps_rate(*node)) {
        return false;
      }
      acknowledged = acknowledged || (node != contenders_.front().node && node->acknowledges());
    }
  }
  return acknowledged;
}

void CanSegment::complete() {
  const Contender sender = contenders_.front();
  const SimTime now = clock_.after(sender.bits - kInterframeBits);
  ++frames_;
  sender.node->sent(now);
  bool outside_hears = false;
  for (CanController* node : nodes_) {
    if (node != sender.node && node->takes_part()) {
      node->receive(now, sender.frame, sender.node->is_outside());
      outside_hears = outside_hears || node->is_outside();
    } else if (node->is_outside()) {
      outside_hears = !node->is_open();
    }
  }
  if (outside_hears && sender.node->exit() != nullptr) {
    sender.node->exit()->send(now, sender.frame);
  }
  settle_losers(now);
  end_attempt(sender.bits, sender.bits - kQuietEndBits);
}

void CanSegment::begin_bit_by_bit(const CanLineState& line) {
  attempt_ = Attempt::bit_by_bit;
  ++error_frames_;  // Until it turns out that it is none.
  bool one_rate = true;
  for (const CanController* node : nodes_) {
    one_rate = one_rate && (!node->takes_part() || keeps_rate(*node));
  }
  unsigned first_bit = 0;
  if (one_rate) {
    const WireFrame wire(contenders_.front().frame);
    // Up to the first bit that can go wrong or differ, all send and read the same.
    first_bit = std::min({wire.acknowledge_slot(), line.inverted_bit, line.short_begin});
    for (const Contender& other : contenders_) {
      first_bit = std::min(first_bit, first_difference(wire, WireFrame(other.frame)));
    }
  }
  bits_.begin(line, first_bit);
  for (const Contender& contender : contenders_) {
    bits_.add_transmitter(*contender.node, contender.frame);
  }
  for (CanController* node : nodes_) {
    if (node->takes_part() &&
        std::ranges::find(contenders_, node, &Contender::node) == contenders_.end()) {
      bits_.add_receiver(*node);
    }
  }
  go_on_bit_by_bit();
}

void CanSegment::go_on_bit_by_bit() {
  if (!bits_.run()) {
    settle_losers(clock_.after(bits_.length()));
    occupy(bits_.length());
    end_attempt(bits_.length(), bits_.recessive_from());
  }
}

void CanSegment::happen(SimTime now) {
  using enum CanHappening::Kind;
  told_ = true;
  const Contender& sender = contenders_[bits_.read_transmitter()];
  bool complete = false;
  bool good = false;
  bool outside_hears = false;
  for (const CanHappening& happening : bits_.happenings()) {
    CanController& node = *happening.node;
    switch (happening.kind) {
      case error:
        node.count_error(now, happening.rule, happening.report);
        break;
      case failed:
        node.failed(now);
        break;
      case lost:
        node.lost(now, happening.report.bit, happening.report.field);
        break;
      case sent:
        node.sent(now);
        good = complete = true;
        break;
      case received:
        node.receive(now, sender.frame, sender.node->is_outside());
        complete = true;
        outside_hears = outside_hears || node.is_outside();
        break;
    }
  }
  for (const CanController* node : nodes_) {
    outside_hears = outside_hears || (node->is_outside() && !node->is_open());
  }
  if (complete && outside_hears && sender.node->exit() != nullptr) {
    sender.node->exit()->send(now, sender.frame);
  }
  frames_ += good ? 1U : 0U;
  error_frames_ -= good ? 1U : 0U;
}

void CanSegment::settle_losers(SimTime now) {
  for (const Contender& loser : losers_) {
    const WireFrame wire(loser.frame);
    const unsigned bit = first_difference(WireFrame(contenders_.front().frame), wire);
    loser.node->lost(now, static_cast<std::uint8_t>(bit), wire.field(bit));
  }
  losers_.clear();
}

void CanSegment::end_attempt(unsigned length, unsigned recessive_from) {
  const SimTime recessive = clock_.after(recessive_from);
  clock_.advance(length);
  for (CanController* node : nodes_) {
    node->set_suspended(false);
    if (node->recovering()) {
      node->begin_recessive_run(recessive);
    }
  }
  for (const Contender& contender : contenders_) {
    contender.node->set_suspended(true);
  }
  attempt_ = Attempt::none;
}

}  // namespace rigwire::emulators
