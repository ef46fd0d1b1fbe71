#include "sim/gnss/satellite_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

constexpr double kNoSignal_dbhz = -std::numeric_limits<double>::infinity();
/// A carrier that was taken up at kCarrierCn0_dbhz stays in a carrier solution down to this
/// strength, where its noise is 0.05 cycles.
constexpr double kCarrierLost_dbhz = 22.0;
/// What a receiver that has two bands leaves of the ionosphere. It smooths what it finds, so its
/// code does not become noisier: a ZED-F9P reports 0.35 m under an open sky (gpsd's regression
/// tests), as receivers of one band do not.
constexpr double kTwoBandIonosphere = 0.15;
/// All satellites of one transmitter close by: evenly strong, wherever they seem to be.
constexpr double kSpoofedCn0_dbhz = 50.0;
constexpr double kSpoofedFading_db = 0.3;

/// Returns whether a satellite's ranges count. Among the augmentation systems only WAAS offers such
/// ranges; EGNOS has none, the others are taken as without.
bool gives_ranges(const Satellite& satellite) {
  constexpr std::array<std::uint8_t, 4> kWaas{131, 133, 135, 138};
  return satellite.system != GnssSystem::sbas ||
         std::ranges::find(kWaas, satellite.number) != kWaas.end();
}

/// Name of a satellite's random stream: "gnss/G05".
std::string stream_name(std::string_view receiver, const Satellite& satellite) {
  constexpr std::string_view kLetters = "GSECIJR";  // by GnssSystem, as RINEX names them
  return std::string(receiver) + "/" + kLetters[static_cast<std::size_t>(satellite.system)] +
         std::to_string(satellite.number);
}

}  // namespace

SatelliteChannels::SatelliteChannels(const GnssParameters& parameters,
                                     std::shared_ptr<const Constellation> constellation,
                                     std::uint64_t seed, std::string_view name)
    : parameters_(parameters),
      constellation_(std::move(constellation)),
      field_(constellation_->errors(seed)),
      reflections_(parameters.multipath) {
  const auto satellites = constellation_->satellites();
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    if (parameters_.systems.receives(satellites[i].system)) {
      channels_.push_back({.index = i,
                           .satellite = satellites[i],
                           .errors = SatelliteErrors(seed, stream_name(name, satellites[i])),
                           .tracker = {},
                           .arrival = {}});
      indices_.push_back(i);
    }
  }
  states_.resize(channels_.size());
  received_.reserve(channels_.size());
  channel_of_.reserve(channels_.size());
  searched_.reserve(channels_.size());
  healthy_.reserve(channels_.size());
}

bool SatelliteChannels::knows(GnssSystem system) const {
  return std::ranges::any_of(
      channels_, [&](const Channel& channel) { return channel.satellite.system == system; });
}

void SatelliteChannels::find_above_horizon(const Reception& reception, const LocalFrame& frame) {
  received_.clear();
  channel_of_.clear();
  healthy_.clear();
  const Eigen::Vector3d p_E = frame.to_ecef(reception.ranges_p_W);
  time_s_ = to_seconds(reception.time);
  p_E_m_ = p_E;
  ecef_from_world_ = frame.world_from_ecef().transpose();
  const Eigen::Matrix3d ned_from_world = frame.ned_from_world(reception.ranges_p_W);
  constellation_->states(indices_, reception.gps, states_);
  for (std::uint32_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    const SatelliteState& state = states_[i];
    ReceivedSatellite received;
    // Line of sight to the satellite, turned from earth-fixed into world axes.
    received.direction_W = (frame.world_from_ecef() * (state.position_E_m - p_E)).normalized();
    received.direction_ned = ned_from_world * received.direction_W;
    // Elevation and azimuth of the direction in north, east, down.
    received.elevation_rad = std::asin(std::clamp(-received.direction_ned.z(), -1.0, 1.0));
    if (received.elevation_rad <= 0.0) {
      channel.tracker.set();
      channel.carries = false;
      continue;
    }
    received.azimuth_rad = std::atan2(received.direction_ned.y(), received.direction_ned.x());
    if (received.azimuth_rad < 0.0) {
      received.azimuth_rad += 2.0 * std::numbers::pi;
    }
    received.index = channel.index;
    received.satellite = channel.satellite;
    received_.push_back(received);
    channel_of_.push_back(i);
    healthy_.push_back(state.healthy);
  }
}

void SatelliteChannels::arrive_as_in_paper(ReceivedSatellite& received, const Reception& reception,
                                           const Visibility& visibility) const {
  const SkyViewParameters& sky = parameters_.sky;
  received.direct =
      !visibility.blocked(reception.p_W, received.direction_W, sky.antenna_clearance_m);
  received.cn0_dbhz = received.direct
                          ? direct_cn0_dbhz(sky, std::sin(received.elevation_rad), SkyArrival{})
                          : kNoSignal_dbhz;
}

void SatelliteChannels::arrive(Channel& channel, ReceivedSatellite& received,
                               const Reception& reception, const Visibility& visibility) {
  const SkyViewParameters& sky = parameters_.sky;
  const double sin_elevation = std::sin(received.elevation_rad);
  channel.arrival = sky_arrival(sky, visibility, reception.p_W, received.direction_W, near_crowns_);
  const double direct_dbhz = direct_cn0_dbhz(sky, sin_elevation, channel.arrival);
  channel.envelope_m = 0.0;
  channel.extra_path_m = 0.0;
  received.direct = true;
  received.cn0_dbhz = direct_dbhz;
  const auto extra_m =
      reflections_.extra_path_m(channel_of_[static_cast<std::size_t>(&received - received_.data())],
                                reception.p_W, received.direction_W);
  if (extra_m) {
    // The stronger path is tracked; a weaker reflection bends the code by its envelope.
    const double reflected_dbhz = direct_cn0_dbhz(sky, sin_elevation, SkyArrival{}) -
                                  parameters_.multipath.reflection_loss_db;
    if (reflected_dbhz > direct_dbhz) {
      received.direct = false;
      received.cn0_dbhz = reflected_dbhz;
      channel.extra_path_m =
          *extra_m + parameters_.multipath.scatter_m * channel.errors.scattered();
    } else {
      channel.envelope_m = multipath_envelope_m(parameters_.multipath, *extra_m);
    }
  }
  received.direct = received.direct && channel.arrival.open_share > 0.0;
}

/// What crowns take of its signal.
double SatelliteChannels::foliage_db(const Channel& channel) const {
  return parameters_.sky.foliage_attenuation_dbpm * channel.arrival.foliage_m;
}

/// Fading changes what a receiver reads of C/N0 in both models; only in the coloured one it loses
/// satellites by it.
void SatelliteChannels::fade(const Reception& reception) {
  for (std::size_t k = 0; k < received_.size(); ++k) {
    Channel& channel = channels_[channel_of_[k]];
    const double step_s = channel.last == kNever ? 0.0 : to_seconds(reception.time - channel.last);
    channel.errors.fade(step_s, reception.speed_mps);
    // Leaves take and leave; they add nothing to what an open sky gives.
    const double crowns_db = foliage_db(channel);
    const double leaves_db =
        std::min(crowns_db, channel.errors.foliage_fading() * foliage_sigma_db(crowns_db));
    channel.fade_db =
        leaves_db + channel.errors.fading() * fading_sigma_db(parameters_.sky,
                                                              std::sin(received_[k].elevation_rad),
                                                              reception.speed_mps);
    channel.slips = channel.errors.slips(parameters_.ranges, crowns_db - leaves_db, step_s);
    channel.last = reception.time;
  }
}

void SatelliteChannels::advance_errors(const Reception& reception) {
  for (const std::uint32_t i : channel_of_) {
    Channel& channel = channels_[i];
    const double own_step_s =
        channel.last == kNever ? 0.0 : to_seconds(reception.time - channel.last);
    channel.errors.advance(parameters_.ranges, own_step_s, reception.speed_mps);
    const MultipathParameters& walls = parameters_.multipath;
    channel.scattered = channel.errors.scatter(own_step_s, walls.scatter_period_s,
                                               reception.speed_mps, walls.scatter_length_m);
    if (parameters_.raw_measurements && parameters_.second_signals) {
      channel.errors.advance_second(parameters_.ranges, own_step_s, reception.speed_mps);
    }
  }
}

/// Adds fading and the faults' jamming or spoofing to C/N0 and advances each tracking loop. A
/// carrier slips when its signal is acquired or changes between direct and reflected, at random
/// under crowns, and when another part of a wall reflects it.
void SatelliteChannels::track(const Reception& reception, const GnssFaultState& fault) {
  const bool paper = parameters_.error_model == ErrorModel::paper;
  std::uint32_t busy = 0;
  for (const std::uint32_t i : channel_of_) {
    busy += channels_[i].tracker.tracked() ? 1U : 0U;
  }
  for (std::size_t k = 0; k < received_.size(); ++k) {
    ReceivedSatellite& received = received_[k];
    Channel& channel = channels_[channel_of_[k]];
    if (fault.spoofed) {
      received.direct = true;
      received.cn0_dbhz = kSpoofedCn0_dbhz;
      channel.fade_db = kSpoofedFading_db * channel.errors.fading();
    }
    const double steady_dbhz =
        fault.no_signal ? kNoSignal_dbhz : received.cn0_dbhz - fault.jamming_db;
    received.cn0_dbhz = steady_dbhz + channel.fade_db;
    received.second_weaker_db = fault.second_jamming_db - fault.jamming_db;
    const bool before = channel.tracker.tracked();
    received.tracked = channel.tracker.advance(
        parameters_.sky, {.time = reception.time,
                          .cn0_dbhz = paper ? steady_dbhz : received.cn0_dbhz,
                          .channel_free = busy < parameters_.sky.maximum_channels,
                          .instantly = paper});
    busy += received.tracked ? 1U : 0U;
    busy -= before ? 1U : 0U;
    received.acquired = received.tracked && !before;
    received.direct = received.direct && received.tracked;
    received.carries = received.direct && received.cn0_dbhz >= (channel.carries ? kCarrierLost_dbhz
                                                                                : kCarrierCn0_dbhz);
    channel.carries = received.carries;
    received.slipped =
        received.acquired ||
        (received.tracked &&
         (received.direct != channel.direct ||
          (!fault.spoofed && (channel.slips || (!received.direct && channel.scattered)))));
    if (received.slipped || !received.carries) {
      channel.held = reception.time;
    }
    received.held_s = to_seconds(reception.time - channel.held);
    channel.direct = received.direct;
    if (received.acquired) {
      channel.errors.acquired();
    }
    received.usable = received.tracked && healthy_[k] && gives_ranges(received.satellite) &&
                      received.elevation_rad >= parameters_.sky.elevation_mask_deg * kDegree;
    if (!received.tracked) {
      received.cn0_dbhz = 0.0;
    }
  }
}

std::span<ReceivedSatellite> SatelliteChannels::receive(const Reception& reception,
                                                        const LocalFrame& frame,
                                                        const Visibility& visibility,
                                                        const GnssFaultState& fault) {
  find_above_horizon(reception, frame);
  if (parameters_.error_model == ErrorModel::paper) {
    for (ReceivedSatellite& received : received_) {
      arrive_as_in_paper(received, reception, visibility);
    }
  } else {
    advance_errors(reception);
    searched_.clear();
    for (std::size_t k = 0; k < received_.size(); ++k) {
      searched_.push_back({channel_of_[k], received_[k].direction_W});
    }
    reflections_.update(reception.time, reception.p_W, searched_,
                        static_cast<std::uint32_t>(channels_.size()), visibility,
                        parameters_.sky.antenna_clearance_m);
    for (std::size_t k = 0; k < received_.size(); ++k) {
      arrive(channels_[channel_of_[k]], received_[k], reception, visibility);
    }
    near_crowns_ = std::ranges::any_of(
        channel_of_, [this](std::uint32_t i) { return channels_[i].arrival.foliage_m > 0.0; });
  }
  fade(reception);
  track(reception, fault);
  return received_;
}

/// A field whose gradient has that deviation has this length.
double SatelliteChannels::ionosphere_length_m() const {
  const RangeErrorParameters& p = parameters_.ranges;
  return p.ionosphere_gradient_sigma_mpkm > 0.0
             ? 1e3 * p.ionosphere_sigma_m / p.ionosphere_gradient_sigma_mpkm
             : 0.0;
}

RangeError SatelliteChannels::shared_error(std::size_t index, SimTime time,
                                           const Eigen::Vector3d& p_E_m,
                                           const Eigen::Vector3d& direction_E,
                                           double elevation_rad) const {
  RangeError error;
  if (parameters_.error_model == ErrorModel::paper || !parameters_.errors) {
    return error;
  }
  const RangeErrorParameters& p = parameters_.ranges;
  const double time_s = to_seconds(time);
  error.orbit_clock_m = p.orbit_clock_sigma_m *
                        field_->satellite(index, time_s, p.orbit_clock_correlation_s, direction_E);
  error.ionosphere_m = ionosphere_mapping(elevation_rad) * p.ionosphere_sigma_m *
                       field_->ionosphere(time_s, p.ionosphere_correlation_s, ionosphere_length_m(),
                                          p_E_m, direction_E);
  error.troposphere_m = troposphere_mapping(elevation_rad) * p.troposphere_sigma_m *
                        field_->troposphere(time_s, p.troposphere_correlation_s, p_E_m);
  return error;
}

void SatelliteChannels::range_errors(const CorrectedShare& share, bool spoofed) {
  if (parameters_.error_model == ErrorModel::paper) {
    return;
  }
  const RangeErrorParameters& p = parameters_.ranges;
  const double troposphere = field_->troposphere(time_s_, p.troposphere_correlation_s, p_E_m_);
  const double length_m = ionosphere_length_m();
  for (std::size_t k = 0; k < received_.size(); ++k) {
    ReceivedSatellite& received = received_[k];
    if (!received.tracked) {
      continue;
    }
    const Channel& channel = channels_[channel_of_[k]];
    SignalArrival arrival{.azimuth_rad = received.azimuth_rad,
                          .elevation_rad = received.elevation_rad,
                          .cn0_dbhz = received.cn0_dbhz,
                          .fade_db = channel.fade_db,
                          .second_weaker_db = received.second_weaker_db};
    // What the open sky would give at this elevation, less what is received but for fading.
    arrival.missing_db =
        direct_cn0_dbhz(parameters_.sky, std::sin(received.elevation_rad), SkyArrival{}) -
        (received.cn0_dbhz - channel.fade_db);
    if (!spoofed) {
      arrival.foliage_db = foliage_db(channel);
      arrival.reflection_envelope_m = channel.envelope_m;
      arrival.extra_path_m = channel.extra_path_m;
    }
    const Eigen::Vector3d direction_E = ecef_from_world_ * received.direction_W;
    arrival.shared = {.orbit_clock = field_->satellite(received.index, time_s_,
                                                       p.orbit_clock_correlation_s, direction_E),
                      .ionosphere = field_->ionosphere(time_s_, p.ionosphere_correlation_s,
                                                       length_m, p_E_m_, direction_E),
                      .troposphere = troposphere};
    const CorrectedShare own{.orbit_clock = p.broadcast_share * share.orbit_clock,
                             .ionosphere = p.broadcast_share * share.ionosphere *
                                           (received.two_bands ? kTwoBandIonosphere : 1.0)};
    received.error = channel.errors.error(p, arrival, own);
    if (spoofed) {  // the transmitter makes ranges that agree with each other
      received.error.corrected_m = 0.0;
      received.error.orbit_clock_m = 0.0;
      received.error.ionosphere_m = 0.0;
      received.error.troposphere_m = 0.0;
    }
    if (!parameters_.errors) {
      RangeError& error = received.error;  // what is believed of them stays
      error.orbit_clock_m = error.ionosphere_m = error.troposphere_m = 0.0;
      error.corrected_m = 0.0;
      error.local_m = error.detour_m = error.carrier_m = 0.0;
      error.second_local_m = error.second_carrier_m = 0.0;
      error.rate_mps = error.range_rate_mps = 0.0;
    }
  }
}

}  // namespace rigwire::sim
