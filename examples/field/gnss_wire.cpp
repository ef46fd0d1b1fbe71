#include "field/gnss_wire.h"

#include <numbers>
#include <utility>

#include "protocols/nmea/readers.h"

namespace rigwire::field {

namespace nmea = protocols::nmea;

FixKind fix_kind(int quality) {
  switch (quality) {
    case 0:
      return FixKind::none;
    case 2:
      return FixKind::differential;
    case 5:
      return FixKind::float_ambiguities;
    case 4:
      return FixKind::fixed;
    default:
      return FixKind::autonomous;
  }
}

GnssWire::GnssWire(std::function<void()> heard) : heard_(std::move(heard)) {}

void GnssWire::receive(std::span<const std::uint8_t> bytes) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  const std::span<const std::uint8_t> all(pending_);
  std::size_t at = nmea::find_start(all, 0);
  while (at < all.size()) {
    const auto sentence = nmea::decode_sentence(all.subspan(at));
    if (sentence.incomplete()) {
      break;
    }
    if (sentence.ok()) {
      take(*sentence);
      at = nmea::find_start(all, at + sentence.consumed());
    } else {
      ++rejected_;
      at = nmea::find_start(all, at + 1);
    }
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(at));
}

// Takes position, quality and dilution from GGA, speed and course over ground from RMC.
void GnssWire::take(const nmea::SentenceView& sentence) {
  if (sentence.type() == "GGA") {
    const auto gga = nmea::read_gga(sentence);
    if (!gga.ok()) {
      ++rejected_;
      return;
    }
    fix_.quality = gga->quality;
    fix_.satellites = gga->satellites_used;
    if (gga->quality != 0) {
      fix_.latitude_deg = gga->latitude_deg;
      fix_.longitude_deg = gga->longitude_deg;
      fix_.altitude_m = gga->altitude_m;
      fix_.horizontal_dilution = gga->horizontal_dilution;
      ++fix_.positions;
    }
    heard_();
  } else if (sentence.type() == "RMC") {
    const auto rmc = nmea::read_rmc(sentence);
    if (!rmc.ok()) {
      ++rejected_;
      return;
    }
    fix_.ground_speed_mps = rmc->valid ? rmc->ground_speed_mps : 0.0;
    fix_.course_rad.reset();
    if (rmc->valid) {
      if (rmc->course_deg) {
        fix_.course_rad = *rmc->course_deg * (std::numbers::pi / 180.0);
      }
      ++fix_.velocities;
    }
    heard_();
  }
}

}  // namespace rigwire::field
