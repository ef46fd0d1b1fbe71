#include "hil/files/replay_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "fields/constants.h"

namespace rigwire::hil {
ReplaySource::ReplaySource(const ReplaySourceSettings& settings,
                           std::optional<std::int64_t> zero_ns)
    : settings_(settings), given_zero_ns_(zero_ns) {
  rewind();
  std::set<std::uint16_t> ports;
  Duration at{0};
  Duration first{0};
  while (next_of_piece(at)) {
    if (summary_.units == 0) {
      first = at;
      summary_.kind = reader_->kind();
    } else if (summary_.kind != reader_->kind()) {
      refuse_replayed(settings_.file, "units of two kinds; name the wire");
    }
    ++summary_.units;
    summary_.bytes += unit_.bytes.size();
    summary_.length = at - first;
    if (summary_.kind == ReplayedKind::datagrams && ports.insert(unit_.to.port).second) {
      summary_.to_ports.push_back(unit_.to.port);
    }
  }
  summary_.truncated = reader_->truncated();
  summary_.notes = reader_->notes();
  if (summary_.units == 0) {
    refuse_replayed(settings_.file,
                    "nothing in it can be played (source.wire, direction, filter, start, end)" +
                        (summary_.notes.empty() ? "" : ", found " + text_of_notes(summary_.notes)));
  }
  // Until the first unit comes again: the piece's own length, or that of its units and a mean gap.
  round_ = settings_.end != Duration{0}
               ? settings_.end - settings_.start
               : at + summary_.length /
                          static_cast<std::int64_t>(std::max<std::uint64_t>(summary_.units - 1, 1));
  if (settings_.loop && round_ <= Duration{0}) {
    refuse_replayed(settings_.file, "a piece of one instant has no length to be repeated (loop)");
  }
  rewind();
}

ReplaySource::~ReplaySource() = default;

std::string text_of_notes(const std::map<std::string, std::uint64_t>& notes) {
  std::string text;
  for (const auto& [what, count] : notes) {
    text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", count, what);
  }
  return text;
}

void ReplaySource::rewind() {
  reader_ = open_replay_reader(settings_);
  first_ = true;
  cut_ns_ = 0;
}

bool ReplaySource::next_of_piece(Duration& at) {
  std::int64_t now_ns = 0;
  while (reader_->next(now_ns, unit_)) {
    if (first_) {
      zero_ns_ = given_zero_ns_.value_or(
          settings_.zero_unix_ns == 0 ? now_ns : static_cast<std::int64_t>(settings_.zero_unix_ns));
      last_ns_ = now_ns;
      first_ = false;
    }
    if (now_ns < last_ns_) {
      // An instant up to 1 s before the last one is replaced by the last one.
      if (last_ns_ - now_ns > kSecond_ns) {
        refuse_replayed(settings_.file,
                        fmt::format("time goes back by {:.6f} s, {:.6f} s behind its start",
                                    1e-9 * static_cast<double>(last_ns_ - now_ns),
                                    1e-9 * static_cast<double>(last_ns_ - zero_ns_)));
      }
      ++summary_.went_back;
      now_ns = last_ns_;
    }
    const std::int64_t gap_ns = now_ns - std::exchange(last_ns_, now_ns);
    const std::int64_t in_file_ns = now_ns - zero_ns_;
    if (settings_.end != Duration{0} && in_file_ns >= settings_.end.count()) {
      return false;
    }
    if (in_file_ns < settings_.start.count()) {
      continue;
    }
    // A gap of more than 1 s is shortened to 1 s.
    if (settings_.gaps == ReplayedGaps::cut && gap_ns > kSecond_ns) {
      cut_ns_ += gap_ns - kSecond_ns;
    }
    at = Duration{in_file_ns - settings_.start.count() - cut_ns_};
    return true;
  }
  return false;
}

const ReplayedUnit* ReplaySource::next() {
  try {
    Duration at{0};
    if (!next_of_piece(at)) {
      if (!settings_.loop) {
        return nullptr;
      }
      rewind();
      ++rounds_;
      if (!next_of_piece(at)) {
        return nullptr;
      }
    }
    // Computed for each unit from its own instant: nothing accumulates.
    const Duration whole = rounds_ * round_ + at;
    const Duration played =
        settings_.speed == 1.0
            ? whole
            : Duration{std::llround(static_cast<long double>(whole.count()) / settings_.speed)};
    unit_.due = std::max(last_due_, kStart + settings_.offset + played);
    last_due_ = unit_.due;
    return &unit_;
  } catch (const std::exception&) {  // the file was changed after it was read
    return nullptr;
  }
}

}  // namespace rigwire::hil
