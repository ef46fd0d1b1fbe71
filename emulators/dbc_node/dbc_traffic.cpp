#include "emulators/dbc_node/dbc_traffic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace can = protocols::can;
namespace j1939 = protocols::j1939;

namespace {

J1939NodeSettings node_of(const DbcNodeSettings& settings, SimTime first_claim) {
  J1939NodeSettings node;
  node.address.preferred = settings.claim->source_address;
  node.address.name = settings.claim->name;
  node.address.arbitrary_address = settings.claim->arbitrary_address;
  node.address.first_claim = first_claim;
  node.address.answer_delay = settings.processing_delay;
  return node;
}

bool is_checked(const DbcSource& source) {
  return std::holds_alternative<DbcCounter>(source) || std::holds_alternative<DbcSum>(source);
}

/// Returns the index of the byte that holds a checksum.
std::size_t byte_of(const can::Coding& layout) {
  return layout.bit / 8U;
}

/// Returns the next value of a counter that runs through its signal's limits.
std::uint64_t next_count(const can::Coding& layout, std::uint64_t raw) {
  const std::uint64_t last = can::to_raw(layout, layout.upper);
  return raw >= last ? can::to_raw(layout, layout.lower) : raw + 1;
}

/// How many multiplexors a signal depends on; of one that depends on itself: many.
std::size_t depth(const can::OwnedMessage& layout, std::size_t signal) {
  std::size_t steps = 0;
  while (signal < layout.signals.size() && steps <= layout.signals.size() &&
         layout.signals[signal].multiplexor != can::kNoMultiplexor) {
    signal = layout.signals[signal].multiplexor;
    ++steps;
  }
  return steps;
}

}  // namespace

std::uint8_t checksum(DbcChecksum method, std::span<const std::uint8_t> data, std::size_t at) {
  constexpr unsigned kPolynomial = 0x1D;
  unsigned value = method == DbcChecksum::crc8_j1850 ? 0xFFU : 0U;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i == at) {
      continue;
    }
    switch (method) {
      case DbcChecksum::none:
        break;
      case DbcChecksum::sum8:
        value += data[i];
        break;
      case DbcChecksum::xor8:
        value ^= data[i];
        break;
      case DbcChecksum::crc8_j1850:
        value ^= data[i];
        for (int bit = 0; bit < 8; ++bit) {
          value = (value << 1U) ^ ((value & 0x80U) != 0 ? kPolynomial : 0U);
        }
        value &= 0xFFU;
        break;
    }
  }
  return static_cast<std::uint8_t>(method == DbcChecksum::crc8_j1850 ? value ^ 0xFFU : value);
}

DbcTraffic::DbcTraffic(const DbcNodeSettings& settings, FrameOutput& output)
    : settings_(settings),
      output_(output),
      supply_(checked(settings.supply)),
      measured_(settings.measured.size(), std::numeric_limits<double>::quiet_NaN()),
      moved_(settings.moved.size(), 0.0),
      sent_(settings.sent.size()),
      taken_(settings.taken.size()) {
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    const DbcSentMessage& message = settings_.sent[m];
    const auto& signals = message.layout.signals;
    SentState& state = sent_[m];
    state.body.resize(message.layout.length);
    state.raw.resize(signals.size());
    state.filtered.resize(signals.size(), std::numeric_limits<double>::quiet_NaN());
    // Among signals of equal depth those without a source come first, so that the others win where
    // the file lets signals overlap.
    const auto rank = [&](std::size_t s) {
      return std::pair(depth(message.layout, s),
                       !std::holds_alternative<DbcHeld>(message.shows[s].source));
    };
    state.order.resize(signals.size());
    std::iota(state.order.begin(), state.order.end(), std::size_t{0});
    std::ranges::stable_sort(state.order, {}, rank);
    for (const can::OwnedSignal& signal : signals) {
      const std::size_t above = signal.multiplexor;
      if (above < signals.size() && signals[above].multiplexor == can::kNoMultiplexor &&
          std::holds_alternative<DbcHeld>(message.shows[above].source) &&
          (state.turning == can::kNoMultiplexor || state.turning == above)) {
        state.turning = above;
        for (const can::RawRange& range : signal.present_at) {
          state.pages.push_back(range.first);
        }
      }
    }
    std::ranges::sort(state.pages);
    state.pages.erase(std::unique(state.pages.begin(), state.pages.end()), state.pages.end());
  }
  for (std::size_t m = 0; m < taken_.size(); ++m) {
    taken_[m].raw.resize(settings_.taken[m].uses.size());
    make_safe(m);
  }
  for (const DbcNodeFault& fault : settings_.faults) {
    begin(fault);
  }
}

DbcNodeFaults::Id DbcTraffic::begin(const DbcNodeFault& fault) {
  const DbcFaultPlace place = place_of(fault);
  const auto message = std::ranges::find(
      settings_.sent, place.message,
      [](const DbcSentMessage& sent) { return std::string_view(sent.layout.name); });
  if (!place.message.empty() && message == settings_.sent.end()) {
    throw std::invalid_argument("faults: it sends no message \"" + std::string(place.message) +
                                "\"");
  }
  if (!place.signal.empty() &&
      std::ranges::none_of(message->layout.signals, [&](const can::OwnedSignal& signal) {
        return signal.name == place.signal;
      })) {
    throw std::invalid_argument("faults: " + std::string(place.message) + " has no signal \"" +
                                std::string(place.signal) + "\"");
  }
  return faults_.add(fault);
}

double DbcTraffic::nominal_rate_hz() const {
  constexpr unsigned kFrameBytes = 8;
  constexpr unsigned kPacketBytes = 7;
  double rate = 0.0;
  for (const DbcSentMessage& message : settings_.sent) {
    if (message.period > Duration{0}) {
      const unsigned frames = message.layout.length <= kFrameBytes
                                  ? 1
                                  : 1 + (message.layout.length + kPacketBytes - 1) / kPacketBytes;
      rate += frames / to_seconds(message.period);
    }
  }
  return rate;
}

ReceiveCounters DbcTraffic::received() const {
  ReceiveCounters all = received_;
  if (node_) {
    const ReceiveCounters& own = node_->received();
    all.bytes += own.bytes;
    all.accepted += own.accepted;
    all.ignored += own.ignored;
    all.malformed += own.malformed;
  }
  return all;
}

std::uint8_t DbcTraffic::address() const {
  return node_ && node_->held() ? node_->address() : j1939::kNullAddress;
}

SimTime DbcTraffic::next_event() const {
  SimTime next = supply_.next_change();
  if (!supply_.on()) {
    return next;
  }
  if (node_) {
    next = std::min(next, node_->next_event());
  }
  for (const SentState& state : sent_) {
    next = std::min({next, state.next_cycle, state.next_extra});
  }
  for (const TakenState& state : taken_) {
    next = std::min(next, state.expires);
  }
  return next;
}

void DbcTraffic::advance(SimTime now) {
  for (SimTime instant = next_event(); instant <= now; instant = next_event()) {
    if (supply_.next_change() == instant) {
      supply_.change();
      supply_.on() ? power_up(instant) : power_down();
      continue;
    }
    if (node_) {
      node_->advance(instant);
    }
    for (std::size_t m = 0; m < taken_.size(); ++m) {
      if (taken_[m].expires <= instant) {
        taken_[m].expires = kNever;
        make_safe(m);
      }
    }
    for (std::size_t m = 0; m < sent_.size(); ++m) {
      SentState& state = sent_[m];
      bool cycle = state.next_cycle <= instant;
      if (cycle) {
        state.next_cycle += settings_.sent[m].period;
        cycle = pace_.has_time(instant, static_cast<std::uint32_t>(m));
      }
      if (cycle || state.next_extra <= instant) {
        send(instant, m);
      }
    }
  }
}

void DbcTraffic::power_up(SimTime now) {
  if (settings_.claim) {
    node_.emplace(node_of(settings_, now), static_cast<J1939Application&>(*this), output_);
  }
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    const DbcSentMessage& message = settings_.sent[m];
    SentState& state = sent_[m];
    for (std::size_t s = 0; s < message.shows.size(); ++s) {
      state.raw[s] = message.shows[s].start_raw;
    }
    const SimTime first = now + message.start_delay + settings_.processing_delay;
    state.next_cycle = message.period > Duration{0} ? first : kNever;
    state.next_extra = message.on_change && message.period == Duration{0} ? first : kNever;
  }
}

void DbcTraffic::power_down() {
  received_ = received();
  node_.reset();
  measured_at_ = kNever;
  std::ranges::fill(measured_, std::numeric_limits<double>::quiet_NaN());
  for (SentState& state : sent_) {
    state.next_cycle = kNever;
    state.next_extra = kNever;
    state.last = kNever;
    state.shown = false;
    state.page = 0;
    std::ranges::fill(state.filtered, std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t m = 0; m < taken_.size(); ++m) {
    taken_[m].expires = kNever;
    std::ranges::fill(taken_[m].raw, std::nullopt);
    make_safe(m);
  }
}

// What is shown.

template <class Fault>
const Fault* DbcTraffic::fault_of(SimTime now, std::size_t message, std::size_t signal) const {
  const DbcSentMessage& sent = settings_.sent[message];
  const Fault* found = nullptr;
  faults_.each(now, [&](const DbcNodeFault& fault) {
    const Fault* what = std::get_if<Fault>(&fault.what);
    if (found != nullptr || what == nullptr) {
      return;
    }
    bool of_it = what->message == sent.layout.name || what->message.empty();
    if constexpr (requires { what->signal; }) {
      of_it = of_it && what->signal == sent.layout.signals[signal].name;
    }
    found = of_it ? what : nullptr;
  });
  return found;
}

std::uint64_t DbcTraffic::shown(std::size_t message, std::size_t signal) const {
  const can::OwnedSignal& layout = settings_.sent[message].layout.signals[signal];
  const DbcShown& row = settings_.sent[message].shows[signal];
  const SentState& state = sent_[message];
  if (const auto* measured = std::get_if<DbcMeasured>(&row.source)) {
    const double value =
        measured->filter > Duration{0} ? state.filtered[signal] : measured_[measured->quantity];
    const bool has_pattern = layout.reserved != can::Reserved::none || layout.is_float;
    if (measured_at_ != kNever && (!std::isnan(value) || has_pattern)) {
      return can::to_raw(layout, value * measured->factor + measured->offset);
    }
    return row.start_raw;
  }
  if (const auto* echo = std::get_if<DbcEcho>(&row.source)) {
    const can::Coding& from = settings_.taken[echo->message].layout.signals[echo->signal];
    const auto raw = taken_[echo->message].raw[echo->signal];
    return raw ? can::to_raw(layout, can::from_raw(from, *raw).number()) : row.start_raw;
  }
  if (signal == state.turning) {
    return state.pages[state.page % state.pages.size()];
  }
  return row.start_raw;
}

void DbcTraffic::compose(SimTime now, std::size_t message, std::vector<std::uint8_t>& body) {
  const DbcSentMessage& sent = settings_.sent[message];
  SentState& state = sent_[message];
  body.assign(sent.layout.length, sent.layout.fill);
  for (const std::size_t s : state.order) {
    const can::OwnedSignal& layout = sent.layout.signals[s];
    if (is_checked(sent.shows[s].source)) {
      continue;
    }
    if (fault_of<FrozenSignalFault>(now, message, s) == nullptr) {
      if (const auto* raw = fault_of<RawSignalFault>(now, message, s)) {
        state.raw[s] = raw->raw;
      } else if (const auto* false_value = fault_of<FalseSignalFault>(now, message, s)) {
        state.raw[s] = can::to_raw(can::unlimited(layout), false_value->value);
      } else {
        state.raw[s] = shown(message, s);
      }
    }
    if (can::is_present(sent.layout, s, body)) {
      can::put_raw(layout, body, state.raw[s]);
    }
  }
}

// Composes the frame, writes the counters, then the checksums over the other bytes as they are
// sent. Faults can stop or replace a counter, invert a checksum or drop the last byte; a silent
// node sends nothing.
void DbcTraffic::send(SimTime now, std::size_t message) {
  const DbcSentMessage& sent = settings_.sent[message];
  SentState& state = sent_[message];
  state.next_extra = kNever;
  compose(now, message, state.body);
  state.shown = true;
  state.shown_page = state.page;
  scratch_ = state.body;
  const bool counting = fault_of<StoppedCounterFault>(now, message, 0) == nullptr;
  for (std::size_t s = 0; s < sent.shows.size(); ++s) {
    if (!std::holds_alternative<DbcCounter>(sent.shows[s].source)) {
      continue;
    }
    const can::OwnedSignal& layout = sent.layout.signals[s];
    const auto* raw = fault_of<RawSignalFault>(now, message, s);
    can::put_raw(layout, scratch_, raw != nullptr ? raw->raw : state.raw[s]);
    state.raw[s] = counting ? next_count(layout, state.raw[s]) : state.raw[s];
  }
  const bool wrong = fault_of<WrongChecksumFault>(now, message, 0) != nullptr;
  for (std::size_t s = 0; s < sent.shows.size(); ++s) {
    if (const auto* sum = std::get_if<DbcSum>(&sent.shows[s].source)) {
      const can::OwnedSignal& layout = sent.layout.signals[s];
      const unsigned right = checksum(sum->method, scratch_, byte_of(layout));
      can::put_raw(layout, scratch_, wrong ? right ^ 0xFFU : right);
    }
  }
  if (fault_of<ShortFrameFault>(now, message, 0) != nullptr && !scratch_.empty()) {
    scratch_.pop_back();
  }
  if (fault_of<SilentNodeFault>(now, message, 0) != nullptr) {
    return;
  }
  if (transmit(now, sent.layout, scratch_)) {
    state.last = now;
    ++state.page;
  }
}

bool DbcTraffic::transmit(SimTime now, const can::OwnedMessage& layout,
                          std::span<const std::uint8_t> payload) {
  if (node_ && layout.j1939) {
    if (!node_->held()) {
      return false;
    }
    j1939::Identifier identifier = j1939::unpack(layout.id);
    if (identifier.destination == j1939::kNullAddress) {
      identifier.destination = j1939::kGlobalAddress;  // the file names no destination
    }
    return node_->send(now, identifier, payload);
  }
  can::Frame wire;
  if (payload.size() > wire.data.size()) {
    return false;
  }
  wire.id = layout.id;
  wire.extended = layout.extended;
  wire.length = static_cast<std::uint8_t>(payload.size());
  std::ranges::copy(payload, wire.data.begin());
  output_.send(now, wire);
  return true;
}

// What is measured.

void DbcTraffic::measure(SimTime now, std::span<const double> values) {
  advance(now);
  if (!supply_.on()) {
    return;
  }
  std::ranges::copy(values, measured_.begin());
  filter(measured_at_ == kNever ? Duration{0} : now - measured_at_);
  measured_at_ = now;
  note_changes(now);
}

/// First-order low-pass, exact for a step: after a time constant 1 - 1/e of it.
void DbcTraffic::filter(Duration step) {
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    for (std::size_t s = 0; s < settings_.sent[m].shows.size(); ++s) {
      const auto* measured = std::get_if<DbcMeasured>(&settings_.sent[m].shows[s].source);
      if (measured == nullptr || measured->filter == Duration{0}) {
        continue;
      }
      double& value = sent_[m].filtered[s];
      const double raw = measured_[measured->quantity];
      const double keep = std::exp(-to_seconds(step) / to_seconds(measured->filter));
      value = std::isfinite(value) && std::isfinite(raw) ? raw + (value - raw) * keep : raw;
    }
  }
}

void DbcTraffic::note_changes(SimTime now) {
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    if (!settings_.sent[m].on_change || sent_[m].next_extra != kNever) {
      continue;
    }
    // Composes the last message as it would be now, on its page, and then restores the state.
    SentState& state = sent_[m];
    raw_scratch_ = state.raw;
    std::swap(state.page, state.shown_page);
    compose(now, m, scratch_);
    std::swap(state.page, state.shown_page);
    state.raw = raw_scratch_;
    if (state.shown && scratch_ != state.body) {
      request(now, m);
    }
  }
}

void DbcTraffic::request(SimTime now, std::size_t message) {
  SentState& state = sent_[message];
  const SimTime soonest = now + settings_.processing_delay;
  const SimTime due = state.last == kNever
                          ? soonest
                          : std::max(soonest, state.last + settings_.sent[message].least_distance);
  state.next_extra = std::min(state.next_extra, due);
}

// What comes in.

void DbcTraffic::controller(SimTime now, const can::ControllerReport& report) {
  advance(now);
  if (node_) {
    node_->controller(now, report);
  }
}

bool DbcTraffic::is_plain(const can::Frame& frame) const {
  return std::ranges::any_of(settings_.taken, [&](const DbcTakenMessage& taken) {
    return !taken.layout.j1939 && taken.layout.id == frame.id &&
           taken.layout.extended == frame.extended;
  });
}

void DbcTraffic::receive(SimTime now, const can::Frame& frame) {
  advance(now);
  if (!supply_.on()) {
    return;
  }
  if (node_ && frame.extended && !frame.remote && !is_plain(frame)) {
    node_->receive(now, frame);
    return;
  }
  received_.bytes += frame.payload().size();
  if (frame.remote) {
    for (std::size_t m = 0; m < sent_.size(); ++m) {
      const DbcSentMessage& sent = settings_.sent[m];
      if (sent.on_request && !sent.layout.j1939 && sent.layout.id == frame.id &&
          sent.layout.extended == frame.extended) {
        ++received_.accepted;
        request(now, m);
        return;
      }
    }
    ++received_.ignored;
    return;
  }
  if (!node_) {
    if (const auto asked = j1939::decode_request(frame); frame.extended && asked.ok()) {
      const std::uint8_t to = j1939::identify(frame)->destination;
      for (std::size_t m = 0; m < sent_.size(); ++m) {
        const can::OwnedMessage& own = settings_.sent[m].layout;
        const j1939::Identifier identifier = j1939::unpack(own.id);
        if (settings_.sent[m].on_request && own.j1939 && identifier.pgn == *asked &&
            (to == j1939::kGlobalAddress || to == identifier.source)) {
          ++received_.accepted;
          request(now, m);
          return;
        }
      }
    }
  }
  for (std::size_t m = 0; m < taken_.size(); ++m) {
    const can::OwnedMessage& row = settings_.taken[m].layout;
    bool meant = row.id == frame.id && row.extended == frame.extended;
    if (row.j1939) {
      // A J1939 message matches by its group: the source address in a file stands for any.
      const auto identifier = j1939::identify(frame);
      meant = !node_ && identifier && identifier->pgn == j1939::unpack(row.id).pgn;
    }
    if (!meant) {
      continue;
    }
    switch (take_payload(now, m, frame.payload())) {
      case J1939Reception::accepted:
        ++received_.accepted;
        break;
      case J1939Reception::malformed:
        ++received_.malformed;
        break;
      case J1939Reception::ignored:
        ++received_.ignored;
        break;
    }
    return;
  }
  ++received_.ignored;
}

J1939Answer DbcTraffic::answer(SimTime now, std::uint32_t pgn, std::uint8_t /*destination*/) {
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    const DbcSentMessage& sent = settings_.sent[m];
    if (sent.on_request && sent.layout.j1939 && j1939::unpack(sent.layout.id).pgn == pgn) {
      request(now, m);
      return J1939Answer::sent;
    }
  }
  return J1939Answer::unknown;
}

J1939Reception DbcTraffic::take(SimTime now, const J1939Message& message) {
  for (std::size_t m = 0; m < taken_.size(); ++m) {
    const can::OwnedMessage& row = settings_.taken[m].layout;
    if (row.j1939 && j1939::unpack(row.id).pgn == message.identifier.pgn) {
      return take_payload(now, m, message.payload);
    }
  }
  return J1939Reception::ignored;
}

bool DbcTraffic::is_sound(std::size_t message, std::span<const std::uint8_t> payload) const {
  const DbcTakenMessage& taken = settings_.taken[message];
  if (!taken.layout.j1939 && payload.size() < taken.layout.length) {
    return false;
  }
  for (std::size_t s = 0; s < taken.uses.size(); ++s) {
    const can::OwnedSignal& layout = taken.layout.signals[s];
    if (const auto* sum = std::get_if<DbcSum>(&taken.uses[s])) {
      if (!can::fits(layout, payload.size()) ||
          can::get_raw(layout, payload) != checksum(sum->method, payload, byte_of(layout))) {
        return false;
      }
    }
    if (std::holds_alternative<DbcCounter>(taken.uses[s]) && taken_[message].raw[s] &&
        can::get_raw(layout, payload) != next_count(layout, *taken_[message].raw[s])) {
      return false;
    }
  }
  return true;
}

J1939Reception DbcTraffic::take_payload(SimTime now, std::size_t message,
                                        std::span<const std::uint8_t> payload) {
  const DbcTakenMessage& taken = settings_.taken[message];
  TakenState& state = taken_[message];
  const bool sound = is_sound(message, payload);
  for (std::size_t s = 0; s < taken.uses.size(); ++s) {
    // A counter is followed from wherever it is, so that one lost frame is not all that follow.
    if ((sound || std::holds_alternative<DbcCounter>(taken.uses[s])) &&
        can::is_present(taken.layout, s, payload) &&
        can::fits(taken.layout.signals[s], payload.size())) {
      state.raw[s] = can::get_raw(taken.layout.signals[s], payload);
    }
  }
  if (!sound) {
    return J1939Reception::malformed;
  }
  for (std::size_t s = 0; s < taken.uses.size(); ++s) {
    const auto* use = std::get_if<DbcMove>(&taken.uses[s]);
    if (use != nullptr && can::is_present(taken.layout, s, payload)) {
      move(*use, taken.layout.signals[s], payload);
    }
  }
  state.expires = taken.timeout > Duration{0} ? now + taken.timeout : kNever;
  for (std::size_t m = 0; m < sent_.size(); ++m) {
    if (settings_.sent[m].after == message) {
      request(now, m);
    }
  }
  note_changes(now);
  return J1939Reception::accepted;
}

void DbcTraffic::move(const DbcMove& use, const can::Coding& layout,
                      std::span<const std::uint8_t> payload) {
  const can::Reading reading = can::get(layout, payload);
  double& value = moved_[use.quantity];
  if (reading.availability == can::Availability::error) {
    value = use.safe;
  }
  if (!reading.valid()) {
    return;
  }
  if (!use.clip && (reading.value < layout.lower || reading.value > layout.upper)) {
    return;
  }
  value = std::clamp(reading.value, layout.lower, layout.upper) * use.factor + use.offset;
}

void DbcTraffic::make_safe(std::size_t message) {
  for (const DbcUse& row : settings_.taken[message].uses) {
    if (const auto* use = std::get_if<DbcMove>(&row)) {
      moved_[use->quantity] = use->safe;
    }
  }
}

}  // namespace rigwire::emulators
