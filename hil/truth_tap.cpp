#include "hil/truth_tap.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <stdexcept>

namespace rigwire::hil {
namespace {

std::string list(const std::array<double, 4>& values) {
  return fmt::format("[{:.9g},{:.9g},{:.9g},{:.9g}]", values[0], values[1], values[2], values[3]);
}

}  // namespace

TruthTap::TruthTap(const std::filesystem::path& path, const Calendar& calendar)
    : file_(std::fopen(path.c_str(), "we")), calendar_(calendar) {
  if (file_ == nullptr) {
    throw std::runtime_error(
        fmt::format("cannot write the truth tap {}: {}", path.string(), std::strerror(errno)));
  }
}

TruthTap::~TruthTap() {
  std::fclose(file_);
}

void TruthTap::record(const TruthRecord& record) {
  std::string line = fmt::format(
      R"({{"sim_s":{:.9f},"utc":"{}","time_of_hour_us":{:.3f},"joint_rad":{},"joint_rate_radps":{},)"
      R"("spool":{},"bucket_tip_m":[{:.6f},{:.6f},{:.6f}])",
      to_seconds(record.time), format_utc(calendar_.utc(record.time)),
      static_cast<double>(calendar_.nanoseconds_of_hour(record.time)) * 1e-3,
      list(record.joint_rad), list(record.joint_rate_radps), list(record.spool),
      record.bucket_tip_W_m.x, record.bucket_tip_W_m.y, record.bucket_tip_W_m.z);
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
