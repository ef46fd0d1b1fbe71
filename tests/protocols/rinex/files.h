// Small navigation files for the tests, made up.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "protocols/gps/ephemeris.h"

namespace rigwire::protocols::rinex {

inline constexpr const char* kVersion2 =
    "     2.10           N: GPS NAV DATA                         RINEX VERSION / TYPE\n"
    "nobody              nowhere             24-JAN-16 00:00     PGM / RUN BY / DATE\n"
    "made up                                                     COMMENT\n"
    "    0.1118D-07  0.1490D-07 -0.5960D-07 -0.1192D-06          ION ALPHA\n"
    "    0.9011D+05  0.6554D+05 -0.1311D+06 -0.4588D+06          ION BETA\n"
    "    0.186264514923D-08-0.444089209850D-14   147456     2297 DELTA-UTC: A0,A1,T,W\n"
    "    18                                                      LEAP SECONDS\n"
    "                                                            END OF HEADER\n"
    " 5 24  1 17 10  0  0.0-0.151757150888D-03-0.125055521494D-10 0.000000000000D+00\n"
    "    0.770000000000D+02 0.431250000000D+01 0.426910639614D-08 0.123456789012D+01\n"
    "    0.201165676117D-06 0.589463487267D-02 0.101365149021D-04 0.515368164253D+04\n"
    "    0.295200000000D+06 0.111758708954D-07-0.236278481532D+01 0.391155481339D-07\n"
    "    0.966430092344D+00 0.183125000000D+03 0.121391273562D+01-0.797568936379D-08\n"
    "    0.210008750000D-09 0.100000000000D+01 0.229700000000D+04 0.000000000000D+00\n"
    "    0.200000000000D+01 0.000000000000D+00-0.111758708954D-07 0.589000000000D+03\n"
    "    0.288018000000D+06 0.400000000000D+01\n";

inline constexpr const char* kVersion3 =
    "     3.04           N: GNSS NAV DATA    M: MIXED            RINEX VERSION / TYPE\n"
    "nobody              nowhere             20240117 000000 UTC PGM / RUN BY / DATE\n"
    "GPSA   1.1180E-08  1.4900E-08 -5.9600E-08 -1.1920E-07       IONOSPHERIC CORR\n"
    "GPSB   9.0110E+04  6.5540E+04 -1.3110E+05 -4.5880E+05       IONOSPHERIC CORR\n"
    "GAL    2.6250E+01  1.0938E-01  6.7749E-03  0.0000E+00       IONOSPHERIC CORR\n"
    "GPUT  1.8626451492E-09-4.440892098E-15 147456 2297          TIME SYSTEM CORR\n"
    "    18    18  2185     7                                    LEAP SECONDS\n"
    "                                                            SOME NEW LABEL\n"
    "                                                            END OF HEADER\n"
    "R07 2024 01 17 09 45 00 3.405846655369E-05 0.000000000000E+00 2.934000000000E+05\n"
    "    -1.245043261719E+04-1.016407966614E+00 9.313225746155E-10 0.000000000000E+00\n"
    "     1.215678906250E+04 1.890110969543E+00 0.000000000000E+00 5.000000000000E+00\n"
    "     1.861532568359E+04-1.911674499512E+00-2.793967723846E-09 0.000000000000E+00\n"
    "G05 2024 01 17 10 00 00-1.517571508880E-04-1.250555214940E-11 0.000000000000E+00\n"
    "     7.700000000000E+01 4.312500000000E+00 4.269106396140E-09 1.234567890120E+00\n"
    "     2.011656761170E-07 5.894634872670E-03 1.013651490210E-05 5.153681642530E+03\n"
    "     2.952000000000E+05 1.117587089540E-08-2.362784815320E+00 3.911554813390E-08\n"
    "     9.664300923440E-01 1.831250000000E+02 1.213912735620E+00-7.975689363790E-09\n"
    "     2.100087500000E-10 1.000000000000E+00 2.297000000000E+03 0.000000000000E+00\n"
    "     2.000000000000E+00 0.000000000000E+00-1.117587089540E-08 5.890000000000E+02\n"
    "     2.880180000000E+05 4.000000000000E+00\n"
    "E11 2024 01 17 10 00 00-1.517571508880E-04-1.250555214940E-11 0.000000000000E+00\n"
    "     7.700000000000E+01 4.312500000000E+00 4.269106396140E-09 1.234567890120E+00\n"
    "     2.011656761170E-07 5.894634872670E-03 1.013651490210E-05 5.153681642530E+03\n"
    "     2.952000000000E+05 1.117587089540E-08-2.362784815320E+00 3.911554813390E-08\n"
    "     9.664300923440E-01 1.831250000000E+02 1.213912735620E+00-7.975689363790E-09\n"
    "     2.100087500000E-10 1.000000000000E+00 2.297000000000E+03                   \n"
    "     2.000000000000E+00 0.000000000000E+00-1.117587089540E-08 0.000000000000E+00\n"
    "     2.880180000000E+05\n";

inline constexpr const char* kYuma =
    "******** Week 249 almanac for PRN-05 ********\n"
    "ID:                         05\n"
    "Health:                     000\n"
    "Eccentricity:               0.5894660950E-002\n"
    "Time of Applicability(s):  319488.0000\n"
    "Orbital Inclination(rad):   0.9664306641\n"
    "Rate of Right Ascen(r/s):  -0.7977475151E-008\n"
    "SQRT(A)  (m 1/2):           5153.681641\n"
    "Right Ascen at Week(rad):  -0.2362785339E+001\n"
    "Argument of Perigee(rad):   1.213912725\n"
    "Mean Anom(rad):            -0.1507446766E+001\n"
    "Af0(s):                    -0.1516342163E-003\n"
    "Af1(s/s):                  -0.1091393642E-010\n"
    "week:                        249\n";

/// The error that `function` throws, as text; empty when it throws none.
template <class Function>
std::string refusal(Function&& function) {
  try {
    function();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

/// `text` with the first `from` replaced.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace rigwire::protocols::rinex
