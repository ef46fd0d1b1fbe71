// The $GPGGA sentence that a Velodyne sensor can be given instead of $GPRMC. It carries no date.
//
//   $GPGGA,hhmmss[.s],ddmm.mmmm,N,dddmm.mmmm,E,q,nn,hh.h,aaaaa.a,M,ggg.g,M,,*hh CR LF
//
// Form: Garmin GPS 18x technical specifications 190-00879-08, section 4.2.3; that Velodyne sensors
// take it: VLS-128 user's manual 63-9483 Rev. A, table 9-2.
#pragma once

#include <string_view>

#include "protocols/velodyne/nmea_text.h"

namespace rigwire::protocols::velodyne {

struct FixData {
  int hour = 0;  ///< UTC.
  int minute = 0;
  int second = 0;
  int tenth = 0;  ///< Written by NmeaTimeForm::tenths alone.
  NmeaTimeForm time_form = NmeaTimeForm::whole_seconds;
  bool valid = false;          ///< Otherwise position, height and dilution are left empty.
  double latitude_deg = 0.0;   ///< [-90, 90]
  double longitude_deg = 0.0;  ///< [-180, 180]
  int quality = 1;             ///< 1 alone, 2 differential.
  int satellites = 0;          ///< Used, 0 .. 99.
  double horizontal_dilution = 0.0;
  double altitude_m = 0.0;          ///< Above mean sea level.
  double geoid_separation_m = 0.0;  ///< Mean sea level above the ellipsoid.
};

class GpggaText {
 public:
  explicit GpggaText(const FixData& values);
  [[nodiscard]] std::string_view view() const { return text_.view(); }

 private:
  NmeaText text_;
};

}  // namespace rigwire::protocols::velodyne
