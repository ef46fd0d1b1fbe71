#include "hil/stream/fix_reader.h"

#include <optional>
#include <variant>

#include "protocols/nmea/readers.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::hil {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

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
  const auto tell = [&](const std::optional<sim::GeodeticPoint>& place) {
    if (place) {
      use(*place);
    }
  };
  messages_.take(bytes, [&](std::span<const std::uint8_t> /*message*/, const auto& content) {
    if (const auto* const frame = std::get_if<ubx::FrameView>(&content)) {
      const auto place = place_of<ubx::NavPvt>(*frame);
      tell(place ? place : place_of<ubx::NavPvt92>(*frame));
    } else if (const auto* const sentence = std::get_if<nmea::SentenceView>(&content)) {
      tell(place_of(*sentence));
    }
  });
}

}  // namespace rigwire::hil
