#include "emulators/j1939/trouble_memory.h"

#include <utility>

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;

TroubleMemory::TroubleMemory(std::span<const Kind> kinds) {
  for (const Kind& kind : kinds) {
    entries_.push_back({kind});
  }
}

void TroubleMemory::set(std::size_t kind, bool active) {
  constexpr std::uint8_t kMostOccurrences = 126;
  Entry& entry = entries_[kind];
  if (active && !entry.active && entry.occurrences < kMostOccurrences) {
    ++entry.occurrences;
  }
  entry.active = active;
}

TroubleMemory::Codes TroubleMemory::select(bool active) const {
  Codes codes;
  for (const Entry& entry : entries_) {
    if (entry.active == active && entry.occurrences != 0 && codes.count < codes.codes.size()) {
      codes.codes[codes.count++] = {entry.kind.spn, static_cast<std::uint8_t>(entry.kind.mode),
                                    entry.occurrences};
    }
  }
  return codes;
}

void TroubleMemory::restart() {
  for (std::size_t kind = 0; kind < entries_.size(); ++kind) {
    set(kind, false);
  }
}

void TroubleMemory::clear_active() {
  for (Entry& entry : entries_) {
    entry.occurrences = entry.active ? std::uint8_t{1} : entry.occurrences;
  }
}

void TroubleMemory::clear_previous() {
  for (Entry& entry : entries_) {
    entry.occurrences = entry.active ? entry.occurrences : std::uint8_t{0};
  }
}

vehicle::TroubleReport TroubleMemory::report(const Codes& codes, bool stop) const {
  vehicle::Lamps lamps;
  lamps.amber_warning = active().count != 0;
  lamps.red_stop = stop;
  return vehicle::make_trouble_report(lamps, std::span(codes.codes).first(codes.count));
}

bool TroubleMemory::is_due(std::uint64_t tick) {
  const Codes now = active();
  const bool changed = now != reported_ && (!last_change_ || tick - *last_change_ >= kPeriodTicks);
  const bool again = std::exchange(postponed_, false);
  if (!changed && !again && tick % kPeriodTicks != kPhaseTicks) {
    return false;
  }
  if (changed) {
    last_change_ = tick;
  }
  reported_ = now;
  return true;
}

void TroubleMemory::send_due(J1939Node& node, SimTime now, std::uint64_t tick, bool stop) {
  if (is_due(tick)) {
    postponed_ = node.send_answer(now, vehicle::kDm1Pgn, protocols::j1939::kGlobalAddress,
                                  report(active(), stop).payload()) != J1939Answer::sent;
  }
}

std::optional<J1939Answer> TroubleMemory::answer(J1939Node& node, SimTime now, std::uint32_t pgn,
                                                 std::uint8_t destination, bool stop) {
  switch (pgn) {
    case vehicle::kDm1Pgn:
      return node.send_answer(now, pgn, destination, report(active(), stop).payload());
    case vehicle::kDm2Pgn:
      return node.send_answer(now, pgn, destination, report(previous(), stop).payload());
    case vehicle::kDm3Pgn:
      clear_previous();
      break;
    case vehicle::kDm11Pgn:
      clear_active();
      break;
    default:
      return std::nullopt;
  }
  if (destination != protocols::j1939::kGlobalAddress) {
    node.acknowledge(now, protocols::j1939::Acknowledge::positive, destination, pgn);
  }
  return J1939Answer::sent;
}

void TroubleMemory::append_layouts(std::vector<protocols::can::OwnedMessage>& list,
                                   const vehicle::LayoutEnds& sent) {
  constexpr auto kPeriod = std::chrono::duration_cast<std::chrono::milliseconds>(
      static_cast<std::int64_t>(kPeriodTicks) * kTick);
  list.push_back(
      vehicle::trouble_layout({"DM1", vehicle::kDm1Pgn, vehicle::kTroublePriority, kPeriod}, sent));
  list.push_back(
      vehicle::trouble_layout({"DM2", vehicle::kDm2Pgn, vehicle::kTroublePriority}, sent));
}

}  // namespace rigwire::emulators
