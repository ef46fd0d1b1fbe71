#include "emulators/starfire/node.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/j1939/message.h"
#include "protocols/j1939/name.h"

namespace rigwire::emulators {
namespace {

namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;

// Below this speed the course says nothing; the last bearing stays.
constexpr double kSlowest_mps = 0.1;

constexpr std::array kQuantities{
    Quantity{"latitude", "deg", -90.0, 90.0, 1e-7},
    Quantity{"longitude", "deg", -180.0, 180.0, 1e-7},
    Quantity{"compass bearing", "deg", 0.0, 360.0, 1.0 / 128.0},
    Quantity{"speed", "m/s", 0.0, 250.996 / 3.6, 1.0 / 256.0 / 3.6},
    Quantity{"altitude", "m", -2500.0, 5531.875, 0.125},
    Quantity{"dilution", "1", 0.0, 25.0, 0.1},
};

const StarFireSettings& checked(const StarFireSettings& settings) {
  validate(settings);
  return settings;
}

J1939AddressPolicy make_policy(const StarFireSettings& settings) {
  // Manufacturer code and function of the real one are not known: none, and "navigation".
  constexpr std::uint8_t kNavigation = 26;
  constexpr std::uint8_t kAgriculture = 2;
  j1939::Name name;
  name.identity = settings.serial;
  name.function = kNavigation;
  name.industry_group = kAgriculture;
  J1939AddressPolicy policy;
  policy.preferred = settings.source_address;
  policy.name = pack(name);
  policy.first_claim = kStart + settings.power_on;
  return policy;
}

}  // namespace

StarFireNode::StarFireNode(const StarFireSettings& settings, const Calendar& calendar,
                           FrameOutput& output)
    : settings_(checked(settings)),
      output_(output),
      address_(make_policy(settings_), output),
      plan_{
          calendar.align_to_gps(kStart + settings_.power_on + settings_.start_up, kStarFirePeriod),
          kStarFirePeriod} {}

double StarFireNode::nominal_rate_hz() const {
  constexpr double kEachEpoch = 2.0 /*VP, VDS*/ + 1.0 / kQualityEpochs;
  return kEachEpoch / to_seconds(kStarFirePeriod);
}

std::span<const Quantity> StarFireNode::quantities() const {
  return kQuantities;
}

SimTime StarFireNode::next_event() const {
  return std::min(address_.next_event(), publish_at_);
}

void StarFireNode::advance(SimTime now) {
  while (next_event() <= now) {
    const SimTime instant = next_event();
    address_.advance(instant);
    if (publish_at_ == instant) {
      publish_at_ = kNever;
      if (address_.held()) {
        send_group(instant, vehicle::VehiclePosition::kGroup.pgn);
        send_group(instant, vehicle::VehicleDirectionSpeed::kGroup.pgn);
        if (epochs_ % kQualityEpochs == 0) {
          send_group(instant, vehicle::VehiclePosition2::kGroup.pgn);
        }
      }
      ++epochs_;
    }
  }
}

void StarFireNode::update(const GnssSample& sample) {
  advance(sample.time);
  take(sample);
  publish_at_ = sample.time + settings_.latency;
  advance(sample.time);
}

void StarFireNode::take(const GnssSample& sample) {
  const bool fix = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
  const double bearing_before_rad = report_.direction.bearing_rad;
  report_ = {};
  report_.quality.satellites =
      static_cast<double>(std::ranges::count(sample.satellites, true, &SatelliteView::tracked));
  if (!fix) {
    return;
  }
  report_.position = {sample.latitude_deg, sample.longitude_deg};
  const Vector3& v = sample.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y);
  report_.direction.speed_mps = speed_mps;
  report_.direction.altitude_m = sample.ellipsoid_height_m - sample.geoid_separation_m;
  report_.direction.bearing_rad = bearing_before_rad;
  if (speed_mps >= kSlowest_mps) {
    const double course_rad = std::atan2(v.y, v.x);
    report_.direction.bearing_rad =
        course_rad < 0.0 ? course_rad + 2.0 * std::numbers::pi : course_rad;
  }
  report_.quality.horizontal_dilution = sample.horizontal_dilution;
  report_.quality.vertical_dilution = sample.vertical_dilution;
  report_.quality.position_dilution = sample.position_dilution;
  report_.quality.time_dilution = sample.time_dilution;
}

bool StarFireNode::send_group(SimTime now, std::uint32_t pgn) {
  switch (pgn) {
    case vehicle::VehiclePosition::kGroup.pgn:
      output_.send(now, vehicle::encode(report_.position, address()));
      return true;
    case vehicle::VehicleDirectionSpeed::kGroup.pgn:
      output_.send(now, vehicle::encode(report_.direction, address()));
      return true;
    case vehicle::VehiclePosition2::kGroup.pgn:
      output_.send(now, vehicle::encode(report_.quality, address()));
      return true;
    default:
      return false;
  }
}

void StarFireNode::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (frame.length > frame.data.size()) {
    ++received_.malformed;
    return;
  }
  received_.bytes += frame.payload().size();
  const auto identifier = j1939::identify(frame);
  if (!identifier) {
    ++received_.ignored;
    return;
  }
  if (identifier->pgn == j1939::kAddressClaimedPgn) {
    const auto name = j1939::decode_address_claim(frame);
    if (!name.ok()) {
      ++received_.malformed;
      return;
    }
    ++received_.accepted;
    address_.on_claim(now, identifier->source, *name);
    return;
  }
  if (identifier->pgn == j1939::kRequestPgn) {
    receive_request(now, frame);
    return;
  }
  ++received_.ignored;
}

void StarFireNode::receive_request(SimTime now, const Frame& frame) {
  const auto pgn = j1939::decode_request(frame);
  if (!pgn.ok()) {
    ++received_.malformed;
    return;
  }
  const j1939::Identifier identifier = *j1939::identify(frame);
  const bool global = identifier.destination == j1939::kGlobalAddress;
  if (!global && identifier.destination != address()) {
    ++received_.ignored;
    return;
  }
  if (*pgn == j1939::kAddressClaimedPgn) {
    ++received_.accepted;
    address_.on_request(now);  // also without an address: "cannot claim"
    return;
  }
  if (!address_.held()) {
    ++received_.ignored;
    return;
  }
  if (send_group(now, *pgn)) {
    ++received_.accepted;
    return;
  }
  ++received_.ignored;
  if (!global) {
    j1939::Acknowledgement refusal;
    refusal.control = j1939::Acknowledge::negative;
    refusal.address = identifier.source;
    refusal.pgn = *pgn;
    output_.send(now, j1939::make_acknowledgement(address(), j1939::kGlobalAddress, refusal));
  }
}

}  // namespace rigwire::emulators
