#include "hil/files/gps_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "fields/constants.h"
#include "protocols/bytes.h"
#include "protocols/velodyne/position_packet.h"

namespace rigwire::hil {
namespace {

constexpr std::int64_t kLooked_ns = 60 * kSecond_ns;
/// Stamps from there on (2001-09-09) count from 1970.
constexpr std::int64_t kLeastAbsolute_ns = 1'000'000'000 * kSecond_ns;

std::optional<std::int64_t> utc_ns(int year, int month, int day, std::int64_t of_day_ns) {
  const std::chrono::year_month_day date{std::chrono::year{year},
                                         std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok() || year < 1980) {
    return std::nullopt;
  }
  return std::chrono::sys_days(date).time_since_epoch().count() * 24 * kHour_ns + of_day_ns;
}

/// The digits at the front of a word; nothing where there are fewer.
std::optional<int> digits(std::string_view word, std::size_t at, std::size_t count) {
  if (word.size() < at + count) {
    return std::nullopt;
  }
  int value = 0;
  for (const char letter : word.substr(at, count)) {
    if (letter < '0' || letter > '9') {
      return std::nullopt;
    }
    value = value * 10 + (letter - '0');
  }
  return value;
}

/// "082015.25" within the day.
std::optional<std::int64_t> time_of_day_ns(std::string_view word) {
  const auto hour = digits(word, 0, 2);
  const auto minute = digits(word, 2, 2);
  const auto second = digits(word, 4, 2);
  if (!hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 60) {
    return std::nullopt;
  }
  std::int64_t ns = ((*hour * 60 + *minute) * 60 + *second) * kSecond_ns;
  std::int64_t place = kSecond_ns / 10;
  for (std::size_t i = 7; i < word.size() && word[6] == '.' && place > 0; ++i, place /= 10) {
    const auto digit = digits(word, i, 1);
    if (!digit) {
      return std::nullopt;
    }
    ns += *digit * place;
  }
  return ns;
}

/// What a sentence or a message tells, UTC in ns since 1970.
struct Told {
  std::int64_t utc_ns = 0;
  std::string_view by;
};

std::optional<Told> told_by_sentence(std::string_view text) {
  const std::size_t star = text.find('*');
  if (text.size() < 7 || text.front() != '$' || star == std::string_view::npos) {
    return std::nullopt;
  }
  std::uint8_t sum = 0;
  for (const char letter : text.substr(1, star - 1)) {
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(letter));
  }
  if (text.substr(star + 1, 2) != fmt::format("{:02X}", sum)) {
    return std::nullopt;
  }
  std::vector<std::string_view> fields;
  for (std::string_view rest = text.substr(0, star);;) {
    const std::size_t comma = rest.find(',');
    fields.push_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(comma + 1);
  }
  const std::string_view type = fields[0].substr(std::min<std::size_t>(3, fields[0].size()));
  const std::int64_t of_day_ns = fields.size() > 1 ? time_of_day_ns(fields[1]).value_or(-1) : -1;
  if (of_day_ns < 0) {
    return std::nullopt;
  }
  std::optional<std::int64_t> at;
  if (type == "RMC" && fields.size() > 9 && fields[2] == "A") {
    const auto day = digits(fields[9], 0, 2);
    const auto month = digits(fields[9], 2, 2);
    const auto year = digits(fields[9], 4, 2);
    if (day && month && year) {
      at = utc_ns(*year + (*year < 80 ? 2000 : 1900), *month, *day, of_day_ns);
    }
  } else if (type == "ZDA" && fields.size() > 4) {
    const auto day = digits(fields[2], 0, 2);
    const auto month = digits(fields[3], 0, 2);
    const auto year = digits(fields[4], 0, 4);
    if (day && month && year) {
      at = utc_ns(*year, *month, *day, of_day_ns);
    }
  }
  return at ? std::optional(Told{*at, type == "RMC" ? "RMC" : "ZDA"}) : std::nullopt;
}

std::optional<Told> told_by_ubx(std::span<const std::uint8_t> message) {
  constexpr std::uint8_t kNavigation = 0x01;
  constexpr std::uint8_t kPositionVelocityTime = 0x07;
  constexpr std::uint8_t kTimeUtc = 0x21;
  constexpr std::size_t kHead = 6;
  if (message.size() < kHead + 20 + 2 || message[0] != 0xB5 || message[1] != 0x62 ||
      message[2] != kNavigation) {
    return std::nullopt;
  }
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  for (const std::uint8_t byte : message.subspan(2, message.size() - 4)) {
    a = static_cast<std::uint8_t>(a + byte);
    b = static_cast<std::uint8_t>(b + a);
  }
  if (message[message.size() - 2] != a || message[message.size() - 1] != b) {
    return std::nullopt;
  }
  const auto payload = message.subspan(kHead);
  // NAV-PVT: year 4, month 6, day 7, hour 8, minute 9, second 10, valid 11, nano 16.
  // NAV-TIMEUTC: nano 8, year 12, month 14, day 15, hour 16, minute 17, second 18, valid 19.
  std::size_t date = 4;
  std::size_t nano = 16;
  bool valid = (payload[11] & 3U) == 3U;  // date and time of day
  if (message[3] == kTimeUtc) {
    date = 12;
    nano = 8;
    valid = (payload[19] & 4U) != 0U;  // UTC
  } else if (message[3] != kPositionVelocityTime) {
    return std::nullopt;
  }
  if (!valid) {
    return std::nullopt;
  }
  const std::int64_t of_day_ns =
      ((payload[date + 4] * 60 + payload[date + 5]) * 60 + payload[date + 6]) * kSecond_ns +
      protocols::load_little<std::int32_t>(payload, nano);
  const auto at = utc_ns(protocols::load_little<std::uint16_t>(payload, date), payload[date + 2],
                         payload[date + 3], of_day_ns);
  return at ? std::optional(Told{*at, date == 4 ? "UBX NAV-PVT" : "UBX NAV-TIMEUTC"})
            : std::nullopt;
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

/// Messages of a receiver out of a stream that comes in pieces.
class Messages {
 public:
  /// What the newest whole message of the piece tells.
  std::optional<Told> take(std::span<const std::uint8_t> piece) {
    bytes_.insert(bytes_.end(), piece.begin(), piece.end());
    std::optional<Told> newest;
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const auto rest = std::span<const std::uint8_t>(bytes_).subspan(at);
      if (rest.size() < kLongest && !is_whole(rest)) {
        break;  // the rest of it comes
      }
      const std::size_t size = receiver_message_size(rest);
      const auto message = rest.first(size);
      auto told = told_by_ubx(message);
      if (!told) {
        told = told_by_sentence({reinterpret_cast<const char*>(message.data()), message.size()});
      }
      newest = told ? told : newest;
      at += size;
    }
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    return newest;
  }

 private:
  static bool is_whole(std::span<const std::uint8_t> rest) {
    constexpr std::size_t kHead = 6;
    if (rest[0] != 0xB5) {
      return receiver_message_size(rest) < rest.size() || rest.back() == '\n';
    }
    return rest.size() >= kHead &&
           rest.size() >= 8U + protocols::load_little<std::uint16_t>(rest, 4);
  }

  static constexpr std::size_t kLongest = 1024;  ///< Of a message that tells the time.
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

GpsAlignment find_gps_alignment(const ReplaySourceSettings& settings) {
  // A lidar's position packets go to a port of their own.
  ReplaySourceSettings all = settings;
  all.from_port = 0;
  all.to_port = 0;
  const auto reader = open_replay_reader(all);
  GpsAlignment found;
  Messages messages;
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
        told = messages.take(unit.bytes);
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
        "source.align: {}: nothing in it tells the GPS time with its date, allowed RMC, ZDA, UBX "
        "NAV-PVT or NAV-TIMEUTC of a receiver that has a fix, position packets of a Velodyne with "
        "GPRMC, stamps of CAN frames since 1970",
        settings.file));
  }
  found.first_utc_ns = *first_ns + found.ahead_ns;
  return found;
}

}  // namespace rigwire::hil
