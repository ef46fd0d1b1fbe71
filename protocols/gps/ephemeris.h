// Clock and orbit of one satellite: subframes 1, 2 and 3 of the legacy navigation message.
//
// Source: IS-GPS-200 sections 20.3.3.3 and 20.3.3.4, tables 20-I, 20-II, 20-III, figure 20-1 sheets
// 1 to 3. Quantities are SI and radians, as RINEX has them too; the semicircles of the message are
// multiples of pi = 3.1415926535898. Encoding takes the nearest step, the maximum error is half a
// step; a value that was decoded encodes to the same bits.
#pragma once

#include <cstdint>

#include "protocols/gps/subframe.h"
#include "protocols/result.h"

namespace rigwire::protocols::gps {

struct Ephemeris {
  std::uint8_t prn = 0;  ///< 1..32; not in the message, which is its satellite's own.
  /// Week of ephemeris_time_s, since 1980-01-06, not rolled over.
  std::int32_t week = 0;
  std::uint8_t l2_code = 1;             ///< 2 bits: 1 P code, 2 C/A code on L2.
  bool l2_p_data_off = false;           ///< L2 P data flag.
  std::uint8_t accuracy_index = 0;      ///< URA, 0..15.
  std::uint8_t health = 0;              ///< 6 bits, 0 = all good.
  std::uint16_t issue_of_clock = 0;     ///< IODC, 10 bits.
  std::uint8_t issue_of_ephemeris = 0;  ///< IODE.
  bool long_fit = false;                ///< Fit interval flag: more than four hours.
  std::uint8_t age_of_data_offset = 0;  ///< AODO, 5 bits, steps of 900 s; 31 = none.
  double group_delay_s = 0.0;           ///< TGD.
  /// Galileo: of E5a (the other is of E5b); BeiDou: of B2I; GPS: none.
  double second_delay_s = 0.0;
  double clock_time_s = 0.0;          ///< toc, time of week.
  double clock_bias_s = 0.0;          ///< af0.
  double clock_drift = 0.0;           ///< af1, s/s.
  double clock_drift_rate = 0.0;      ///< af2, s/s2.
  double ephemeris_time_s = 0.0;      ///< toe, time of week.
  double sqrt_semi_major_axis = 0.0;  ///< sqrt(m).
  double eccentricity = 0.0;
  double mean_anomaly_rad = 0.0;         ///< M0.
  double mean_motion_difference = 0.0;   ///< Delta n, rad/s.
  double ascending_node_rad = 0.0;       ///< OMEGA0, longitude at the start of the week.
  double inclination_rad = 0.0;          ///< i0.
  double argument_of_perigee_rad = 0.0;  ///< omega.
  double ascending_node_rate = 0.0;      ///< OMEGADOT, rad/s.
  double inclination_rate = 0.0;         ///< IDOT, rad/s.
  double latitude_cosine_rad = 0.0;      ///< Cuc.
  double latitude_sine_rad = 0.0;        ///< Cus.
  double radius_cosine_m = 0.0;          ///< Crc.
  double radius_sine_m = 0.0;            ///< Crs.
  double inclination_cosine_rad = 0.0;   ///< Cic.
  double inclination_sine_rad = 0.0;     ///< Cis.

  friend bool operator==(const Ephemeris&, const Ephemeris&) = default;
};

/// Words 3..10 of subframe `id` 1, 2 or 3 (precondition), words 1 and 2 as they are. `sent_week` is
/// the week in which the subframe leaves. Values beyond a field are clamped to it.
void put_ephemeris(SubframeData& data, std::uint8_t id, const Ephemeris& ephemeris,
                   std::int32_t sent_week);

/// Returns the ephemeris with every field rounded to the message's steps, as a receiver finds it.
[[nodiscard]] Ephemeris quantised(const Ephemeris& ephemeris);

/// Decodes three subframes with heads. `week_hint` is a week within 511 of the week in which they
/// were sent, of which they carry only the low ten bits. Malformed when a head is, when the ids are
/// not 1, 2, 3 or the issues differ (a change between them); the offset is that of the subframe.
[[nodiscard]] Decoded<Ephemeris> decode_ephemeris(const SubframeData& first,
                                                  const SubframeData& second,
                                                  const SubframeData& third, std::uint8_t prn,
                                                  std::int32_t week_hint);

/// The week nearest to `week_hint` that has the low bits `rolled`, modulo `modulus` (1024 or 256).
[[nodiscard]] std::int32_t unrolled_week(std::int32_t rolled, std::int32_t modulus,
                                         std::int32_t week_hint);

/// Nominal user range accuracy of an index, metres, as RINEX writes it: section 20.3.3.3.1.3. 15,
/// which gives no accuracy, is 8192.
[[nodiscard]] double nominal_accuracy_m(std::uint8_t index);
/// Returns the lowest index whose upper bound is not below `accuracy_m`; 15 beyond 6144 m. Nominal
/// values give their own index.
[[nodiscard]] std::uint8_t accuracy_index(double accuracy_m);

}  // namespace rigwire::protocols::gps
