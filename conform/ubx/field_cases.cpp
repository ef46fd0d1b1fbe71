// What single messages say has to be possible: ranges, versions, sums within one message. Sections
// of UBX-13003221 R28 and UBXDOC-963802114-12815, as the messages' own.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

using T = UbxTrial;
using P = UbxPayload;

void within(T& trial, const P& p, std::string_view field, double least, double most) {
  const double value = p.value(field);
  trial.expect(value >= least && value <= most,
               std::string(field) + " from " + std::to_string(std::llround(least)) + " to " +
                   std::to_string(std::llround(most)),
               p.words());
}

void blocks_within(T& trial, const P& p, std::string_view field, double least, double most) {
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    const double value = p.value_in(i, field);
    trial.expect(value >= least && value <= most,
                 std::string(field) + " from " + std::to_string(std::llround(least)) + " to " +
                     std::to_string(std::llround(most)) + " in each",
                 "block " + std::to_string(i) + ": " + std::to_string(value));
  }
}

/// "A.B" at the end of the text that begins so.
bool is_protocol(const std::string& text) {
  const bool begins = text.starts_with("PROTVER ") || text.starts_with("PROTVER=");
  return begins && text.size() == 13 && text[10] == '.' &&
         std::ranges::all_of(text.substr(8),
                             [](char c) { return c == '.' || (c >= '0' && c <= '9'); });
}

/// Text up to its first zero; nothing where there is something behind it, or no ASCII.
std::optional<std::string> padded(std::span<const std::uint8_t> bytes) {
  const auto end = std::ranges::find(bytes, 0);
  const bool zeros = std::ranges::all_of(end, bytes.end(), [](std::uint8_t b) { return b == 0; });
  const bool ascii =
      std::all_of(bytes.begin(), end, [](std::uint8_t b) { return b >= 0x20 && b < 0x7F; });
  return zeros && ascii ? std::optional(std::string(bytes.begin(), end)) : std::nullopt;
}

void versions(T& trial, const P& p) {
  const std::span<const std::uint8_t> all = p.bytes();
  const auto text = [&](std::size_t at, std::size_t count) {
    const auto found = padded(all.subspan(at, count));
    trial.expect(found.has_value(), "ASCII, and zeros behind it",
                 hex_text({all.begin() + static_cast<std::ptrdiff_t>(at),
                           all.begin() + static_cast<std::ptrdiff_t>(at + count)}));
    return found.value_or("");
  };
  trial.expect(!text(0, 30).empty(), "a software version", "none");
  trial.expect(!text(30, 10).empty(), "a hardware version", "none");
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    static_cast<void>(text(40 + 30 * i, 30));
  }
}

void protocol_version(T& trial, const P& p) {
  int found = 0;
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    const auto text = padded(std::span(p.bytes()).subspan(40 + 30 * i, 30));
    found += text && is_protocol(*text) ? 1 : 0;
  }
  trial.expect(found == 1, "PROTVER once among the extensions, with two decimals", p.words());
}

void place(T& trial, const P& p) {
  within(trial, p, "lat", -900'000'000, 900'000'000);
  within(trial, p, "lon", -1'800'000'000, 1'800'000'000);
}

void civil_time(T& trial, const P& p) {
  within(trial, p, "month", 1, 12);
  within(trial, p, "day", 1, 31);
  within(trial, p, "hour", 0, 23);
  within(trial, p, "min", 0, 59);
  within(trial, p, "sec", 0, 60);
  within(trial, p, "nano", -1e9, 1e9);
}

bool near(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance;
}

void dilutions(T& trial, const P& p) {
  constexpr double kNoDilution = 9999;
  const auto at = [&](std::string_view field) { return p.value(field); };
  if (at("pDOP") >= kNoDilution || at("tDOP") >= kNoDilution) {
    return trial.not_applicable("no dilutions without a fix");
  }
  // Each is rounded to a hundredth.
  const auto sum = [&](std::string_view whole, std::string_view a, std::string_view b) {
    trial.expect(near(at(whole), std::hypot(at(a), at(b)), 1.5 + 0.005 * at(whole)),
                 std::string(whole) + " squared as the sum of " + std::string(a) + " squared and " +
                     std::string(b) + " squared",
                 p.words());
  };
  sum("pDOP", "hDOP", "vDOP");
  sum("gDOP", "pDOP", "tDOP");
  sum("hDOP", "nDOP", "eDOP");
}

void ground_speed(T& trial, const P& p) {
  const double speed = std::hypot(p.value("velN"), p.value("velE"));
  trial.expect(near(p.value("gSpeed"), speed, 2.0), "gSpeed of velN and velE", p.words());
}

void speed_in_space(T& trial, const P& p) {
  const double speed = std::hypot(p.value("velN"), p.value("velE"), p.value("velD"));
  trial.expect(near(p.value("speed"), speed, 2.0), "speed of velN, velE and velD", p.words());
  ground_speed(trial, p);
}

void heading(T& trial, const P& p, std::string_view field) {
  // Frozen when slow; of a metre per second and more it is where the velocity points.
  const double per_mps = field == "heading" ? 100.0 : 1000.0;
  if (p.value("gSpeed") < per_mps) {
    return trial.not_applicable("slower than 1 m/s");
  }
  double off =
      p.value(field) * 1e-5 - std::atan2(p.value("velE"), p.value("velN")) * 57.295779513082320877;
  off = std::remainder(off, 360.0);
  trial.expect(std::abs(off) < 5.0, "the direction of velN and velE within 5 degrees", p.words());
}

void satellites(T& trial, const P& p) {
  const bool newer = p.message().name == "NAV-SAT";
  blocks_within(trial, p, "elev", -91, 90);
  blocks_within(trial, p, "azim", newer ? 0 : -1, 360);
  blocks_within(trial, p, "cno", 0, 63);
}

void satellites_once(T& trial, const P& p) {
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      trial.expect(p.value_in(i, "gnssId") != p.value_in(j, "gnssId") ||
                       p.value_in(i, "svId") != p.value_in(j, "svId"),
                   "each satellite once", "satellite " + std::to_string(p.value_in(i, "svId")));
    }
  }
}

void used_are_tracked(T& trial, const P& p) {
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    const bool used = p.bits_in(i, "flags", 3) != 0;
    trial.expect(!used || (p.bits_in(i, "flags", 0, 3) >= 4 && p.value_in(i, "cno") > 0),
                 "of what is used code and time are locked (quality 4 to 7), and it has a strength",
                 "satellite " + std::to_string(p.value_in(i, "svId")) + ", quality " +
                     std::to_string(p.bits_in(i, "flags", 0, 3)));
  }
}

void pseudoranges(T& trial, const P& p) {
  // Pseudoranges of satellites in medium and geostationary orbits, with a clock error below a
  // millisecond.
  blocks_within(trial, p, "prMes", 1.5e7, 5.0e7);
  if (p.message().name == "RXM-RAWX") {
    blocks_within(trial, p, "locktime", 0, 64'500);
    blocks_within(trial, p, "gnssId", 0, 6);
    within(trial, p, "rcvTow", -1, 604'801);
  }
}

void usages(T& trial, const P& p) {
  for (std::size_t i = 0; i < 6; ++i) {
    trial.expect(p.value("usage", i) <= 100 && p.value("peakUsage", i) <= 100 &&
                     p.value("usage", i) <= p.value("peakUsage", i),
                 "usages up to 100 %, and none above its peak", p.words());
  }
}

void hardware(T& trial, const P& p) {
  within(trial, p, "aStatus", 0, 4);
  within(trial, p, "aPower", 0, 2);
  within(trial, p, "agcCnt", 0, 8191);
}

void times_since(T& trial, const P& p) {
  trial.expect(p.value("ttff") <= p.value("msss"), "a first fix within the time since start",
               p.words());
  within(trial, p, "gpsFix", 0, 5);
}

void fine_parts(T& trial, const P& p, std::initializer_list<std::string_view> fields,
                double greatest) {
  for (const std::string_view field : fields) {
    within(trial, p, field, -greatest, greatest);
  }
}

void variances(T& trial, const P& p) {
  for (const std::string_view field :
       {"posCovNN", "posCovEE", "posCovDD", "velCovNN", "velCovEE", "velCovDD"}) {
    trial.expect(p.value(field) >= 0, "variances of 0 and more", p.words());
  }
  const auto bounded = [&](std::string_view both, std::string_view a, std::string_view b) {
    trial.expect(std::abs(p.value(both)) <= 1.001 * std::sqrt(p.value(a) * p.value(b)) + 1e-12,
                 "no covariance above its variances", p.words());
  };
  bounded("posCovNE", "posCovNN", "posCovEE");
  bounded("posCovND", "posCovNN", "posCovDD");
  bounded("posCovED", "posCovEE", "posCovDD");
  bounded("velCovNE", "velCovNN", "velCovEE");
}

void distances(T& trial, const P& p) {
  within(trial, p, "version", 0, 0);
  trial.expect(p.value("distance") <= p.value("totalDistance") + 1,
               "no more since the reset than in all", p.words());
}

/// Checks a time of week.
void time_of_week(T& trial, const P& p) {
  if (p.bits("valid", 0) == 0) {
    return trial.not_applicable("its time is not valid");
  }
  within(trial, p, "iTOW", 0, 604'799'999);
  within(trial, p, "week", 1024, 8191);
}

struct FieldRow {
  const char* message;
  const char* title;
  Strength strength;
  void (*run)(T&, const P&);
};

const std::array kFieldRows{
    FieldRow{"MON-VER", "Versions are texts with zeros behind", kMust, versions},
    FieldRow{"MON-VER", "The protocol's version is among the extensions", kMust, protocol_version},
    FieldRow{"MON-VER", "What it calls itself", Strength::observed,
             [](T& t, const P& p) { t.observe(p.words()); }},
    FieldRow{"MON-HW", "The antenna's state and power, and the gain, are such", kMust, hardware},
    FieldRow{"MON-RXBUF", "Usages are shares", kMust, usages},
    FieldRow{"MON-TXBUF", "Usages are shares", kMust, usages},
    FieldRow{"MON-GNSS", "What is enabled is supported", kMust,
             [](T& t, const P& p) {
               t.expect((static_cast<unsigned>(p.value("enabled")) &
                         ~static_cast<unsigned>(p.value("supported"))) == 0,
                        "no system that is not supported", p.words());
             }},
    FieldRow{"MON-RF", "The antenna's state is such", kMust,
             [](T& t, const P& p) {
               blocks_within(t, p, "antStatus", 0, 4);
               blocks_within(t, p, "antPower", 0, 2);
               blocks_within(t, p, "agcCnt", 0, 8191);
             }},
    FieldRow{"MON-COMMS", "Usages are shares", kMust,
             [](T& t, const P& p) {
               blocks_within(t, p, "txUsage", 0, 100);
               blocks_within(t, p, "rxUsage", 0, 100);
             }},
    FieldRow{"SEC-UNIQID", "The number is not nothing", kMust,
             [](T& t, const P& p) {
               t.expect(p.value("version") == 1, "version 1", p.words());
               const auto number = std::span(p.bytes()).subspan(4);
               t.expect(std::ranges::any_of(number, [](std::uint8_t b) { return b != 0; }),
                        "a number", p.words());
             }},
    FieldRow{"NAV-PVT", "The place is on the earth", kMust, place},
    FieldRow{"NAV-POSLLH", "The place is on the earth", kMust, place},
    FieldRow{"NAV-PVT", "Date and time are such", kMust,
             [](T& t, const P& p) {
               if (p.bits("valid", 0, 2) != 3) {
                 return t.not_applicable("date or time is not valid");
               }
               civil_time(t, p);
             }},
    FieldRow{"NAV-TIMEUTC", "Date and time are such", kMust,
             [](T& t, const P& p) {
               if (p.bits("valid", 2) == 0) {
                 return t.not_applicable("the time is not valid");
               }
               civil_time(t, p);
             }},
    FieldRow{"NAV-PVT", "The kind of fix is one that there is", kMust,
             [](T& t, const P& p) { within(t, p, "fixType", 0, 5); }},
    FieldRow{"NAV-PVT", "A fix that is good has a kind", kMust,
             [](T& t, const P& p) {
               t.expect(p.bits("flags", 0) == 0 || p.value("fixType") > 0, "a kind with gnssFixOK",
                        p.words());
             }},
    FieldRow{"NAV-PVT", "The speed over ground is of the velocity", kMust, ground_speed},
    FieldRow{"NAV-PVT", "The course is of the velocity", kMust,
             [](T& t, const P& p) { heading(t, p, "headMot"); }},
    FieldRow{"NAV-VELNED", "The speeds are of the velocity", kMust, speed_in_space},
    FieldRow{"NAV-VELNED", "The course is of the velocity", kMust,
             [](T& t, const P& p) { heading(t, p, "heading"); }},
    FieldRow{"NAV-DOP", "Dilutions belong together", kMust, dilutions},
    FieldRow{"NAV-STATUS", "The times since the start are such", kMust, times_since},
    FieldRow{"NAV-TIMEGPS", "Week and time of week are such", kMust, time_of_week},
    FieldRow{"NAV-TIMEGPS", "The leap seconds are those since 2017 (IERS Bulletin C)",
             Strength::should,
             [](T& t, const P& p) {
               if (p.bits("valid", 2) == 0) {
                 return t.not_applicable("leapS is not valid");
               }
               t.expect(p.value("leapS") == 18, "18 s", p.words());
             }},
    FieldRow{"NAV-CLOCK", "The bias is within the receiver's millisecond", Strength::should,
             [](T& t, const P& p) { within(t, p, "clkB", -1'000'000, 1'000'000); }},
    FieldRow{"NAV-SVINFO", "Elevations, azimuths and strengths are such", kMust, satellites},
    FieldRow{"NAV-SAT", "Elevations, azimuths and strengths are such", kMust, satellites},
    FieldRow{"NAV-SAT", "The version is 1, and systems are such", kMust,
             [](T& t, const P& p) {
               within(t, p, "version", 1, 1);
               blocks_within(t, p, "gnssId", 0, 7);
             }},
    FieldRow{"NAV-SAT", "Each satellite is there once", kMust, satellites_once},
    FieldRow{"NAV-SAT", "What is used is tracked", kMust, used_are_tracked},
    FieldRow{"NAV-SIG", "The version is 0, and systems are such", kMust,
             [](T& t, const P& p) {
               within(t, p, "version", 0, 0);
               blocks_within(t, p, "gnssId", 0, 7);
               blocks_within(t, p, "qualityInd", 0, 7);
             }},
    FieldRow{"NAV-ORB", "The version is 1, each satellite there once", kMust,
             [](T& t, const P& p) {
               within(t, p, "version", 1, 1);
               satellites_once(t, p);
             }},
    FieldRow{"NAV-HPPOSLLH", "The fine parts are below a step of the coarse", kMust,
             [](T& t, const P& p) {
               fine_parts(t, p, {"lonHp", "latHp"}, 99);
               fine_parts(t, p, {"heightHp", "hMSLHp"}, 9);
             }},
    FieldRow{"NAV-HPPOSECEF", "The fine parts are below a step of the coarse", kMust,
             [](T& t, const P& p) {
               fine_parts(t, p, {"ecefXHp", "ecefYHp", "ecefZHp"}, 99);
             }},
    FieldRow{"NAV-COV", "Variances and covariances are such", kMust, variances},
    FieldRow{"NAV-ODO", "Distances are such", kMust, distances},
    FieldRow{"NAV-SVIN", "Flags are flags", kMust,
             [](T& t, const P& p) {
               within(t, p, "valid", 0, 1);
               within(t, p, "active", 0, 1);
             }},
    FieldRow{"NAV-RELPOSNED", "The version is 1, the fine parts are below a step", kMust,
             [](T& t, const P& p) {
               within(t, p, "version", 1, 1);
               fine_parts(t, p, {"relPosHPN", "relPosHPE", "relPosHPD", "relPosHPLength"}, 99);
             }},
    FieldRow{"RXM-RAWX", "Pseudoranges and lock times are such", kMust, pseudoranges},
    FieldRow{"RXM-RAW", "Pseudoranges are such", kMust, pseudoranges},
    FieldRow{"TIM-TP", "The next pulse is within a week", kMust,
             [](T& t, const P& p) { within(t, p, "towMS", 0, 604'800'000); }},
};

}  // namespace

std::vector<UbxCase> ubx_field_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const FieldRow& row : kFieldRows) {
    const UbxMessage& message = *ubx_message(row.message);
    UbxCase& made = all.emplace_back();
    made.identity =
        message.document == UbxDocument::recordings
            ? citations.m8.next_in(row.message, row.title, source_of(message), row.strength)
            : (message.document == UbxDocument::f9 ? citations.f9 : citations.m8)
                  .next(std::string(message.section), row.title, row.strength);
    made.needs = {message.name};
    made.run = [&message, run = row.run](UbxTrial& trial) {
      if (const auto found = trial.poll(message.name)) {
        run(trial, *found);
      }
    };
  }
  return all;
}

}  // namespace rigwire::conform
