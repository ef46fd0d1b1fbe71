// What pictures cost and how wrong the cheap ones are: rays against bare Embree, samples against
// many, the lattice of the sky against rays that look for it, air, and the sensor's noise against
// its own figures.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"
#include "hil/world/simulated_world.h"
#include "sim/camera/camera_renderer.h"
#include "sim/camera/camera_sensor.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::bench {

/// A scene, its machine standing in it, seen from one place.
class CameraCase {
 public:
  /// The rig's scene and machine.
  CameraCase(std::string name, const hil::RigConfiguration& rig, const Eigen::Isometry3d& X_WS);
  /// The pit's terrain alone.
  CameraCase(std::string name, const Eigen::Isometry3d& X_WS);
  /// A mesh alone, with the look of a label where it has none of its own; W is its frame.
  CameraCase(std::string name, const sim::TriangleMesh& mesh, const std::string& label,
             const Eigen::Isometry3d& X_WS);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const sim::Scene& scene() const { return *built_.scene; }
  /// Returns the job of the whole sensor, in even daylight, the sun 40 degrees high.
  [[nodiscard]] sim::PictureJob job(const sim::CameraParameters& camera) const;
  /// Returns a shot of a camera of any kind in the same light: its image alone, of 12 bits.
  [[nodiscard]] sim::CameraShot shot(int width_px, int height_px) const;
  [[nodiscard]] const sim::SkyVisibility& sky() const { return sky_; }

 private:
  void place();

  std::string name_;
  hil::MachineInScene built_;
  Eigen::Isometry3d X_WS_;
  sim::Daylight light_;
  sim::SkyVisibility sky_;
};

/// The forest's track, leaf by leaf.
[[nodiscard]] CameraCase forest_case();

/// Excavator in the pit, forest track, the pit's terrain alone.
[[nodiscard]] std::vector<CameraCase> camera_cases();

/// A pinhole camera of that width, 4 : 3, 75 degrees across.
[[nodiscard]] sim::CameraParameters bench_camera(int width_px, int samples = 1, int sky_rays = 0);

struct PictureCost {
  std::string scene;
  int samples = 1;
  std::size_t pixels = 0;
  double shadow_share = 0.0;    ///< Rays towards the sun per ray of the camera,
  double doubtful_share = 0.0;  ///< and those of them that the picture casts, also per camera ray.
  double picture_s = 0.0;       ///< CPU time of the whole picture, sensor included; one thread.
  double bare_s = 0.0;          ///< CPU time of Embree's calls alone with the same rays.
  double doubtful_s = 0.0;      ///< bare_s without shadow rays that are certain to come through.
  double ratio = 0.0;           ///< Bare over picture, median of the rounds.
  double least_ratio = 0.0;
  double greatest_ratio = 0.0;
};

[[nodiscard]] PictureCost measure_picture(const CameraCase& scene, int width_px, int samples,
                                          int rounds);

/// How a pixel averages over its area.
struct SamplingWay {
  std::string name;
  int samples = 1;
  double edge_ratio = 0.0;
  double mtf = 1.0;
};
/// The first way is a ray through the middle of each pixel and nothing else.
[[nodiscard]] std::vector<SamplingWay> sampling_ways();

/// Rms difference of the scene's light, in grey levels of 8 bits when the mean is at 100, from a
/// picture of `reference_samples` behind the same lens; and CPU time, one thread, relative to that
/// of the first way, the minimum of `rounds` in turns.
struct SamplingError {
  std::string scene;
  std::string way;
  double rms_levels = 0.0;
  double cost = 0.0;
};

[[nodiscard]] std::vector<SamplingError> measure_sampling(const CameraCase& scene, int width_px,
                                                          const std::vector<SamplingWay>& ways,
                                                          int reference_samples, int rounds);

/// Ways to know how much of the sky is seen, against many rays.
struct SkyCost {
  std::string scene;
  int sky_rays = 0;  ///< 0: the lattice; -1: all of it, everywhere.
  double pixel_ns = 0.0;
  double rms_levels = 0.0;
  double bias_levels = 0.0;
};

[[nodiscard]] std::vector<SkyCost> measure_sky(const CameraCase& scene, int width_px,
                                               const std::vector<int>& sky_rays, int reference);

/// What air costs each pixel above clear air.
struct AirCost {
  std::string medium;
  double pixel_ns = 0.0;
  double above_clear_ns = 0.0;
};

[[nodiscard]] std::vector<AirCost> measure_air(const CameraCase& scene, int width_px);

/// Cost of a surface's own texture in a picture, compared with its label's material.
struct TextureCost {
  std::string view;
  std::string surface;
  double pixel_ns = 0.0;    ///< CPU time; one thread.
  double ratio = 0.0;       ///< Time over that of the label's material, both minimum of rounds.
  double rms_levels = 0.0;  ///< RMS difference of one sample against many, as in SamplingError.
};

/// Measures a wall that fills the picture: seen straight on, where texels are wider than pixels;
/// from far, where they are narrower; and with its surface slanting away to 80 degrees and more.
[[nodiscard]] std::vector<TextureCost> measure_textures(int width_px, int rounds,
                                                        int reference_samples);

/// A figure of the sensor as set and as a photon transfer measurement finds it (EMVA 1288).
struct SensorFigure {
  std::string figure;
  double set = 0.0;
  double found = 0.0;
};

[[nodiscard]] std::vector<SensorFigure> measure_sensor();

}  // namespace rigwire::bench
