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

#include <string_view>

#include "protocols/velodyne/nmea_text.h"

namespace rigwire::protocols::velodyne {

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

/// Room for any sentence, and the text in it.
class GprmcText {
 public:
  explicit GprmcText(const RecommendedMinimum& values);
  [[nodiscard]] std::string_view view() const { return text_.view(); }

 private:
  NmeaText text_;
};

}  // namespace rigwire::protocols::velodyne
