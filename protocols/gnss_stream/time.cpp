#include "protocols/gnss_stream/time.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <string_view>

#include "protocols/bytes.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::protocols::gnss_stream {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kDay_ns = 86'400 * kSecond_ns;
constexpr std::int64_t kWeek_ns = 7 * kDay_ns;
/// A message may be so much out of order.
constexpr std::int64_t kDisorder_ns = 3600 * kSecond_ns;

/// So many digits at a place of a text; nothing where there are fewer.
std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
  if (text.size() < at + count) {
    return std::nullopt;
  }
  int value = 0;
  for (const char letter : text.substr(at, count)) {
    if (letter < '0' || letter > '9') {
      return std::nullopt;
    }
    value = value * 10 + (letter - '0');
  }
  return value;
}

/// "hhmmss", with any number of decimals.
std::optional<std::int64_t> of_day_ns(std::string_view text) {
  const auto hour = digits(text, 0, 2);
  const auto minute = digits(text, 2, 2);
  const auto second = digits(text, 4, 2);
  if (!hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 60) {
    return std::nullopt;
  }
  std::int64_t ns = ((*hour * 60 + *minute) * 60 + *second) * kSecond_ns;
  if (text.size() > 6 && text[6] != '.') {
    return std::nullopt;
  }
  std::int64_t unit_ns = kSecond_ns / 10;
  for (std::size_t i = 7; i < text.size(); ++i, unit_ns /= 10) {
    const auto digit = digits(text, i, 1);
    if (!digit) {
      return std::nullopt;
    }
    ns += *digit * unit_ns;
  }
  return ns;
}

std::optional<std::int64_t> day_of(std::optional<int> year, std::optional<int> month,
                                   std::optional<int> day) {
  if (!year || !month || !day || *year < 1980) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  return date.ok()
             ? std::optional(std::int64_t{std::chrono::sys_days(date).time_since_epoch().count()})
             : std::nullopt;
}

/// "ddmmyy": 80 to 99 are of the last century.
std::optional<std::int64_t> day_of(std::string_view text) {
  const auto year = digits(text, 4, 2);
  return day_of(year ? std::optional(*year + (*year < 80 ? 2000 : 1900)) : std::nullopt,
                digits(text, 2, 2), digits(text, 0, 2));
}

/// Messages of class NAV, and where iTOW is in their payload.
struct WeekTimeRow {
  std::uint8_t id;
  std::uint8_t at;
};
constexpr std::array kWeekTimes{
    WeekTimeRow{0x01, 0}, WeekTimeRow{0x02, 0}, WeekTimeRow{0x03, 0}, WeekTimeRow{0x04, 0},
    WeekTimeRow{0x05, 0}, WeekTimeRow{0x06, 0}, WeekTimeRow{0x07, 0}, WeekTimeRow{0x09, 4},
    WeekTimeRow{0x11, 0}, WeekTimeRow{0x12, 0}, WeekTimeRow{0x13, 4}, WeekTimeRow{0x14, 4},
    WeekTimeRow{0x17, 0}, WeekTimeRow{0x20, 0}, WeekTimeRow{0x21, 0}, WeekTimeRow{0x22, 0},
    WeekTimeRow{0x23, 0}, WeekTimeRow{0x24, 0}, WeekTimeRow{0x25, 0}, WeekTimeRow{0x26, 0},
    WeekTimeRow{0x27, 0}, WeekTimeRow{0x28, 0}, WeekTimeRow{0x30, 0}, WeekTimeRow{0x31, 0},
    WeekTimeRow{0x32, 0}, WeekTimeRow{0x34, 0}, WeekTimeRow{0x35, 0}, WeekTimeRow{0x36, 0},
    WeekTimeRow{0x39, 0}, WeekTimeRow{0x3B, 4}, WeekTimeRow{0x3C, 4}, WeekTimeRow{0x42, 0},
    WeekTimeRow{0x43, 0}, WeekTimeRow{0x60, 0}, WeekTimeRow{0x61, 0}};

/// RXM-RAWX: the receiver's own time of week, and the leap seconds where they are known.
std::optional<MessageTime> time_of_raw(std::span<const std::uint8_t> payload) {
  constexpr std::size_t kHead = 16;
  if (payload.size() < kHead) {
    return std::nullopt;
  }
  const auto of_week_s = std::bit_cast<double>(load_little<std::uint64_t>(payload, 0));
  if (!(of_week_s >= 0.0 && of_week_s < 604'800.0)) {
    return std::nullopt;
  }
  MessageTime time;
  time.of_week_ns = std::llround(of_week_s * 1e9);
  if ((payload[12] & 1U) != 0U) {
    time.leap_seconds = static_cast<std::int8_t>(payload[10]);
  }
  return time;
}

/// Adds the UTC of a message, where the message says that it knows it.
template <class Message>
void add_utc(const Message& message, bool date_known, bool time_known, MessageTime& time) {
  if (!time_known || message.hour > 23 || message.minute > 59 || message.second > 60) {
    return;
  }
  const std::int64_t second = (message.hour * 60 + message.minute) * 60 + message.second;
  time.of_day_ns = second * kSecond_ns + message.nanosecond;
  if (date_known) {
    time.day = day_of(int{message.year}, int{message.month}, int{message.day});
  }
  if (*time.of_day_ns < 0) {  // the last nanoseconds of the day before
    *time.of_day_ns += kDay_ns;
    time.day = time.day ? std::optional(*time.day - 1) : std::nullopt;
  }
}

std::int64_t positive_remainder(std::int64_t value, std::int64_t of) {
  return (value % of + of) % of;
}

/// From one time to another that comes later, of counts that turn over.
std::int64_t onward(std::int64_t from, std::int64_t to, std::int64_t turn) {
  return positive_remainder(to - from + kDisorder_ns, turn) - kDisorder_ns;
}

}  // namespace

std::optional<MessageTime> time_of(const nmea::SentenceView& sentence) {
  const std::string_view type = sentence.type();
  MessageTime time;
  if (type == "GGA" || type == "GNS" || type == "GBS" || type == "GST" || type == "GRS") {
    time.of_day_ns = of_day_ns(sentence.field(0));
  } else if (type == "GLL") {
    time.of_day_ns = of_day_ns(sentence.field(4));
  } else if (type == "RMC") {
    time.of_day_ns = of_day_ns(sentence.field(0));
    time.day = day_of(sentence.field(8));
    time.doubtful = sentence.field(1) != "A";
    time.by = "RMC";
  } else if (type == "ZDA") {
    time.of_day_ns = of_day_ns(sentence.field(0));
    time.day = day_of(digits(sentence.field(3), 0, 4), digits(sentence.field(2), 0, 2),
                      digits(sentence.field(1), 0, 2));
    time.by = "ZDA";
  } else if (sentence.address == "PUBX" && sentence.field(0) == "00") {
    time.of_day_ns = of_day_ns(sentence.field(1));
  } else if (sentence.address == "PUBX" && sentence.field(0) == "04") {
    time.of_day_ns = of_day_ns(sentence.field(1));
    time.day = day_of(sentence.field(2));
    time.by = "PUBX,04";
  }
  return time.of_day_ns ? std::optional(time) : std::nullopt;
}

// Reads the GPS time of week of RXM-RAWX and of the navigation messages in kWeekTimes; NAV-PVT and
// NAV-TIMEUTC add UTC as far as they mark it valid, NAV-TIMEGPS the leap seconds.
std::optional<MessageTime> time_of(const ubx::FrameView& frame) {
  constexpr std::uint8_t kNavigation = 0x01;
  constexpr ubx::MessageId kRaw{0x02, 0x15};
  if (frame.id == kRaw) {
    return time_of_raw(frame.payload);
  }
  const auto* const row = std::ranges::find(kWeekTimes, frame.id.message_id, &WeekTimeRow::id);
  if (frame.id.message_class != kNavigation || row == kWeekTimes.end() ||
      frame.payload.size() < row->at + sizeof(std::uint32_t)) {
    return std::nullopt;
  }
  MessageTime time;
  time.of_week_ns =
      std::int64_t{load_little<std::uint32_t>(frame.payload, row->at)} * kMillisecond_ns;
  if (*time.of_week_ns >= kWeek_ns) {
    return std::nullopt;
  }
  if (frame.id == ubx::NavPvt::kId) {
    time.by = "UBX NAV-PVT";
    if (const auto pvt = ubx::decode<ubx::NavPvt92>(frame); pvt.ok()) {
      add_utc(*pvt, (pvt->valid & 1U) != 0U, (pvt->valid & 2U) != 0U, time);
    } else if (const auto short_form = ubx::decode<ubx::NavPvt>(frame); short_form.ok()) {
      add_utc(*short_form, (short_form->valid & 1U) != 0U, (short_form->valid & 2U) != 0U, time);
    }
  } else if (const auto utc = ubx::decode<ubx::NavTimeutc>(frame); utc.ok()) {
    const bool known = (utc->valid & 4U) != 0U;
    time.by = "UBX NAV-TIMEUTC";
    add_utc(*utc, known, known, time);
  } else if (const auto gps = ubx::decode<ubx::NavTimegps>(frame); gps.ok()) {
    if ((gps->valid & 4U) != 0U) {
      time.leap_seconds = gps->leap_seconds;
    }
  }
  return time;
}

int leap_seconds_on(std::int64_t day) {
  struct Row {
    int year;
    unsigned month;
    int leap_seconds;
  };
  constexpr std::array<Row, 6> kRows{
      {{1999, 1, 13}, {2006, 1, 14}, {2009, 1, 15}, {2012, 7, 16}, {2015, 7, 17}, {2017, 1, 18}}};
  int leap_seconds = kRows.front().leap_seconds;
  for (const Row& row : kRows) {
    const std::chrono::sys_days from{std::chrono::year{row.year} / row.month / 1};
    if (day >= from.time_since_epoch().count()) {
      leap_seconds = row.leap_seconds;
    }
  }
  return leap_seconds;
}

void LeapSeconds::take(const MessageTime& time) {
  constexpr int kMost = 40;
  if (time.leap_seconds) {
    told_ = told_ ? told_ : time.leap_seconds;
  }
  if (time.day && !by_date_) {
    by_date_ = leap_seconds_on(*time.day);
  }
  const auto differ = [&](const MessageTime& week, const MessageTime& day) {
    if (!week.of_week_ns || !day.of_day_ns) {
      return;
    }
    const std::int64_t ahead_ns =
        positive_remainder(*week.of_week_ns - *day.of_day_ns + kSecond_ns / 2, kDay_ns);
    const auto ahead_s = static_cast<int>(ahead_ns / kSecond_ns);
    // The difference of neighbouring messages of two epochs can be off by one second: 18 s (since
    // 2017) is preferred. Other values keep the messages in order, too.
    if (ahead_s <= kMost && (!by_neighbours_ || ahead_s == 18)) {
      by_neighbours_ = ahead_s;
    }
  };
  differ(time, time);
  if (last_) {
    differ(time, *last_);
    differ(*last_, time);
  }
  last_ = time;
}

int LeapSeconds::value() const {
  constexpr int kSince2017 = 18;
  return told_ ? *told_ : by_date_ ? *by_date_ : by_neighbours_.value_or(kSince2017);
}

std::int64_t StreamClock::take(const MessageTime& time) {
  // A receiver that does not know the leap seconds yet is wrong in UTC and right in GPS time.
  const bool by_week = time.of_week_ns.has_value();
  const std::int64_t of_day_ns =
      by_week ? positive_remainder(*time.of_week_ns - leap_seconds_ * kSecond_ns, kDay_ns)
              : time.of_day_ns.value_or(0);
  std::optional<std::int64_t> date_ns;
  if (time.day && time.of_day_ns && !by_week) {
    date_ns = *time.day * kDay_ns + of_day_ns;
  }
  if (!begun_) {
    begun_ = true;
    now_ns_ = of_day_ns;
    of_day_ns_ = of_day_ns;
    of_week_ns_ = time.of_week_ns;
    date_ns_ = date_ns;
    return now_ns_;
  }
  // A second 60 is over: the count of the day has had one more.
  const std::int64_t leap_ns =
      of_day_ns_ >= kDay_ns && of_day_ns < kDay_ns ? kSecond_ns : std::int64_t{0};
  std::int64_t passed_ns = onward(of_day_ns_, of_day_ns, kDay_ns) + leap_ns;
  if (by_week && of_week_ns_) {
    passed_ns = onward(*of_week_ns_, *time.of_week_ns, kWeek_ns);
  } else if (date_ns && date_ns_) {
    // A receiver corrects its date when it has a fix: that takes no time.
    const std::int64_t by_date_ns = *date_ns - *date_ns_ + leap_ns;
    passed_ns = by_date_ns >= -kDisorder_ns && by_date_ns < kWeek_ns ? by_date_ns : passed_ns;
  }
  now_ns_ += passed_ns;
  of_day_ns_ =
      by_week && of_week_ns_ ? positive_remainder(of_day_ns_ + passed_ns, kDay_ns) : of_day_ns;
  if (by_week) {
    of_week_ns_ = time.of_week_ns;
  } else if (of_week_ns_) {
    of_week_ns_ = positive_remainder(*of_week_ns_ + passed_ns, kWeek_ns);
  }
  if (date_ns) {
    date_ns_ = date_ns;
  } else if (date_ns_) {
    *date_ns_ += passed_ns;
  }
  return now_ns_;
}

}  // namespace rigwire::protocols::gnss_stream
