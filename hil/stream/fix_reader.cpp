#include "hil/stream/fix_reader.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "protocols/nmea/readers.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::hil {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

template <class Message>
std::optional<ReceiverFix> fix_of(const ubx::FrameView& frame) {
  const auto pvt = ubx::decode<Message>(frame);
  if (!pvt.ok() || (pvt->flags & ubx::kPvtFixOk) == 0) {
    return std::nullopt;
  }
  const double across_m = 1e-3 * pvt->horizontal_accuracy_mm;
  return ReceiverFix{
      {1e-7 * pvt->latitude_e7deg, 1e-7 * pvt->longitude_e7deg, 1e-3 * pvt->ellipsoid_height_mm},
      {{across_m, across_m, 1e-3 * pvt->vertical_accuracy_mm}}};
}

/// Standard deviations at a dilution of 1, by GGA's quality.
struct Guess {
  int quality;
  double across_m;
  double up_m;
};
constexpr double kAcrossAt95 = 2.45;
constexpr double kUpAt95 = 1.96;
constexpr std::array<Guess, 3> kGuesses{{{1, 15.0 / kAcrossAt95, 23.0 / kUpAt95},
                                         {2, 3.75 / kAcrossAt95, 5.75 / kUpAt95},
                                         {4, 0.02, 0.04}}};

std::optional<ReceiverFix> fix_of(const nmea::Gga& gga,
                                  const std::optional<std::array<double, 3>>& told_sigma_m) {
  if (gga.quality == 0) {
    return std::nullopt;
  }
  ReceiverFix fix{{gga.latitude_deg, gga.longitude_deg, gga.altitude_m + gga.separation_m},
                  told_sigma_m};
  const auto guess = std::ranges::find(kGuesses, gga.quality, &Guess::quality);
  if (!fix.sigma_m && guess != kGuesses.end() && gga.horizontal_dilution) {
    const double across_m = guess->across_m * *gga.horizontal_dilution;
    fix.sigma_m = {across_m, across_m, guess->up_m * *gga.horizontal_dilution};
    fix.guessed = true;
  }
  return fix;
}

}  // namespace

void FixReader::take(std::span<const std::uint8_t> bytes, const Use& use) {
  const auto tell = [&](const std::optional<ReceiverFix>& fix) {
    if (fix) {
      use(*fix);
    }
  };
  messages_.take(bytes, [&](std::span<const std::uint8_t> /*message*/, const auto& content) {
    if (const auto* const frame = std::get_if<ubx::FrameView>(&content)) {
      const auto fix = fix_of<ubx::NavPvt>(*frame);
      tell(fix ? fix : fix_of<ubx::NavPvt92>(*frame));
    } else if (const auto* const sentence = std::get_if<nmea::SentenceView>(&content)) {
      if (const auto gst = nmea::read_gst(*sentence);
          gst.ok() && gst->longitude_m && gst->latitude_m && gst->altitude_m) {
        told_sigma_m_ = {*gst->longitude_m, *gst->latitude_m, *gst->altitude_m};
      } else if (const auto gga = nmea::read_gga(*sentence); gga.ok()) {
        tell(fix_of(*gga, std::exchange(told_sigma_m_, std::nullopt)));
      }
    }
  });
}

}  // namespace rigwire::hil
