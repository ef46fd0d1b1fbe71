#include "hil/stream/sky_reader.h"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "protocols/ubx/blocks.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::hil {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

/// Talker of GSV, its digit in GSA from version 4.10 on (protocols/nmea/satellite_numbers.h), and
/// the number in NAV-SAT.
struct SystemRow {
  std::string_view talker;
  int nmea;
  int ubx;
  std::string_view name;
};
constexpr std::array<SystemRow, 7> kSystems{{{"GP", 1, 0, "GPS"},
                                             {"", -1, 1, "SBAS"},
                                             {"GL", 2, 6, "GLONASS"},
                                             {"GA", 3, 2, "Galileo"},
                                             {"GB", 4, 3, "BeiDou"},
                                             {"GQ", 5, 5, "QZSS"},
                                             {"GN", 0, -1, "satellite"}}};

/// NMEA numbers satellites of augmentation systems above these, under the talker of GPS.
constexpr int kLastGps = 32;
/// Pages that have a hundred satellites of one system are none of one epoch.
constexpr std::size_t kMostInView = 100;

/// Talker of BeiDou in older receivers.
constexpr std::string_view kOldBeidou = "BD";

const SystemRow* row_of(std::string_view talker) {
  const auto* const found = std::ranges::find(
      kSystems, talker == kOldBeidou ? std::string_view("GB") : talker, &SystemRow::talker);
  return found == kSystems.end() ? nullptr : found;
}

}  // namespace

void SkyReader::take(std::span<const std::uint8_t> bytes, const Use& use) {
  messages_.take(bytes, [&](std::span<const std::uint8_t> /*message*/, const auto& content) {
    if (const auto* const frame = std::get_if<ubx::FrameView>(&content)) {
      take(*frame, use);
    } else if (const auto* const sentence = std::get_if<nmea::SentenceView>(&content)) {
      take(*sentence, use);
    }
  });
}

void SkyReader::take(const ubx::FrameView& frame, const Use& use) {
  const auto told = ubx::decode_blocks<ubx::NavSatHead, ubx::NavSatBlock>(frame);
  if (!told.ok()) {
    return;
  }
  constexpr int kLowest_deg = -90;  // below it is not known
  std::vector<SkySatellite> sky;
  for (std::size_t i = 0; i < told->size(); ++i) {
    const ubx::NavSatBlock block = (*told)[i];
    const auto* const row = std::ranges::find(kSystems, int{block.system}, &SystemRow::ubx);
    if (row != kSystems.end() && block.elevation_deg >= kLowest_deg) {
      sky.push_back({std::string(row->name) + " " + std::to_string(block.satellite),
                     block.azimuth_deg, block.elevation_deg, block.cn0_dbhz,
                     (block.flags & ubx::kSatUsed) != 0});
    }
  }
  use("NAV-SAT", sky);
}

void SkyReader::take(const nmea::SentenceView& sentence, const Use& use) {
  const std::string_view talker = sentence.address.substr(0, 2);
  if (const auto view = nmea::read_gsv(sentence); view.ok()) {
    take_view(talker, *view, use);
  } else if (const auto used = nmea::read_gsa(sentence); used.ok()) {
    take_used(talker, *used);
  }
}

void SkyReader::take_used(std::string_view talker, const nmea::Gsa& used) {
  if (std::exchange(viewed_since_used_, false)) {
    used_.clear();
  }
  const SystemRow* const row = row_of(talker);
  const int system = used.system.value_or(row == nullptr ? 0 : row->nmea);
  for (const int number : std::span(used.used).first(used.used_count)) {
    used_.emplace(system, number);
  }
}

void SkyReader::take_view(std::string_view talker, const nmea::Gsv& view, const Use& use) {
  if (row_of(talker) == nullptr) {
    return;  // so that the table stays as long as it is
  }
  viewed_since_used_ = true;
  Group& group = groups_[{std::string(talker), view.signal.value_or(0)}];
  if (view.page == 1 || group.incomplete.size() > kMostInView) {
    group.incomplete.clear();
  }
  const auto page = std::span(view.satellites).first(view.satellite_count);
  group.incomplete.insert(group.incomplete.end(), page.begin(), page.end());
  if (view.page != view.pages) {
    return;
  }
  // A group that comes again begins a round. Groups that the last round lacked exist no more.
  if (group.round == round_) {
    std::erase_if(groups_, [this](const auto& entry) {
      return entry.second.round < round_ && entry.second.incomplete.empty();
    });
    ++round_;
  }
  group.round = round_;
  group.complete = std::move(group.incomplete);
  group.incomplete.clear();
  use("GSV", sky());
}

std::vector<SkySatellite> SkyReader::sky() const {
  std::map<std::pair<const SystemRow*, int>, SkySatellite> satellites;
  for (const auto& [key, group] : groups_) {
    const SystemRow& talker = *row_of(key.first);
    for (const nmea::GsvSatellite& one : group.complete) {
      if (one.number == 0 || !one.elevation_deg || !one.azimuth_deg) {
        continue;
      }
      const bool augments = &talker == &kSystems.front() && one.number > kLastGps;
      const SystemRow& system = augments ? kSystems[1] : talker;
      // A satellite is in the group of each of its signals: the strongest counts.
      SkySatellite& satellite = satellites[{&system, one.number}];
      satellite.name = std::string(system.name) + " " + std::to_string(one.number);
      satellite.azimuth_deg = *one.azimuth_deg;
      satellite.elevation_deg = *one.elevation_deg;
      satellite.cn0_dbhz = std::max(satellite.cn0_dbhz, one.cn0_dbhz.value_or(0));
      satellite.used = used_.contains({talker.nmea, one.number}) || used_.contains({0, one.number});
    }
  }
  std::vector<SkySatellite> sky;
  for (auto& [key, satellite] : satellites) {
    sky.push_back(std::move(satellite));
  }
  return sky;
}

}  // namespace rigwire::hil
