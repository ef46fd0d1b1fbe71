#include "sim/camera/all_round_camera.h"

#include <array>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr double kHalfTurn = std::numbers::pi;
/// Rounding of angles that a file gives in degrees.
constexpr double kRounding_rad = 1e-9;

constexpr std::array<fields::Choice<AllRoundMethod>, 2> kMethods{
    {{AllRoundMethod::rays, "rays", "Each pixel's ray is cast where it looks."},
     {AllRoundMethod::views, "views", "Pictures of several cameras are joined."}}};

}  // namespace

CameraParameters AllRoundCameraParameters::optics() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 744;
  p.lens.vignetting = 0.0;
  return p;
}

void visit(fields::Visitor& v, AllRoundCameraParameters& p) {
  v.choice("method", p.method, kMethods, "Where the picture comes from.");
  v.integer("width", p.width_px, kPictureSide, "Columns of the joined picture, 360 degrees.");
  v.integer("height", p.height_px, kPictureSide, "Rows of the joined picture.");
  v.number("elevation_upper", p.elevation_upper_rad, in("deg").between(-90, 90),
           "Of the picture's upper edge; a row is 360 degrees / width high.");
  v.only_if(p.method == AllRoundMethod::views, "method", "method: views",
            [&p](fields::Visitor& keys) {
              keys.integer("views", p.views, IntegerRule{3, 12}, "Cameras that share the round.");
              keys.group(
                  "view", [&p](fields::Visitor& view) { visit_size(view, p.camera.sensor); },
                  "Sensor of each view.");
            });
  v.group(
      "lens", [&p](fields::Visitor& lens) { visit_light(lens, p.camera.lens); },
      "How much light comes through the lens.");
  v.group(
      "image_sensor", [&p](fields::Visitor& sensor) { visit_figures(sensor, p.camera.sensor); },
      "What turns light into numbers.");
  visit_pictures(v, p.camera);
}

void validate(const AllRoundCameraParameters& p) {
  fields::check(p);
  const double height_rad = 2.0 * kHalfTurn * p.height_px / p.width_px;
  fields::require(
      p.elevation_upper_rad - height_rad >= -0.5 * kHalfTurn - kRounding_rad, "height",
      std::to_string(p.height_px),
      "rows down to -90 degrees, " +
          std::to_string(static_cast<int>(
              (p.elevation_upper_rad + 0.5 * kHalfTurn) / (2.0 * kHalfTurn) * p.width_px + 1e-6)) +
          " with such an upper edge and width");
  if (p.method == AllRoundMethod::rays) {
    // A direction of the joined picture has no angle from an axis.
    fields::require(p.camera.lens.vignetting == 0.0, "lens.vignetting",
                    fields::plain().print(p.camera.lens.vignetting), "0 with method: rays");
  }
  validate(p.camera);
}

}  // namespace rigwire::sim
