// Navigation files and almanacs from arbitrary text: what is read lies within the ranges that the
// readers promise, and what the message can carry is written and read back to the same bits.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "protocols/rinex/navigation.h"
#include "protocols/rinex/yuma.h"

namespace {

using namespace rigwire::protocols;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void navigation(std::string_view text) {
  rinex::NavigationFile file;
  try {
    file = rinex::read_navigation(text, "fuzz");
  } catch (const std::invalid_argument&) {
    return;
  }
  rinex::NavigationFile exact;
  for (const rinex::NavigationRecord& record : file.records) {
    const gps::Ephemeris& e = record.ephemeris;
    require(e.prn >= 1 && e.prn <= 32 && e.issue_of_clock <= 1023 && e.health <= 63);
    require(e.ephemeris_time_s >= 0.0 && e.ephemeris_time_s < gps::kWeekSeconds);
    require(e.clock_time_s >= 0.0 && e.clock_time_s < gps::kWeekSeconds);
    const gps::Ephemeris quantised = gps::quantised(e);
    if (quantised.ephemeris_time_s < gps::kWeekSeconds &&
        quantised.clock_time_s < gps::kWeekSeconds && quantised.sqrt_semi_major_axis > 0.0 &&
        quantised.week >= 0 && quantised.week < 99'999) {
      exact.records.push_back({quantised, 0.0});
    }
  }
  const std::string written = rinex::write_navigation(exact, {});
  const rinex::NavigationFile again = rinex::read_navigation(written, "again");
  require(again.records.size() == exact.records.size());
  for (std::size_t i = 0; i < exact.records.size(); ++i) {
    require(gps::quantised(again.records[i].ephemeris) == exact.records[i].ephemeris);
  }
}

void almanac(std::string_view text) {
  try {
    for (const gps::Almanac& a : rinex::read_yuma(text, "fuzz", 2300).almanacs) {
      require(a.prn >= 1 && a.prn <= 32 && a.eccentricity >= 0.0 && a.eccentricity < 1.0);
      require(gps::quantised(a) == gps::quantised(gps::quantised(a)));
    }
  } catch (const std::invalid_argument&) {
    return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  navigation(text);
  almanac(text);
  return 0;
}
