#include "hil/record/truth_tap.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "hil/record/number_paths.h"
#include "hil/world/quantities.h"

namespace rigwire::hil {
namespace {

/// JSON has no number for infinities and NaN.
std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.12g}", value) : "null";
}

std::string place(const sim::GeodeticPoint& point) {
  return fmt::format(R"({{"latitude_deg":{:.10f},"longitude_deg":{:.10f},"height_m":{:.4f}}})",
                     point.latitude_deg, point.longitude_deg, point.ellipsoid_height_m);
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
                   std::span<const sim::TruthField> fields, OutputFailures* failures,
                   std::chrono::milliseconds patience)
    : file_("the truth", path.string(), failures, patience),
      calendar_(calendar),
      fields_(fields.begin(), fields.end()) {}

std::string truth_line(const TruthRecord& record, const Calendar& calendar,
                       std::span<const sim::TruthField> fields) {
  std::string line =
      fmt::format(R"({{"sim_s":{:.9f},"utc":"{}","time_of_hour_us":{:.3f})",
                  to_seconds(record.time), format_utc(calendar.utc(record.time)),
                  static_cast<double>(calendar.nanoseconds_of_hour(record.time)) * 1e-3);
  const sim::LinkMotion& carrier = record.links.front();
  const Eigen::Quaterniond attitude(carrier.X_WL.linear());
  const std::array<double, 4> wxyz{attitude.w(), attitude.x(), attitude.y(), attitude.z()};
  const auto put = [&line](std::string_view key, std::span<const double> values) {
    fmt::format_to(std::back_inserter(line), R"(,"{}":{})", key, list(values));
  };
  const auto vector = [](const Eigen::Vector3d& v) { return std::array{v.x(), v.y(), v.z()}; };
  put("position_m", vector(carrier.X_WL.translation()));
  put("attitude_wxyz", wxyz);
  put("velocity_mps", vector(carrier.v_WL_W));
  put("rate_radps", vector(carrier.w_WL_W));
  std::span<const double> rest(record.machine);
  for (const sim::TruthField& field : fields) {
    put(field.key, rest.first(field.count));
    rest = rest.subspan(field.count);
  }
  if (!record.state.empty()) {
    line += R"(,"state":{)";
    for (std::size_t i = 0; i < record.state.size(); ++i) {
      fmt::format_to(std::back_inserter(line), R"({}{}:{})", i == 0 ? "" : ",",
                     nlohmann::json(std::string(record.state[i].name)).dump(),
                     number(record.state[i].value));
    }
    line += '}';
  }
  if (record.contact) {
    const ContactTruth& contact = *record.contact;
    fmt::format_to(std::back_inserter(line), R"(,"contact":{{"touching":{},"body":{},"with":{})",
                   contact.touching, nlohmann::json(std::string(contact.body)).dump(),
                   nlohmann::json(std::string(contact.with)).dump());
    put("place_m", vector(contact.place_W));
    put("force_n", vector(contact.force_W));
    put("deepest_m", std::array{contact.deepest_m});
    put("dent_m", std::array{contact.dent_m});
    put("pressed_m", std::array{contact.pressed_m});
    put("sunk_m", std::array{contact.sunk_m});
    put("lost_j", std::array{contact.lost_j});
    fmt::format_to(std::back_inserter(line), R"(,"felled":{}}})", contact.felled);
  }
  if (!record.moved.empty()) {
    line += R"(,"moved":{)";
    for (std::size_t i = 0; i < record.moved.size(); ++i) {
      const MovedBodyTruth& body = record.moved[i];
      const Eigen::Quaterniond turned(body.motion.X_WL.linear());
      fmt::format_to(std::back_inserter(line), R"({}{}:{{"position_m":{},"attitude_wxyz":{}}})",
                     i == 0 ? "" : ",", nlohmann::json(std::string(body.name)).dump(),
                     list(vector(body.motion.X_WL.translation())),
                     list(std::array{turned.w(), turned.x(), turned.y(), turned.z()}));
    }
    line += '}';
  }
  if (!record.hand.empty()) {
    line += R"(,"hand":[)";
    for (const std::string_view& name : record.hand) {
      line += fmt::format(R"({}"{}")", &name == record.hand.data() ? "" : ",", name);
    }
    line += ']';
  }
  if (!record.antennas.empty()) {
    line += R"(,"antenna":)" + place(record.antennas.front().place) + R"(,"antennas":{)";
    for (std::size_t i = 0; i < record.antennas.size(); ++i) {
      const AntennaTruth& antenna = record.antennas[i];
      fmt::format_to(std::back_inserter(line), R"({}"{}":{})", i == 0 ? "" : ",", antenna.device,
                     place(antenna.place));
    }
    line += '}';
  }
  line += '}';
  return line;
}

std::vector<std::string> truth_numbers(const sim::Machine& machine,
                                       std::span<const std::string> antennas) {
  // A record with zeros in all places, laid out as those of a run are.
  const std::vector<StateQuantity> quantities = state_quantities(machine);
  const std::span<const sim::TruthField> fields = machine.truth_fields();
  TruthRecord record;
  record.links.assign(machine.links().begin(), machine.links().end());
  for (const sim::TruthField& field : fields) {
    record.machine.resize(record.machine.size() + field.count);
  }
  for (const StateQuantity& quantity : quantities) {
    record.state.push_back({quantity.name, 0.0});
  }
  if (machine.contact_report() != nullptr) {
    record.contact.emplace();
  }
  for (const std::string& antenna : antennas) {
    record.antennas.push_back({antenna, {}});
  }
  return number_paths(nlohmann::ordered_json::parse(
      truth_line(record, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), fields)));
}

void TruthTap::record(const TruthRecord& record) {
  file_.write(truth_line(record, calendar_, fields_) + '\n');
}

}  // namespace rigwire::hil
