#include "hil/truth_tap.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>

namespace rigwire::hil {
namespace {

/// JSON has no number for what is not finite.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.12g}", value) : "null";
}

std::string list(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : ",") + number(value);
  }
  return values.size() == 1 ? text : "[" + text + "]";
}

}  // namespace

TruthTap::TruthTap(const std::filesystem::path& path, const Calendar& calendar,
                   std::span<const sim::TruthField> fields)
    : file_(std::fopen(path.c_str(), "we")),
      calendar_(calendar),
      fields_(fields.begin(), fields.end()) {
  if (file_ == nullptr) {
    throw std::runtime_error(
        fmt::format("cannot write the truth tap {}: {}", path.string(), std::strerror(errno)));
  }
}

TruthTap::~TruthTap() {
  std::fclose(file_);
}

void TruthTap::record(const TruthRecord& record) {
  std::string line =
      fmt::format(R"({{"sim_s":{:.9f},"utc":"{}","time_of_hour_us":{:.3f})",
                  to_seconds(record.time), format_utc(calendar_.utc(record.time)),
                  static_cast<double>(calendar_.nanoseconds_of_hour(record.time)) * 1e-3);
  std::span<const double> rest(record.machine);
  for (const sim::TruthField& field : fields_) {
    fmt::format_to(std::back_inserter(line), R"(,"{}":{})", field.key,
                   list(rest.first(field.count)));
    rest = rest.subspan(field.count);
  }
  if (!std::isnan(record.antenna_latitude_deg)) {
    fmt::format_to(
        std::back_inserter(line),
        R"(,"antenna":{{"latitude_deg":{:.10f},"longitude_deg":{:.10f},"height_m":{:.4f}}})",
        record.antenna_latitude_deg, record.antenna_longitude_deg, record.antenna_height_m);
  }
  line += "}\n";
  std::fwrite(line.data(), 1, line.size(), file_);
}

}  // namespace rigwire::hil
