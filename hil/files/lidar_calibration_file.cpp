#include "hil/files/lidar_calibration_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "hil/configuration/outside_file.h"

namespace rigwire::hil {
namespace {

using protocols::velodyne::Hdl64eCalibration;
using protocols::velodyne::Hdl64eLaser;
using protocols::velodyne::kHdl64eLasers;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr double kDistanceResolution_m = 0.002;

/// A member that is a length in metres or has no unit.
struct Member {
  std::string_view key;
  double Hdl64eLaser::*value;
  double factor = 1.0;
};
constexpr std::array<Member, 9> kMembers{
    {{"rot_correction", &Hdl64eLaser::rot_correction_deg, kDegreesPerRadian},
     {"vert_correction", &Hdl64eLaser::vert_correction_deg, kDegreesPerRadian},
     {"dist_correction", &Hdl64eLaser::dist_correction_m},
     {"dist_correction_x", &Hdl64eLaser::dist_correction_x_m},
     {"dist_correction_y", &Hdl64eLaser::dist_correction_y_m},
     {"vert_offset_correction", &Hdl64eLaser::vert_offset_m},
     {"horiz_offset_correction", &Hdl64eLaser::horiz_offset_m},
     {"focal_distance", &Hdl64eLaser::focal_distance_m},
     {"focal_slope", &Hdl64eLaser::focal_slope}}};

struct CalibrationReader {
  const std::string& path;

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) const {
    throw std::runtime_error(
        fmt::format("{}:{}:{}: {}", path, mark.line + 1, mark.column + 1, what));
  }

  [[nodiscard]] double number(const YAML::Node& node, const std::string& key) const {
    double value = 0.0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
      refuse(node.Mark(), fmt::format("{}: found '{}', allowed: a finite number", key,
                                      node.IsScalar() ? node.Scalar() : "no number"));
    }
    return value;
  }

  [[nodiscard]] int whole(const YAML::Node& node, const std::string& key, int upper) const {
    const double value = number(node, key);
    if (value < 0 || value > upper || value != std::floor(value)) {
      refuse(node.Mark(), fmt::format("{}: found {}, allowed: 0 .. {}", key, value, upper));
    }
    return static_cast<int>(value);
  }

  /// Its number and its values.
  [[nodiscard]] std::pair<int, Hdl64eLaser> laser(const YAML::Node& node, std::size_t place) const {
    const std::string prefix = fmt::format("lasers.{}", place);
    if (!node.IsMap()) {
      refuse(node.Mark(), prefix + ": not a map of values");
    }
    for (const char* required : {"laser_id", "rot_correction", "vert_correction"}) {
      if (!node[required]) {
        refuse(node.Mark(), fmt::format("{}: {} is missing", prefix, required));
      }
    }
    int id = 0;
    Hdl64eLaser laser;
    for (const auto& entry : node) {
      const std::string name = entry.first.Scalar();
      const std::string key = prefix + "." + name;
      const auto member = std::ranges::find(kMembers, name, &Member::key);
      if (member != kMembers.end()) {
        laser.*member->value = number(entry.second, key) * member->factor;
      } else if (name == "laser_id") {
        id = whole(entry.second, key, static_cast<int>(kHdl64eLasers) - 1);
      } else if (name == "min_intensity") {
        laser.min_intensity = static_cast<std::uint8_t>(whole(entry.second, key, 255));
      } else if (name == "max_intensity") {
        laser.max_intensity = static_cast<std::uint8_t>(whole(entry.second, key, 255));
      } else if (name != "two_pt_correction_available") {
        refuse(entry.first.Mark(), key + ": unknown key");
      }
    }
    return {id, laser};
  }

  [[nodiscard]] Hdl64eCalibration calibration(const YAML::Node& root) const {
    if (!root.IsMap() || !root["lasers"] || !root["lasers"].IsSequence()) {
      refuse(root.Mark(), "no list 'lasers'; is this a calibration in the form of ROS drivers?");
    }
    for (const auto& entry : root) {
      const std::string key = entry.first.Scalar();
      if (key == "distance_resolution") {
        if (std::abs(number(entry.second, key) - kDistanceResolution_m) > 1e-9) {
          refuse(entry.second.Mark(), fmt::format("{}: found {}, allowed: {}", key,
                                                  entry.second.Scalar(), kDistanceResolution_m));
        }
      } else if (key == "num_lasers") {
        if (number(entry.second, key) != static_cast<double>(root["lasers"].size())) {
          refuse(entry.second.Mark(), fmt::format("{}: found {}, but the list has {} lasers", key,
                                                  entry.second.Scalar(), root["lasers"].size()));
        }
      } else if (key != "lasers") {
        refuse(entry.first.Mark(), key + ": unknown key");
      }
    }
    const YAML::Node list = root["lasers"];
    if (list.size() != kHdl64eLasers) {
      refuse(list.Mark(), fmt::format("lasers: found {}, allowed: {}", list.size(), kHdl64eLasers));
    }
    std::array<std::optional<Hdl64eLaser>, kHdl64eLasers> lasers;
    for (std::size_t place = 0; place < list.size(); ++place) {
      const auto [id, values] = laser(list[place], place);
      auto& slot = lasers[static_cast<std::size_t>(id)];
      if (slot) {
        refuse(list[place].Mark(), fmt::format("lasers.{}: laser {} is there twice", place, id));
      }
      slot = values;
    }
    Hdl64eCalibration result;
    for (const auto& one : lasers) {
      result.lasers.push_back(one.value());  // 64 different numbers: each is there
    }
    return result;
  }
};

}  // namespace

Hdl64eCalibration load_lidar_calibration(const std::string& path) {
  const CalibrationReader reader{path};
  Hdl64eCalibration calibration;
  try {
    calibration = reader.calibration(YAML::Load(read_outside_file(path, kCalibrationFile)));
  } catch (const FileRefused& refused) {
    throw std::runtime_error(refused.what());
  } catch (const YAML::Exception& error) {
    reader.refuse(error.mark, error.msg);
  }
  try {
    validate(calibration);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  return calibration;
}

}  // namespace rigwire::hil
