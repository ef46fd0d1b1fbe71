// How a lidar is simulated, and what a depth image does when that is the way.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/lidar/depth_image_parameters.h"

namespace rigwire::hil {

enum class LidarMethod {
  rays,         ///< sim::SpinningLidar
  depth_image,  ///< sim::DepthImageLidar
};

inline constexpr std::array<fields::Choice<LidarMethod>, 2> kLidarMethods{
    {{LidarMethod::rays, "rays", "Every shot is a ray at its own instant."},
     {LidarMethod::depth_image, "depth_image", "Shots are read from images of virtual cameras."}}};

}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::DepthFormat>, 2> kDepthFormats{
    {{sim::DepthFormat::reversed_float, "reversed_float", "Near plane / depth as a float."},
     {sim::DepthFormat::fixed_24, "fixed_24", "24 bits: steps of 6 mm at 100 m."}}};

}  // namespace rigwire::sim

namespace rigwire::hil {}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::RowRule>, 3> kRowRules{
    {{sim::RowRule::straight, "straight", "A laser's row is the same in every column."},
     {sim::RowRule::hyperbola_half_width, "half_width", "Eq. 4 as printed, b = W / 2."},
     {sim::RowRule::hyperbola_focal, "focal", "Exact: b = f."}}};

}  // namespace rigwire::sim

namespace rigwire::hil {}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::ColumnRule>, 2> kColumnRules{
    {{sim::ColumnRule::uniform, "uniform", "As if all columns were equally wide in angle."},
     {sim::ColumnRule::resampled, "resampled", "Exact: f tan p."}}};

}  // namespace rigwire::sim

namespace rigwire::hil {}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::ElevationRule>, 2> kElevationRules{
    {{sim::ElevationRule::pixels_per_beam, "pixels_per_beam", "Equal steps of rows."},
     {sim::ElevationRule::sensor_table, "sensor_table", "Exact: each laser's own elevation."}}};

}  // namespace rigwire::sim

namespace rigwire::hil {}  // namespace rigwire::hil

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::DepthSampling>, 5> kDepthSamplings{
    {{sim::DepthSampling::nearest, "nearest", "The nearest pixel."},
     {sim::DepthSampling::bilinear_depth, "bilinear_depth", "Of four depths."},
     {sim::DepthSampling::bilinear_inverse_depth, "bilinear_inverse_depth",
      "Of four 1/z: exact on planes."},
     {sim::DepthSampling::edge_aware, "edge_aware", "Of 1/z on surfaces, nearest at edges."},
     {sim::DepthSampling::tangent_plane, "tangent_plane", "The nearest pixel's plane."}}};

inline void visit(fields::Visitor& v, sim::DepthImageParameters& p) {
  v.integer("cameras", p.cameras, fields::IntegerRule{3, 64}, "Around the axis, a sector each.");
  v.number("field_of_view", p.field_of_view_deg, fields::in("deg").stored_as("deg").between(0, 170),
           "Horizontal, of each; 0 = just the sector.");
  v.integer("width", p.width_px, fields::IntegerRule{8, 16384}, "Pixels of each image.");
  v.integer("height", p.height_px, fields::IntegerRule{0, 16384},
            "Pixels; 0 = as the lasers need.");
  v.integer("images_per_revolution", p.images_per_revolution, fields::IntegerRule{1, 360},
            "Instants at which a revolution is seen; 1 = all at once.");
  v.choice("depth", p.depth, kDepthFormats, "What the depth buffer holds.");
  v.number("near_plane", p.near_plane_m, fields::in("m").between(1e-3, 10), "Of the depth buffer.");
  v.choice("rows", p.rows, kRowRules, "Which row a laser has beside the optical axis.");
  v.choice("columns", p.columns, kColumnRules, "Which column an azimuth has.");
  v.choice("elevations", p.elevations, kElevationRules, "Which row a laser has on the axis.");
  v.choice("sampling", p.sampling, kDepthSamplings, "How depth is read between pixels.");
  v.integer("parallax_steps", p.parallax_steps, fields::IntegerRule{0, 8},
            "Towards where each beam leaves the head; needs the exact rules.");
}

}  // namespace rigwire::sim

namespace rigwire::hil {}  // namespace rigwire::hil
