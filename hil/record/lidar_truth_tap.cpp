#include "hil/record/lidar_truth_tap.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <nlohmann/json.hpp>
#include <utility>

namespace rigwire::hil {
namespace {

template <class Integer>
void put(std::string& bytes, Integer value) {
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bytes.push_back(static_cast<char>(static_cast<unsigned char>(value >> (8 * i))));
  }
}

void put(std::string& bytes, float value) {
  put(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

LidarTruthTap::LidarTruthTap(const std::filesystem::path& path, const Calendar& calendar,
                             const sim::Scene& scene, std::vector<std::string> lidars,
                             OutputFailures* failures, std::chrono::milliseconds patience)
    : file_("the lidar truth", path.string(), failures, patience), lidars_(std::move(lidars)) {
  nlohmann::ordered_json header{
      {"rigwire_lidar_truth", 1},
      {"record_bytes", kLidarTruthRecordSize},
      {"start_utc", format_utc(calendar.utc(kStart))},
      {"start_time_of_hour_us", static_cast<double>(calendar.nanoseconds_of_hour(kStart)) * 1e-3},
      {"lidars", lidars_},
      {"instances", nlohmann::ordered_json::array()}};
  for (sim::Scene::InstanceId id = 0; id < scene.instance_count(); ++id) {
    header["instances"].push_back({{"name", scene.name(id)}, {"label", scene.material(id).label}});
  }
  file_.write(header.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void LidarTruthTap::record(std::string_view lidar, const LidarPattern& pattern,
                           const std::vector<LidarFiring>& firings,
                           const std::vector<sim::LidarBankTruth>& truth) {
  records_.clear();
  const auto named = std::find(lidars_.begin(), lidars_.end(), lidar);
  assert(named != lidars_.end());
  const auto number = static_cast<std::uint16_t>(named - lidars_.begin());
  for (std::size_t f = 0; f < firings.size(); ++f) {
    const LidarFiring& firing = firings[f];
    const std::size_t lasers = std::min(pattern.lasers.size() - firing.first_laser, kBankLasers);
    for (std::size_t i = 0; i < lasers; ++i) {
      const std::size_t laser = firing.first_laser + i;
      const SimTime time = firing.time + pattern.lasers[laser].time_offset;
      put(records_, static_cast<std::uint64_t>((time - kStart).count()));
      put(records_, number);
      put(records_, static_cast<std::uint16_t>(laser));
      put(records_, truth[f][i].instance);
      put(records_, truth[f][i].range_m);
      put(records_, truth[f][i].cosine_of_incidence);
      put(records_, firing.strongest[i].range_m);
      put(records_, firing.strongest[i].reflectivity);
    }
  }
  file_.write(records_);
}

}  // namespace rigwire::hil
