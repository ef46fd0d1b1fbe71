// Textures in pictures: where they are, how bright, near and far, on what stands and what moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "camera_site.h"
#include "sim/camera/camera_renderer.h"
#include "sim/scene/colour_texture.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// The camera of small_camera(): pinhole, x forward, y left, z up.
constexpr double kMiddleColumn = 79.5;
constexpr double kMiddleRow = 59.5;

using Board = std::shared_ptr<const ColourTexture>;

Texel texel(double red, double green, double blue) {
  const auto share = [](double albedo) {
    return static_cast<std::uint16_t>(albedo * 65535.0 + 0.5);
  };
  return {share(red), share(green), share(blue), 65535};
}

/// Fields of `dark` and `light`, dark where v and u are 0.
Board checks(std::size_t fields, double dark, double light) {
  std::vector<Texel> texels;
  for (std::size_t r = 0; r < fields; ++r) {
    for (std::size_t c = 0; c < fields; ++c) {
      const double albedo = (r + c) % 2 == 0 ? dark : light;
      texels.push_back(texel(albedo, albedo, albedo));
    }
  }
  return std::make_shared<ColourTexture>("checks", fields, fields, std::move(texels));
}

Board even(double albedo) {
  return std::make_shared<ColourTexture>("even", 1, 1,
                                         std::vector<Texel>{texel(albedo, albedo, albedo)});
}

/// A square of x and y from -half to half, facing up, the picture on it once.
TriangleMesh card(const Board& board, float half_m, float repeats = 1.0F) {
  TriangleMesh mesh;
  mesh.name = "card";
  mesh.vertices = {
      {-half_m, -half_m, 0}, {half_m, -half_m, 0}, {half_m, half_m, 0}, {-half_m, half_m, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.texture_coordinates = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
  mesh.colour = std::make_shared<MeshColour>(MeshColour{board});
  return mesh;
}

Eigen::Isometry3d looking_down(double height_m) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 0.0, 0.0, height_m;
  X.linear() << 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0;
  return X;
}

/// A picture of a card; `label` has neither gloss nor light that shines through.
RenderedPicture picture_of(const TriangleMesh& mesh, const Eigen::Isometry3d& X_WM,
                           const Eigen::Isometry3d& X_WS, double focal_px, double scale = 1.0) {
  Scene scene;
  scene.add_object(scene.add_mesh(mesh), X_WM, scale, surface("wall"));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 180.0));
  CameraParameters parameters = small_camera(focal_px);
  parameters.lens.mtf = 1.0;  // the card alone is judged
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, X_WS, light), picture);
  return picture;
}

struct Pixel {
  double column, row;
};

Pixel project(const Eigen::Vector3d& p_W, const Eigen::Isometry3d& X_WS, double focal_px) {
  const Eigen::Vector3d p = X_WS.inverse() * p_W;
  return {kMiddleColumn - focal_px * p.y() / p.x(), kMiddleRow - focal_px * p.z() / p.x()};
}

TEST(PaintedLooks, FieldsAreWhereAPinholeHasThemInTheirLinearColours) {
  // Four by four fields of 1 m; albedos of each band by the field's number.
  std::vector<Texel> texels;
  const auto albedo = [](int field, int band) { return 0.05 + 0.05 * ((field * (band + 2)) % 16); };
  for (int i = 0; i < 16; ++i) {
    texels.push_back(texel(albedo(i, 0), albedo(i, 1), albedo(i, 2)));
  }
  const Board board = std::make_shared<ColourTexture>("fields", 4, 4, texels);
  const Eigen::Isometry3d X_WM = at(9.0, 1.0, 0.5, 0.6, 0.3, -0.4);
  for (const double scale : {1.0, 0.7}) {
    const Eigen::Isometry3d X_WS = at(1.0, 0.5, 6.0, 0.05, 0.55);
    const double focal_px = 130.0;
    const RenderedPicture seen = picture_of(card(board, 2.0F), X_WM, X_WS, focal_px, scale);
    const RenderedPicture white = picture_of(card(even(0.5), 2.0F), X_WM, X_WS, focal_px, scale);
    for (int i = 0; i < 16; ++i) {
      const Eigen::Vector3d p_M(scale * (-1.5 + i % 4), scale * (-1.5 + i / 4), 0.0);
      const Pixel pixel = project(X_WM * p_M, X_WS, focal_px);
      const auto column = static_cast<int>(std::lround(pixel.column));
      const auto row = static_cast<int>(std::lround(pixel.row));
      ASSERT_TRUE(column > 0 && column < 159 && row > 0 && row < 119) << i;
      // Halfway to the next field is the mean of both: half a pixel off is less than a tenth of
      // the way to it.
      for (int band = 0; band < 3; ++band) {
        const double ratio = luminance_at(seen, column, row, static_cast<std::size_t>(band)) /
                             luminance_at(white, column, row, static_cast<std::size_t>(band));
        EXPECT_NEAR(0.5 * ratio, albedo(i, band), 0.06) << i << ", band " << band;
      }
    }
  }
}

TEST(PaintedLooks, LinesBetweenFieldsLieWithinATenthOfAPixel) {
  // Along a row of the picture, brightness crosses the mean where the projection says.
  const Board board = checks(8, 0.1, 0.7);
  const double height = 10.0;
  const double focal_px = 100.0;
  const RenderedPicture seen =
      picture_of(card(board, 4.0F), at(0.03, 0.0, 0.0), looking_down(height), focal_px);
  const RenderedPicture half =
      picture_of(card(even(0.4), 4.0F), at(0.03, 0.0, 0.0), looking_down(height), focal_px);
  const int row = 64;  // amid fields
  for (int line = -3; line <= 3; ++line) {
    const double expected = kMiddleColumn + focal_px * (0.03 + line) / height;
    const auto ratio = [&](int column) {
      return luminance_at(seen, column, row) / luminance_at(half, column, row) - 1.0;
    };
    const auto left = static_cast<int>(std::floor(expected));
    ASSERT_LT(ratio(left) * ratio(left + 1), 0.0) << line;
    const double crossing = left + ratio(left) / (ratio(left) - ratio(left + 1));
    EXPECT_NEAR(crossing, expected, 0.1) << line;
  }
}

TEST(PaintedLooks, FarAndSlantedBoardsAreAsBrightAsTheirMean) {
  const Board board = checks(64, 0.1, 0.7);
  for (const double pitch_deg : {90.0, 30.0, 8.0}) {
    // Towards the middle of the board, from 60 m.
    const double pitch = pitch_deg * kDegree;
    const Eigen::Isometry3d X_WS =
        at(-60.0 * std::cos(pitch), 0.0, 60.0 * std::sin(pitch), 0.0, pitch);
    const RenderedPicture seen = picture_of(card(board, 10.0F, 8.0F), at(0, 0, 0), X_WS, 240.0);
    const RenderedPicture mean = picture_of(card(even(0.4), 10.0F), at(0, 0, 0), X_WS, 240.0);
    double most = 0.0;
    double sum = 0.0;
    int count = 0;
    for (int row = 58; row <= 61; ++row) {
      for (int column = 60; column < 100; ++column) {
        const double ratio = luminance_at(seen, column, row) / luminance_at(mean, column, row);
        most = std::max(most, std::abs(ratio - 1.0));
        sum += ratio;
        ++count;
      }
    }
    EXPECT_NEAR(sum / count, 1.0, 1e-3) << pitch_deg;
    EXPECT_LT(most, 0.01) << pitch_deg;
  }
}

TEST(PaintedLooks, FineFieldsDoNotFlickerUnderMotion) {
  const Board board = checks(64, 0.1, 0.7);
  const TriangleMesh mesh = card(board, 10.0F, 4.0F);  // fields of 78 mm
  // Rms over pixels and steps of 1/8 pixel of a pixel's change about its mean, against that mean.
  const auto flicker = [&](double pitch_deg, double range_m, double focal_px) {
    std::vector<double> sum(40, 0.0);
    std::vector<double> square(40, 0.0);
    constexpr int kSteps = 16;
    for (int step = 0; step < kSteps; ++step) {
      const double pitch = pitch_deg * kDegree;
      const Eigen::Isometry3d X_WS = at(-range_m * std::cos(pitch), step * range_m / focal_px / 8.0,
                                        range_m * std::sin(pitch), 0.0, pitch);
      // The middle row looks along the middle of a row of fields.
      const RenderedPicture seen = picture_of(mesh, at(0.039, 0, 0), X_WS, focal_px);
      for (int i = 0; i < 40; ++i) {
        const double value = luminance_at(seen, 60 + i, 60);
        sum[static_cast<std::size_t>(i)] += value;
        square[static_cast<std::size_t>(i)] += value * value;
      }
    }
    double variance = 0.0;
    double mean = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      mean += sum[i] / kSteps / 40.0;
      variance += (square[i] / kSteps - sum[i] * sum[i] / kSteps / kSteps) / 40.0;
    }
    return std::sqrt(variance) / mean;
  };
  // A pixel is 1.6 and 2.1 fields wide, and as much slanted, eight times longer.
  EXPECT_LT(flicker(90.0, 20.0, 160.0), 0.04);
  EXPECT_LT(flicker(90.0, 26.0, 160.0), 0.04);
  EXPECT_LT(flicker(7.0, 20.0, 160.0), 0.04);
  // Fields of four pixels are there.
  EXPECT_GT(flicker(90.0, 20.0, 1024.0), 0.1);
}

TEST(PaintedLooks, PartsOfOneModelHaveTheirOwnPictures) {
  TriangleMesh left = card(even(0.2), 1.0F);
  TriangleMesh right = card(even(0.6), 1.0F);
  TriangleMesh plain = card({}, 1.0F);
  plain.colour = std::make_shared<MeshColour>(MeshColour{{}, {0.4F, 0.4F, 0.4F}});
  plain.texture_coordinates.clear();
  for (std::size_t i = 0; i < 4; ++i) {
    left.vertices[i].y() += 3.0F;
    right.vertices[i].y() -= 3.0F;
  }
  Scene scene;
  const std::vector<MeshPart> parts{
      {left, surface("wall")}, {plain, surface("wall")}, {right, surface("wall")}};
  scene.add_model_object(scene.add_model(parts), at(0, 0, 0), 1.0, "signs");
  ready(scene);
  const auto twin = scene.twin();
  twin->begin_slice(kStart, kStart + 100ms, scene.placement(), {});
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 180.0));
  const CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  // North, which is left of the models' x, is up in the picture.
  camera.render(scene, job_for(parameters, looking_down(8.0), light), picture);
  EXPECT_NEAR(luminance_at(picture, 79, 90) / luminance_at(picture, 79, 30), 3.0, 0.01);
  EXPECT_NEAR(mean_luminance(picture, 75, 55, 85, 65) / luminance_at(picture, 79, 30), 2.0, 0.25)
      << "plain paint with its label's wear";
  RenderedPicture again;
  camera.render(*twin, job_for(parameters, looking_down(8.0), light), again);
  EXPECT_EQ(again.luminance, picture.luminance);
}

TEST(PaintedLooks, PicturesMoveWithTheirBody) {
  Scene scene;
  const auto body = scene.add_body("sled");
  scene.add_body_part(body, scene.add_mesh(card(checks(2, 0.1, 0.7), 2.0F)), at(0, 0, 1),
                      surface("wall"));
  const Eigen::Isometry3d X_WB = at(1.5, -0.5, 0.0, 0.8);
  const BodyMotion motion{X_WB, X_WB};
  scene.begin_slice(kStart, kStart + 100ms, Eigen::Vector3d::Zero(), {&motion, 1});
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 180.0));
  const CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture moving;
  camera.render(scene, job_for(parameters, looking_down(8.0), light), moving);
  Scene standing;
  standing.add_object(standing.add_mesh(card(checks(2, 0.1, 0.7), 2.0F)), X_WB * at(0, 0, 1), 1.0,
                      surface("wall"));
  ready(standing);
  RenderedPicture still;
  camera.render(standing, job_for(parameters, looking_down(8.0), light), still);
  double most = 0.0;
  for (int row = 45; row < 75; ++row) {
    for (int column = 80; column < 110; ++column) {
      most = std::max(
          most,
          std::abs(luminance_at(moving, column, row) / luminance_at(still, column, row) - 1.0));
    }
  }
  EXPECT_LT(most, 0.01);
}

TEST(PaintedLooks, WhatHasNoColourOfItsOwnIsTheSameToTheByte) {
  const auto taken = [](bool painted, unsigned threads) {
    Scene scene;
    scene.add_terrain(level_ground(), surface("meadow"));
    scene.add_object(scene.add_mesh(make_box("box", {2.0, 2.0, 2.0})), at(6.0, 0.0, 1.0, 0.4), 1.0,
                     surface("machine"));
    if (painted) {
      // Behind the camera.
      scene.add_object(scene.add_mesh(card(checks(8, 0.1, 0.7), 2.0F)), at(-30.0, 0.0, 1.0), 1.0,
                       surface("machine"));
    }
    ready(scene);
    const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 180.0));
    CameraParameters parameters = small_camera();
    parameters.threads = static_cast<int>(threads);
    CameraRenderer camera(parameters, 1, "camera");
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.2), light), picture);
    return picture.luminance;
  };
  EXPECT_EQ(taken(true, 1), taken(false, 1));
  EXPECT_EQ(taken(true, 3), taken(false, 1));
}

}  // namespace
}  // namespace rigwire::sim
