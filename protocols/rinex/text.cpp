#include "protocols/rinex/text.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace rigwire::protocols::rinex {
namespace {

constexpr std::chrono::sys_days kGpsStart{std::chrono::January / 6 / 1980};
constexpr double kWeek_s = 604'800.0;
constexpr std::int64_t kTicksPerSecond = 10'000'000;  // The seven decimals of an epoch line.

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result + (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace

bool LineReader::next(std::string_view& line) {
  if (rest_.empty()) {
    return false;
  }
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
  if (!line.empty() && line.back() == '\r') {
    line.remove_suffix(1);
  }
  ++line_;
  return true;
}

std::string_view LineReader::require(std::string_view expected) {
  std::string_view line;
  if (!next(line)) {
    ++line_;
    fail("the file ends here, expected " + std::string(expected));
  }
  return line;
}

char LineReader::peek() const {
  return rest_.empty() || rest_.front() == '\n' || rest_.front() == '\r' ? '\0' : rest_.front();
}

void LineReader::fail(const std::string& message) const {
  throw std::invalid_argument(std::string(name_) + ":" + std::to_string(line_) + ": " + message);
}

double LineReader::number(std::string_view text, std::string_view what) const {
  std::string_view digits = trimmed(text);
  if (!digits.empty() && digits.front() == '+') {
    digits.remove_prefix(1);
  }
  std::string copy(digits);
  std::ranges::replace_if(
      copy, [](char c) { return c == 'D' || c == 'd'; }, 'e');
  double value = 0.0;
  const auto [end, error] = std::from_chars(copy.data(), copy.data() + copy.size(), value);
  if (error != std::errc{} || end != copy.data() + copy.size() || !std::isfinite(value)) {
    fail(std::string(what) + " is " + quoted(text) + ", allowed is a finite number");
  }
  return value;
}

double LineReader::number_or(std::string_view text, std::string_view what, double blank) const {
  return trimmed(text).empty() ? blank : number(text, what);
}

std::int32_t LineReader::integer(std::string_view text, std::string_view what, std::int32_t least,
                                 std::int32_t greatest) const {
  const double value = number(text, what);
  if (value != std::floor(value) || value < least || value > greatest) {
    fail(std::string(what) + " is " + quoted(trimmed(text)) + ", allowed are whole numbers from " +
         std::to_string(least) + " to " + std::to_string(greatest));
  }
  return static_cast<std::int32_t>(value);
}

std::string_view columns(std::string_view line, std::size_t first, std::size_t count) {
  return first < line.size() ? line.substr(first, count) : std::string_view{};
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

Epoch to_epoch(const CalendarDate& date, const LineReader& reader) {
  const std::chrono::year_month_day day{std::chrono::year{date.year},
                                        std::chrono::month{static_cast<unsigned>(date.month)},
                                        std::chrono::day{static_cast<unsigned>(date.day)}};
  if (!day.ok() || std::chrono::sys_days{day} < kGpsStart || date.hour < 0 || date.hour > 23 ||
      date.minute < 0 || date.minute > 59 || !(date.second >= 0.0 && date.second < 60.0)) {
    reader.fail("date is " + std::to_string(date.year) + "-" + std::to_string(date.month) + "-" +
                std::to_string(date.day) + " " + std::to_string(date.hour) + ":" +
                std::to_string(date.minute) + ":" + std::to_string(date.second) +
                ", allowed is GPS time since 1980-01-06");
  }
  const auto days = (std::chrono::sys_days{day} - kGpsStart).count();
  const auto day_of_week = static_cast<std::int32_t>(days % 7);
  return {static_cast<std::int32_t>(days / 7),
          day_of_week * 86'400.0 + date.hour * 3600.0 + date.minute * 60.0 + date.second};
}

CalendarDate to_date(const Epoch& epoch) {
  auto ticks = std::llround(epoch.time_of_week_s * static_cast<double>(kTicksPerSecond));
  constexpr auto kWeekTicks = static_cast<std::int64_t>(kWeek_s) * kTicksPerSecond;
  std::int32_t week = epoch.week;
  while (ticks >= kWeekTicks) {
    ticks -= kWeekTicks;
    ++week;
  }
  constexpr std::int64_t kMinute = 60 * kTicksPerSecond;
  const std::int64_t minutes = ticks / kMinute;
  const std::chrono::year_month_day day{
      kGpsStart + std::chrono::days{week * 7 + static_cast<std::int32_t>(minutes / 1440)}};
  return {static_cast<std::int32_t>(static_cast<int>(day.year())),
          static_cast<std::int32_t>(static_cast<unsigned>(day.month())),
          static_cast<std::int32_t>(static_cast<unsigned>(day.day())),
          static_cast<std::int32_t>(minutes / 60 % 24),
          static_cast<std::int32_t>(minutes % 60),
          static_cast<double>(ticks % kMinute) / static_cast<double>(kTicksPerSecond)};
}

}  // namespace rigwire::protocols::rinex
