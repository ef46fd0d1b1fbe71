// The $GPRMC sentence that a Velodyne sensor receives from its GPS receiver and repeats in its
// position packets.
//
//   $GPRMC,hhmmss[.s],A,ddmm.mmmm,N,dddmm.mmmm,E,kkk.k,ddd.d,ddmmyy,000.0,E,A*hh CR LF
//
// Form: Garmin GPS 18x technical specifications 190-00879-08, section 4.2.7 (the receiver that
// Velodyne ships), with NMEA 2.3 mode indicator. Magnetic variation is 0 east, as in a public
// capture of a VLP-16; another one would need a model of the field. Time is the second of the
// preceding pulse; status 'V', empty position and variation without a fix.
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

struct RecommendedMinimum {
  int year = 1980;  ///< UTC, four digits.
  int month = 1;
  int day = 1;
  int hour = 0;
  int minute = 0;
  int second = 0;  ///< 60 in a leap second.
  int tenth = 0;   ///< Written by NmeaTimeForm::tenths alone.
  NmeaTimeForm time_form = NmeaTimeForm::whole_seconds;
  bool valid = false;
  double latitude_deg = 0.0;   ///< [-90, 90]
  double longitude_deg = 0.0;  ///< [-180, 180]
  double speed_mps = 0.0;      ///< Over ground, printed in knots up to 999.9.
  double course_deg = 0.0;     ///< Clockwise from true north, [0, 360).
};

/// The text, built in place without allocation: never longer than the 128 bytes that the extended
/// position packet has for it.
class GprmcText {
 public:
  explicit GprmcText(const RecommendedMinimum& values);
  [[nodiscard]] std::string_view view() const { return {text_.data(), size_}; }

 private:
  /// Appends text like printf; what does not fit is cut off.
  [[gnu::format(printf, 2, 3)]] void append(const char* format, ...);
  /// Appends "ddmm.mmmm,N,dddmm.mmmm,E,", clamped to the globe. Rounded once, on the whole angle,
  /// so that 60 minutes cannot appear.
  void append_position(double latitude_deg, double longitude_deg);

  std::array<char, 128> text_{};
  std::size_t size_ = 0;
};

}  // namespace rigwire::protocols::velodyne
