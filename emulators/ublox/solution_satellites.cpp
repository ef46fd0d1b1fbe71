// NAV-SVINFO, NAV-DGPS and NAV-SBAS: the messages that list satellites.
#include <algorithm>
#include <numbers>

#include "emulators/ublox/solution.h"
#include "emulators/ublox/wire_units.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Numbers of the older messages: SBAS 120..158 as they are, GLONASS from 65, QZSS from 193.
std::uint8_t single_number(const SatelliteView& view) {
  switch (view.system) {
    case GnssSystem::glonass:
      return static_cast<std::uint8_t>(64 + view.number);
    case GnssSystem::qzss:
      return static_cast<std::uint8_t>(192 + view.number);
    case GnssSystem::galileo:
      return static_cast<std::uint8_t>(210 + view.number);
    case GnssSystem::beidou:
      return static_cast<std::uint8_t>(view.number <= 5 ? 158 + view.number : 27 + view.number);
    case GnssSystem::imes:
      return static_cast<std::uint8_t>(172 + view.number);
    default:
      return view.number;
  }
}

NavSvinfoChannel channel_of(const UbloxSolution& s, const SatelliteView& view, std::size_t index) {
  NavSvinfoChannel channel;
  channel.channel = static_cast<std::uint8_t>(view.tracked ? index : 255);
  channel.satellite = single_number(view);
  const bool used = view.used && s.dimensions > 0;
  channel.flags =
      static_cast<std::uint8_t>((used ? 0x01 : 0) | (view.corrected && s.differential ? 0x02 : 0) |
                                (s.orbits_known ? 0x0C : 0));
  channel.quality = used ? 7 : view.tracked ? 4 : 1;
  channel.cn0_dbhz = view.tracked ? to_field<std::uint8_t>(view.cn0_dbhz, 1.0) : std::uint8_t{0};
  if (s.orbits_known) {
    channel.elevation_deg = to_field<std::int8_t>(view.elevation_rad, kDegree);
    channel.azimuth_deg =
        static_cast<std::int16_t>(to_field<std::int16_t>(view.azimuth_rad, kDegree) % 360);
  }
  channel.residual_cm = used ? signed_field(view.residual_m, 0.01) : 0;
  return channel;
}

std::size_t put_svinfo(const UbloxSolution& s, const UbloxProfile& profile,
                       std::span<std::uint8_t> out) {
  std::array<NavSvinfoChannel, kMostSatellites> channels{};
  const std::size_t count = std::min(s.satellites.size(), channels.size());
  for (std::size_t i = 0; i < count; ++i) {
    channels[i] = channel_of(s, s.satellites[i], i);
  }
  const NavSvinfoHead head{s.time_of_week_ms, static_cast<std::uint8_t>(count),
                           profile.chip_generation};
  return encode_blocks<NavSvinfoHead, NavSvinfoChannel>(head, std::span(channels).first(count),
                                                        out);
}

/// Corrections from RTCM; SBAS has its own message. Without them the head alone.
std::size_t put_dgps(const UbloxSolution& s, std::span<std::uint8_t> out) {
  NavDgpsHead head;
  head.time_of_week_ms = s.time_of_week_ms;
  return encode_blocks<NavDgpsHead, NavDgpsBlock>(head, {}, out);
}

/// 0 WAAS, 1 EGNOS, 2 MSAS, 3 GAGAN, -1 unknown, by PRN: R28 section 32.17.16 and appendix A.
std::int8_t sbas_system(std::uint8_t prn) {
  switch (prn) {
    case 122:
    case 131:
    case 133:
    case 134:
    case 135:
    case 138:
      return 0;
    case 120:
    case 121:
    case 123:
    case 124:
    case 126:
    case 136:
      return 1;
    case 129:
    case 137:
      return 2;
    case 127:
    case 128:
    case 132:
      return 3;
    default:
      return -1;
  }
}

std::size_t put_sbas(const UbloxSolution& s, std::span<std::uint8_t> out) {
  constexpr std::uint8_t kRangingAndCorrections = 0x03;
  std::array<NavSbasBlock, kMostSatellites> blocks{};
  NavSbasHead head;
  head.time_of_week_ms = s.time_of_week_ms;
  std::size_t count = 0;
  for (const auto& view : s.satellites) {
    const bool sbas = view.system == GnssSystem::sbas;
    if (sbas && view.tracked && head.geostationary == 0 && s.differential) {
      head.geostationary = view.number;
      head.system = sbas_system(view.number);
      head.services = kRangingAndCorrections;
      head.mode = 1;
    }
    if (count < blocks.size() && (sbas ? view.tracked : view.corrected && s.differential)) {
      NavSbasBlock& block = blocks[count++];
      block.satellite = single_number(view);
      constexpr std::int8_t kGps = 16;
      block.system = sbas ? sbas_system(view.number) : kGps;
      block.services = sbas ? kRangingAndCorrections : std::uint8_t{0};
    }
  }
  head.satellites = static_cast<std::uint8_t>(count);
  return encode_blocks<NavSbasHead, NavSbasBlock>(head, std::span(blocks).first(count), out);
}

}  // namespace

std::size_t encode_satellites(const UbloxSolution& s, const UbloxProfile& profile, MessageId id,
                              std::span<std::uint8_t> out) {
  if (id == NavSvinfoHead::kId) return put_svinfo(s, profile, out);
  if (id == NavDgpsHead::kId) return put_dgps(s, out);
  if (id == NavSbasHead::kId) return put_sbas(s, out);
  return 0;
}

}  // namespace rigwire::emulators
