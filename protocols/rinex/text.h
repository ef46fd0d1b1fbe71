// Text files by fixed columns and lines: what the readers of this folder share.
//
// Errors are those of set-up (docs/errors.md): std::invalid_argument with file, line, what was
// found and what is allowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace rigwire::protocols::rinex {

/// Walks over the lines of a text; line ends are LF or CR LF.
class LineReader {
 public:
  /// `name` is the file's name in errors. Both must outlive the reader.
  LineReader(std::string_view text, std::string_view name) : rest_(text), name_(name) {}

  /// Writes the next line, without its end, to `line`; returns false at the end of the text.
  bool next(std::string_view& line);
  /// Reads a line like next(), but throws with "expected" at the end of the text.
  [[nodiscard]] std::string_view require(std::string_view expected);
  /// Returns the first character of the next line, '\0' at the end of the text or for an empty
  /// line.
  [[nodiscard]] char peek() const;

  /// Throws std::invalid_argument "name:line: message".
  [[noreturn]] void fail(const std::string& message) const;

  /// Returns the number in `text` (blanks around it, exponent by E or D), finite. `what` names it
  /// in errors.
  [[nodiscard]] double number(std::string_view text, std::string_view what) const;
  /// Returns the number in `text`, or `blank` if the text is blank.
  [[nodiscard]] double number_or(std::string_view text, std::string_view what, double blank) const;
  /// Returns the whole number in `text`, from `least` to `greatest`.
  [[nodiscard]] std::int32_t integer(std::string_view text, std::string_view what,
                                     std::int32_t least, std::int32_t greatest) const;

 private:
  std::string_view rest_;
  std::string_view name_;
  std::size_t line_ = 0;
};

/// Columns `first`.. (counted from 0), as many as the line has of them.
[[nodiscard]] std::string_view columns(std::string_view line, std::size_t first, std::size_t count);

/// Without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// An instant of GPS time.
struct Epoch {
  std::int32_t week = 0;        ///< Since 1980-01-06, not rolled over.
  double time_of_week_s = 0.0;  ///< [0, 604800).
};

/// A date in the GPS calendar, which has no leap seconds.
struct CalendarDate {
  std::int32_t year = 1980;
  std::int32_t month = 1;
  std::int32_t day = 6;
  std::int32_t hour = 0;
  std::int32_t minute = 0;
  double second = 0.0;  ///< [0, 60).
};

/// Throws std::invalid_argument by `reader` when there is no such date since 1980-01-06.
[[nodiscard]] Epoch to_epoch(const CalendarDate& date, const LineReader& reader);
/// Seconds are rounded to 1e-7 s, so that 59.99999999 is the next minute.
[[nodiscard]] CalendarDate to_date(const Epoch& epoch);

}  // namespace rigwire::protocols::rinex
