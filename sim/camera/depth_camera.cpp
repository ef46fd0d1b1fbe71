#include "sim/camera/depth_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"
#include "sim/lidar/counter_noise.h"
#include "sim/random.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr double kGreatestValue = 65535.0;
constexpr std::string_view kKind = "depth camera";
/// Nearer than this own light is as bright as there.
constexpr float kNearest_m = 0.01F;

DepthCameraParameters valid(const DepthCameraParameters& parameters) {
  validate(parameters);
  return parameters;
}

/// A standard normal number of (key, counter).
double gaussian(std::uint64_t key, std::uint64_t counter) {
  const double q = counter_uniform(key, counter) - 0.5;
  if (std::abs(q) <= kCentralHalfWidth) {
    return central_normal_quantile<double>(q);
  }
  const double root = std::sqrt(-std::log(0.5 - std::abs(q)));
  return std::copysign(outer_normal_quantile<double>(root), q);
}

class DepthCamera final : public CameraSensor {
 public:
  DepthCamera(const DepthCameraParameters& parameters, std::uint64_t seed, std::string_view name)
      : parameters_(valid(parameters)),
        renderer_(parameters.camera, seed, name),
        noise_key_(RandomStream(seed, std::string(name) + "/range").bits()) {
    // Range along the axis, for each unit along the ray.
    const ImageSensorParameters& sensor = parameters.camera.sensor;
    for (int row = 0; row < sensor.height_px; ++row) {
      for (int column = 0; column < sensor.width_px; ++column) {
        const auto direction = renderer_.lens().direction(Eigen::Vector2d(column, row));
        along_axis_.push_back(direction ? static_cast<float>(direction->z()) : 0.0F);
        falloff_.push_back(direction ? static_cast<float>(renderer_.lens().falloff(*direction))
                                     : 0.0F);
      }
    }
  }

  [[nodiscard]] Duration span(const CameraCommand& command, Duration exposure) const override {
    return whole_span(command, exposure, parameters_.camera.sensor);
  }

  [[nodiscard]] Taken take(const Scene& scene, const CameraShot& shot,
                           CameraTruth* truth) override {
    const CameraCommand& command = shot.command;
    const ImageSensorParameters& sensor = parameters_.camera.sensor;
    require_fits(command, kKind, kDepthParts, sensor_formats(false));
    require_region(command, kKind, sensor.width_px, sensor.height_px);
    PictureJob job = job_of(shot, whole_read_out(shot, sensor));
    job.truth = truth != nullptr;
    renderer_.render(scene, job, rendered_);
    renderer_.cast(scene, job, parameters_.rays_across, rays_);
    add_up(shot.exposure);
    const double mean = expose(job);
    measure(shot);

    Picture picture = empty_picture(shot);
    const auto add = [&](PictureComponent component, PixelFormat format,
                         std::span<const std::uint8_t> bytes) {
      add_part(picture, component, format, command.region, bytes, sensor.width_px);
    };
    if (command.intensity) {
      pack_numbers(numbers_, job.read_out.bits, packed_);
      add(PictureComponent::intensity, command.format, packed_);
    }
    if (command.range) {
      packed_.resize(2 * values_.size());
      for (std::size_t i = 0; i < values_.size(); ++i) {
        put_16(values_[i], packed_.data() + 2 * i);
      }
      add(PictureComponent::range, PixelFormat::coord3d_c16, packed_);
    }
    if (command.confidence) {
      add(PictureComponent::confidence, PixelFormat::confidence8, confidence_);
    }
    if (truth != nullptr) {
      *truth = crop(rendered_, command.region);
    }
    return {std::make_shared<const Picture>(std::move(picture)), mean};
  }

 private:
  /// Own light as a pixel sees it.
  struct Echo {
    float strength = 0.0F;  ///< S, length of the vector sum.
    float sum = 0.0F;       ///< Sum of the strengths: what the image sees.
    float range_m = 0.0F;
  };

  void add_up(Duration exposure) {
    const DepthCameraParameters& p = parameters_;
    const auto pixels =
        static_cast<std::size_t>(rays_.width) * static_cast<std::size_t>(rays_.height);
    const auto rays = static_cast<std::size_t>(rays_.rays);
    echoes_.resize(pixels);
    const double longer = to_seconds(exposure) / to_seconds(p.noise_exposure);
    const auto reference =
        static_cast<float>(longer * p.noise_distance_m * p.noise_distance_m / p.noise_reflectance);
    // A turn of the phase is the range without ambiguity.
    const auto wave_pm = static_cast<float>(2.0 * std::numbers::pi / p.unambiguous_m);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      const std::size_t first = pixel * rays;
      float cosine = 0.0F;
      float sine = 0.0F;
      Echo& echo = echoes_[pixel];
      echo = {};
      // Phases are relative to the first echo's, so that equal ones add up without rounding.
      float from_m = 0.0F;
      for (std::size_t at = first; at < first + rays; ++at) {
        const float range_m = rays_.range_m[at];
        if (range_m <= 0.0F) {
          continue;
        }
        const float near_m = std::max(range_m, kNearest_m);
        float strength = reference * rays_.reflectance[at] * rays_.cosine[at] / (near_m * near_m) *
                         falloff_[pixel] / static_cast<float>(rays);
        if (!rays_.depth.empty()) {
          strength *= std::exp(-2.0F * rays_.depth[at]);  // There and back.
        }
        from_m = echo.sum == 0.0F ? range_m : from_m;
        cosine += strength * std::cos(wave_pm * (range_m - from_m));
        sine += strength * std::sin(wave_pm * (range_m - from_m));
        echo.sum += strength;
      }
      echo.strength = std::hypot(cosine, sine);
      echo.range_m = from_m + std::atan2(sine, cosine) / wave_pm;
    }
  }

  /// The image: own light and a share of the day's on the sensor. Mean share of full scale.
  double expose(const PictureJob& job) {
    const DepthCameraParameters& p = parameters_;
    const auto day = static_cast<float>(p.daylight_share);
    // Strengths grow with the exposure; the sensor multiplies by it once more.
    const double longer = to_seconds(job.read_out.exposure) / to_seconds(p.noise_exposure);
    const auto own = static_cast<float>(p.own_luminance_cd / longer);
    luminance_.resize(rendered_.luminance.size());
    for (std::size_t i = 0; i < echoes_.size(); ++i) {
      // The echo has passed the lens once already.
      const float through = falloff_[i] > 0.0F ? 1.0F / falloff_[i] : 0.0F;
      for (std::size_t band = 0; band < 3; ++band) {
        luminance_[3 * i + band] =
            own * echoes_[i].sum * through + day * rendered_.luminance[3 * i + band];
      }
    }
    std::array<float, 3> haze{};
    for (int band = 0; band < 3; ++band) {
      haze[static_cast<std::size_t>(band)] =
          day * job.light->total_lx()[band] * std::numbers::inv_pi_v<float>;
    }
    numbers_.resize(echoes_.size());
    renderer_.sensor().expose(luminance_, falloff_, haze, job.read_out, 0, rays_.height, numbers_);
    return mean_share(numbers_, job.read_out);
  }

  void measure(const CameraShot& shot) {
    const DepthCameraParameters& p = parameters_;
    const ImageSensor& sensor = renderer_.sensor();
    const std::uint64_t key = counter_bits(noise_key_, shot.frame);
    const double full = sensor.parameters().full_well / sensor.electrons(1.0, shot.exposure);
    values_.assign(echoes_.size(), 0);
    confidence_.assign(echoes_.size(), 0);
    for (std::size_t i = 0; i < echoes_.size(); ++i) {
      const Echo& echo = echoes_[i];
      if (!(echo.strength > 0.0F)) {
        continue;
      }
      const float* const light = rendered_.luminance.data() + 3 * i;
      const double day_cd =
          static_cast<double>((light[0] + light[1] + light[2]) * (1.0F / 3.0F) * falloff_[i]);
      const double noise_m =
          range_noise_m(p, static_cast<double>(echo.strength), day_cd, shot.exposure);
      const double lit_cd = static_cast<double>(luminance_[3 * i] * falloff_[i]);
      double range_m = static_cast<double>(echo.range_m);
      range_m += noise_m * gaussian(key, i) +
                 p.cyclic_error_m * std::sin(2.0 * std::numbers::pi * range_m / p.cycle_m);
      // Beyond the range without ambiguity the phase begins again.
      range_m -= p.unambiguous_m * std::floor(range_m / p.unambiguous_m);
      if (noise_m > p.greatest_noise_m || lit_cd >= full || range_m < p.nearest_m ||
          range_m > p.farthest_m) {
        continue;
      }
      const double steps = range_m * static_cast<double>(along_axis_[i]) / p.step_m;
      values_[i] = static_cast<std::uint16_t>(std::clamp(std::round(steps), 0.0, kGreatestValue));
      confidence_[i] = values_[i] == 0 ? std::uint8_t{0}
                                       : static_cast<std::uint8_t>(std::lround(
                                             255.0 * (1.0 - noise_m / p.greatest_noise_m)));
    }
  }

  DepthCameraParameters parameters_;
  CameraRenderer renderer_;
  std::uint64_t noise_key_;
  std::vector<float> along_axis_;
  std::vector<float> falloff_;

  // Working memory of one shot, used again.
  RenderedPicture rendered_;
  PictureRays rays_;
  std::vector<Echo> echoes_;
  std::vector<float> luminance_;
  std::vector<std::uint16_t> numbers_;
  std::vector<std::uint16_t> values_;
  std::vector<std::uint8_t> confidence_;
  std::vector<std::uint8_t> packed_;
};

}  // namespace

CameraParameters DepthCameraParameters::optics() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 480;
  p.sensor.pixel_pitch_m = 1e-5;
  p.lens.focal_length_m = 0.00483;
  p.lens.f_number = 1.4;
  return p;
}

void visit(fields::Visitor& v, DepthCameraParameters& p) {
  visit(v, p.camera);
  v.integer("rays_across", p.rays_across, IntegerRule{1, 8},
            "Rays across a pixel, and as many down, that its range comes from.");
  v.number("nearest", p.nearest_m, in("m").between(0, 100), "Nearer there is no range.");
  v.number("farthest", p.farthest_m, in("m").between(0.1, 1000), "Farther there is no range.");
  v.number("unambiguous", p.unambiguous_m, in("m").between(0.1, 10000),
           "Distances beyond fold back by this much.");
  v.number("step", p.step_m, in("mm").between(0.01, 100), "Step in which a range is coded.");
  v.number("noise", p.noise_m, in("mm").between(0, 1000),
           "Standard deviation of the range of the reference surface, in the dark.");
  v.number("noise_distance", p.noise_distance_m, in("m").between(0.1, 1000),
           "Distance of the reference surface.");
  v.number("noise_reflectance", p.noise_reflectance, in("%").above(0).at_most(100),
           "Reflectance of the reference surface.");
  v.duration("noise_exposure", p.noise_exposure, {1'000, 1'000'000'000},
             "Exposure with which the reference is seen.");
  v.number("noise_floor", p.noise_floor_m, in("mm").between(0, 1000),
           "Standard deviation that is left at all distances.");
  v.number("greatest_noise", p.greatest_noise_m, in("mm").between(0.01, 10000),
           "Standard deviation above which there is no range.");
  v.number("doubling_luminance", p.doubling_luminance_cd, plain().between(1e-3, 1e9),
           "Luminance in daylight, cd/m2, that doubles the variance at the reference exposure.");
  v.number("cyclic_error", p.cyclic_error_m, in("mm").between(0, 1000),
           "Amplitude of the error that repeats with distance.");
  v.number("cycle", p.cycle_m, in("m").between(0.001, 1000), "Distance after which it repeats.");
  v.number("own_luminance", p.own_luminance_cd, plain().between(0, 1e9),
           "Luminance of the reference surface in the camera's own light, cd/m2, in the image.");
  v.number("daylight_share", p.daylight_share, in("%").between(0, 100),
           "Share of the light of day that comes through the filter into the image.");
}

void validate(const DepthCameraParameters& p) {
  fields::check(p);
  validate(p.camera);
  fields::require(!p.camera.sensor.colour, "image_sensor.colour", "true",
                  "false: it sees its own light");
  const LensParameters& lens = p.camera.lens;
  fields::require(lens.model == LensModel::brown_conrady, "lens.model", "another",
                  "brown_conrady: a pinhole camera is reported");
  for (const auto& [key, value] : {std::pair{"lens.k1", lens.k1},
                                   {"lens.k2", lens.k2},
                                   {"lens.p1", lens.p1},
                                   {"lens.p2", lens.p2},
                                   {"lens.k3", lens.k3}}) {
    fields::require(value == 0.0, key, plain().print(value), "0: a pinhole camera is reported");
  }
  fields::require(p.nearest_m < p.farthest_m, "nearest", in("m").print(p.nearest_m),
                  "below farthest, " + in("m").print(p.farthest_m));
  fields::require(p.farthest_m <= p.unambiguous_m, "farthest", in("m").print(p.farthest_m),
                  "up to unambiguous, " + in("m").print(p.unambiguous_m));
  fields::require(p.farthest_m <= kGreatestValue * p.step_m, "farthest",
                  in("m").print(p.farthest_m),
                  "up to 65535 steps, " + in("m").print(kGreatestValue * p.step_m));
  fields::require(p.noise_floor_m < p.greatest_noise_m, "noise_floor",
                  in("mm").print(p.noise_floor_m),
                  "below greatest_noise, " + in("mm").print(p.greatest_noise_m));
}

ReportedGeometry depth_geometry(const DepthCameraParameters& p) {
  const Lens lens(p.camera.lens, p.camera.sensor.pixel_pitch_m, p.camera.sensor.width_px,
                  p.camera.sensor.height_px);
  ReportedGeometry geometry;
  geometry.focal_length_px = lens.focal_length_px();
  geometry.principal_u_px = lens.principal_point_px().x();
  geometry.principal_v_px = lens.principal_point_px().y();
  geometry.coding = {p.step_m, 0.0, 0};
  return geometry;
}

double range_noise_m(const DepthCameraParameters& p, double strength, double luminance_cd,
                     Duration exposure) {
  // sigma^2 = floor^2 + (sigma0 / S)^2 (1 + L / L2 t / t0).
  const double longer = to_seconds(exposure) / to_seconds(p.noise_exposure);
  const double variance = (1.0 + luminance_cd / p.doubling_luminance_cd * longer) /
                          (strength * strength) * p.noise_m * p.noise_m;
  return std::sqrt(p.noise_floor_m * p.noise_floor_m + variance);
}

std::unique_ptr<CameraSensor> make_depth_camera(const DepthCameraParameters& parameters,
                                                std::uint64_t seed, std::string_view name) {
  return std::make_unique<DepthCamera>(parameters, seed, name);
}

}  // namespace rigwire::sim
