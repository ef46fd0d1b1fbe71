#include "bench/camera_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "fields/constants.h"
#include "hil/command_line/config_files.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig.h"
#include "sim/random.h"
#include "sim/scene/colour_texture.h"
#include "sim/scene/scene_description.h"

namespace rigwire::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kCameraSeed = 1;
constexpr double kView_rad = 75.0 * kDegree;
constexpr double kMeanLevel = 100.0;
const SimTime kSliceEnd = kStart + 50ms;

Eigen::Isometry3d looking(double x_m, double y_m, double z_m, double yaw_deg, double pitch_deg) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x_m, y_m, z_m;
  X.linear() = (Eigen::AngleAxisd(yaw_deg * kDegree, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(pitch_deg * kDegree, Eigen::Vector3d::UnitY()))
                   .toRotationMatrix();
  return X;
}

Eigen::Vector3d to_sun() {
  const double elevation = 40.0 * kDegree;
  const double azimuth = 210.0 * kDegree;
  return {std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
          std::sin(elevation)};
}

/// CPU seconds of this thread that `work` takes.
template <class Work>
double timed(const Work& work) {
  const double before_s = hil::thread_cpu_seconds();
  work();
  return hil::thread_cpu_seconds() - before_s;
}

/// Returns the minimum time of several runs.
template <class Work>
double least_of(int rounds, const Work& work) {
  double least_s = timed(work);
  for (int i = 1; i < rounds; ++i) {
    least_s = std::min(least_s, timed(work));
  }
  return least_s;
}

/// Green of each pixel as a grey level: `scale` levels for each cd/m2, cut off at 255.
std::vector<double> levels(const sim::RenderedPicture& picture, double scale) {
  std::vector<double> result;
  for (std::size_t i = 1; i < picture.luminance.size(); i += 3) {
    result.push_back(std::min(255.0, scale * static_cast<double>(picture.luminance[i])));
  }
  return result;
}

double level_scale(const sim::RenderedPicture& picture) {
  double sum = 0.0;
  for (std::size_t i = 1; i < picture.luminance.size(); i += 3) {
    sum += static_cast<double>(picture.luminance[i]);
  }
  const std::size_t pixels = picture.luminance.size() / 3;
  return kMeanLevel * static_cast<double>(pixels) / sum;
}

/// A wall of 40 x 40 m across x, facing the camera at -x, a picture of a metre on each square
/// metre. Random texels of `texels` a metre: a picture with all of its contrast where it is
/// sampled.
sim::TriangleMesh wall(bool coloured, std::size_t texels) {
  sim::TriangleMesh mesh;
  mesh.name = "wall";
  constexpr float kHalf_m = 20.0F;
  mesh.vertices = {{0, -kHalf_m, -kHalf_m},
                   {0, kHalf_m, -kHalf_m},
                   {0, kHalf_m, kHalf_m},
                   {0, -kHalf_m, kHalf_m}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  if (!coloured) {
    return mesh;
  }
  sim::MeshColour colour;
  colour.factor = {0.5F, 0.4F, 0.3F};
  if (texels > 0) {
    sim::RandomStream random(kCameraSeed, "bench.texels");
    std::vector<sim::Texel> picture(texels * texels);
    for (sim::Texel& texel : picture) {
      const auto albedo = static_cast<std::uint16_t>(random.uniform(0.1, 0.9) * 65535.0);
      texel = {albedo, albedo, albedo, 65535};
    }
    colour.texture =
        std::make_shared<sim::ColourTexture>("texels", texels, texels, std::move(picture));
    mesh.texture_coordinates = {
        {0, 0}, {2 * kHalf_m, 0}, {2 * kHalf_m, 2 * kHalf_m}, {0, 2 * kHalf_m}};
  }
  mesh.colour = std::make_shared<sim::MeshColour>(colour);
  return mesh;
}

struct Difference {
  double rms = 0.0;
  double mean = 0.0;
};

Difference difference(const std::vector<double>& a, const std::vector<double>& b) {
  Difference d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    d.mean += a[i] - b[i];
    d.rms += (a[i] - b[i]) * (a[i] - b[i]);
  }
  d.mean /= static_cast<double>(a.size());
  d.rms = std::sqrt(d.rms / static_cast<double>(a.size()));
  return d;
}

}  // namespace

CameraCase::CameraCase(std::string name, const hil::RigConfiguration& rig,
                       const Eigen::Isometry3d& X_WS)
    : name_(std::move(name)),
      built_(hil::build_machine_in_scene(rig)),
      X_WS_(X_WS),
      light_({}, to_sun()) {
  built_.machine->step(1s);
  X_WS_.translation().z() +=
      built_.ground->height_m(X_WS.translation().x(), X_WS.translation().y());
  place();
}

CameraCase::CameraCase(std::string name, const Eigen::Isometry3d& X_WS)
    : name_(std::move(name)), X_WS_(X_WS), light_({}, to_sun()) {
  sim::SceneDescription description;
  description.terrain = sim::PitTerrain{};
  sim::BuiltScene built = sim::build_scene(description, {}, kCameraSeed);
  X_WS_.translation().z() += built.ground.height_m(X_WS.translation().x(), X_WS.translation().y());
  built_.scene = std::move(built.scene);
  place();
}

CameraCase::CameraCase(std::string name, const sim::TriangleMesh& mesh, const std::string& label,
                       const Eigen::Isometry3d& X_WS)
    : name_(std::move(name)), X_WS_(X_WS), light_({}, to_sun()) {
  built_.scene = std::make_unique<sim::Scene>();
  sim::Material material;
  material.label = label;
  built_.scene->add_object(built_.scene->add_mesh(mesh), Eigen::Isometry3d::Identity(), 1.0,
                           material);
  place();
}

void CameraCase::place() {
  std::vector<sim::BodyMotion> motions;
  if (built_.machine) {
    for (const sim::LinkMotion& link : built_.machine->links()) {
      motions.push_back({link.X_WL, link.X_WL});
    }
  }
  built_.scene->begin_slice(kStart, kSliceEnd, X_WS_.translation(), motions);
  sky_ = sim::SkyVisibility(*built_.scene);
}

sim::PictureJob CameraCase::job(const sim::CameraParameters& camera) const {
  sim::PictureJob job;
  job.read_out.region = {0, 0, camera.sensor.width_px, camera.sensor.height_px};
  job.read_out.exposure = 200us;
  job.exposure_start = kStart + 10ms;
  sim::CameraPose pose;
  pose.time = kStart;
  pose.mount.X_WL = X_WS_;
  job.poses = {pose, pose};
  job.poses.back().time = kSliceEnd;
  job.light = &light_;
  job.sky = &sky_;
  return job;
}

sim::CameraShot CameraCase::shot(int width_px, int height_px) const {
  const sim::PictureJob alike = job({});
  sim::CameraShot shot;
  shot.command.format = PixelFormat::mono12;
  shot.command.region = {0, 0, width_px, height_px};
  shot.exposure = alike.read_out.exposure;
  shot.start = alike.exposure_start;
  shot.poses = alike.poses;
  shot.light = alike.light;
  shot.sky = alike.sky;
  return shot;
}

CameraCase forest_case() {
  return {"forest", hil::load_rig(hil::find_rig("forest_lidar"), {}).configuration,
          looking(34.0, 0.0, 2.2, 10.0, 2.0)};
}

std::vector<CameraCase> camera_cases() {
  std::vector<CameraCase> cases;
  cases.reserve(3);
  cases.emplace_back("pit", hil::load_rig(hil::find_rig("excavator_pit"), {}).configuration,
                     looking(-14.0, -8.0, 2.2, 28.0, 3.0));
  cases.push_back(forest_case());
  cases.emplace_back("terrain", looking(-14.0, -8.0, 2.2, 28.0, 3.0));
  return cases;
}

sim::CameraParameters bench_camera(int width_px, int samples, int sky_rays) {
  sim::CameraParameters camera;
  camera.sensor.width_px = width_px;
  camera.sensor.height_px = width_px * 3 / 4;
  camera.lens.focal_length_m =
      0.5 * width_px / std::tan(0.5 * kView_rad) * camera.sensor.pixel_pitch_m;
  camera.samples = samples;
  camera.sky_rays = sky_rays;
  return camera;
}

PictureCost measure_picture(const CameraCase& scene, int width_px, int samples, int rounds) {
  sim::CameraRenderer camera(bench_camera(width_px, samples), kCameraSeed, "bench");
  const sim::PictureJob job = scene.job(camera.parameters());
  sim::RenderedPicture picture;
  sim::RecordedPictureRays rays = camera.record(scene.scene(), job);
  PictureCost cost;
  cost.scene = scene.name();
  cost.samples = samples;
  cost.shadow_share =
      static_cast<double>(rays.shadow_rays()) / static_cast<double>(rays.primary_rays());
  cost.doubtful_share = static_cast<double>(rays.shadow_rays(sim::ShadowRays::doubtful)) /
                        static_cast<double>(rays.primary_rays());
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    double picture_s = 0.0;
    double bare_s = 0.0;
    const auto render = [&] {
      picture_s = timed([&] { camera.render(scene.scene(), job, picture); });
    };
    const auto bare = [&] {
      rays.reset();
      bare_s = timed([&] { rays.cast_bare(scene.scene()); });
    };
    // In turns, because the second one finds the scene in the caches.
    if (round % 2 == 0) {
      bare();
      render();
    } else {
      render();
      bare();
    }
    cost.picture_s += picture_s / rounds;
    cost.bare_s += bare_s / rounds;
    rays.reset();
    cost.doubtful_s +=
        timed([&] { rays.cast_bare(scene.scene(), sim::ShadowRays::doubtful); }) / rounds;
    ratios.push_back(bare_s / picture_s);
  }
  cost.pixels = picture.numbers.size();
  std::ranges::sort(ratios);
  cost.ratio = ratios[ratios.size() / 2];
  cost.least_ratio = ratios.front();
  cost.greatest_ratio = ratios.back();
  return cost;
}

std::vector<SamplingWay> sampling_ways() {
  const sim::CameraParameters usual;
  const double mtf = usual.lens.mtf;
  return {{"middle alone", 1, 0.0, 1.0},
          {"and blur", 1, 0.0, mtf},
          {"and edges (default)", 1, usual.edge_ratio, mtf},
          {"4 samples", 4, 0.0, mtf},
          {"16 samples", 16, 0.0, mtf}};
}

std::vector<SamplingError> measure_sampling(const CameraCase& scene, int width_px,
                                            const std::vector<SamplingWay>& ways,
                                            int reference_samples, int rounds) {
  struct Picture {
    std::unique_ptr<sim::CameraRenderer> camera;
    sim::PictureJob job;
    sim::RenderedPicture picture;
    double least_s = std::numeric_limits<double>::infinity();
    void render(const sim::Scene& in) {
      least_s = std::min(least_s, timed([&] { camera->render(in, job, picture); }));
    }
  };
  const auto prepared = [&](const SamplingWay& way, std::uint64_t frame) {
    sim::CameraParameters parameters = bench_camera(width_px, way.samples);
    parameters.edge_ratio = way.edge_ratio;
    parameters.lens.mtf = way.mtf;
    Picture result{std::make_unique<sim::CameraRenderer>(parameters, kCameraSeed, "bench"),
                   scene.job(parameters),
                   {}};
    result.job.read_out.frame = frame;
    return result;
  };
  std::vector<Picture> pictures;
  for (const SamplingWay& way : ways) {
    pictures.push_back(prepared(way, 0));
  }
  for (int round = 0; round < rounds; ++round) {
    for (Picture& picture : pictures) {
      picture.render(scene.scene());
    }
  }
  std::vector<SamplingError> errors;
  std::map<double, sim::RenderedPicture> references;  // by the lens's transfer
  for (std::size_t i = 0; i < ways.size(); ++i) {
    sim::RenderedPicture& reference = references[ways[i].mtf];
    if (reference.luminance.empty()) {
      Picture many = prepared({"", reference_samples, 0.0, ways[i].mtf}, 1);
      many.render(scene.scene());
      reference = std::move(many.picture);
    }
    const double scale = level_scale(reference);
    errors.push_back({scene.name(), ways[i].name,
                      difference(levels(pictures[i].picture, scale), levels(reference, scale)).rms,
                      pictures[i].least_s / pictures.front().least_s});
  }
  return errors;
}

std::vector<SkyCost> measure_sky(const CameraCase& scene, int width_px,
                                 const std::vector<int>& sky_rays, int reference) {
  sim::RenderedPicture picture;
  const auto render = [&](int rays, int rounds) {
    sim::CameraRenderer camera(bench_camera(width_px, 1, std::max(rays, 0)), kCameraSeed, "bench");
    sim::PictureJob job = scene.job(camera.parameters());
    if (rays < 0) {
      job.sky = nullptr;
    }
    return least_of(rounds, [&] { camera.render(scene.scene(), job, picture); });
  };
  render(reference, 1);
  const double scale = level_scale(picture);
  const std::vector<double> true_levels = levels(picture, scale);
  std::vector<SkyCost> costs;
  for (const int rays : sky_rays) {
    SkyCost cost;
    cost.scene = scene.name();
    cost.sky_rays = rays;
    cost.pixel_ns = 1e9 * render(rays, 3) / static_cast<double>(true_levels.size());
    const Difference d = difference(levels(picture, scale), true_levels);
    cost.rms_levels = d.rms;
    cost.bias_levels = d.mean;
    costs.push_back(cost);
  }
  return costs;
}

std::vector<AirCost> measure_air(const CameraCase& scene, int width_px) {
  sim::CameraRenderer camera(bench_camera(width_px), kCameraSeed, "bench");
  sim::WeatherParameters fog;
  fog.course = {{.fog_visibility_m = 100.0}};
  sim::WeatherParameters layer = fog;
  layer.fog.scale_height_m = 10.0;
  sim::WeatherParameters rain;
  rain.course = {{.rain_mmph = 10.0}};
  // A plume that has drifted for a while: as many puffs as a drive leaves behind.
  sim::DustCloud dust({});
  std::vector<sim::DustEmitter> emitters(1);
  for (int i = 0; i < 500; ++i) {
    emitters[0].position_W = {-10.0 + 0.06 * i, 0.0, 1.0};
    emitters[0].mass_rate_kgps = 0.05;
    dust.advance(0.02, {0.5, 0.5}, 1.0, emitters);
  }
  const std::array<std::pair<const char*, sim::CameraAir>, 5> airs{
      {{"clear", {}},
       {"fog", {fog, kStart, nullptr}},
       {"fog, layered", {layer, kStart, nullptr}},
       {"rain", {rain, kStart, nullptr}},
       {"dust", {{}, kStart, &dust}}}};
  sim::RenderedPicture picture;
  std::vector<AirCost> costs;
  for (const auto& [medium, air] : airs) {
    sim::PictureJob job = scene.job(camera.parameters());
    job.air = &air;
    const double seconds = least_of(5, [&] { camera.render(scene.scene(), job, picture); });
    const double pixel_ns = 1e9 * seconds / static_cast<double>(picture.numbers.size());
    costs.push_back({medium, pixel_ns, costs.empty() ? 0.0 : pixel_ns - costs.front().pixel_ns});
  }
  return costs;
}

std::vector<TextureCost> measure_textures(int width_px, int rounds, int reference_samples) {
  struct View {
    const char* name;
    Eigen::Isometry3d X_WS;
  };
  const std::array views{View{"3 m, straight on", looking(-3.0, 0.0, 0.0, 0.0, 0.0)},
                         View{"12 m, straight on", looking(-12.0, 0.0, 0.0, 0.0, 0.0)},
                         View{"along it", looking(-1.0, -19.0, 0.0, 50.0, 0.0)}};
  struct Surface {
    const char* name;
    sim::TriangleMesh mesh;
  };
  // 64 texels a metre: 64 x 3 m / 417 px of focal length is half a texel a pixel at 640 pixels.
  const std::array surfaces{Surface{"its label's look", wall(false, 0)},
                            Surface{"a colour", wall(true, 0)},
                            Surface{"a picture", wall(true, 64)}};
  std::vector<TextureCost> costs;
  for (const View& view : views) {
    sim::CameraRenderer camera(bench_camera(width_px), kCameraSeed, "bench");
    std::vector<CameraCase> cases;
    cases.reserve(surfaces.size());
    for (const Surface& surface : surfaces) {
      cases.emplace_back(surface.name, surface.mesh, "concrete", view.X_WS);
    }
    // In turns, so that other load of the host affects all of them.
    std::array<double, surfaces.size()> least_s{};
    sim::RenderedPicture picture;
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < cases.size(); ++i) {
        const sim::PictureJob job = cases[i].job(camera.parameters());
        const double picture_s = timed([&] { camera.render(cases[i].scene(), job, picture); });
        least_s[i] = round == 0 ? picture_s : std::min(least_s[i], picture_s);
      }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
      costs.push_back(
          {view.name, surfaces[i].name,
           1e9 * least_s[i] / static_cast<double>(picture.numbers.size()), least_s[i] / least_s[0],
           measure_sampling(cases[i], width_px, {sampling_ways()[2]}, reference_samples, 1)
               .front()
               .rms_levels});
    }
  }
  return costs;
}

std::vector<SensorFigure> measure_sensor() {
  sim::ImageSensorParameters p;
  p.photo_response_nonuniformity = 0.0;
  p.dark_signal_nonuniformity = 0.0;
  const sim::ImageSensor sensor(p, 2.8, kCameraSeed, "bench");
  const auto pixels = static_cast<std::size_t>(p.width_px) * static_cast<std::size_t>(p.height_px);
  const std::vector<float> falloff(pixels, 1.0F);
  constexpr std::array<float, 3> kHaze{};
  sim::ReadOut r;
  r.region = {0, 0, p.width_px, p.height_px};
  r.exposure = 10ms;
  r.bits = 12;
  r.black_level = 8.0;
  struct Point {
    double mean = 0.0;
    double variance = 0.0;
  };
  // Mean of two frames, temporal variance by their difference (EMVA 1288, section 6).
  const auto measure = [&](double electrons) {
    const std::vector<float> light(
        3 * pixels, static_cast<float>(electrons / sensor.electrons(1.0, r.exposure)));
    std::array<std::vector<std::uint16_t>, 2> frames;
    for (std::vector<std::uint16_t>& frame : frames) {
      frame.resize(pixels);
      ++r.frame;
      sensor.expose(light, falloff, kHaze, r, 0, p.height_px, frame);
    }
    double sum = 0.0;
    double apart = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
      const double a = frames[0][i];
      const double b = frames[1][i];
      sum += a + b;
      apart += a - b;
      squares += (a - b) * (a - b);
    }
    const auto n = static_cast<double>(pixels);
    return Point{0.5 * sum / n, 0.5 * (squares / n - apart * apart / (n * n))};
  };
  const Point dark = measure(0.0);
  double xy = 0.0;
  double xx = 0.0;
  double peak_variance = 0.0;
  double saturation = 0.0;
  const double gain = sensor.numbers_per_electron(0.0, r.bits);
  for (double share = 0.02; share < 1.1; share += 0.01) {
    const Point point = measure(share * p.saturation_capacity);
    const double mean = point.mean - dark.mean;
    if (share <= 0.7) {
      xy += mean * (point.variance - dark.variance);
      xx += mean * mean;
    }
    // Saturation is at the maximum of the variance.
    if (point.variance > peak_variance) {
      peak_variance = point.variance;
      saturation = mean / gain;
    }
  }
  // What the black level takes of the range is lost to the signal; the variance begins to fall
  // where the brightest pixels reach the end, three times the shot noise before it.
  const double end = p.saturation_capacity - (8.0 * 16.0) / gain;
  const double expected_saturation = end - 3.0 * std::sqrt(end);
  return {{"gain, numbers per electron", gain, xy / xx},
          {"read noise, electrons", p.read_noise, std::sqrt(dark.variance - 1.0 / 12.0) / gain},
          {"saturation, electrons", expected_saturation, saturation}};
}

}  // namespace rigwire::bench
