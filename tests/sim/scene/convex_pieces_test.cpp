#include "sim/scene/convex_pieces.h"

#include <gtest/gtest.h>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

TriangleMesh moved(TriangleMesh mesh, const Eigen::Vector3f& by) {
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex += by;
  }
  return mesh;
}

TEST(ConvexPieces, TwoBoxesOfOneMeshDoNotFillTheRoomBetweenThem) {
  TriangleMesh both = make_box("both", {1.0, 2.0, 3.0});
  const TriangleMesh other = moved(make_box("other", {1.0, 2.0, 3.0}), {5.0F, 0.0F, 0.0F});
  const auto first = static_cast<std::uint32_t>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& triangle : other.triangles) {
    both.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
  }
  const auto pieces = convex_pieces({&both, 1}, 2.0);
  ASSERT_EQ(pieces.size(), 2U);
  for (const auto& piece : pieces) {
    EXPECT_TRUE(piece->half_lengths_m().isApprox(Vector(1.0, 2.0, 3.0), 1e-6));
    EXPECT_EQ(piece->faces().size(), 6U);
  }
}

TEST(ConvexPieces, AFlatPlateIsSolidAndAPebbleIsNot) {
  TriangleMesh plate;
  plate.name = "plate";
  plate.vertices = {{0.0F, 0.0F, 1.0F}, {2.0F, 0.0F, 1.0F}, {2.0F, 1.0F, 1.0F}, {0.0F, 1.0F, 1.0F}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<TriangleMesh> meshes{plate, make_box("pebble", {0.04, 0.04, 0.04})};
  const auto pieces = convex_pieces(meshes, 1.0);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_NEAR(pieces[0]->half_lengths_m().z(), 0.01, 1e-6);
}

TEST(ConvexPieces, ARoundBodyKeepsItsSizeWithFewerPoints) {
  RandomStream random(1, "rock");
  const TriangleMesh rock = make_rock("rock", random);
  const auto pieces = convex_pieces({&rock, 1}, 1.0);
  ASSERT_EQ(pieces.size(), 1U);
  for (const Eigen::Vector3f& vertex : rock.vertices) {
    const Vector p = vertex.cast<double>();
    for (const ConvexShape::Face& face : pieces[0]->faces()) {
      EXPECT_LT(face.normal.dot(p) - face.offset_m, 0.12);
    }
  }
}

}  // namespace
}  // namespace rigwire::sim
