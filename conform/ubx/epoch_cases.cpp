// What the messages of one navigation epoch say of the same thing: it is the same, in the units of
// each. Sections of UBX-13003221 R28 and UBXDOC-963802114-12815, as the messages' own; of the
// sentences, 31.
//
// Tolerances are the coarser message's step, and half of one for its rounding.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "conform/nmea/nmea_log.h"
#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

using T = UbxTrial;
using P = UbxPayload;
using All = UbxTrial::Payloads;

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

/// `field` of `a` times `scale` is `other` of `b`, to `tolerance`.
void same(T& trial, const P& a, std::string_view field, const P& b, std::string_view other,
          double scale = 1.0, double tolerance = 0.0) {
  const double one = a.value(field) * scale;
  const double two = b.value(other);
  trial.expect(std::abs(one - two) <= tolerance,
               std::string(field) + " of " + std::string(a.message().name) + " in " +
                   std::string(other) + " of " + std::string(b.message().name),
               text_of(one) + " and " + text_of(two));
}

void same_flag(T& trial, const P& a, unsigned bit, const P& b, unsigned other,
               const std::string& what) {
  trial.expect(a.bits("flags", bit) == b.bits("flags", other), what + " in both",
               a.words() + " and " + b.words());
}

/// Earth-fixed, of WGS 84, in metres.
std::array<double, 3> earth_fixed(double latitude_deg, double longitude_deg, double height_m) {
  constexpr double kMajor_m = 6'378'137.0;
  constexpr double kFlattening = 1.0 / 298.257'223'563;
  constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);
  const double phi = latitude_deg * std::numbers::pi / 180.0;
  const double lambda = longitude_deg * std::numbers::pi / 180.0;
  const double sine = std::sin(phi);
  const double normal_m = kMajor_m / std::sqrt(1.0 - kEccentricity2 * sine * sine);
  const double axis_m = (normal_m + height_m) * std::cos(phi);
  return {axis_m * std::cos(lambda), axis_m * std::sin(lambda),
          (normal_m * (1.0 - kEccentricity2) + height_m) * sine};
}

void place_in_both_frames(T& trial, const P& llh, const P& ecef, double step_m) {
  const double height_m = llh.value("height") * 1e-3;
  const auto expected = earth_fixed(llh.value("lat") * 1e-7, llh.value("lon") * 1e-7, height_m);
  static constexpr std::array<std::string_view, 3> kAxes{"ecefX", "ecefY", "ecefZ"};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const double found_m = ecef.value(kAxes[i]) * 0.01;
    // 1e-7 degrees are 11 mm.
    trial.expect(std::abs(found_m - expected[i]) <= step_m + 0.012,
                 std::string(kAxes[i]) + " of the place in latitude, longitude and height (WGS 84)",
                 text_of(found_m) + " m, not " + text_of(expected[i]) + " m");
  }
}

/// Days since 1970-01-01 of the Gregorian calendar.
long days_of(int year, int month, int day) {
  year -= month <= 2 ? 1 : 0;
  const int era = year / 400;
  const int of_era = year - era * 400;
  const int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146'097L + of_era * 365L + of_era / 4 - of_era / 100 + of_year - 719'468L;
}

double utc_s(const P& p) {
  const auto at = [&](std::string_view field) { return static_cast<int>(p.value(field)); };
  return static_cast<double>(days_of(at("year"), at("month"), at("day"))) * 86'400.0 +
         at("hour") * 3600.0 + at("min") * 60.0 + at("sec") + p.value("nano") * 1e-9;
}

/// Both of UTC of a date and GPS time of a week, where valid.
void calendar(T& trial, const P& utc, const P& gps, bool valid) {
  if (!valid || gps.bits("valid", 0, 3) != 7) {
    return trial.not_applicable("a time is not valid");
  }
  constexpr double kBeginOfGps_s = 315'964'800.0;
  const double gps_s = kBeginOfGps_s + gps.value("week") * 604'800.0 + gps.value("iTOW") * 1e-3 +
                       gps.value("fTOW") * 1e-9 - gps.value("leapS");
  trial.expect(std::abs(utc_s(utc) - gps_s) < 2e-6, "UTC as GPS time less leap seconds",
               utc.words() + " and " + gps.words());
}

void dates_of_pvt_and_utc(T& trial, const P& pvt, const P& utc) {
  for (const std::string_view field :
       {"year", "month", "day", "hour", "min", "sec", "nano", "tAcc"}) {
    same(trial, pvt, field, utc, field);
  }
}

void velocity_north(T& trial, const P& pvt, const P& ned) {
  for (const std::string_view field : {"velN", "velE", "velD", "gSpeed"}) {
    same(trial, pvt, field, ned, field, 0.1, 1.01);
  }
  same(trial, pvt, "sAcc", ned, "sAcc", 0.1, 1.01);
  same(trial, pvt, "headMot", ned, "heading", 1.0, 1.0);
}

void velocity_in_both_frames(T& trial, const P& ned, const P& ecef) {
  const double one = std::hypot(ned.value("velN"), ned.value("velE"), ned.value("velD"));
  const double two = std::hypot(ecef.value("ecefVX"), ecef.value("ecefVY"), ecef.value("ecefVZ"));
  trial.expect(std::abs(one - two) <= 2.0, "the same speed in both frames",
               text_of(one) + " and " + text_of(two) + " cm/s");
  same(trial, ned, "sAcc", ecef, "sAcc", 1.0, 1.0);
}

std::size_t used(const P& p, std::string_view flags, unsigned bit) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < p.blocks(); ++i) {
    count += p.bits_in(i, flags, bit);
  }
  return count;
}

void counts(T& trial, const P& fix, const P& list, std::string_view flags, unsigned bit) {
  const std::size_t named = used(list, flags, bit);
  trial.expect(fix.value("numSV") == static_cast<double>(named),
               "as many satellites in numSV as " + std::string(list.message().name) + " has used",
               text_of(fix.value("numSV")) + " and " + std::to_string(named));
}

struct Row {
  std::string_view one;
  std::string_view other;
  const char* title;
  void (*run)(T&, const P&, const P&);
};

const std::array kRows{
    Row{"NAV-PVT", "NAV-POSLLH", "The place, and its accuracy",
        [](T& t, const P& a, const P& b) {
          for (const std::string_view field : {"lon", "lat", "height", "hMSL", "hAcc", "vAcc"}) {
            same(t, a, field, b, field);
          }
        }},
    Row{"NAV-PVT", "NAV-VELNED", "Velocity, speed, course", velocity_north},
    Row{"NAV-PVT", "NAV-STATUS", "The fix, and whether it is good",
        [](T& t, const P& a, const P& b) {
          same(t, a, "fixType", b, "gpsFix");
          same_flag(t, a, 0, b, 0, "gnssFixOK");
          same_flag(t, a, 1, b, 1, "diffSoln");
        }},
    Row{"NAV-PVT", "NAV-DOP", "The dilution",
        [](T& t, const P& a, const P& b) { same(t, a, "pDOP", b, "pDOP"); }},
    Row{"NAV-PVT", "NAV-SOL", "Fix, satellites, dilution",
        [](T& t, const P& a, const P& b) {
          same(t, a, "fixType", b, "gpsFix");
          same(t, a, "numSV", b, "numSV");
          same(t, a, "pDOP", b, "pDOP");
          same_flag(t, a, 0, b, 0, "gnssFixOK");
          same(t, a, "sAcc", b, "sAcc", 0.1, 1.01);
        }},
    Row{"NAV-PVT", "NAV-TIMEUTC", "Date and time", dates_of_pvt_and_utc},
    Row{"NAV-PVT", "NAV-TIMEGPS", "UTC against GPS time",
        [](T& t, const P& a, const P& b) { calendar(t, a, b, a.bits("valid", 0, 3) == 7); }},
    Row{"NAV-TIMEUTC", "NAV-TIMEGPS", "UTC against GPS time",
        [](T& t, const P& a, const P& b) { calendar(t, a, b, a.bits("valid", 2) == 1); }},
    Row{"NAV-POSECEF", "NAV-SOL", "The place in the earth's frame",
        [](T& t, const P& a, const P& b) {
          for (const std::string_view field : {"ecefX", "ecefY", "ecefZ", "pAcc"}) {
            same(t, a, field, b, field);
          }
        }},
    Row{"NAV-VELECEF", "NAV-SOL", "The velocity in the earth's frame",
        [](T& t, const P& a, const P& b) {
          for (const std::string_view field : {"ecefVX", "ecefVY", "ecefVZ", "sAcc"}) {
            same(t, a, field, b, field);
          }
        }},
    Row{"NAV-SOL", "NAV-TIMEGPS", "Week and rest",
        [](T& t, const P& a, const P& b) {
          same(t, a, "week", b, "week");
          same(t, a, "fTOW", b, "fTOW");
        }},
    Row{"NAV-STATUS", "NAV-SOL", "The fix, and whether it is good",
        [](T& t, const P& a, const P& b) {
          same(t, a, "gpsFix", b, "gpsFix");
          for (unsigned bit = 0; bit < 4; ++bit) {
            same_flag(t, a, bit, b, bit, "flags");
          }
        }},
    Row{"NAV-POSLLH", "NAV-POSECEF", "The place in both frames",
        [](T& t, const P& a, const P& b) { place_in_both_frames(t, a, b, 0.01); }},
    Row{"NAV-PVT", "NAV-POSECEF", "The place in both frames",
        [](T& t, const P& a, const P& b) { place_in_both_frames(t, a, b, 0.01); }},
    Row{"NAV-VELNED", "NAV-VELECEF", "The velocity in both frames", velocity_in_both_frames},
    Row{"NAV-HPPOSLLH", "NAV-POSLLH", "The fine place rounds to the coarse one",
        [](T& t, const P& a, const P& b) {
          for (const std::string_view field : {"lon", "lat", "height", "hMSL"}) {
            same(t, a, field, b, field, 1.0, 1.0);
          }
          same(t, a, "hAcc", b, "hAcc", 0.1, 1.0);
        }},
    Row{"NAV-HPPOSECEF", "NAV-POSECEF", "The fine place rounds to the coarse one",
        [](T& t, const P& a, const P& b) {
          for (const std::string_view field : {"ecefX", "ecefY", "ecefZ"}) {
            same(t, a, field, b, field, 1.0, 1.0);
          }
          same(t, a, "pAcc", b, "pAcc", 0.01, 1.0);
        }},
    Row{"NAV-SOL", "NAV-SVINFO", "How many satellites are used",
        [](T& t, const P& a, const P& b) { counts(t, a, b, "flags", 0); }},
    Row{"NAV-PVT", "NAV-SAT", "How many satellites are used",
        [](T& t, const P& a, const P& b) { counts(t, a, b, "flags", 3); }},
    Row{"NAV-SAT", "NAV-ORB", "Both know the same satellites",
        [](T& t, const P& a, const P& b) {
          for (std::size_t i = 0; i < a.blocks(); ++i) {
            bool known = a.bits_in(i, "flags", 3) == 0;
            for (std::size_t j = 0; j < b.blocks(); ++j) {
              known = known || (a.value_in(i, "gnssId") == b.value_in(j, "gnssId") &&
                                a.value_in(i, "svId") == b.value_in(j, "svId"));
            }
            t.expect(known, "what is used in NAV-ORB",
                     "satellite " + text_of(a.value_in(i, "svId")) + " is missing");
          }
        }},
    Row{"NAV-SAT", "NAV-SIG", "Signals are of satellites that are in view",
        [](T& t, const P& a, const P& b) {
          for (std::size_t i = 0; i < b.blocks(); ++i) {
            bool known = false;
            for (std::size_t j = 0; j < a.blocks(); ++j) {
              known = known || (b.value_in(i, "gnssId") == a.value_in(j, "gnssId") &&
                                b.value_in(i, "svId") == a.value_in(j, "svId"));
            }
            t.expect(known, "each signal's satellite in NAV-SAT",
                     "satellite " + text_of(b.value_in(i, "svId")) + " is missing");
          }
        }},
    Row{"NAV-TIMELS", "NAV-TIMEGPS", "The leap seconds",
        [](T& t, const P& a, const P& b) {
          if (b.bits("valid", 2) == 0 || a.bits("valid", 0) == 0) {
            return t.not_applicable("they are not valid");
          }
          same(t, a, "currLs", b, "leapS");
        }},
    Row{"NAV-TIMEGAL", "NAV-TIMEGPS", "Galileo's week began 1024 weeks after that of GPS",
        [](T& t, const P& a, const P& b) {
          if (a.bits("valid", 0, 3) != 7 || b.bits("valid", 0, 3) != 7) {
            return t.not_applicable("a time is not valid");
          }
          t.expect(a.value("galWno") + 1024 == b.value("week"), "galWno of week less 1024",
                   a.words() + " and " + b.words());
          t.expect(std::abs(a.value("galTow") * 1000.0 - b.value("iTOW")) <= 1000.0,
                   "galTow of iTOW", a.words());
        }},
    Row{"NAV-TIMEBDS", "NAV-TIMEGPS", "BeiDou's week began 1356 weeks and 14 seconds after",
        [](T& t, const P& a, const P& b) {
          if (a.bits("valid", 0, 3) != 7 || b.bits("valid", 0, 3) != 7) {
            return t.not_applicable("a time is not valid");
          }
          const double one = (a.value("week") + 1356) * 604'800.0 + a.value("SOW") + 14.0;
          const double two = b.value("week") * 604'800.0 + b.value("iTOW") * 1e-3;
          t.expect(std::abs(one - two) <= 1.0, "week and SOW of week and iTOW",
                   a.words() + " and " + b.words());
        }},
    Row{"NAV-COV", "NAV-PVT", "The accuracy is of the covariance",
        [](T& t, const P& a, const P& b) {
          if (a.value("posCovValid") != 1) {
            return t.not_applicable("it is not valid");
          }
          const double one = std::sqrt(a.value("posCovNN") + a.value("posCovEE")) * 1000.0;
          const double two = b.value("hAcc");
          t.expect(one <= 3.0 * two + 1.0 && two <= 3.0 * one + 1.0,
                   "hAcc within three times the covariance's",
                   text_of(one) + " and " + text_of(two));
        }},
};

/// A sentence of that type as it comes, and NAV-PVT of its epoch.
struct Met {
  NmeaSentence sentence;
  P pvt;
};

/// Waits for a sentence of that type, polls NAV-PVT and compares their UTC, to hundredths of a
/// second. Tries up to four times, as an epoch may begin in between.
std::optional<Met> meet(T& trial, std::string_view type) {
  constexpr int kTries = 4;
  for (int i = 0; i < kTries && trial.fine(); ++i) {
    const auto deadline = trial.now() + std::chrono::seconds(12);
    std::optional<UbxHeard> met;
    NmeaLog log;
    while (!met) {
      auto heard = trial.hear(deadline);
      if (!heard) {
        trial.not_applicable("it sends no " + std::string(type));
        return std::nullopt;
      }
      if (heard->kind == UbxHeard::Kind::sentence && heard->text().size() > 6 &&
          heard->text().substr(3, 3) == type) {
        met = std::move(heard);
      }
    }
    trial.show(*met);
    log.add({}, met->bytes);
    const auto pvt = trial.poll("NAV-PVT");
    if (!pvt || log.sentences().empty()) {
      return std::nullopt;
    }
    const NmeaSentence& sentence = log.sentences().front();
    const auto time = time_field(sentence.type);
    if (pvt->bits("valid", 1) == 0 || !time || sentence.field(*time).empty()) {
      trial.not_applicable("the time is not known");
      return std::nullopt;
    }
    std::array<char, 16> of_pvt{};
    const double second = std::round((pvt->value("sec") + pvt->value("nano") * 1e-9) * 100) / 100;
    std::snprintf(of_pvt.data(), of_pvt.size(), "%02d%02d%05.2f",
                  static_cast<int>(pvt->value("hour")), static_cast<int>(pvt->value("min")),
                  second);
    if (sentence.field(*time) == of_pvt.data()) {
      return Met{sentence, *pvt};
    }
  }
  trial.expect(false, "the time of the sentence in NAV-PVT polled behind it",
               "another in each of four tries");
  return std::nullopt;
}

double degrees_of(const NmeaSentence& s, std::size_t field) {
  const double value = s.number(field).value_or(0.0);
  const double whole = std::floor(value / 100.0);
  const double magnitude = whole + (value - whole * 100.0) / 60.0;
  return s.field(field + 1) == "S" || s.field(field + 1) == "W" ? -magnitude : magnitude;
}

void sentence_place(T& trial, std::string_view type, std::size_t field) {
  const auto met = meet(trial, type);
  if (!met) {
    return;
  }
  if (met->sentence.field(field).empty()) {
    return trial.not_applicable("without a fix");
  }
  // Five decimals of a minute are 1.7e-7 degrees.
  const bool near =
      std::abs(degrees_of(met->sentence, field) - met->pvt.value("lat") * 1e-7) <= 2.3e-7 &&
      std::abs(degrees_of(met->sentence, field + 2) - met->pvt.value("lon") * 1e-7) <= 2.3e-7;
  trial.expect(near, "the place of NAV-PVT in " + std::string(type),
               met->sentence.text + " and " + met->pvt.words());
}

void sentence_speed(T& trial) {
  const auto met = meet(trial, "RMC");
  if (met && met->sentence.number(6)) {
    const double knots = met->pvt.value("gSpeed") * 1e-3 * 3600.0 / 1852.0;
    trial.expect(std::abs(*met->sentence.number(6) - knots) <= 0.004, "the speed of NAV-PVT in RMC",
                 met->sentence.text + " and " + met->pvt.words());
  }
}

void sentence_date(T& trial) {
  const auto met = meet(trial, "RMC");
  if (met && met->pvt.bits("valid", 0) == 1) {
    std::array<char, 16> date{};
    std::snprintf(date.data(), date.size(), "%02d%02d%02d", static_cast<int>(met->pvt.value("day")),
                  static_cast<int>(met->pvt.value("month")),
                  static_cast<int>(met->pvt.value("year")) % 100);
    trial.expect(met->sentence.field(8) == date.data(), "the date of NAV-PVT in RMC",
                 met->sentence.text + " and " + met->pvt.words());
  }
}

void sentence_height(T& trial) {
  const auto met = meet(trial, "GGA");
  if (!met || !met->sentence.number(8) || !met->sentence.number(10)) {
    return;
  }
  const double sea_m = met->pvt.value("hMSL") * 1e-3;
  const double geoid_m = (met->pvt.value("height") - met->pvt.value("hMSL")) * 1e-3;
  trial.expect(std::abs(*met->sentence.number(8) - sea_m) <= 0.06, "hMSL of NAV-PVT in GGA",
               met->sentence.text + " and " + met->pvt.words());
  trial.expect(std::abs(*met->sentence.number(10) - geoid_m) <= 0.06,
               "height less hMSL of NAV-PVT in GGA",
               met->sentence.text + " and " + met->pvt.words());
}

void sentence_fix(T& trial) {
  const auto met = meet(trial, "GGA");
  if (met) {
    trial.expect((met->sentence.field(5) != "0") == (met->pvt.bits("flags", 0) == 1),
                 "a quality above 0 with gnssFixOK",
                 met->sentence.text + " and " + met->pvt.words());
    const double told = met->sentence.number(6).value_or(-1.0);
    trial.expect(told == std::min(12.0, met->pvt.value("numSV")) || told == met->pvt.value("numSV"),
                 "the satellites of numSV in GGA, or 12 of more",
                 met->sentence.text + " and " + met->pvt.words());
  }
}

/// What is measured is not the same to the last digit, epoch after epoch.
void measured_anew(T& trial) {
  constexpr std::size_t kEpochs = 5;
  std::vector<P> all;
  const auto deadline = trial.now() + std::chrono::seconds(30);
  while (all.size() < kEpochs && trial.now() < deadline) {
    const auto next = trial.poll("NAV-PVT");
    if (!next) {
      return;
    }
    if (all.empty() || all.back().value("iTOW") != next->value("iTOW")) {
      all.push_back(*next);
    }
    static_cast<void>(trial.listen(std::chrono::milliseconds(100)));
  }
  if (all.size() < kEpochs || all.back().bits("flags", 0) == 0) {
    return trial.not_applicable("no five epochs with a fix in 30 s");
  }
  bool moved = false;
  for (const P& p : all) {
    for (const std::string_view field :
         {"lat", "lon", "height", "hAcc", "vAcc", "velN", "velE", "velD", "sAcc"}) {
      moved = moved || p.value(field) != all.front().value(field);
    }
  }
  trial.expect(moved, "place, velocity or accuracy other in one of five epochs", "all the same");
}

struct SentenceRow {
  const char* title;
  Strength strength;
  void (*run)(T&);
};

constexpr std::array kSentences{
    SentenceRow{"GGA has the place of NAV-PVT", Strength::must,
                [](T& t) { sentence_place(t, "GGA", 1); }},
    SentenceRow{"RMC has the place of NAV-PVT", Strength::must,
                [](T& t) { sentence_place(t, "RMC", 2); }},
    SentenceRow{"RMC has the speed of NAV-PVT", Strength::must, sentence_speed},
    SentenceRow{"RMC has the date of NAV-PVT", Strength::must, sentence_date},
    SentenceRow{"GGA has the height of NAV-PVT", Strength::must, sentence_height},
    SentenceRow{"GGA has the fix of NAV-PVT", Strength::must, sentence_fix},
    SentenceRow{"What is measured differs from epoch to epoch", Strength::should, measured_anew},
};

}  // namespace

std::vector<UbxCase> ubx_epoch_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const Row& row : kRows) {
    UbxCase& made = all.emplace_back();
    const std::string names = std::string(row.one) + " and " + std::string(row.other);
    made.identity = citations.m8.next_in(
        "epoch", names + ": " + row.title,
        source_of(*ubx_message(row.one)) + "; " + source_of(*ubx_message(row.other)));
    made.needs = {row.one, row.other};
    made.run = [&row](UbxTrial& trial) {
      if (const auto found = trial.together({row.one, row.other})) {
        row.run(trial, found->at(row.one), found->at(row.other));
      }
    };
  }
  for (const SentenceRow& row : kSentences) {
    UbxCase& made = all.emplace_back();
    made.identity = citations.m8.next_in("epoch", row.title, "UBX-13003221 R28, 31.2 and 32.17.17",
                                         row.strength);
    made.needs = {"NAV-PVT"};
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
