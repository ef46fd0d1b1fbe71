#include "conform/nmea/nmea_suite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

namespace rigwire::conform {

namespace {

using Log = NmeaLog;
using Claims = NmeaClaims;
using Sentence = NmeaSentence;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// The first sentence that is wrong is shown.
bool expect(Trial& trial, const Sentence& sentence, bool holds, std::string expected,
            std::string got) {
  if (!holds && trial.fine()) {
    trial.received(bytes_of(sentence.text), sentence.text);
  }
  return trial.expect(holds, std::move(expected), std::move(got));
}

bool proprietary(const Sentence& sentence) {
  return sentence.talker == "P";
}

/// Calls `check` for each sentence of a type.
template <class Check>
void each_of(Trial& trial, const Log& log, std::string_view type, const Check& check) {
  bool any = false;
  for (const Sentence& sentence : log.sentences()) {
    if (sentence.type == type && !proprietary(sentence)) {
      any = true;
      check(sentence);
    }
  }
  if (!any) {
    trial.not_applicable("it sends no " + std::string(type));
  }
}

/// Calls `check` for each epoch that has both sentences.
template <class Check>
void each_pair(Trial& trial, const Log& log, std::string_view one, std::string_view other,
               const Check& check) {
  bool any = false;
  for (const NmeaEpoch& epoch : log.epochs()) {
    const Sentence* const a = epoch.find(one);
    const Sentence* const b = epoch.find(other);
    if (a != nullptr && b != nullptr) {
      any = true;
      check(*a, *b);
    }
  }
  if (!any) {
    trial.not_applicable("no epoch has both " + std::string(one) + " and " + std::string(other));
  }
}

bool is_hex(const std::string& text, std::size_t digits) {
  return text.size() == digits && text.find_first_not_of("0123456789ABCDEF") == std::string::npos;
}

bool digits_at(const std::string& text, std::size_t from, std::size_t count) {
  return text.size() >= from + count &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(from),
                     text.begin() + static_cast<std::ptrdiff_t>(from + count),
                     [](char c) { return c >= '0' && c <= '9'; });
}

/// "hhmmss" or "hhmmss.ss", a leap second included.
bool is_time(const std::string& text) {
  if (!digits_at(text, 0, 6) || (text.size() > 6 && (text[6] != '.' || text.size() == 7 ||
                                                     !digits_at(text, 7, text.size() - 7)))) {
    return false;
  }
  return std::stoi(text.substr(0, 2)) < 24 && std::stoi(text.substr(2, 2)) < 60 &&
         std::stoi(text.substr(4, 2)) <= 60;
}

/// "ddmm.mmmm" or "dddmm.mmmm".
bool is_angle(const std::string& text, std::size_t degrees, int most) {
  if (!digits_at(text, 0, degrees + 2) || text.size() < degrees + 4 || text[degrees + 2] != '.' ||
      !digits_at(text, degrees + 3, text.size() - degrees - 3)) {
    return false;
  }
  const int whole = std::stoi(text.substr(0, degrees));
  const double minutes = std::stod(text.substr(degrees));
  return minutes < 60.0 && whole * 60 + minutes <= most * 60;
}

/// Place and its two letters at these fields, all empty or all there and right.
bool is_place(const Sentence& s, std::size_t at) {
  const std::string& latitude = s.field(at);
  const std::string& longitude = s.field(at + 2);
  if ((latitude + s.field(at + 1) + longitude + s.field(at + 3)).empty()) {
    return true;
  }
  return is_angle(latitude, 2, 90) && is_angle(longitude, 3, 180) &&
         (s.field(at + 1) == "N" || s.field(at + 1) == "S") &&
         (s.field(at + 3) == "E" || s.field(at + 3) == "W");
}

std::string fields_text(const Sentence& s, std::size_t from, std::size_t count) {
  std::string text;
  for (std::size_t i = from; i < from + count; ++i) {
    text += (i > from ? "," : "") + s.field(i);
  }
  return text;
}

// --- sentences ---

void ends(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    expect(trial, s, s.carriage_return, "CR and LF at the end", "LF alone");
  }
}

void length(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    expect(trial, s, s.text.size() + 2 <= 82, "82 characters at most, with CR and LF",
           std::to_string(s.text.size() + 2));
  }
}

void has_check(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    expect(trial, s, is_hex(s.check, 2), "two upper-case hexadecimal digits behind an asterisk",
           s.check.empty() ? "none" : s.check);
  }
}

void right_check(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    std::array<char, 3> right{};
    std::snprintf(right.data(), right.size(), "%02X", s.right_check);
    std::string given = s.check;
    std::ranges::transform(given, given.begin(),
                           [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    expect(trial, s, given == right.data(), "the exclusive or of its characters", s.check);
  }
}

void characters(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    const bool printable =
        std::ranges::all_of(s.text, [](char c) { return c >= 0x20 && c <= 0x7E; });
    expect(trial, s, printable, "printable ASCII", "another character");
    // $ and ! begin a sentence, * ends its data.
    const bool reserved = s.text.find_first_of("$!", 1) != std::string::npos;
    expect(trial, s, !reserved, "no $ or ! within", "one");
  }
}

void talkers(Trial& trial, const Log& log, const Claims&) {
  static constexpr std::array<std::string_view, 8> kKnown{"GP", "GL", "GA", "GB",
                                                          "GQ", "GN", "GI", "BD"};
  for (const Sentence& s : log.sentences()) {
    expect(trial, s, proprietary(s) || std::ranges::find(kKnown, s.talker) != kKnown.end(),
           "a talker of satellites: GP, GL, GA, GB, GQ, GI, GN", s.talker);
  }
}

void field_counts(Trial& trial, const Log& log, const Claims&) {
  struct Count {
    std::string_view type;
    std::size_t least;
    std::size_t most;
  };
  // From NMEA 2.1 to 4.1: mode, status and signal came behind.
  static constexpr std::array<Count, 11> kCounts{{{"RMC", 11, 13},
                                                  {"GGA", 14, 14},
                                                  {"GLL", 6, 7},
                                                  {"GNS", 12, 13},
                                                  {"GSA", 17, 18},
                                                  {"VTG", 8, 9},
                                                  {"ZDA", 6, 6},
                                                  {"GST", 8, 8},
                                                  {"GBS", 8, 10},
                                                  {"GRS", 14, 16},
                                                  {"DTM", 8, 8}}};
  for (const Sentence& s : log.sentences()) {
    const auto* const known = std::ranges::find(kCounts, s.type, &Count::type);
    if (known != kCounts.end() && !proprietary(s)) {
      expect(trial, s, s.fields.size() >= known->least && s.fields.size() <= known->most,
             "of " + s.type + " " + std::to_string(known->least) + " to " +
                 std::to_string(known->most) + " fields",
             std::to_string(s.fields.size()));
    }
    if (s.type == "GSV") {
      const std::size_t rest = s.fields.size() < 3 ? 3 : (s.fields.size() - 3) % 4;
      expect(trial, s, rest <= 1 && s.fields.size() <= 20,
             "of GSV three fields, four for each of at most four satellites, a signal",
             std::to_string(s.fields.size()));
    }
  }
}

// --- fields ---

void times(Trial& trial, const Log& log, const Claims&) {
  for (const Sentence& s : log.sentences()) {
    const auto field = time_field(s.type);
    if (field && !s.field(*field).empty()) {
      expect(trial, s, is_time(s.field(*field)), "hhmmss.ss", s.field(*field));
    }
  }
}

void places(Trial& trial, const Log& log, const Claims&) {
  struct Place {
    std::string_view type;
    std::size_t at;
  };
  for (const auto& [type, at] :
       std::array<Place, 4>{{{"RMC", 2}, {"GGA", 1}, {"GLL", 0}, {"GNS", 1}}}) {
    for (const Sentence& s : log.sentences()) {
      if (s.type == type && !proprietary(s)) {
        expect(trial, s, is_place(s, at), "ddmm.mmmm,N,dddmm.mmmm,E, or all empty",
               fields_text(s, at, 4));
      }
    }
  }
}

void dates(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "RMC", [&](const Sentence& s) {
    const std::string& date = s.field(8);
    const bool right =
        date.empty() || (date.size() == 6 && digits_at(date, 0, 6) &&
                         std::stoi(date.substr(0, 2)) >= 1 && std::stoi(date.substr(0, 2)) <= 31 &&
                         std::stoi(date.substr(2, 2)) >= 1 && std::stoi(date.substr(2, 2)) <= 12);
    expect(trial, s, right, "ddmmyy", date);
  });
}

void status(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "RMC", [&](const Sentence& s) {
    expect(trial, s, s.field(1) == "A" || s.field(1) == "V", "A or V", s.field(1));
  });
}

void quality(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "GGA", [&](const Sentence& s) {
    expect(trial, s, s.field(5).size() == 1 && digits_at(s.field(5), 0, 1) && s.field(5) < "9",
           "a quality of 0 to 8", s.field(5));
  });
}

void units(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "GGA", [&](const Sentence& s) {
    expect(trial, s, s.field(9) == "M" && s.field(11) == "M", "metres, M",
           s.field(9) + ", " + s.field(11));
  });
}

void course(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "VTG", [&](const Sentence& s) {
    const auto degrees = s.number(0);
    expect(trial, s, s.field(0).empty() || (degrees && *degrees >= 0.0 && *degrees < 360.0),
           "0 up to 360 degrees, or empty", s.field(0));
    expect(trial, s,
           s.field(1) == "T" && s.field(3) == "M" && s.field(5) == "N" && s.field(7) == "K",
           "T, M, N, K beside their numbers", fields_text(s, 0, 8));
  });
}

void speeds(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "VTG", [&](const Sentence& s) {
    const auto knots = s.number(4);
    const auto kmph = s.number(6);
    if (knots && kmph) {
      // Three digits behind the point of each, or two.
      expect(trial, s, std::abs(*knots * 1.852 - *kmph) <= 0.012 + 1e-3 * *kmph,
             "the same speed in knots and km/h", fields_text(s, 4, 3));
    }
  });
}

// --- epochs ---

void one_time(Trial& trial, const Log& log, const Claims&) {
  // An epoch is what has one time: what would have another begins the next, and comes twice.
  for (const NmeaEpoch& epoch : log.epochs()) {
    std::set<std::string> seen;
    for (const Sentence* s : epoch.sentences) {
      if (time_field(s->type) && s->type != "GRS") {
        expect(trial, *s, seen.insert(s->talker + s->type).second, "each sentence once in an epoch",
               s->talker + s->type + " twice at " + epoch.time);
      }
    }
  }
}

double seconds_of(const std::string& time) {
  return is_time(time) ? std::stoi(time.substr(0, 2)) * 3600.0 +
                             std::stoi(time.substr(2, 2)) * 60.0 + std::stod(time.substr(4))
                       : 0.0;
}

/// Between epochs, over midnight too.
std::vector<double> periods_s(const Log& log) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < log.epochs().size(); ++i) {
    const double step = seconds_of(log.epochs()[i].time) - seconds_of(log.epochs()[i - 1].time);
    periods.push_back(step < -43'200.0 ? step + 86'400.0 : step);
  }
  return periods;
}

void forward(Trial& trial, const Log& log, const Claims&) {
  const std::vector<double> periods = periods_s(log);
  for (std::size_t i = 0; i < periods.size(); ++i) {
    expect(trial, *log.epochs()[i + 1].sentences.front(), periods[i] > 0.0, "a later time",
           log.epochs()[i].time + " and then " + log.epochs()[i + 1].time);
  }
}

void rate(Trial& trial, const Log& log, const Claims& claims) {
  if (claims.rate_hz <= 0.0) {
    return trial.not_applicable("no rate is claimed");
  }
  const std::vector<double> periods = periods_s(log);
  if (periods.size() < 2) {
    return trial.not_applicable("fewer than three whole epochs");
  }
  for (std::size_t i = 0; i < periods.size(); ++i) {
    expect(trial, *log.epochs()[i + 1].sentences.front(),
           std::abs(periods[i] * claims.rate_hz - 1.0) < 0.02 + 0.011 * claims.rate_hz,
           number_text(claims.rate_hz) + " epochs per second",
           number_text(periods[i]) + " s before " + log.epochs()[i + 1].time);
  }
}

void pace(Trial& trial, const Log& log, const Claims&) {
  if (log.epochs().size() < 3) {
    return trial.not_applicable("fewer than three whole epochs");
  }
  // Times of navigation against the clock of this machine, from first to last.
  const std::vector<double> periods = periods_s(log);
  const double said = std::accumulate(periods.begin(), periods.end(), 0.0);
  const std::chrono::duration<double> passed =
      log.epochs().back().sentences.front()->at - log.epochs().front().sentences.front()->at;
  trial.observe(number_text(said) + " s were said in " + number_text(passed.count()) + " s");
}

void claimed(Trial& trial, const Log& log, const Claims& claims) {
  if (claims.sentences.empty()) {
    return trial.not_applicable("no sentences are claimed");
  }
  for (const NmeaEpoch& epoch : log.epochs()) {
    for (const std::string& type : claims.sentences) {
      expect(trial, *epoch.sentences.front(), epoch.find(type) != nullptr,
             "each claimed sentence in every epoch", "no " + type + " at " + epoch.time);
    }
  }
}

// --- what sentences say together ---

bool same_place(const Sentence& a, std::size_t i, const Sentence& b, std::size_t j) {
  return fields_text(a, i, 4) == fields_text(b, j, 4);
}

void same_places(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "GGA", [&](const Sentence& rmc, const Sentence& gga) {
    expect(trial, gga, same_place(rmc, 2, gga, 1), "the place of RMC in GGA",
           fields_text(rmc, 2, 4) + " and " + fields_text(gga, 1, 4));
  });
}

void same_places_gll(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "GLL", [&](const Sentence& rmc, const Sentence& gll) {
    expect(trial, gll, same_place(rmc, 2, gll, 0), "the place of RMC in GLL",
           fields_text(rmc, 2, 4) + " and " + fields_text(gll, 0, 4));
  });
}

void valid_with_quality(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "GGA", [&](const Sentence& rmc, const Sentence& gga) {
    // Dead reckoning (6) may be either.
    const bool fix = gga.field(5) != "0";
    expect(trial, gga, gga.field(5) == "6" || (rmc.field(1) == "A") == fix,
           "status A with a quality above 0, V with 0", rmc.field(1) + " with " + gga.field(5));
  });
}

void valid_in_gll(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "GLL", [&](const Sentence& rmc, const Sentence& gll) {
    expect(trial, gll, rmc.field(1) == gll.field(5), "the status of RMC in GLL",
           rmc.field(1) + " and " + gll.field(5));
  });
}

void speed_in_both(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "VTG", [&](const Sentence& rmc, const Sentence& vtg) {
    const auto a = rmc.number(6);
    const auto b = vtg.number(4);
    if (a && b) {
      expect(trial, vtg, std::abs(*a - *b) <= 0.011, "the speed of RMC in VTG",
             rmc.field(6) + " and " + vtg.field(4));
    }
  });
}

void course_in_both(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "VTG", [&](const Sentence& rmc, const Sentence& vtg) {
    const auto a = rmc.number(7);
    const auto b = vtg.number(0);
    expect(trial, vtg, a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= 0.011),
           "the course of RMC in VTG", rmc.field(7) + " and " + vtg.field(0));
  });
}

void precision_in_both(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "GGA", "GSA", [&](const Sentence& gga, const Sentence& gsa) {
    const auto a = gga.number(7);
    const auto b = gsa.number(15);
    if (a && b) {
      expect(trial, gsa, std::abs(*a - *b) <= 0.011, "the HDOP of GGA in GSA",
             gga.field(7) + " and " + gsa.field(15));
    }
  });
}

/// Returns the value of the last digit: "1.25" 0.01.
double step_of(const std::string& number) {
  const std::size_t point = number.find('.');
  return point == std::string::npos
             ? 1.0
             : std::pow(10.0, -static_cast<double>(number.size() - point - 1));
}

void precisions(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "GSA", [&](const Sentence& s) {
    const auto p = s.number(14);
    const auto h = s.number(15);
    const auto v = s.number(16);
    if (p && h && v && *p < 99.0) {
      const double sum = std::hypot(*h, *v);
      // All three are rounded: some receivers have one decimal, some two.
      const double step =
          std::max({step_of(s.field(14)), step_of(s.field(15)), step_of(s.field(16))});
      expect(trial, s, std::abs(*p - sum) <= 1.5 * step + 0.01 * sum,
             "PDOP squared as the sum of HDOP squared and VDOP squared", fields_text(s, 14, 3));
    }
  });
}

void fix_and_quality(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "GGA", "GSA", [&](const Sentence& gga, const Sentence& gsa) {
    const bool fix = gga.field(5) != "0";
    expect(trial, gsa, gga.field(5) == "6" || fix == (gsa.field(1) == "2" || gsa.field(1) == "3"),
           "a fix in two or three dimensions with a quality above 0",
           gsa.field(1) + " with quality " + gga.field(5));
  });
}

/// Satellites that GSA says are used, of all systems of an epoch.
std::size_t used_in(const NmeaEpoch& epoch) {
  std::size_t used = 0;
  for (const Sentence* s : epoch.sentences) {
    for (std::size_t i = 2; s->type == "GSA" && i < 14; ++i) {
      used += s->field(i).empty() ? 0 : 1;
    }
  }
  return used;
}

void used_satellites(Trial& trial, const Log& log, const Claims&) {
  bool any = false;
  for (const NmeaEpoch& epoch : log.epochs()) {
    const Sentence* const gga = epoch.find("GGA");
    if (gga == nullptr || epoch.find("GSA") == nullptr || !gga->number(6)) {
      continue;
    }
    any = true;
    const std::size_t used = used_in(epoch);
    // GSA has room for twelve of a system; GGA of NMEA 2.3 counts to twelve.
    const auto told = static_cast<std::size_t>(*gga->number(6));
    expect(trial, *gga, told == used || (told >= 12 && used >= 12),
           "as many satellites in GGA as GSA names",
           std::to_string(told) + " and " + std::to_string(used));
  }
  if (!any) {
    trial.not_applicable("no epoch has both GGA and GSA");
  }
}

/// A row of GSV as it came: its head, and whether it continues the one before.
void view_rows(Trial& trial, const Log& log, const Claims&) {
  const Sentence* before = nullptr;
  each_of(trial, log, "GSV", [&](const Sentence& s) {
    const auto total = s.number(0);
    const auto number = s.number(1);
    expect(trial, s, total && number && *number >= 1 && *number <= *total,
           "a number from 1 to the total", fields_text(s, 0, 2));
    if (before != nullptr && number && *number > 1) {
      const bool follows = before->talker == s.talker && before->field(0) == s.field(0) &&
                           before->field(2) == s.field(2) && before->number(1) == *number - 1;
      expect(trial, s, follows, "the sentence before of the same row before it",
             before->text + " before it");
    }
    before = &s;
  });
}

void view_counts(Trial& trial, const Log& log, const Claims&) {
  std::size_t listed = 0;
  bool whole = false;
  each_of(trial, log, "GSV", [&](const Sentence& s) {
    if (s.number(1) == 1.0) {
      listed = 0;
      whole = true;
    }
    for (std::size_t i = 3; i + 3 < s.fields.size(); i += 4) {
      listed += s.field(i).empty() ? 0 : 1;
    }
    if (whole && s.number(0) && s.number(1) == s.number(0) && s.number(2)) {
      expect(trial, s, listed == static_cast<std::size_t>(*s.number(2)),
             "as many satellites as the row counts", std::to_string(listed) + " of " + s.field(2));
    }
  });
}

void view_angles(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "GSV", [&](const Sentence& s) {
    for (std::size_t i = 3; i + 3 < s.fields.size(); i += 4) {
      const auto elevation = s.number(i + 1);
      const auto azimuth = s.number(i + 2);
      const auto strength = s.number(i + 3);
      expect(trial, s,
             (!elevation || (*elevation >= -90 && *elevation <= 90)) &&
                 (!azimuth || (*azimuth >= 0 && *azimuth < 360)) &&
                 (!strength || (*strength >= 0 && *strength <= 99)),
             "elevations to 90, azimuths below 360 degrees, strengths to 99 dBHz",
             fields_text(s, i, 4));
    }
  });
}

void used_are_in_view(Trial& trial, const Log& log, const Claims&) {
  bool any = false;
  for (const NmeaEpoch& epoch : log.epochs()) {
    std::set<std::string> seen;
    for (const Sentence* s : epoch.sentences) {
      for (std::size_t i = 3; s->type == "GSV" && i + 3 < s->fields.size(); i += 4) {
        seen.insert(s->field(i));
      }
    }
    for (const Sentence* s : epoch.sentences) {
      for (std::size_t i = 2; s->type == "GSA" && i < 14 && !seen.empty(); ++i) {
        any = true;
        expect(trial, *s, s->field(i).empty() || seen.contains(s->field(i)),
               "what is used among what is in view", "satellite " + s->field(i));
      }
    }
  }
  if (!any) {
    trial.not_applicable("no epoch has both GSA and GSV");
  }
}

void age_with_corrections(Trial& trial, const Log& log, const Claims&) {
  each_of(trial, log, "GGA", [&](const Sentence& s) {
    const bool corrected = s.field(5) == "2" || s.field(5) == "4" || s.field(5) == "5";
    expect(trial, s, corrected || s.field(12).empty(), "no age without corrections",
           "age " + s.field(12) + " with quality " + s.field(5));
  });
}

void modes(Trial& trial, const Log& log, const Claims&) {
  each_pair(trial, log, "RMC", "GGA", [&](const Sentence& rmc, const Sentence& gga) {
    if (rmc.fields.size() < 12) {
      return;  // Before NMEA 2.3.
    }
    static const std::map<std::string, std::string> kModes{{"0", "N"}, {"1", "A"}, {"2", "D"},
                                                           {"4", "R"}, {"5", "F"}, {"6", "E"}};
    const auto known = kModes.find(gga.field(5));
    const std::string mode = rmc.field(11);
    // Until NMEA 4.0 a fix by carrier phase is D.
    expect(trial, rmc,
           known == kModes.end() || mode == known->second ||
               (mode == "D" && (gga.field(5) == "4" || gga.field(5) == "5")),
           "the mode that belongs to the quality", mode + " with " + gga.field(5));
  });
}

void minutes_digits(Trial& trial, const Log& log, const Claims&) {
  const auto found = std::ranges::find_if(
      log.sentences(), [](const Sentence& s) { return s.type == "GGA" && !s.field(1).empty(); });
  if (found == log.sentences().end()) {
    return trial.not_applicable("no GGA with a place");
  }
  const std::size_t digits = found->field(1).size() - 5;
  trial.observe(std::to_string(digits) + " digits of a minute: steps of " +
                number_text(1852.0 * std::pow(10.0, -static_cast<double>(digits))) + " m");
}

void kinds(Trial& trial, const Log& log, const Claims&) {
  std::map<std::string, int> counts;
  for (const Sentence& s : log.sentences()) {
    ++counts[s.talker + s.type];
  }
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  }
  trial.observe(text);
}

struct Row {
  const char* chapter;
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(Trial&, const Log&, const Claims&);
};

constexpr std::array kRows{
    Row{"sentence", "31.1.1", "A sentence ends with CR and LF", kMust, ends},
    Row{"sentence", "31.1.1", "A sentence has a check", kMust, has_check},
    Row{"sentence", "31.1.1", "The check is right", kMust, right_check},
    Row{"sentence", "31.1.1", "A sentence has printable characters, and one begin", kMust,
        characters},
    Row{"sentence", "31.1.1", "A sentence has at most 82 characters", kShould, length},
    Row{"sentence", "31.1.2", "The talker is one of satellite navigation", kMust, talkers},
    Row{"sentence", "31.2", "A sentence has the fields of its type", kMust, field_counts},
    Row{"sentence", "31.2", "Kinds of sentences that come", kObserved, kinds},
    Row{"field", "31.2, RMC", "Times of day are hhmmss.ss", kMust, times},
    Row{"field", "31.1.5", "Places are degrees and minutes with their letters", kMust, places},
    Row{"field", "31.1.5", "How fine places are", kObserved, minutes_digits},
    Row{"field", "31.2, RMC", "Dates are ddmmyy", kMust, dates},
    Row{"field", "31.2, RMC", "The status is A or V", kMust, status},
    Row{"field", "31.2, GGA", "The quality is one that there is", kMust, quality},
    Row{"field", "31.2, GGA", "Heights are in metres", kMust, units},
    Row{"field", "31.2, VTG", "Courses are below 360 degrees, and units stand beside", kMust,
        course},
    Row{"field", "31.2, VTG", "Knots and km/h are the same speed", kMust, speeds},
    Row{"field", "31.2, GSV", "Elevations, azimuths and strengths are such", kMust, view_angles},
    Row{"epoch", "31.2", "Sentences of an epoch have its time", kMust, one_time},
    Row{"epoch", "31.2", "Time goes forward", kMust, forward},
    Row{"epoch", "31.2", "Epochs come at the rate that is claimed", kMust, rate},
    Row{"epoch", "31.2", "Each claimed sentence comes in every epoch", kMust, claimed},
    Row{"epoch", "31.2", "How time goes against this machine's clock", kObserved, pace},
    Row{"together", "31.2", "GGA has the place of RMC", kMust, same_places},
    Row{"together", "31.2", "GLL has the place of RMC", kMust, same_places_gll},
    Row{"together", "31.1.6", "RMC is valid when GGA has a fix", kMust, valid_with_quality},
    Row{"together", "31.1.6", "GLL is valid when RMC is", kMust, valid_in_gll},
    Row{"together", "31.1.6", "The mode of RMC belongs to the quality of GGA", kMust, modes},
    Row{"together", "31.1.6", "GSA has a fix when GGA has one", kMust, fix_and_quality},
    Row{"together", "31.2", "VTG has the speed of RMC", kMust, speed_in_both},
    Row{"together", "31.2", "VTG has the course of RMC", kMust, course_in_both},
    Row{"together", "31.2", "GSA has the HDOP of GGA", kMust, precision_in_both},
    Row{"together", "31.2, GSA", "PDOP, HDOP and VDOP belong together", kMust, precisions},
    Row{"together", "31.2, GSA", "GGA counts the satellites of GSA", kShould, used_satellites},
    Row{"together", "31.2, GSV", "GSV are numbered through a row", kMust, view_rows},
    Row{"together", "31.2, GSV", "A row of GSV has the satellites that it counts", kMust,
        view_counts},
    Row{"together", "31.2, GSV", "Satellites of GSA are among those of GSV", kShould,
        used_are_in_view},
    Row{"together", "31.2, GGA", "Corrections have an age only where there are such", kMust,
        age_with_corrections},
};

}  // namespace

std::vector<NmeaCase> nmea_cases() {
  std::vector<NmeaCase> all;
  Citations citations("nmea", "");
  for (const Row& row : kRows) {
    all.push_back({citations.next_in(row.chapter, row.title,
                                     std::string("UBX-13003221 R28, ") + row.section, row.strength),
                   row.run});
  }
  return all;
}

NmeaLog listen_nmea(const Endpoint& endpoint, std::chrono::nanoseconds span) {
  const auto line = open_bytes(endpoint);
  return listen_nmea(*line, span);
}

NmeaLog listen_nmea(ByteLine& line, std::chrono::nanoseconds span) {
  // Four times what a line of 921600 baud carries.
  constexpr std::size_t kPerSecond = 368'640;
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(span);
  const std::size_t most = kPerSecond * (1U + static_cast<std::size_t>(seconds.count()));
  NmeaLog log;
  const auto begin = line.now();
  std::size_t came = 0;
  std::vector<std::uint8_t> bytes;
  while (line.now() < begin + span && !line.closed() && came <= most) {
    bytes.clear();
    if (line.receive(bytes, begin + span)) {
      came += bytes.size();
      log.add(line.now() - begin, bytes);
    }
  }
  if (came > most) {
    log.overflow(std::to_string(most) + " bytes in " + std::to_string(seconds.count()) + " s");
  }
  log.close();
  return log;
}

SuiteResult run_nmea_suite(const NmeaLog& log, const NmeaClaims& claims,
                           const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "nmea";
  for (const NmeaCase& each : nmea_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    Trial trial(each.identity);
    if (!log.overflow().empty()) {
      trial.demand(false, "at most " + log.overflow(), "more");
    } else if (log.sentences().empty()) {
      trial.broken("no sentence came");
    } else {
      each.run(trial, log, claims);
    }
    result.cases.push_back(trial.result());
  }
  return result;
}

NmeaClaims survey_nmea(const NmeaLog& log) {
  if (!log.overflow().empty()) {
    throw Unreachable("the device sends without end: more than " + log.overflow());
  }
  NmeaClaims claims;
  std::vector<double> periods = periods_s(log);
  if (!periods.empty()) {
    std::ranges::nth_element(periods,
                             periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2));
    const double period = periods[periods.size() / 2];
    claims.rate_hz = period > 0.0 ? std::round(1000.0 / period) / 1000.0 : 0.0;
  }
  std::set<std::string> types;
  for (const NmeaEpoch& epoch : log.epochs()) {
    for (const Sentence* s : epoch.sentences) {
      if (!proprietary(*s)) {
        types.insert(s->type);
      }
    }
  }
  for (const std::string& type : types) {
    if (std::ranges::all_of(log.epochs(),
                            [&](const NmeaEpoch& epoch) { return epoch.find(type) != nullptr; })) {
      claims.sentences.push_back(type);
    }
  }
  return claims;
}

}  // namespace rigwire::conform
