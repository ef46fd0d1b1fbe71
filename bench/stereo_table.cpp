#include "bench/stereo_table.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace rigwire::bench {
namespace {

std::string shown_ms(double seconds) {
  return std::isnan(seconds) ? "" : fmt::format("{:.0f}", 1e3 * seconds);
}

}  // namespace

StereoTable::StereoTable(std::ostream& text)
    : text_(text),
      table_(text, {{"scene", "<9"},
                    {"matcher", "<12"},
                    {"depth m", "<8"},
                    {"match ms", ">9"},
                    {"confidence", ">11"},
                    {"shot ms", ">8"},
                    {"density", ">8"},
                    {"bad1", ">7"},
                    {"median px", ">10"},
                    {"median m", ">9"},
                    {"sure", ">7"},
                    {"bad1", ">7"},
                    {"median px", ">10"},
                    {"told apart", ">11"}}) {
  table_.head();
}

void StereoTable::add(const StereoCost& cost, nlohmann::json& rows) const {
  const auto row = [&](const DepthBand& band, const std::string& depths, bool first) {
    rows.push_back(
        table_.row({word("scene", cost.scene),
                    word("matcher", cost.matcher),
                    shown(depths),
                    shown(first ? shown_ms(cost.disparity_s) : ""),
                    shown(first ? shown_ms(cost.confidence_s) : ""),
                    shown(first ? shown_ms(cost.take_s) : ""),
                    number("density", band.density, "{:.1f}%", 100.0),
                    number("bad1", band.bad1, "{:.1f}%", 100.0),
                    number("median_px", band.median_px, "{:.2f}"),
                    number("median_m", band.median_m, "{:.3f}"),
                    shown(first ? fmt::format("{:.1f}%", 100.0 * cost.sure.density) : ""),
                    shown(first ? fmt::format("{:.1f}%", 100.0 * cost.sure.bad1) : ""),
                    shown(first ? fmt::format("{:.2f}", cost.sure.median_px) : ""),
                    shown(first ? fmt::format("{:.3f}", cost.sure.told_apart) : ""),
                    stored("sure_density", cost.sure.density),
                    stored("sure_bad1", cost.sure.bad1),
                    stored("sure_median_px", cost.sure.median_px),
                    stored("told_apart", cost.sure.told_apart),
                    stored("from_m", band.from_m),
                    stored("to_m", band.to_m),
                    stored("match_s", cost.disparity_s),
                    stored("confidence_s", cost.confidence_s),
                    stored("shot_s", number_or_null(cost.take_s))}));
  };
  row(cost.all, "all", true);
  for (const DepthBand& band : cost.bands) {
    row(band, fmt::format("{:g}..{:g}", band.from_m, band.to_m), false);
  }
}

void StereoTable::end() const {
  text_ << "640 x 480, 128 disparities, baseline 0.16 m, one thread, CPU time; by matcher and\n"
           "paths; bad1: share of the disparities that are off by more than a pixel; depths\n"
           "nearer than the search left out; sure: with a confidence of 128 or more; told apart:\n"
           "how often a right disparity has more confidence than a wrong one\n\n";
}

}  // namespace rigwire::bench
