#include "bench/camera_kinds_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "fields/constants.h"
#include "hil/executive/cpu_time.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kCameraKindsSeed = 1;
constexpr double kCameraKindsMeanLevel = 100.0;

/// CPU seconds of this thread, minimum of several runs.
template <class Work>
double least_of_rounds(int rounds, const Work& work) {
  double least_s = std::numeric_limits<double>::infinity();
  for (int i = 0; i < rounds; ++i) {
    const double before_s = hil::thread_cpu_seconds();
    work();
    least_s = std::min(least_s, hil::thread_cpu_seconds() - before_s);
  }
  return least_s;
}

double median(std::vector<double>& values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Numbers of an image of 12 bits.
std::vector<double> numbers_of(const Picture& picture) {
  const std::vector<std::uint8_t>& bytes = picture.parts.front().bytes;
  std::vector<double> numbers(bytes.size() / 2);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = bytes[2 * i] + 256.0 * bytes[2 * i + 1];
  }
  return numbers;
}

/// Returns a shot of both heads' pictures.
sim::CameraShot stereo_shot(const CameraCase& scene,
                            const sim::StereoCameraParameters& parameters) {
  const sim::ImageSensorParameters& sensor = parameters.camera.sensor;
  sim::CameraShot shot = scene.shot(sensor.width_px, sensor.height_px);
  shot.command.format = PixelFormat::mono8;
  shot.command.intensity_right = true;
  return shot;
}

/// Calls `work(pixel, true depth, true disparity)` for the pixels whose disparity the search can
/// find: the columns on the left have nothing to be searched in.
template <class Work>
void each_searched(const sim::CameraTruth& truth, const sim::StereoCameraParameters& parameters,
                   const Work& work) {
  const sim::ReportedGeometry geometry = stereo_geometry(parameters);
  const double focal_baseline = geometry.focal_length_px * geometry.baseline_m;
  const int searched = parameters.matching.least_disparity + parameters.matching.disparities;
  for (std::size_t i = 0; i < truth.depth_m.size(); ++i) {
    const auto depth_m = static_cast<double>(truth.depth_m[i]);
    const double disparity_px = focal_baseline / depth_m;
    if (depth_m > 0.0 && disparity_px < searched - 1 &&
        static_cast<int>(i % static_cast<std::size_t>(truth.width)) >= searched) {
      work(i, depth_m, disparity_px);
    }
  }
}

DepthBand band_of(const sim::DisparityPicture& found, const sim::CameraTruth& truth,
                  const sim::StereoCameraParameters& parameters, double from_m, double to_m) {
  DepthBand band{.from_m = from_m, .to_m = to_m};
  std::vector<double> errors_px;
  std::vector<double> errors_m;
  std::vector<double> depths_m;
  double bad = 0.0;
  each_searched(truth, parameters, [&](std::size_t i, double depth_m, double disparity_px) {
    if (!(depth_m > from_m) || depth_m > to_m) {
      return;
    }
    depths_m.push_back(depth_m);
    const auto matched_px = static_cast<double>(found.disparity_px[i]);
    if (matched_px <= 0.0) {
      return;
    }
    errors_px.push_back(std::abs(matched_px - disparity_px));
    errors_m.push_back(std::abs(depth_m * disparity_px / matched_px - depth_m));
    bad += errors_px.back() > 1.0 ? 1.0 : 0.0;
  });
  const auto count = static_cast<double>(errors_px.size());
  band.density = count / static_cast<double>(depths_m.size());
  band.bad1 = bad / count;
  band.median_px = median(errors_px);
  band.median_m = median(errors_m);
  band.median_depth_m = median(depths_m);
  return band;
}

ConfidenceWorth worth_of(const sim::DisparityPicture& found, const sim::CameraTruth& truth,
                         const sim::StereoCameraParameters& parameters) {
  constexpr std::size_t kSure = 128;
  // By confidence: disparities that are right, and wrong.
  std::array<double, 256> right{};
  std::array<double, 256> wrong{};
  double pixels = 0.0;
  std::vector<double> sure_errors_px;
  each_searched(truth, parameters, [&](std::size_t i, double, double disparity_px) {
    pixels += 1.0;
    const auto matched_px = static_cast<double>(found.disparity_px[i]);
    if (matched_px <= 0.0) {
      return;
    }
    const double error_px = std::abs(matched_px - disparity_px);
    (error_px > 1.0 ? wrong : right)[found.confidence[i]] += 1.0;
    if (found.confidence[i] >= kSure) {
      sure_errors_px.push_back(error_px);
    }
  });
  double below = 0.0;  // wrong ones of less confidence
  double pairs = 0.0;
  double all_right = 0.0;
  std::array<double, 2> sure{};
  for (std::size_t c = 0; c < right.size(); ++c) {
    pairs += right[c] * (below + 0.5 * wrong[c]);
    below += wrong[c];
    all_right += right[c];
    if (c >= kSure) {
      sure[0] += right[c];
      sure[1] += wrong[c];
    }
  }
  return {(sure[0] + sure[1]) / pixels, sure[1] / (sure[0] + sure[1]), median(sure_errors_px),
          pairs / (all_right * below)};
}

}  // namespace

StereoCost measure_matcher(const CameraCase& scene, const std::string& name,
                           sim::StereoMatcher& matcher,
                           const sim::StereoMatchingParameters& searched, int rounds) {
  sim::StereoCameraParameters parameters;
  parameters.matching = searched;
  const auto camera = make_stereo_camera(parameters, kCameraKindsSeed, "bench");
  sim::CameraShot shot = stereo_shot(scene, parameters);
  sim::CameraTruth left;
  const auto heads = camera->take(scene.scene(), shot, &left).picture;

  // Depths as the right head has them, for the matcher that wants them.
  shot.command.intensity = false;
  sim::CameraTruth right;
  (void)camera->take(scene.scene(), shot, &right);
  const sim::ReportedGeometry geometry = stereo_geometry(parameters);
  sim::StereoPair pair;
  pair.width = parameters.camera.sensor.width_px;
  pair.height = parameters.camera.sensor.height_px;
  pair.left = heads->parts[0].bytes;
  pair.right = heads->parts[1].bytes;
  pair.left_depth_m = left.depth_m;
  pair.right_depth_m = right.depth_m;
  pair.focal_baseline_px_m = geometry.focal_length_px * geometry.baseline_m;
  sim::DisparityPicture found;

  StereoCost cost;
  cost.scene = scene.name();
  cost.matcher = name;
  cost.disparity_s = least_of_rounds(rounds, [&] { matcher.match(pair, false, found); });
  const double both_s = least_of_rounds(rounds, [&] { matcher.match(pair, true, found); });
  cost.confidence_s = std::max(0.0, both_s - cost.disparity_s);
  cost.take_s = std::numeric_limits<double>::quiet_NaN();
  cost.all = band_of(found, left, parameters, 0.0, 1000.0);
  cost.sure = worth_of(found, left, parameters);
  for (const auto& [from_m, to_m] :
       {std::pair{2.0, 5.0}, {5.0, 10.0}, {10.0, 20.0}, {20.0, 40.0}}) {
    cost.bands.push_back(band_of(found, left, parameters, from_m, to_m));
  }
  return cost;
}

StereoCost measure_stereo(const CameraCase& scene, const std::string& name,
                          const sim::StereoMatchingParameters& matching, int rounds) {
  StereoCost cost =
      measure_matcher(scene, name, *sim::make_stereo_matcher(matching), matching, rounds);
  sim::StereoCameraParameters parameters;
  parameters.matching = matching;
  const auto camera = make_stereo_camera(parameters, kCameraKindsSeed, "bench");
  sim::CameraShot shot = stereo_shot(scene, parameters);
  shot.command.disparity = true;
  cost.take_s = least_of_rounds(rounds, [&] { (void)camera->take(scene.scene(), shot, nullptr); });
  return cost;
}

std::vector<AllRoundCost> measure_all_round(const CameraCase& scene, int reference_samples,
                                            int rounds) {
  struct Way {
    const char* name;
    sim::AllRoundMethod method;
    int views;
    int view_width_px;
    int view_height_px;
    int samples;
  };
  // Views have as many pixels as the ray picture has in the middle of each.
  using Method = sim::AllRoundMethod;
  const std::array ways{Way{"rays", Method::rays, 3, 640, 744, 1},
                        Way{"rays", Method::rays, 3, 640, 744, 4},
                        Way{"3 views of 640", Method::views, 3, 640, 744, 1},
                        Way{"3 views of 640", Method::views, 3, 640, 744, 4},
                        Way{"4 views of 328", Method::views, 4, 328, 464, 1},
                        Way{"4 views of 328", Method::views, 4, 328, 464, 4}};
  sim::AllRoundCameraParameters parameters;
  const sim::CameraShot shot = scene.shot(parameters.width_px, parameters.height_px);
  parameters.camera.samples = reference_samples;
  parameters.camera.sensor.read_noise = 0.0;
  const std::vector<double> reference =
      numbers_of(*make_all_round_camera(parameters, kCameraKindsSeed + 1, "reference")
                      ->take(scene.scene(), shot, nullptr)
                      .picture);
  double sum = 0.0;
  for (const double number : reference) {
    sum += number;
  }
  const double scale = kCameraKindsMeanLevel * static_cast<double>(reference.size()) / sum;

  std::vector<AllRoundCost> costs;
  for (const Way& way : ways) {
    parameters = {};
    parameters.method = way.method;
    parameters.views = way.views;
    parameters.camera.samples = way.samples;
    parameters.camera.sensor.width_px = way.view_width_px;
    parameters.camera.sensor.height_px = way.view_height_px;
    const auto camera = make_all_round_camera(parameters, kCameraKindsSeed, "bench");
    AllRoundCost cost;
    cost.scene = scene.name();
    cost.way = way.name;
    cost.samples = way.samples;
    std::vector<double> numbers;
    cost.picture_s = least_of_rounds(
        rounds, [&] { numbers = numbers_of(*camera->take(scene.scene(), shot, nullptr).picture); });
    const std::size_t pixels =
        way.method == Method::rays
            ? numbers.size()
            : static_cast<std::size_t>(way.views * way.view_width_px * way.view_height_px);
    cost.rays = pixels * static_cast<std::size_t>(way.samples);
    double count = 0.0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      // Where no view looks it is black; daylight leaves no pixel so.
      if (numbers[i] == 0.0) {
        continue;
      }
      const double difference = scale * (numbers[i] - reference[i]);
      count += 1.0;
      cost.bias_levels += difference;
      cost.rms_levels += difference * difference;
    }
    cost.seen = count / static_cast<double>(numbers.size());
    cost.bias_levels /= count;
    cost.rms_levels = std::sqrt(cost.rms_levels / count);
    costs.push_back(cost);
  }
  return costs;
}

std::vector<RangeNoise> measure_range_noise() {
  sim::DepthCameraParameters parameters;
  parameters.cyclic_error_m = 0.0;
  parameters.camera.sensor.width_px = 160;
  parameters.camera.sensor.height_px = 120;
  parameters.camera.lens.vignetting = 0.0;
  // Narrow, so that all of the wall is seen straight on.
  parameters.camera.lens.focal_length_m = 5000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, kCameraKindsSeed, "bench");
  const sim::Daylight night({}, {0.0, 0.0, -1.0});
  const sim::Daylight noon({}, {-std::cos(50.0 * kDegree), 0.0, std::sin(50.0 * kDegree)});

  struct Case {
    const char* surface;
    double reflectance;
    double distance_m;
    bool sunlit;
  };
  std::vector<Case> cases;
  for (const double distance_m : {1.0, 2.0, 4.0, 5.5, 8.0}) {
    cases.push_back({"white, dark", 0.9, distance_m, false});
  }
  for (const double distance_m : {2.0, 4.0, 8.0}) {
    cases.push_back({"soil, dark", 0.2, distance_m, false});
  }
  for (const double distance_m : {1.0, 2.0, 4.0, 8.0}) {
    cases.push_back({"soil, sunlit", 0.2, distance_m, true});
  }
  std::vector<RangeNoise> noises;
  for (const Case& c : cases) {
    sim::Scene scene;
    const auto mesh = scene.add_mesh(sim::make_box("wall", {0.2, 80.0, 80.0}));
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation().x() = c.distance_m + 0.1;
    sim::Material material;
    material.reflectance = c.reflectance;
    material.label = "wall";
    scene.add_object(mesh, X, 1.0, material);
    scene.begin_slice(kStart, kStart + 50ms, Eigen::Vector3d::Zero(), {});

    sim::CameraShot shot;
    shot.command.region = {0, 0, 160, 120};
    shot.command.range = true;
    shot.exposure = c.distance_m < 1.5 ? 200us : 1ms;  // as a device would choose it
    shot.start = kStart + 10ms;
    shot.poses.resize(2);
    shot.poses[0].time = kStart;
    shot.poses[1].time = kStart + 50ms;
    shot.light = c.sunlit ? &noon : &night;
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    double pixels = 0.0;
    for (shot.frame = 0; shot.frame < 4; ++shot.frame) {
      sim::CameraTruth truth;
      const auto picture = camera->take(scene, shot, &truth).picture;
      const std::vector<std::uint8_t>& bytes = picture->parts[1].bytes;
      for (std::size_t i = 0; i < truth.depth_m.size(); ++i) {
        pixels += 1.0;
        const int value = bytes[2 * i] | bytes[2 * i + 1] << 8;
        if (value != 0) {
          const double error = value * parameters.step_m - static_cast<double>(truth.depth_m[i]);
          sum += error;
          squares += error * error;
          count += 1.0;
        }
      }
    }
    RangeNoise noise{.surface = c.surface, .distance_m = c.distance_m};
    noise.valid = count / pixels;
    const double mean = sum / count;
    noise.found_m = count > 0.0 ? std::sqrt(squares / count - mean * mean)
                                : std::numeric_limits<double>::quiet_NaN();
    // The wall's mean luminance, from the same renderer's picture.
    sim::CameraRenderer renderer(parameters.camera, kCameraKindsSeed, "bench");
    sim::RenderedPicture rendered;
    renderer.render(scene, job_of(shot, whole_read_out(shot, parameters.camera.sensor)), rendered);
    double luminance = 0.0;
    for (const float band : rendered.luminance) {
      luminance += static_cast<double>(band);
    }
    luminance /= static_cast<double>(rendered.luminance.size());
    const double strength = c.reflectance / parameters.noise_reflectance *
                            std::pow(parameters.noise_distance_m / c.distance_m, 2) *
                            to_seconds(shot.exposure) / to_seconds(parameters.noise_exposure);
    noise.set_m = range_noise_m(parameters, strength, luminance, shot.exposure);
    noises.push_back(noise);
  }
  return noises;
}

double measure_depth_shot(const CameraCase& scene, int rounds) {
  const sim::DepthCameraParameters parameters;
  const auto camera = make_depth_camera(parameters, kCameraKindsSeed, "bench");
  const sim::ImageSensorParameters& sensor = parameters.camera.sensor;
  sim::CameraShot shot = scene.shot(sensor.width_px, sensor.height_px);
  shot.command.range = true;
  shot.command.confidence = true;
  return least_of_rounds(rounds, [&] { (void)camera->take(scene.scene(), shot, nullptr); });
}

}  // namespace rigwire::bench
