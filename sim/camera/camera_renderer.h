// Pictures of a scene, ray by ray.
//
// Each pixel's rays are cast along the lens's directions, from where the camera is at that pixel's
// own instant: rows start one after the other (rolling shutter) or together; several samples are
// spread over the exposure and over the pixel's area. No image is warped. Each hit point is lit by
// the sun, with its shadow, and by the sky (shading_lanes.h), and is seen through the air
// (camera_air.h); the sensor turns its luminance into numbers (image_sensor.h).
//
// A picture depends on its job, on the scene in its present slice, and on the renderer's
// parameters, seed and name alone: not on pictures before, on threads, or on tiles.
//
// Embree 3.13.5 can loop for ever in packets of shadow rays that are marked coherent, in scenes of
// meshes and instances; so they are marked incoherent here (a test holds that they come back).
//
// Errors. Pose within the exposure: by the motion at its middle, (w t / 2)^2 / 2 rad for w rad/s
// and t s, 1e-5 rad at 1 rad/s and 10 ms; moving bodies as Scene has them. Directions of several
// samples: pixel_rays.h. Speed, and rms error of one sample against 64: `rigwire bench camera`.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/camera/camera_air.h"
#include "sim/camera/camera_parameters.h"
#include "sim/camera/daylight.h"
#include "sim/camera/sky_visibility.h"
#include "sim/link_motion.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// The camera's mount frame S (x forward along the optical axis, y left, z up) at an instant.
struct CameraPose {
  SimTime time{};
  LinkMotion mount;
};

/// One picture to take.
struct PictureJob {
  ReadOut read_out;
  SimTime exposure_start{};  ///< Start of exposure of the region's first row.
  /// In order of time, at least two; they, and the scene's slice, span the exposure of all rows.
  std::vector<CameraPose> poses;
  std::uint32_t mask = Scene::kSeeEverything;  ///< Mask of the camera's rays; shadows ignore it.
  const Daylight* light = nullptr;             ///< Must not be null.
  const CameraAir* air = nullptr;              ///< Null: clear.
  const SkyVisibility* sky = nullptr;          ///< Null: all of the sky, everywhere.
  double wetness = 0.0;                        ///< Wetness of the ground, 0 .. 1 (wetness_of()).
  bool truth = false;  ///< Range, depth and instance of each pixel's middle, too.
};

/// From the first row's start to the end of the last one's exposure.
[[nodiscard]] Duration exposure_span(const PictureJob& job, const ImageSensorParameters& sensor);

struct RenderedPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> numbers;  ///< Row by row, of the job's bits.
  /// Luminance of the scene at each pixel, red, green and blue, cd/m2, without the effects of
  /// sensor and vignetting.
  std::vector<float> luminance;
  double mean = 0.0;  ///< Mean of `numbers` above the black level, share of full scale.

  // Truth at each pixel's middle, at the middle of its exposure; empty unless asked for.
  std::vector<float> range_m;           ///< Along the ray; 0: nothing.
  std::vector<float> depth_m;           ///< Along the optical axis, z in the lens's frame C.
  std::vector<std::uint32_t> instance;  ///< Scene::InstanceId; ~0: none.
};

/// Hits of several rays per pixel: pixel by pixel, the rays of a pixel one after the other.
struct PictureRays {
  int width = 0;
  int height = 0;
  int rays = 0;                    ///< Per pixel: a square number.
  std::vector<float> range_m;      ///< 0: nothing.
  std::vector<float> cosine;       ///< Cosine of the angle of incidence, 0 .. 1.
  std::vector<float> reflectance;  ///< Diffuse, at the lidar's wavelength.
  std::vector<float> depth;        ///< Optical depth of the air on the way; empty: clear.
};

/// Selects rays towards the sun: all, or only those that something may block (shadow_ceiling.h). A
/// picture casts only the latter.
enum class ShadowRays { all, doubtful };

/// All rays of a picture, primary and towards the sun, to be cast bare: for benchmarks.
class RecordedPictureRays {
 public:
  RecordedPictureRays();
  ~RecordedPictureRays();
  RecordedPictureRays(RecordedPictureRays&&) noexcept;
  RecordedPictureRays& operator=(RecordedPictureRays&&) noexcept;

  [[nodiscard]] std::size_t primary_rays() const;
  [[nodiscard]] std::size_t shadow_rays(ShadowRays which = ShadowRays::all) const;
  /// Makes the rays as new. Must be called before every cast_bare().
  void reset();
  /// Nothing but the ray caster's own calls, on one thread, in the order and packets of the camera.
  void cast_bare(const Scene& scene, ShadowRays which = ShadowRays::all);

 private:
  friend class CameraRenderer;
  struct Packets;
  std::unique_ptr<Packets> packets_;
};

class CameraRenderer {
 public:
  /// Throws std::invalid_argument for parameters, or a lens and a sensor, that do not go together.
  CameraRenderer(const CameraParameters& parameters, std::uint64_t seed, std::string_view name);
  ~CameraRenderer();
  CameraRenderer(const CameraRenderer&) = delete;
  CameraRenderer& operator=(const CameraRenderer&) = delete;

  /// The scene must be ready for a slice that spans the exposure, and must not change meanwhile.
  /// One call at a time. Memory of `picture` is used again. Throws std::invalid_argument for a job
  /// that does not fit: read-out, poses that are not finite or do not span the exposure, no light.
  void render(const Scene& scene, const PictureJob& job, RenderedPicture& picture);

  /// Writes only size, range, depth and instance to `picture`, equal to render()'s with
  /// `job.truth`.
  void measure(const Scene& scene, const PictureJob& job, RenderedPicture& picture);

  /// A lattice of so many by so many rays in each pixel, spread over the exposure as render()'s
  /// samples are; 1: through its middle. Errors as render()'s.
  void cast(const Scene& scene, const PictureJob& job, int rays_across, PictureRays& found);

  /// The rays that render() would cast.
  [[nodiscard]] RecordedPictureRays record(const Scene& scene, const PictureJob& job);

  [[nodiscard]] const CameraParameters& parameters() const;
  [[nodiscard]] const Lens& lens() const;
  [[nodiscard]] const ImageSensor& sensor() const;

 private:
  struct Internals;
  std::unique_ptr<Internals> internals_;
};

/// Mount frame S from the lens's frame C: x_S = z_C, y_S = -x_C, z_S = -y_C.
[[nodiscard]] Eigen::Vector3d lens_to_mount(const Eigen::Vector3d& v_C);
[[nodiscard]] Eigen::Vector3d mount_to_lens(const Eigen::Vector3d& v_S);

}  // namespace rigwire::sim
