// Shots of a scene for cameras of any kind, and what their pictures hold.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "camera_site.h"
#include "sim/camera/camera_sensor.h"
#include "sim/random.h"

namespace rigwire::sim::camera_test {

/// Shot of the whole picture, in the slice from 0 to 100 ms, in the middle of the day.
inline CameraShot shot_for(int width, int height, const Eigen::Isometry3d& X_WS,
                           const Daylight& light) {
  CameraShot shot;
  shot.command.format = PixelFormat::mono8;
  shot.command.region = {0, 0, width, height};
  shot.exposure = 1ms;
  shot.start = kStart + 10ms;
  shot.poses = poses(X_WS, kStart, kStart + 100ms);
  shot.light = &light;
  return shot;
}

/// What a shot is refused with; empty: it is not.
inline std::string refused(CameraSensor& camera, const Scene& scene, const CameraShot& shot) {
  try {
    (void)camera.take(scene, shot, nullptr);
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
  return "";
}

inline const PicturePart& part_of(const Picture& picture, PictureComponent component,
                                  std::uint8_t source = 0) {
  for (const PicturePart& part : picture.parts) {
    if (part.component == component && part.source == source) {
      return part;
    }
  }
  throw std::out_of_range("the picture has no such part");
}

/// A number of a part, of one or two bytes.
inline int number_at(const PicturePart& part, int x, int y) {
  const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(part.region.width) +
                         static_cast<std::size_t>(x);
  return bytes_per_pixel(part.format) == 2 ? part.bytes[2 * at] | part.bytes[2 * at + 1] << 8
                                           : part.bytes[at];
}

inline double truth_at(const std::vector<float>& plane, const CameraTruth& truth, int x, int y) {
  return static_cast<double>(
      plane[static_cast<std::size_t>(y) * static_cast<std::size_t>(truth.width) +
            static_cast<std::size_t>(x)]);
}

/// Parts of both are the same bytes.
inline bool same_bytes(const Picture& a, const Picture& b) {
  return std::ranges::equal(a.parts, b.parts, [](const PicturePart& p, const PicturePart& q) {
    return p.component == q.component && p.source == q.source && p.format == q.format &&
           p.region == q.region && p.bytes == q.bytes;
  });
}

/// Ground of gravel with rocks on it, a dark wall behind.
struct StonySite {
  StonySite() {
    scene.add_terrain(level_ground(), surface("ground"));
    RandomStream random(3, "rocks");
    const auto rock = scene.add_mesh(make_rock("rock", random));
    for (int i = 0; i < 60; ++i) {
      scene.add_object(
          rock,
          at(random.uniform(3.0, 20.0), random.uniform(-10.0, 10.0), 0.0, random.uniform(0.0, 6.0)),
          random.uniform(0.2, 0.8), surface("rock"));
    }
    const auto wall = scene.add_mesh(make_box("wall", {0.5, 60.0, 12.0}));
    scene.add_object(wall, at(24.0, 0.0, 6.0), 1.0, surface("rock"));
    ready(scene);
  }
  Scene scene;
};

}  // namespace rigwire::sim::camera_test
