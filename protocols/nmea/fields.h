// Fields that several sentences share. For the writers of this folder.
#pragma once

#include <optional>
#include <string_view>

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/sentence.h"

namespace rigwire::protocols::nmea {

inline constexpr double kKnotsPerMps = 3600.0 / 1852.0;
inline constexpr double kKilometresPerHourPerKnot = 1.852;

[[nodiscard]] Sentence begin_sentence(std::string_view talker, std::string_view type);

[[nodiscard]] bool has_fix(const Epoch& epoch);
/// Version 4.10 or later: system, signal and navigational status are printed.
[[nodiscard]] bool has_identifiers(const Epoch& epoch);
/// The letter of position mode. `with_carrier`: RMC and GNS tell float and fixed apart.
[[nodiscard]] std::string_view position_mode(const Epoch& epoch, bool with_carrier);
/// GGA quality.
[[nodiscard]] int quality(const Epoch& epoch);

void put_time(Sentence& sentence, const std::optional<TimeOfDay>& time);
void put_date(Sentence& sentence, const std::optional<Date>& date);
/// Two fields: latitude and hemisphere, then longitude and hemisphere, however there is a fix.
/// Error at most half a unit of the last decimal.
void put_coordinates(Sentence& sentence, const Epoch& epoch);
/// The same four fields, empty without fix.
void put_position(Sentence& sentence, const Epoch& epoch);
void put_altitude(Sentence& sentence, const Epoch& epoch);
/// Two decimals; 360.00 becomes 0.00.
void put_course(Sentence& sentence, double course_deg);
/// Two decimals, 99.99 at most and when unknown.
void put_dilution(Sentence& sentence, const std::optional<double>& dilution);
/// About two significant digits: 148, 12, 1.2, 0.12, 0.012.
void put_deviation(Sentence& sentence, double value);
/// Age and station of corrections; empty without them.
void put_corrections(Sentence& sentence, const Epoch& epoch);

}  // namespace rigwire::protocols::nmea
