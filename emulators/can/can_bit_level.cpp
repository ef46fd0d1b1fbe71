#include "emulators/can/can_bit_level.h"

#include <algorithm>

namespace rigwire::emulators {

using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::Frame;
using protocols::can::kInterframeBits;
using protocols::can::WireFrame;

namespace {

constexpr unsigned kFlagBits = 6;
constexpr unsigned kDelimiterBits = 8;
constexpr unsigned kStuffViolation = 6;
constexpr unsigned kToleratedDominants = 8;  // Each such sequence after an error flag counts.

}  // namespace

void CanBitLevel::reserve(std::size_t nodes) {
  parties_.reserve(nodes);
  views_.reserve(nodes);
  happenings_.reserve(3 * nodes);
}

void CanBitLevel::begin(const CanLineState& line, unsigned first_bit) {
  line_ = line;
  parties_.clear();
  views_.clear();
  happenings_.clear();
  bit_ = first_bit;
  run_ = 0;
  last_ = true;
  seen_ = first_bit > 0;
  readable_ = true;
  corrupted_ = false;
  complete_ = false;
  one_rate_ = true;
  read_ = 0;
  length_ = 0;
  recessive_from_ = 0;
}

void CanBitLevel::add_transmitter(CanController& node, const Frame& frame) {
  CanWireView view(frame, node.bit_rate_bps(), segment_bps_);
  if (views_.empty()) {
    readable_ = view.readable();
    for (unsigned bit = 0; bit < bit_; ++bit) {
      const bool level = view.recessive(bit);
      run_ = level == last_ && bit > 0 ? run_ + 1 : 1;
      last_ = level;
      recessive_from_ = level ? recessive_from_ : bit + 1;
    }
  }
  one_rate_ = one_rate_ && view.readable();
  Party party;
  party.node = &node;
  party.does = Does::transmit;
  party.own = true;
  party.view = static_cast<std::uint16_t>(views_.size());
  party.flag_bits = std::max(1U, kFlagBits * segment_bps_ / node.bit_rate_bps());
  views_.push_back(view);
  parties_.push_back(party);
}

void CanBitLevel::add_receiver(CanController& node) {
  Party party;
  party.node = &node;
  if (node.bit_rate_bps() != segment_bps_) {
    party.misreads_at = views_.front().misread_at(node.bit_rate_bps());
    party.flag_bits = std::max(1U, kFlagBits * segment_bps_ / node.bit_rate_bps());
  }
  parties_.push_back(party);
}

bool CanBitLevel::sends_recessive(const Party& party) const {
  switch (party.does) {
    case Does::transmit:
      return views_[party.view].recessive(bit_);
    case Does::receive:
      return !(readable_ && seen_ && !corrupted_ && party.misreads_at == CanLineState::kNoBit &&
               party.node->acknowledges() && bit_ == read().wire().acknowledge_slot());
    case Does::active_flag:
      return false;
    default:
      return true;
  }
}

bool CanBitLevel::run() {
  happenings_.clear();
  while (busy() && happenings_.empty()) {
    // Wired-and of all senders (dominant is false), then inverted or shorted by the wire's faults.
    bool level = true;
    for (const Party& party : parties_) {
      level = level && sends_recessive(party);
    }
    level = level != (bit_ == line_.inverted_bit);
    level = level || (bit_ >= line_.short_begin && bit_ < line_.short_end);
    if (!seen_ && !level) {
      seen_ = true;
      readable_ = readable_ && bit_ == 0;
    }
    // Length of the run of equal bits, for the stuff rule.
    run_ = level == last_ && run_ > 0 ? run_ + 1 : (seen_ ? 1U : 0U);
    last_ = level;
    recessive_from_ = level ? recessive_from_ : bit_ + 1;
    for (Party& party : parties_) {
      observe(party, level);
    }
    const WireFrame& wire = read().wire();
    corrupted_ = corrupted_ || (bit_ < wire.stuffed_bits() && level != wire.recessive(bit_));
    ++bit_;
  }
  return !happenings_.empty();
}

/// Nodes that saw no start of frame wait for nothing.
bool CanBitLevel::busy() const {
  return !complete_ && std::ranges::any_of(parties_, [this](const Party& party) {
    return party.does != Does::nothing && (seen_ || party.does != Does::receive);
  });
}

/// A transmitter is out. Receivers read what another one still sends: up to here it was the same.
void CanBitLevel::choose_what_is_read() {
  const auto other = std::ranges::find(parties_, Does::transmit, &Party::does);
  if (other != parties_.end() && other->view != read_) {
    corrupted_ = corrupted_ || !read().readable();
    read_ = other->view;
    readable_ = readable_ && read().readable();
  }
}

void CanBitLevel::observe(Party& party, bool level) {
  if (party.does != Does::nothing && !party.node->takes_part()) {
    party.does = Does::nothing;  // Bus-off, or closed.
    length_ = std::max(length_, bit_);
    choose_what_is_read();
    return;
  }
  switch (party.does) {
    case Does::transmit:
      observe_transmitter(party, level);
      break;
    case Does::receive:
      observe_receiver(party, level);
      break;
    case Does::active_flag:
      if (level) {
        report_error(party, BusError::bit, CanErrorRule::none, true);
        penalise(party);
        signal(party);
      } else if (++party.count == party.flag_bits) {
        party.does = Does::await_recessive;
      }
      break;
    case Does::passive_flag:
      observe_passive_flag(party, level);
      break;
    case Does::await_recessive:
    case Does::delimiter:
      observe_after_flag(party, level);
      break;
    case Does::nothing:
      break;
  }
}

void CanBitLevel::observe_transmitter(Party& party, bool level) {
  const CanWireView& view = views_[party.view];
  const WireFrame& wire = view.wire();
  const unsigned bit = view.bit_at(bit_);
  const bool recessive = wire.recessive(bit);
  // Acknowledgement: no node made the slot dominant. A passive node's count waits for its flag.
  if (bit >= wire.acknowledge_slot() && !party.acknowledged) {
    party.acknowledged = true;
    if (level) {
      party.unacknowledged_passive = party.node->passive();
      report_error(party, BusError::acknowledgement,
                   party.unacknowledged_passive ? CanErrorRule::none : CanErrorRule::transmit);
      fail(party);
    }
    return;
  }
  if (level == recessive) {
    if (bit >= wire.last_bit()) {
      tell(party, CanHappening::Kind::sent);
      finish(party);
      complete_ = true;
    }
    return;
  }
  // Arbitration: recessive sent, dominant read.
  if (!level && wire.in_arbitration(bit)) {
    tell(party, CanHappening::Kind::lost);
    party.own = false;
    party.does = Does::receive;
    choose_what_is_read();
    observe_receiver(party, level);
    return;
  }
  // Exception of 12.1.4: a stuff bit during arbitration that reads dominant counts nothing.
  if (!level && one_rate_ && wire.is_arbitration_stuff_bit(bit)) {
    report_error(party, BusError::stuff, CanErrorRule::none);
  } else if (bit >= wire.stuffed_bits()) {
    report_error(party, BusError::form, CanErrorRule::transmit);
  } else {
    report_error(party, BusError::bit, CanErrorRule::transmit, !recessive);
  }
  fail(party);
}

void CanBitLevel::fail(Party& party) {
  tell(party, CanHappening::Kind::failed);
  signal(party);
  choose_what_is_read();
}

void CanBitLevel::observe_receiver(Party& party, bool level) {
  const WireFrame& wire = read().wire();
  const bool misreads = party.misreads_at != CanLineState::kNoBit;
  if (!readable_ || misreads || bit_ < wire.stuffed_bits()) {
    // Six equal bits are a stuff error.
    if (run_ == kStuffViolation || (misreads && seen_ && bit_ >= party.misreads_at)) {
      report_error(party, BusError::stuff, CanErrorRule::receive);
      signal(party);
    }
    return;
  }
  const unsigned place = bit_ - wire.stuffed_bits();
  if (bit_ == wire.acknowledge_slot()) {
    if (level && !corrupted_ && party.node->acknowledges()) {
      report_error(party, BusError::bit, CanErrorRule::receive, true);
      signal(party);
    }
  } else if (bit_ == wire.last_bit()) {
    tell(party, CanHappening::Kind::received);
    if (level) {
      finish(party);
    } else {
      party.overload = true;
      signal(party);
    }
  } else if (!level) {
    report_error(party, BusError::form, CanErrorRule::receive);
    signal(party);
  } else if (place == 2 && corrupted_) {
    report_error(party, BusError::crc, CanErrorRule::receive);
    signal(party);
  }
}

void CanBitLevel::observe_passive_flag(Party& party, bool level) {
  // 12.1.4: a passive transmitter without acknowledgement pays once its flag is answered.
  if (!level && party.unacknowledged_passive) {
    party.unacknowledged_passive = false;
    penalise(party);
  }
  party.count = party.count > 0 && level == party.equal_to ? party.count + 1 : 1;
  party.equal_to = level;
  if (party.count == kFlagBits) {
    party.does = Does::await_recessive;
  }
}

void CanBitLevel::observe_after_flag(Party& party, bool level) {
  if (level) {
    party.count = party.does == Does::delimiter ? party.count + 1 : 1;
    party.does = Does::delimiter;
    if (party.count == kDelimiterBits) {
      finish(party);
    }
    return;
  }
  if (party.does == Does::delimiter) {
    report_error(party, BusError::form, party.own ? CanErrorRule::transmit : CanErrorRule::receive);
    signal(party);
    return;
  }
  // 12.1.4: dominant right after the own flag, and each eight dominant bits more, count 8.
  ++party.dominants;
  if ((party.dominants == 1 && !party.own) || party.dominants % kToleratedDominants == 0) {
    penalise(party);
  }
}

void CanBitLevel::signal(Party& party) {
  party.count = 0;
  party.dominants = 0;
  // The flag depends on the error state before this error: counters are updated after the bit.
  const bool silent = party.node->settings().listen_only;
  party.does = party.node->passive() || silent ? Does::passive_flag : Does::active_flag;
}

/// A rule that applies during error signalling, without a new error in a frame.
void CanBitLevel::penalise(Party& party) {
  if (!party.overload) {
    happenings_.push_back({party.node,
                           CanHappening::Kind::error,
                           party.own ? CanErrorRule::transmit : CanErrorRule::severe_receive,
                           {}});
  }
}

void CanBitLevel::report_error(Party& party, BusError error, CanErrorRule rule, bool dominant) {
  ControllerReport report;
  report.error = error;
  report.transmitting = party.own;
  report.dominant = dominant;
  report.bit = static_cast<std::uint8_t>(std::min(bit_, 255U));
  const CanWireView& view = party.own ? views_[party.view] : read();
  report.field = error == BusError::crc ? protocols::can::FrameField::crc_sequence
                                        : view.wire().field(view.bit_at(bit_));
  happenings_.push_back({party.node, CanHappening::Kind::error, rule, report});
}

void CanBitLevel::tell(Party& party, CanHappening::Kind kind) {
  CanHappening happening;
  happening.node = party.node;
  happening.kind = kind;
  const CanWireView& view = views_[party.view];
  happening.report.bit = static_cast<std::uint8_t>(std::min(bit_, 255U));
  happening.report.field = view.wire().field(view.bit_at(bit_));
  happenings_.push_back(happening);
}

void CanBitLevel::finish(Party& party) {
  party.does = Does::nothing;
  length_ = std::max(length_, bit_ + 1 + kInterframeBits);
}

}  // namespace rigwire::emulators
