#include "sim/lidar/depth_image_lookup.h"

#include <gtest/gtest.h>

#include <functional>

#include "depth_image_head.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;

/// A small image painted by a formula.
class Painted {
 public:
  explicit Painted(DepthImageParameters parameters = small())
      : geometry(parameters, ideal_head()), image(geometry, 0, parameters, 100.0) {}

  static DepthImageParameters small() {
    DepthImageParameters parameters;
    parameters.cameras = 4;
    parameters.width_px = 64;
    return parameters;
  }
  /// Inverse depth of the plane n . p = d, where it is in front of the camera.
  [[nodiscard]] double plane(const Vector3d& n, double d, double u_px, double v_px) const {
    return n.dot(geometry.direction_S({0, u_px, v_px})) / d;
  }
  void paint(const std::function<double(double, double)>& inverse_depth, const Vector3d& n) {
    for (std::size_t row = 0; row < image.height_px(); ++row) {
      for (std::size_t column = 0; column < image.width_px(); ++column) {
        const double u = static_cast<double>(column) + 0.5 - 32.0;
        const double v = geometry.top_px() - static_cast<double>(row) - 0.5;
        image.set(image.index(column, row), static_cast<float>(inverse_depth(u, v)), 0,
                  n.cast<float>());
      }
    }
  }
  [[nodiscard]] double at(double u, double v, DepthSampling sampling) const {
    return look_up(image, geometry, {0, u, v}, sampling).inverse_depth;
  }

  DepthImageGeometry geometry;
  DepthImage image;
};

constexpr DepthSampling kExactOnPlanes[] = {
    DepthSampling::bilinear_inverse_depth, DepthSampling::edge_aware, DepthSampling::tangent_plane};

TEST(DepthLookup, PlanesAreExactInInverseDepthUpToTheImagesEdge) {
  Painted picture;
  const Vector3d n = Vector3d(1.0, 0.3, -0.4).normalized();
  picture.paint([&](double u, double v) { return picture.plane(n, 8.0, u, v); }, n);
  RandomStream random(3, "places");
  double worst_between_depths = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double u = -32.0 + 64.0 * random.uniform();
    const double v = picture.geometry.top_px() -
                     random.uniform() * static_cast<double>(picture.image.height_px());
    const double truth = picture.plane(n, 8.0, u, v);
    for (const DepthSampling sampling : kExactOnPlanes) {
      EXPECT_NEAR(picture.at(u, v, sampling), truth, 2e-7 * truth) << u << " " << v;
    }
    const double between = picture.at(u, v, DepthSampling::bilinear_depth);
    worst_between_depths = std::max(worst_between_depths, std::abs(between / truth - 1.0));
  }
  EXPECT_GT(worst_between_depths, 1e-5);
  EXPECT_LT(worst_between_depths, 1e-2);
}

TEST(DepthLookup, NoPointBetweenTwoSurfacesThoughTheirEdgeRunsAlongTheColumns) {
  Painted picture;
  // Twenty metres to the left, five to the right, and sky above both.
  picture.paint(
      [](double u, double v) { return v > 5.0 ? 0.0 : (u < 0.0 ? 1.0 / 20.0 : 1.0 / 5.0); },
      Vector3d::UnitX());
  int ghosts = 0;
  for (double v = -20.0; v < 8.0; v += 0.13) {
    for (double u = -6.0; u < 6.0; u += 0.07) {
      for (const DepthSampling sampling :
           {DepthSampling::nearest, DepthSampling::edge_aware, DepthSampling::tangent_plane}) {
        const double inverse = picture.at(u, v, sampling);
        const bool on_surface =
            inverse == 0.0 || std::abs(inverse - 0.05) < 0.03 || std::abs(inverse - 0.2) < 0.08;
        EXPECT_TRUE(on_surface) << u << " " << v << ": " << inverse;
      }
      const double inverse = picture.at(u, v, DepthSampling::bilinear_depth);
      ghosts += inverse > 0.055 && inverse < 0.19 ? 1 : 0;
    }
  }
  EXPECT_GT(ghosts, 100);
}

TEST(DepthLookup, AnEdgeAlongTheRowsIsAnEdgeToo) {
  Painted picture;
  picture.paint([](double, double v) { return v > -3.0 ? 1.0 / 60.0 : 1.0 / 6.0; },
                Vector3d::UnitX());
  for (double v = -5.0; v < -1.0; v += 0.05) {
    const double inverse = picture.at(0.3, v, DepthSampling::edge_aware);
    EXPECT_TRUE(std::abs(inverse * 60.0 - 1.0) < 1e-6 || std::abs(inverse * 6.0 - 1.0) < 1e-6);
  }
}

TEST(DepthLookup, OutsideTheImageItsNearestPlaceAnswers) {
  Painted picture;
  picture.paint([](double, double) { return 0.1; }, Vector3d::UnitX());
  for (const DepthSampling sampling :
       {DepthSampling::nearest, DepthSampling::bilinear_depth, DepthSampling::edge_aware}) {
    EXPECT_NEAR(picture.at(1e6, -1e6, sampling), 0.1, 1e-8);
    EXPECT_NEAR(picture.at(-1e6, 1e6, sampling), 0.1, 1e-8);
  }
}

/// Depth of a wall square to the camera, read from an image of it.
double depth_of_wall_m(DepthFormat format, double near_m, double distance_m) {
  DepthImageParameters parameters = Painted::small();
  parameters.depth = format;
  parameters.near_plane_m = near_m;
  Painted picture(parameters);
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {1.0, 400.0, 400.0}));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() << distance_m + 0.5, 0.0, 0.0;
  scene.add_object(wall, X_WM, 1.0, {});
  scene.begin_slice(kStart, kStart + kRevolution, Vector3d::Zero(), {});
  const std::size_t row = picture.image.height_px() / 2;
  EXPECT_EQ(picture.image.render_row(scene, {}, row, {10, 20}), 10U);
  EXPECT_EQ(picture.image.surface(picture.image.index(9, row)), DepthImage::kNothing);
  return 1.0 / static_cast<double>(picture.image.inverse_depth(picture.image.index(12, row)));
}

TEST(DepthImage, TwentyFourBitsStepBySixMillimetresAtAHundredMetres) {
  double worst_m = 0.0;
  double worst_half_metre_m = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double distance_m = 95.0 + 0.0937 * i;
    const double error_m = depth_of_wall_m(DepthFormat::fixed_24, 0.1, distance_m) - distance_m;
    worst_m = std::max(worst_m, std::abs(error_m));
    const double with_half_metre = depth_of_wall_m(DepthFormat::fixed_24, 0.5, distance_m);
    worst_half_metre_m = std::max(worst_half_metre_m, std::abs(with_half_metre - distance_m));
    EXPECT_NEAR(depth_of_wall_m(DepthFormat::reversed_float, 0.1, distance_m), distance_m, 3e-5);
  }
  // Half a step z^2 / (2^24 n).
  EXPECT_GT(worst_m, 0.002);
  EXPECT_LT(worst_m, 0.00305);
  EXPECT_GT(worst_half_metre_m, 0.0004);
  EXPECT_LT(worst_half_metre_m, 0.00065);
}

}  // namespace
}  // namespace rigwire::sim
