#include "dig_cycle/imu_wire.h"

#include <cmath>
#include <utility>

#include "protocols/j1939/message.h"
#include "protocols/j1939/name.h"
#include "protocols/openimu/messages.h"

namespace rigwire::dig_cycle {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;

namespace {

bool usable(double value, std::uint8_t merit) {
  // Merit 3 is what the 300RI always sends; only an error is one.
  return std::isfinite(value) && merit != openimu::FigureOfMerit::kError;
}

}  // namespace

ImuWire::ImuWire(Estimator& estimator, const ImuWireSettings& settings,
                 std::function<void(Link)> heard)
    : estimator_(estimator), heard_(std::move(heard)), identities_(settings.identities) {
  if (!identities_) {
    for (std::size_t link = 0; link < kLinks; ++link) {
      addresses_[link] = settings.addresses[link];
    }
  }
}

std::optional<Link> ImuWire::link_of(std::uint8_t address) const {
  for (std::size_t link = 0; link < kLinks; ++link) {
    if (addresses_[link] == address) {
      return static_cast<Link>(link);
    }
  }
  return std::nullopt;
}

void ImuWire::learn(std::uint8_t address, std::uint64_t name) {
  const std::uint32_t identity = j1939::unpack_name(name).identity;
  for (std::size_t link = 0; link < kLinks; ++link) {
    if ((*identities_)[link] == identity) {
      addresses_[link] =
          address == j1939::kNullAddress ? std::nullopt : std::optional<std::uint8_t>(address);
    } else if (addresses_[link] == address) {
      addresses_[link].reset();  // its address was taken by a node with priority
    }
  }
}

// Passes pitch rates and specific forces to the estimator, if their figures of merit are usable,
// and learns the sensors' addresses from their J1939 address claims.
void ImuWire::receive(const protocols::can::Frame& frame) {
  const auto identifier = j1939::identify(frame);
  if (!identifier) {
    return;
  }
  if (identifier->pgn == j1939::kAddressClaimedPgn) {
    if (const auto name = j1939::decode_address_claim(frame); name.ok() && identities_) {
      learn(identifier->source, *name);
    }
    return;
  }
  const auto link = link_of(identifier->source);
  if (!link) {
    return;
  }
  if (identifier->pgn == openimu::kAngularRatePgn) {
    const auto rate = openimu::decode<openimu::AngularRate>(frame);
    if (rate.ok() && usable(rate->pitch_dps, rate->pitch_merit)) {
      estimator_.imu_rate(*link, rate->pitch_dps * kDegree);
    }
  } else if (identifier->pgn == openimu::kAccelerationPgn) {
    const auto acceleration = openimu::decode<openimu::Acceleration>(frame);
    if (acceleration.ok() &&
        usable(acceleration->longitudinal_mps2, acceleration->longitudinal_merit) &&
        usable(acceleration->vertical_mps2, acceleration->vertical_merit)) {
      estimator_.imu_specific_force(*link, acceleration->longitudinal_mps2,
                                    acceleration->vertical_mps2);
      heard_(*link);
    }
  }
}

std::optional<protocols::can::Frame> ImuWire::question() const {
  if (!identities_) {
    return std::nullopt;
  }
  for (const auto& address : addresses_) {
    if (!address) {
      return j1939::make_request(j1939::kNullAddress, j1939::kGlobalAddress,
                                 j1939::kAddressClaimedPgn);
    }
  }
  return std::nullopt;
}

}  // namespace rigwire::dig_cycle
