#include "protocols/rinex/yuma.h"

#include <array>
#include <string>

#include "protocols/rinex/text.h"

namespace rigwire::protocols::rinex {
namespace {

struct Quantity {
  std::string_view name;  // Begin of the line.
  double least;
  double beyond;  // Exclusive upper limit.
  void (*set)(gps::Almanac&, double);
};

constexpr double kAnyAngle_rad = 100.0;
constexpr std::int32_t kRollover = 1024;

constexpr std::array<Quantity, 13> kQuantities{{
    {"ID", 1, 33, [](gps::Almanac& a, double v) { a.prn = static_cast<std::uint8_t>(v); }},
    {"Health", 0, 256, [](gps::Almanac& a, double v) { a.health = static_cast<std::uint8_t>(v); }},
    {"Eccentricity", 0, 1, [](gps::Almanac& a, double v) { a.eccentricity = v; }},
    {"Time of Applicability", 0, 604'800, [](gps::Almanac& a, double v) { a.almanac_time_s = v; }},
    {"Orbital Inclination", -kAnyAngle_rad, kAnyAngle_rad,
     [](gps::Almanac& a, double v) { a.inclination_rad = v; }},
    {"Rate of Right Ascen", -1, 1, [](gps::Almanac& a, double v) { a.ascending_node_rate = v; }},
    {"SQRT(A)", 1, 10'000, [](gps::Almanac& a, double v) { a.sqrt_semi_major_axis = v; }},
    {"Right Ascen at Week", -kAnyAngle_rad, kAnyAngle_rad,
     [](gps::Almanac& a, double v) { a.ascending_node_rad = v; }},
    {"Argument of Perigee", -kAnyAngle_rad, kAnyAngle_rad,
     [](gps::Almanac& a, double v) { a.argument_of_perigee_rad = v; }},
    {"Mean Anom", -kAnyAngle_rad, kAnyAngle_rad,
     [](gps::Almanac& a, double v) { a.mean_anomaly_rad = v; }},
    {"Af0", -1, 1, [](gps::Almanac& a, double v) { a.clock_bias_s = v; }},
    {"Af1", -1, 1, [](gps::Almanac& a, double v) { a.clock_drift = v; }},
    {"week", 0, 100'000, [](gps::Almanac& a, double v) { a.week = static_cast<std::int32_t>(v); }},
}};

class YumaReader {
 public:
  YumaReader(std::string_view text, std::string_view name, std::int32_t week_hint)
      : lines_(text, name), week_hint_(week_hint) {}

  YumaAlmanac read() {
    std::string_view line;
    while (lines_.next(line)) {
      if (line.starts_with("****")) {
        finish();
        open_ = true;
      } else if (!trimmed(line).empty()) {
        quantity(line);
      }
    }
    finish();
    if (result_.almanacs.empty()) {
      lines_.fail("no almanac found, expected lines from \"******** Week ...\" on");
    }
    return result_;
  }

 private:
  void quantity(std::string_view line) {
    const std::size_t colon = line.find(':');
    const std::string_view name = trimmed(line.substr(0, colon));
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
      const Quantity& quantity = kQuantities[i];
      if (colon == std::string_view::npos || !name.starts_with(quantity.name)) {
        continue;
      }
      if (!open_) {
        lines_.fail("\"" + std::string(quantity.name) + "\" is before the first \"****\" line");
      }
      if (seen_[i]) {
        lines_.fail("\"" + std::string(quantity.name) + "\" is twice in one block");
      }
      const double value = lines_.number(line.substr(colon + 1), quantity.name);
      if (!(value >= quantity.least && value < quantity.beyond)) {
        lines_.fail(std::string(quantity.name) + " is " + std::to_string(value) + ", allowed is " +
                    std::to_string(quantity.least) + " to less than " +
                    std::to_string(quantity.beyond));
      }
      quantity.set(almanac_, value);
      seen_[i] = true;
      return;
    }
    ++result_.skipped_lines;
  }

  void finish() {
    if (!open_) {
      return;
    }
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
      if (!seen_[i]) {
        lines_.fail("the block before has no \"" + std::string(kQuantities[i].name) + "\"");
      }
    }
    if (almanac_.week < kRollover) {
      almanac_.week = gps::unrolled_week(almanac_.week, kRollover, week_hint_);
    }
    result_.almanacs.push_back(almanac_);
    almanac_ = {};
    seen_ = {};
    open_ = false;
  }

  LineReader lines_;
  std::int32_t week_hint_;
  YumaAlmanac result_;
  gps::Almanac almanac_;
  std::array<bool, kQuantities.size()> seen_{};
  bool open_ = false;
};

}  // namespace

YumaAlmanac read_yuma(std::string_view text, std::string_view name, std::int32_t week_hint) {
  return YumaReader(text, name, week_hint).read();
}

}  // namespace rigwire::protocols::rinex
