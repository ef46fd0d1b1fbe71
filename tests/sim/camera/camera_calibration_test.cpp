// What others find in our pictures: OpenCV's own calibration and corner finder.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "shot_site.h"
#include "sim/camera/plain_camera.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

constexpr int kColumns = 9;  ///< Inner corners.
constexpr int kRows = 6;
constexpr double kSquare_m = 0.1;

/// A chessboard in the plane x = 0 of its own frame, seen from -x: columns along -y, rows along -z,
/// the inner corners about its origin, with a white margin. As thin as paint: a step between black
/// and white moves corners that are seen aslant.
struct Chessboard {
  Chessboard() {
    const auto white = scene.add_body("white");
    const auto board = scene.add_mesh(make_box("board", {0.0002, 1.3, 1.0}));
    scene.add_body_part(white, board, at(0.0003, 0.0, 0.0), surface("white"));
    const auto square = scene.add_mesh(make_box("square", {0.0002, kSquare_m, kSquare_m}));
    for (int column = 0; column <= kColumns; ++column) {
      for (int row = 0; row <= kRows; ++row) {
        if ((column + row) % 2 == 0) {
          const Eigen::Vector3d middle =
              corner(column, row) + Eigen::Vector3d(0.0001, 0.5 * kSquare_m, 0.5 * kSquare_m);
          scene.add_body_part(white, square, at(middle.x(), middle.y(), middle.z()),
                              surface("black"));
        }
      }
    }
  }
  /// In the board's frame; its front is there.
  [[nodiscard]] static Eigen::Vector3d corner(int column, int row) {
    return {0.0, (0.5 * (kColumns - 1) - column) * kSquare_m,
            (0.5 * (kRows - 1) - row) * kSquare_m};
  }
  void stand(const Eigen::Isometry3d& X_WB) {
    const std::vector<BodyMotion> motions{{X_WB, X_WB}};
    scene.begin_slice(kStart, kStart + 100ms, Eigen::Vector3d::Zero(), motions);
  }
  Scene scene;
};

CameraParameters calibrated_camera() {
  CameraParameters p;
  p.sensor.width_px = 480;
  p.sensor.height_px = 360;
  p.lens.focal_length_m = 390.0 * p.sensor.pixel_pitch_m;
  p.lens.principal_offset_px = {6.3, -4.1};
  p.lens.k1 = -0.12;
  p.lens.k2 = 0.04;
  p.lens.p1 = 0.0008;
  p.lens.p2 = -0.0005;
  p.threads = 2;
  p.looks = {{.label = "white", .kind = SurfaceKind::plaster, .colour = {0.8, 0.8, 0.8}},
             {.label = "black", .kind = SurfaceKind::plaster, .colour = {0.03, 0.03, 0.03}}};
  return p;
}

/// Boards before a camera at the origin: over all of the picture, tilted both ways.
std::vector<Eigen::Isometry3d> stands() {
  std::vector<Eigen::Isometry3d> result;
  RandomStream random(11, "boards");
  for (int i = 0; i < 10; ++i) {
    const double distance_m = random.uniform(1.1, 1.6);
    result.push_back(at(distance_m, random.uniform(-0.16, 0.16) * distance_m,
                        random.uniform(-0.10, 0.10) * distance_m, random.uniform(-0.6, 0.6),
                        random.uniform(-0.5, 0.5), random.uniform(-0.2, 0.2)));
  }
  return result;
}

/// Corners as OpenCV finds them; empty: it does not.
std::vector<cv::Point2f> corners_in(const Picture& picture) {
  const PicturePart& part = picture.parts.front();
  cv::Mat grey(part.region.height, part.region.width, CV_8UC1);
  std::ranges::copy(part.bytes, grey.data);
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCorners(grey, {kColumns, kRows}, corners,
                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return {};
  }
  cv::cornerSubPix(grey, corners, {8, 8}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4});
  return corners;
}

/// Where each corner is by the lens alone; turned round when OpenCV began at the other end.
std::vector<Eigen::Vector2d> corners_by_lens(const Lens& lens, const Eigen::Isometry3d& X_WB,
                                             const cv::Point2f& first) {
  std::vector<Eigen::Vector2d> places;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      places.push_back(*lens.project(mount_to_lens(X_WB * Chessboard::corner(column, row))));
    }
  }
  const Eigen::Vector2d found(static_cast<double>(first.x), static_cast<double>(first.y));
  if ((places.front() - found).norm() > (places.back() - found).norm()) {
    std::ranges::reverse(places);
  }
  return places;
}

/// The parameter is the number of rays per pixel: with 25 the picture is exact, 1 is the default.
class CameraCalibration : public testing::TestWithParam<int> {};

TEST_P(CameraCalibration, OthersFindCornersAndLensWhereTheyAre) {
  Chessboard board;
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 270.0));
  CameraParameters parameters = calibrated_camera();
  parameters.samples = GetParam();
  const Lens lens(parameters.lens, parameters.sensor.pixel_pitch_m, 480, 360);
  const auto camera = make_plain_camera(parameters, 1, "camera");
  CameraShot shot = shot_for(480, 360, at(0.0, 0.0, 0.0), light);
  shot.exposure = 600us;

  std::vector<std::vector<cv::Point2f>> found;
  std::vector<std::vector<cv::Point3f>> known;
  double squares = 0.0;
  int corners = 0;
  for (const Eigen::Isometry3d& X_WB : stands()) {
    board.stand(X_WB);
    ++shot.frame;
    const auto taken = camera->take(board.scene, shot, nullptr);
    const auto seen = corners_in(*taken.picture);
    if (seen.empty()) {
      continue;  // a board that reaches off the picture
    }
    const auto expected = corners_by_lens(lens, X_WB, seen.front());
    std::vector<cv::Point3f> points;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Eigen::Vector2d at_pixel(static_cast<double>(seen[i].x),
                                     static_cast<double>(seen[i].y));
      squares += (at_pixel - expected[i]).squaredNorm();
      ++corners;
      points.emplace_back(static_cast<float>(kSquare_m) * static_cast<float>(i % kColumns),
                          static_cast<float>(kSquare_m) * static_cast<float>(i / kColumns), 0.0F);
    }
    found.push_back(seen);
    known.push_back(points);
  }
  ASSERT_GE(found.size(), 8U);
  // Rms distance of a corner from where the lens puts it.
  const double rms_px = std::sqrt(squares / corners);
  RecordProperty("corner_rms_px", std::to_string(rms_px));
  EXPECT_LT(rms_px, 0.1);

  cv::Mat K;
  cv::Mat distortion;
  cv::Mat deviations;
  const double left_px =
      cv::calibrateCamera(known, found, {480, 360}, K, distortion, cv::noArray(), cv::noArray(),
                          deviations, cv::noArray(), cv::noArray(), cv::CALIB_FIX_K3);
  EXPECT_LT(left_px, 0.1);
  // Its own standard deviations are of independent errors; those of corners are not quite.
  const auto expect = [&](const char* what, double value, double truth, int index, double most) {
    const double deviation = deviations.at<double>(index);
    RecordProperty(what, std::to_string(value));
    EXPECT_NEAR(value, truth, std::max(4.0 * deviation, 1e-9)) << what;
    EXPECT_LT(deviation, most) << what;
  };
  expect("fx", K.at<double>(0, 0), 390.0, 0, 1.0);
  expect("fy", K.at<double>(1, 1), 390.0, 1, 1.0);
  expect("cx", K.at<double>(0, 2), 239.5 + 6.3, 2, 1.0);
  expect("cy", K.at<double>(1, 2), 179.5 - 4.1, 3, 1.0);
  expect("k1", distortion.at<double>(0), -0.12, 4, 0.005);
  expect("k2", distortion.at<double>(1), 0.04, 5, 0.03);
  expect("p1", distortion.at<double>(2), 0.0008, 6, 5e-4);
  expect("p2", distortion.at<double>(3), -0.0005, 7, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Samples, CameraCalibration, testing::Values(1, 25));

}  // namespace
}  // namespace rigwire::sim
