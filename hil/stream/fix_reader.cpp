#include "hil/stream/fix_reader.h"

#include <algorithm>
#include <optional>

#include "protocols/nmea/readers.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::hil {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::uint8_t kUbxSync = 0xB5;
constexpr std::uint8_t kNmeaStart = '$';

template <class Message>
std::optional<sim::GeodeticPoint> place_of(const ubx::FrameView& frame) {
  const auto pvt = ubx::decode<Message>(frame);
  if (!pvt.ok() || (pvt->flags & ubx::kPvtFixOk) == 0) {
    return std::nullopt;
  }
  return sim::GeodeticPoint{1e-7 * pvt->latitude_e7deg, 1e-7 * pvt->longitude_e7deg,
                            1e-3 * pvt->ellipsoid_height_mm};
}

std::optional<sim::GeodeticPoint> place_of(const nmea::SentenceView& sentence) {
  const auto gga = nmea::read_gga(sentence);
  if (!gga.ok() || gga->quality == 0) {
    return std::nullopt;
  }
  return sim::GeodeticPoint{gga->latitude_deg, gga->longitude_deg,
                            gga->altitude_m + gga->separation_m};
}

}  // namespace

void FixReader::take(std::span<const std::uint8_t> bytes, const Use& use) {
  kept_.insert(kept_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  // What cannot begin a message is passed over, byte by byte.
  while (at < kept_.size()) {
    const auto rest = std::span(std::as_const(kept_)).subspan(at);
    std::size_t used = 1;
    if (rest.front() == kUbxSync) {
      const auto frame = ubx::decode_frame(rest, kMostKept / 2);
      if (frame.incomplete()) {
        break;
      }
      if (frame.ok()) {
        used = frame.consumed();
        auto place = place_of<ubx::NavPvt>(*frame);
        place = place ? place : place_of<ubx::NavPvt92>(*frame);
        if (place) {
          use(*place);
        }
      }
    } else if (rest.front() == kNmeaStart) {
      const auto sentence = nmea::decode_sentence(rest);
      if (sentence.incomplete()) {
        break;
      }
      if (sentence.ok()) {
        used = sentence.consumed();
        if (const auto place = place_of(*sentence)) {
          use(*place);
        }
      }
    }
    at += used;
  }
  const std::size_t left = kept_.size() - at;
  at += left > kMostKept ? left - kMostKept : 0;
  kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace rigwire::hil
