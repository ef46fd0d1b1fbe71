#include "sim/lidar/depth_image_parameters.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr double kWidestView_deg = 170.0;
constexpr int kLeastRows = 8;

constexpr std::array<fields::Choice<DepthFormat>, 2> kDepthFormats{
    {{DepthFormat::reversed_float, "reversed_float", "Near plane / depth as a float."},
     {DepthFormat::fixed_24, "fixed_24", "24 bits: steps of 6 mm at 100 m."}}};
constexpr std::array<fields::Choice<RowRule>, 3> kRowRules{
    {{RowRule::straight, "straight", "A laser's row is the same in every column."},
     {RowRule::hyperbola_half_width, "half_width", "Eq. 4 as printed, b = W / 2."},
     {RowRule::hyperbola_focal, "focal", "Exact: b = f."}}};
constexpr std::array<fields::Choice<ColumnRule>, 2> kColumnRules{
    {{ColumnRule::uniform, "uniform", "All columns count as equally wide in angle."},
     {ColumnRule::resampled, "resampled", "Exact: f tan p."}}};
constexpr std::array<fields::Choice<ElevationRule>, 2> kElevationRules{
    {{ElevationRule::pixels_per_beam, "pixels_per_beam", "Equal steps of rows."},
     {ElevationRule::sensor_table, "sensor_table", "Exact: each laser's own elevation."}}};
constexpr std::array<fields::Choice<DepthSampling>, 5> kDepthSamplings{
    {{DepthSampling::nearest, "nearest", "The nearest pixel."},
     {DepthSampling::bilinear_depth, "bilinear_depth", "Mean of four depths."},
     {DepthSampling::bilinear_inverse_depth, "bilinear_inverse_depth",
      "Mean of four 1/z: exact on planes."},
     {DepthSampling::edge_aware, "edge_aware", "Mean of 1/z on surfaces, nearest pixel at edges."},
     {DepthSampling::tangent_plane, "tangent_plane", "The nearest pixel's plane."}}};

}  // namespace

DepthImageParameters as_printed() {
  DepthImageParameters parameters;
  parameters.rows = RowRule::hyperbola_half_width;
  parameters.elevations = ElevationRule::pixels_per_beam;
  parameters.sampling = DepthSampling::nearest;
  parameters.parallax_steps = 0;
  return parameters;
}

double field_of_view_rad(const DepthImageParameters& parameters) {
  const double sector_deg = 360.0 / parameters.cameras;
  const double view_deg =
      parameters.field_of_view_deg == 0.0 ? sector_deg : parameters.field_of_view_deg;
  return view_deg * std::numbers::pi / 180.0;
}

void visit(fields::Visitor& v, DepthImageParameters& p) {
  v.integer("cameras", p.cameras, IntegerRule{3, 64},
            "Virtual cameras around the axis, a sector each.");
  v.number("field_of_view", p.field_of_view_deg,
           in("deg").stored_as("deg").between(0, kWidestView_deg),
           "View of each camera, horizontally; 0 = just the sector.");
  v.integer("width", p.width_px, IntegerRule{8, 16384}, "Width of each image in pixels.");
  v.integer("height", p.height_px, IntegerRule{0, 16384},
            "Height of each image in pixels, 8 or more; 0 = as the lasers need.");
  v.integer("images_per_revolution", p.images_per_revolution, IntegerRule{1, 360},
            "Instants at which a revolution is seen; 1 = all at once.");
  v.choice("depth", p.depth, kDepthFormats, "What the depth buffer holds.");
  v.number("near_plane", p.near_plane_m, in("m").between(1e-3, 10),
           "Nearest depth that the depth buffer holds.");
  v.choice("rows", p.rows, kRowRules, "Rule for the row of a laser beside the optical axis.");
  v.choice("columns", p.columns, kColumnRules, "Rule for the column of an azimuth.");
  v.choice("elevations", p.elevations, kElevationRules, "Rule for the row of a laser on the axis.");
  v.choice("sampling", p.sampling, kDepthSamplings, "How depth is read between pixels.");
  v.integer("parallax_steps", p.parallax_steps, IntegerRule{0, 8},
            "Steps towards where each beam leaves the head; needs the exact rules.");
}

void validate(const DepthImageParameters& p) {
  fields::check(p);
  if (p.height_px != 0 && p.height_px < kLeastRows) {
    throw fields::Refused("height", "found " + std::to_string(p.height_px) +
                                        ", allowed 0 (as the lasers need) or 8 .. 16384");
  }
  const double sector_deg = 360.0 / p.cameras;
  if (p.field_of_view_deg != 0.0 && p.field_of_view_deg < sector_deg) {
    throw fields::Refused(
        "field_of_view",
        "found " + fields::shortest(p.field_of_view_deg) +
            " deg, allowed 0 (just the sector) or at least the sector of each of " +
            std::to_string(p.cameras) + " cameras, " + fields::shortest(sector_deg) + " deg");
  }
  const bool exact = p.rows == RowRule::hyperbola_focal && p.columns == ColumnRule::resampled &&
                     p.elevations == ElevationRule::sensor_table;
  if (p.parallax_steps > 0 && !exact) {
    throw fields::Refused("parallax_steps",
                          "found " + std::to_string(p.parallax_steps) +
                              ", allowed 0 unless rows, columns and elevations all follow the "
                              "exact rule");
  }
}

}  // namespace rigwire::sim
