#include "sim/scene/mesh_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <map>

namespace rigwire::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

double area_m2(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area += 0.5 * static_cast<double>((mesh.vertices[b] - mesh.vertices[a])
                                          .cross(mesh.vertices[c] - mesh.vertices[a])
                                          .norm());
  }
  return area;
}

TEST(MeshRepair, BadTrianglesAreDroppedAndCountedByReason) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}, {1e6F, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 4}, {0, 1, 5}, {1, 1, 2}, {1, 5, 2}};
  const DroppedTriangles dropped = drop_bad_triangles(mesh);
  EXPECT_EQ(dropped.not_finite, 1U);
  EXPECT_EQ(dropped.too_far, 1U);
  EXPECT_EQ(dropped.no_area, 2U);
  EXPECT_EQ(dropped.total(), 4U);
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.vertices.size(), 4U) << "unused vertices go too";
  EXPECT_NO_THROW(validate(mesh));
  EXPECT_DOUBLE_EQ(area_m2(mesh), 1.0);
}

TEST(MeshRepair, TessellationKeepsTheSurfaceAndItsSeams) {
  TriangleMesh box = make_box("hall", {100.0, 0.15, 12.0});
  const double area = area_m2(box);
  tessellate(box, 5.0);
  EXPECT_NEAR(area_m2(box), area, 1e-3);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& triangle : box.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = triangle[i];
      const auto b = triangle[(i + 1) % 3];
      EXPECT_LE((box.vertices[a] - box.vertices[b]).norm(), 5.0F + 1e-4F);
      ++sides[{a, b}];
    }
  }
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(sides.contains({side.second, side.first})) << "a gap at an edge";
  }
}

TEST(MeshRepair, TessellationTakesTextureCoordinatesAlong) {
  TriangleMesh mesh;
  mesh.name = "square";
  mesh.vertices = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  tessellate(mesh, 1.5);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_FLOAT_EQ(mesh.texture_coordinates[i].x() * 8.0F, mesh.vertices[i].x());
    EXPECT_FLOAT_EQ(mesh.texture_coordinates[i].y() * 8.0F, mesh.vertices[i].y());
  }
}

TEST(MeshRepair, AbsurdTessellationIsRefused) {
  TriangleMesh box = make_box("city", {1000.0, 1000.0, 1000.0});
  EXPECT_THAT([&] { tessellate(box, 0.1); }, ThrowsMessage<std::invalid_argument>(AllOf(
                                                 HasSubstr("mesh 'city'"), HasSubstr("5000000"))));
}

}  // namespace
}  // namespace rigwire::sim
