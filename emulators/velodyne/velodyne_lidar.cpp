#include "emulators/velodyne/velodyne_lidar.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "protocols/velodyne/gprmc.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::int64_t kDataPacketsPerPositionPacket = 14;

/// The sentence of a second is complete in the sensor so long after the second's pulse: pulse
/// 100 ms, pause 50 ms, and 72 characters at 9600 baud (manual 63-9113, "GPS and PPS").
constexpr Duration kSentenceDelay = std::chrono::milliseconds{225};

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("velodyne lidar: " + what);
}

std::string model_names() {
  std::string names;
  for (const velodyne::Model& model : velodyne::models()) {
    names += (names.empty() ? "" : ", ") + std::string(model.name);
  }
  return names;
}

const velodyne::Model& checked_model(const VelodyneSettings& settings) {
  validate(settings);
  return *velodyne::find_model(std::string_view(settings.model));
}

double or_default(double value, double fallback) {
  return value > 0.0 ? value : fallback;
}

std::uint8_t reflectivity_byte(float reflectance) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(reflectance, 0.0F, 1.0F) * 100.0F));
}

}  // namespace

void validate(const VelodyneSettings& settings) {
  const velodyne::Model* model = velodyne::find_model(std::string_view(settings.model));
  if (model == nullptr) {
    refuse("model '" + settings.model + "' is not known; allowed: " + model_names());
  }
  if (!(settings.rotor_rpm >= model->minimum_rotor_rpm &&
        settings.rotor_rpm <= model->maximum_rotor_rpm)) {
    refuse("rotor_rpm is " + std::to_string(settings.rotor_rpm) +
           ", allowed: " + std::to_string(model->minimum_rotor_rpm) + " to " +
           std::to_string(model->maximum_rotor_rpm));
  }
  if (settings.return_mode != velodyne::ReturnMode::strongest) {
    refuse("return_mode must be strongest: one echo is simulated per shot");
  }
  const double largest = 65535.0 * model->distance_unit_mm * 1e-3;
  const double minimum = or_default(settings.minimum_range_m, model->minimum_range_m);
  const double maximum = or_default(settings.maximum_range_m, model->maximum_range_m);
  if (!(settings.minimum_range_m >= 0.0 && settings.maximum_range_m >= 0.0 && minimum < maximum &&
        maximum <= largest)) {
    refuse("range limits are " + std::to_string(minimum) + " m and " + std::to_string(maximum) +
           " m, allowed: 0 < minimum < maximum <= " + std::to_string(largest) + " m");
  }
  const std::int64_t packet_ns = static_cast<std::int64_t>(velodyne::kBlocksPerPacket) *
                                 model->firings_per_block * model->firing_period_ns;
  if (settings.send_delay < Duration::zero() || settings.send_delay.count() > packet_ns) {
    refuse("send_delay is " + std::to_string(settings.send_delay.count()) +
           " ns, allowed: 0 to one packet period, " + std::to_string(packet_ns) + " ns");
  }
  if (settings.position_period != Duration::zero() &&
      settings.position_period < std::chrono::milliseconds{1}) {
    refuse("position_period is " + std::to_string(settings.position_period.count()) +
           " ns, allowed: 0 (the model's own) or at least 1 ms");
  }
}

VelodyneLidar::VelodyneLidar(const VelodyneSettings& settings, const Calendar& calendar,
                             ByteOutput& data, ByteOutput& position)
    : settings_(settings),
      model_(checked_model(settings)),
      calendar_(calendar),
      data_(data),
      position_(position),
      counts_per_metre_(1000.0 / model_.distance_unit_mm) {
  command_.rotor_rate_radps = settings.rotor_rpm / 60.0 * 2.0 * std::numbers::pi;
  pattern_.firing_period = Duration{model_.firing_period_ns};
  pattern_.minimum_range_m = or_default(settings.minimum_range_m, model_.minimum_range_m);
  pattern_.maximum_range_m = or_default(settings.maximum_range_m, model_.maximum_range_m);
  pattern_.beam = {model_.divergence.horizontal_mrad * 1e-3, model_.divergence.vertical_mrad * 1e-3,
                   Duration{std::llround(model_.pulse_ns)}};
  for (const velodyne::Laser& laser : model_.lasers) {
    pattern_.lasers.push_back(
        {.elevation_rad = laser.elevation_deg * kDegree,
         .azimuth_offset_rad = laser.azimuth_offset_deg * kDegree,
         .vertical_offset_m = settings.vertical_offsets ? laser.vertical_offset_mm * 1e-3 : 0.0,
         .horizontal_offset_m = laser.horizontal_offset_mm * 1e-3,
         .time_offset = Duration{laser.time_offset_ns}});
  }
  position_period_ = settings.position_period;
  if (position_period_ == Duration::zero()) {
    position_period_ = Duration{kDataPacketsPerPositionPacket *
                                static_cast<std::int64_t>(velodyne::kBlocksPerPacket) *
                                model_.firings_per_block * model_.firing_period_ns};
  }
  next_position_ = kStart + position_period_;
  quantities_ = {{{"range", "m", pattern_.minimum_range_m, pattern_.maximum_range_m,
                   model_.distance_unit_mm * 1e-3},
                  {"azimuth", "deg", 0.0, 359.99, 0.01},
                  {"reflectivity", "%", 0.0, 100.0, 1.0},
                  {"time of hour", "us", 0.0, 3599999999.0, 1.0}}};
  packet_.return_mode_byte =
      settings.legacy_factory_bytes ? 0 : static_cast<std::uint8_t>(settings.return_mode);
  packet_.product_id = settings.legacy_factory_bytes ? 0 : model_.product_id;
}

SamplePlan VelodyneLidar::sample_plan() const {
  return {kStart + pattern_.firing_period, pattern_.firing_period};
}

void VelodyneLidar::advance(SimTime now) {
  while (next_position_ <= now) {
    send_position(next_position_);
    next_position_ += position_period_;
  }
}

void VelodyneLidar::update(const LidarFiring& firing) {
  advance(firing.time);
  if (firings_in_packet_ > 0 &&
      firing.time != packet_start_ + firings_in_packet_ * pattern_.firing_period) {
    firings_in_packet_ = 0;
  }
  if (firings_in_packet_ == 0) {
    begin_packet(firing);
  }
  add_firing(firing);
  const int firings_per_packet =
      static_cast<int>(velodyne::kBlocksPerPacket) * model_.firings_per_block;
  if (firings_in_packet_ == firings_per_packet) {
    send_data();
    firings_in_packet_ = 0;
  }
  packet_complete_at_ =
      firing.time + (firings_per_packet - firings_in_packet_) * pattern_.firing_period;
}

double VelodyneLidar::nominal_rate_hz() const {
  const double firings_per_packet =
      static_cast<double>(velodyne::kBlocksPerPacket) * model_.firings_per_block;
  return 1.0 / (firings_per_packet * to_seconds(pattern_.firing_period)) +
         1.0 / to_seconds(position_period_);
}

void VelodyneLidar::begin_packet(const LidarFiring& firing) {
  packet_start_ = firing.time;
  packet_.timestamp_us = microseconds_of_hour(firing.time);
}

void VelodyneLidar::add_firing(const LidarFiring& firing) {
  const auto block_index = static_cast<std::size_t>(firings_in_packet_ / model_.firings_per_block);
  const auto firing_in_block =
      static_cast<std::size_t>(firings_in_packet_ % model_.firings_per_block);
  velodyne::Block& block = packet_.blocks[block_index];
  if (firing_in_block == 0) {
    const auto counts = std::llround(firing.rotor_azimuth_rad / kDegree * 100.0);
    const auto turn = static_cast<long long>(velodyne::kAzimuthCounts);
    block.azimuth_counts = static_cast<std::uint16_t>(((counts % turn) + turn) % turn);
  }
  const std::size_t lasers = model_.lasers.size();
  for (std::size_t i = 0; i < lasers; ++i) {
    velodyne::Channel& channel = block.channels[firing_in_block * lasers + i];
    channel = {};
    const double range = firing.strongest[i].range_m;
    if (!(range >= pattern_.minimum_range_m && range <= pattern_.maximum_range_m)) {
      continue;  // also what is not a number
    }
    const auto counts = std::clamp(std::lround(range * counts_per_metre_), 1L, 65535L);
    channel.distance_counts = static_cast<std::uint16_t>(counts);
    channel.reflectivity = reflectivity_byte(firing.strongest[i].reflectivity);
  }
  ++firings_in_packet_;
}

void VelodyneLidar::send_data() {
  velodyne::encode(packet_, data_bytes_);
  const SimTime last_shot = packet_start_ + (firings_in_packet_ - 1) * pattern_.firing_period +
                            pattern_.lasers.back().time_offset;
  data_.send(last_shot + settings_.send_delay, data_bytes_);
}

void VelodyneLidar::send_position(SimTime due) {
  const UtcTime utc = calendar_.utc(due - kSentenceDelay);
  const velodyne::GprmcText sentence({.year = utc.year,
                                      .month = utc.month,
                                      .day = utc.day,
                                      .hour = utc.hour,
                                      .minute = utc.minute,
                                      .second = utc.second,
                                      .valid = fix_.valid,
                                      .latitude_deg = fix_.latitude_deg,
                                      .longitude_deg = fix_.longitude_deg,
                                      .speed_mps = fix_.speed_mps,
                                      .course_deg = fix_.course_deg});
  velodyne::PositionPacket packet;
  packet.timestamp_us = microseconds_of_hour(due);
  packet.pulse_state = velodyne::PulseState::locked;
  packet.set_sentence(sentence.view());
  velodyne::encode(packet, position_bytes_);
  position_.send(due, position_bytes_);
}

std::uint32_t VelodyneLidar::microseconds_of_hour(SimTime instant) const {
  return static_cast<std::uint32_t>(calendar_.nanoseconds_of_hour(instant) / 1000);
}

void VelodyneLidar::observe_fix(const GnssSample& sample) {
  fix_ = {};
  fix_.valid = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
  if (!fix_.valid) {
    return;
  }
  fix_.latitude_deg = sample.latitude_deg;
  fix_.longitude_deg = sample.longitude_deg;
  fix_.speed_mps = std::hypot(sample.velocity_ned_mps.x, sample.velocity_ned_mps.y);
  const double course = std::atan2(sample.velocity_ned_mps.y, sample.velocity_ned_mps.x) / kDegree;
  fix_.course_deg = course < 0.0 ? course + 360.0 : course;
}

}  // namespace rigwire::emulators
