#include "hil/files/gps_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>

#include "fields/constants.h"
#include "protocols/gnss_stream/splitter.h"
#include "protocols/gnss_stream/time.h"
#include "protocols/velodyne/position_packet.h"

namespace rigwire::hil {
namespace {

namespace gnss_stream = protocols::gnss_stream;

constexpr std::int64_t kLooked_ns = 60 * kSecond_ns;
/// Stamps from there on (2001-09-09) count from 1970.
constexpr std::int64_t kLeastAbsolute_ns = 1'000'000'000 * kSecond_ns;

/// The time in a sentence or a message, UTC in ns since 1970.
struct Told {
  std::int64_t utc_ns = 0;
  std::string_view by;
};

std::optional<Told> told_by(const std::optional<gnss_stream::MessageTime>& time) {
  if (!time || !time->day || !time->of_day_ns || time->doubtful) {
    return std::nullopt;
  }
  return Told{*time->day * 24 * kHour_ns + *time->of_day_ns, time->by};
}

std::optional<Told> told_by(const gnss_stream::Splitter::Content& content) {
  if (const auto* const frame = std::get_if<protocols::ubx::FrameView>(&content)) {
    return told_by(gnss_stream::time_of(*frame));
  }
  const auto* const sentence = std::get_if<protocols::nmea::SentenceView>(&content);
  return sentence == nullptr ? std::nullopt : told_by(gnss_stream::time_of(*sentence));
}

/// A sentence without its end of line.
std::optional<Told> told_by_sentence(std::string_view text) {
  const std::string line = std::string(text) + "\r\n";
  const auto sentence = protocols::nmea::decode_sentence(
      {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  return sentence.ok() ? told_by(gnss_stream::time_of(*sentence)) : std::nullopt;
}

std::optional<Told> told_by_velodyne(std::span<const std::uint8_t> datagram) {
  namespace velodyne = protocols::velodyne;
  if (datagram.size() != velodyne::kPositionPacketSize) {
    return std::nullopt;
  }
  const auto packet = velodyne::decode_position_packet(datagram);
  if (!packet.ok()) {
    return std::nullopt;
  }
  const auto second = told_by_sentence(packet->sentence());
  if (!second) {
    return std::nullopt;
  }
  // The sentence is of a second near by: the hour in which the packet's microseconds are nearest.
  std::int64_t at =
      second->utc_ns - second->utc_ns % kHour_ns + std::int64_t{packet->timestamp_us} * 1000;
  if (at - second->utc_ns > kHour_ns / 2) {
    at -= kHour_ns;
  } else if (second->utc_ns - at > kHour_ns / 2) {
    at += kHour_ns;
  }
  return Told{at, "Velodyne position packets"};
}

}  // namespace

GpsAlignment find_gps_alignment(const ReplaySourceSettings& settings) {
  // A lidar's position packets go to a port of their own.
  ReplaySourceSettings all = settings;
  all.from_port = 0;
  all.to_port = 0;
  const auto reader = open_replay_reader(all);
  GpsAlignment found;
  gnss_stream::Splitter splitter;
  std::optional<std::int64_t> first_ns;
  std::int64_t at_ns = 0;
  for (ReplayedUnit unit; reader->next(at_ns, unit);) {
    if (!first_ns) {
      first_ns = at_ns;
    }
    std::optional<Told> told;
    if (reader->kind() == ReplayedKind::frames) {
      if (at_ns >= kLeastAbsolute_ns) {
        told = Told{at_ns, "its stamps"};
      }
    } else {
      if (reader->kind() == ReplayedKind::datagrams) {
        told = told_by_velodyne(unit.bytes);
      }
      if (!told) {
        splitter.take(unit.bytes, [&told](std::span<const std::uint8_t> /*bytes*/,
                                          const gnss_stream::Splitter::Content& content) {
          const std::optional<Told> newest = told_by(content);
          told = newest ? newest : told;
        });
      }
    }
    if (told) {
      const std::int64_t ahead_ns = told->utc_ns - (at_ns - reader->transmission_ns(unit));
      if (found.told == 0 || ahead_ns > found.ahead_ns) {
        found.ahead_ns = ahead_ns;
        found.by = told->by;
      }
      ++found.told;
    }
    if (found.told != 0 && at_ns - *first_ns > kLooked_ns) {
      break;
    }
  }
  if (found.told == 0) {
    throw std::invalid_argument(fmt::format(
        "source.align: {}: it has no GPS time with a date, allowed RMC, ZDA, UBX "
        "NAV-PVT or NAV-TIMEUTC of a receiver that has a fix, position packets of a Velodyne with "
        "GPRMC, stamps of CAN frames since 1970",
        settings.file));
  }
  found.first_utc_ns = *first_ns + found.ahead_ns;
  return found;
}

}  // namespace rigwire::hil
