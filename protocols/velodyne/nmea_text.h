// What the sentences of a Velodyne's GPS receiver have in common: the text and its checksum.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace rigwire::protocols::velodyne {

/// How the receiver writes the time of day. Velodyne sensors take both.
enum class NmeaTimeForm {
  whole_seconds,  ///< hhmmss
  tenths,         ///< hhmmss.s
};

/// Text built in place, without allocation: never longer than the 128 bytes that the extended
/// position packet has for it.
class NmeaText {
 public:
  [[nodiscard]] std::string_view view() const { return {text_.data(), size_}; }

  /// As printf; what does not fit is cut off.
  [[gnu::format(printf, 2, 3)]] void append(const char* format, ...);
  /// "hhmmss" or "hhmmss.s" and a comma.
  void append_time(int hour, int minute, int second, int tenth, NmeaTimeForm form);
  /// "ddmm.mmmm,N,dddmm.mmmm,E,", clamped to the globe. Rounded once, on the whole angle, so that
  /// 60 minutes cannot appear.
  void append_position(double latitude_deg, double longitude_deg);
  /// '*', the exclusive or of everything behind '$', CR, LF.
  void finish();

 private:
  std::array<char, 128> text_{};
  std::size_t size_ = 0;
};

}  // namespace rigwire::protocols::velodyne
