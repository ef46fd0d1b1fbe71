#include "emulators/modbus/rtu_framer.h"

#include <algorithm>
#include <array>

#include "fields/visitor.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

namespace {

constexpr std::array<fields::Choice<SerialCharacter>, 4> kParities{
    {{SerialCharacter::even_8e1, "even", "8E1, 11 bits; the standard's default."},
     {SerialCharacter::odd_8o1, "odd", "8O1, 11 bits."},
     {SerialCharacter::none_8n2, "none", "8N2, 11 bits."},
     {SerialCharacter::none_8n1, "none_one_stop", "8N1, 10 bits; common, not standard."}}};

}  // namespace

void visit(fields::Visitor& v, RtuFramerSettings& p) {
  v.integer("baud", p.timing.baud, fields::IntegerRule{300, 1'000'000, fields::unit("bit/s")},
            "Speed of the line.");
  v.choice("parity", p.timing.character, kParities, "Parity and stop bits of a character.");
  v.boolean("strict_gaps", p.strict_gaps,
            "More than 1.5 characters of silence inside a request spoil it, as on a wire.");
  v.only_if(!p.strict_gaps, "strict_gaps", "strict_gaps: false", [&p](fields::Visitor& w) {
    w.duration("gap_tolerance", p.gap_tolerance, {0, 5'000'000'000},
               "How long the rest of a request may take to come.");
  });
}

RtuFramer::RtuFramer(const RtuFramerSettings& settings, RtuListener& listener)
    : settings_(settings), listener_(listener) {}

SimTime RtuFramer::line_free() const {
  return std::max(burst_start_ + settings_.timing.characters(burst_characters_), occupied_until_);
}

std::size_t RtuFramer::receive(SimTime now, std::span<const std::uint8_t> bytes, bool in_error,
                               bool new_lump) {
  if (bytes.empty()) {
    return 0;
  }
  const SimTime heard_until = burst_start_ + settings_.timing.characters(burst_characters_);
  const bool collides = settings_.strict_gaps && now < occupied_until_;
  const SimTime begin =
      std::max({now, heard_until, settings_.strict_gaps ? SimTime::min() : occupied_until_});
  spoiled_ =
      spoiled_ || in_error || collides ||
      (settings_.strict_gaps && size_ > 0 && begin - heard_until > settings_.timing.inside_limit());
  if (begin > heard_until) {
    burst_start_ = begin;
    burst_characters_ = 0;
  }
  std::size_t taken = 0;
  if (new_lump) {
    mark_lump();
  }
  for (const std::uint8_t byte : bytes) {
    if (burst_start_ + settings_.timing.characters(burst_characters_) >
        now + settings_.timing.characters(kBacklogMaximum)) {
      break;
    }
    ++burst_characters_;
    ++taken;
    if (size_ < bytes_.size()) {
      bytes_[size_++] = byte;
    } else {
      spoiled_ = true;
    }
  }
  waiting_ = false;
  return taken;
}

void RtuFramer::mark_lump() {
  if (size_ > 0 && size_ < bytes_.size() && lump_count_ < lumps_.size()) {
    lumps_[lump_count_++] = size_;
  }
}

SimTime RtuFramer::next_event() const {
  if (size_ == 0) {
    return kNever;
  }
  const SimTime heard_until = burst_start_ + settings_.timing.characters(burst_characters_);
  const Duration silence = settings_.timing.frame_silence();
  return heard_until + (waiting_ ? std::max<Duration>(settings_.gap_tolerance, silence) : silence);
}

void RtuFramer::advance(SimTime now) {
  for (SimTime event = next_event(); event <= now; event = next_event()) {
    if (waiting_) {
      clear();
      listener_.communication_error(event);
    } else {
      resolve(event);
    }
  }
}

void RtuFramer::resolve(SimTime now) {
  const auto whole = decode_rtu(run());
  if (!spoiled_ && whole.ok()) {
    size_ = 0;  // the bytes stay where they are until the listener has seen them
    listener_.frame(now, *whole);
    clear();
  } else if (spoiled_ || settings_.strict_gaps) {
    clear();
    listener_.communication_error(now);
  } else {
    search(now);
  }
}

void RtuFramer::search(SimTime now) {
  std::size_t used = 0;  // everything before has been handed on or is noise
  bool noise = false;
  for (std::size_t lump = 0; lump <= lump_count_; ++lump) {
    const std::size_t begin = lump == 0 ? 0 : lumps_[lump - 1];
    const std::size_t row = begin < used ? 0 : row_end(begin);
    if (row == 0) {
      continue;
    }
    noise = noise || begin > used;
    for (used = begin; used < row;) {
      const std::size_t end = frame_end(used);
      const auto frame = decode_rtu(run().subspan(used, end - used));
      listener_.frame(now, *frame);
      used = end;
    }
  }
  if (noise) {
    listener_.communication_error(now);
  }
  keep_from(used);
  waiting_ = size_ > 0;
}

std::size_t RtuFramer::row_end(std::size_t begin) const {
  const auto lumps = std::span(lumps_).first(lump_count_);
  for (std::size_t end = frame_end(begin); end != 0; end = frame_end(end)) {
    if (end == size_ || std::ranges::find(lumps, end) != lumps.end()) {
      return end;
    }
  }
  return 0;
}

std::size_t RtuFramer::frame_end(std::size_t begin) const {
  std::size_t nearest = 0;
  std::uint16_t crc = kCrcStart;
  const std::size_t limit = std::min(size_, begin + kRtuFrameMaximum);
  for (std::size_t end = begin; end < limit;) {
    crc = crc16(crc, bytes_[end]);
    ++end;
    if (crc == 0 && end - begin >= kRtuFrameMinimum) {
      if (end == size_) {
        return end;
      }
      nearest = nearest == 0 ? end : nearest;
    }
  }
  return nearest;
}

void RtuFramer::keep_from(std::size_t begin) {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin),
            bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.begin());
  size_ -= begin;
  std::size_t kept = 0;
  for (const std::size_t lump : std::span(lumps_).first(lump_count_)) {
    if (lump > begin) {
      lumps_[kept++] = lump - begin;
    }
  }
  lump_count_ = kept;
}

void RtuFramer::clear() {
  size_ = 0;
  lump_count_ = 0;
  spoiled_ = false;
  waiting_ = false;
}

}  // namespace rigwire::emulators
