#include "sim/camera/camera_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

#include "fields/rules.h"
#include "sim/camera/lens_blur.h"
#include "sim/camera/pixel_rays.h"
#include "sim/camera/scene_looks.h"
#include "sim/camera/shading_lanes.h"
#include "sim/camera/shadow_ceiling.h"
#include "sim/lidar/beam_hits.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/hit_surface.h"
#include "sim/lidar/worker_pool.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr int kTileWidth = 32;
constexpr int kTileHeight = 16;
constexpr int kRowsAtOnce = 8;
constexpr int kMostRaysAcross = 32;
constexpr std::size_t kSunPoints = 256;
/// Packets of parts of pixels that are shaded together.
constexpr std::size_t kPartPackets = 8;
/// Pixels beside the region of which the blur takes, and whose neighbours say what is an edge.
constexpr int kBlurMargin = 1;
constexpr int kEdgeMargin = 1;
/// What is added to both sides of an edge, as share of the light that fills a pixel: two levels of
/// 255 are no edge.
constexpr double kDarkShare = 0.01;
/// Maximum length of a path through fog or rain, for rays that hit nothing.
constexpr double kFarthestAir_m = 5000.0;
constexpr double kAirHeight_m = 1500.0;
/// Dust's own colour: its share of the light, red, green, blue (mineral dust scatters 0.9 and more
/// of the light, less of the blue).
constexpr std::array<float, 3> kDustColour{0.92F, 0.80F, 0.62F};

void require(bool holds, const std::string& text) {
  if (!holds) {
    throw std::invalid_argument("picture: " + text);
  }
}

CameraParameters valid(const CameraParameters& parameters) {
  validate(parameters);
  return parameters;
}

bool finite(const LinkMotion& m) {
  return m.X_WL.matrix().allFinite() && m.v_WL_W.allFinite() && m.w_WL_W.allFinite();
}

/// The mount at `time`, which the poses span.
LinkMotion mount_at(const std::vector<CameraPose>& poses, SimTime time) {
  const auto after = std::ranges::upper_bound(poses, time, {}, &CameraPose::time);
  const auto end = after == poses.end() ? std::prev(after) : after;
  const auto begin = std::prev(end);
  return LinkMotionInterpolation(begin->time, begin->mount, end->time,
                                 end->mount)(std::clamp(time, begin->time, end->time));
}

std::uint64_t key_of(std::uint64_t seed, std::string_view name) {
  return RandomStream(seed, std::string(name) + "/rays").bits();
}

RTCIntersectContext incoherent() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return context;
}

RTCIntersectContext coherent() {
  RTCIntersectContext context = incoherent();
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

/// Casts shadow rays at the scene: sets tfar of each blocked ray below 0. Rays that were blocked
/// before stay blocked.
void occlude(const Scene::Internals& scene, const int* valid, RTCRay8& rays) {
  RTCIntersectContext context = incoherent();
  rtcOccluded8(valid, scene.moving.get(), &context, &rays);
  rtcOccluded8(valid, scene.fixed.get(), &context, &rays);
}

void resize(RenderedPicture& picture, int width, int height, std::size_t seen, std::size_t known) {
  picture.width = width;
  picture.height = height;
  picture.numbers.resize(seen);
  picture.luminance.resize(3 * seen);
  picture.range_m.resize(known);
  picture.depth_m.resize(known);
  picture.instance.resize(known);
}

float square(float x) {
  return x * x;
}

/// Evenly over the sun's disc, by the golden angle.
void lay_on_sun(const Eigen::Vector3f& to_sun, std::array<Eigen::Vector3f, kSunPoints>& points) {
  const Eigen::Vector3f side = to_sun.unitOrthogonal();
  const Eigen::Vector3f up = to_sun.cross(side);
  for (std::size_t i = 0; i < kSunPoints; ++i) {
    const double place = (static_cast<double>(i) + 0.5) / kSunPoints;
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) * std::numbers::phi;
    const auto out = Daylight::kSunRadius_rad * static_cast<float>(std::sqrt(place));
    points[i] = (to_sun + out * (static_cast<float>(std::cos(angle)) * side +
                                 static_cast<float>(std::sin(angle)) * up))
                    .normalized();
  }
}

/// Share `weight` of what the pixels see that the lens fills.
RIGWIRE_WIDE_VECTORS void add_up(const std::array<LaneArray, 3>& luminance,
                                 const std::array<int, kLanes>& active, bool first, float weight,
                                 std::array<LaneArray, 3>& sum) {
  for (std::size_t band = 0; band < 3; ++band) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float seen = active[i] != 0 ? luminance[band][i] * weight : 0.0F;
      sum[band][i] = first ? seen : sum[band][i] + seen;
    }
  }
}

/// Bands of a packet beside each other, its first pixel at `to`.
RIGWIRE_WIDE_VECTORS void store(const std::array<LaneArray, 3>& bands,
                                const std::array<int, kLanes>& valid, std::size_t width,
                                float* to) {
  int missing = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    missing |= ~valid[i];
  }
  for (std::size_t half = 0; half < kPacketHeight; ++half) {
    float* const row = to + 3 * half * width;
    for (std::size_t k = 0; k < kPacketWidth; ++k) {
      const std::size_t i = half * kPacketWidth + k;
      if (missing == 0 || valid[i] != 0) {
        row[3 * k] = bands[0][i];
        row[3 * k + 1] = bands[1][i];
        row[3 * k + 2] = bands[2][i];
      }
    }
  }
}

/// Sets `seen` to 1 in each active lane whose ray was not blocked, and to 0 in all others.
RIGWIRE_WIDE_VECTORS void see_through(const RTCRay8& rays, const std::array<int, kLanes>& active,
                                      LaneArray& seen) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    seen[i] = active[i] != 0 && rays.tfar[i] >= 0.0F ? 1.0F : 0.0F;
  }
}

struct ShadowPacket {
  RTCRay8 rays;
  alignas(32) std::array<int, kLanes> active;
  /// Rays that something may block; only these are cast.
  alignas(32) std::array<int, kLanes> doubtful;
};

struct PrimaryPacket {
  RTCRayHit8 rays;
  alignas(32) std::array<int, kLanes> active;
};

}  // namespace

Eigen::Vector3d lens_to_mount(const Eigen::Vector3d& v) {
  return {v.z(), -v.x(), -v.y()};
}

Eigen::Vector3d mount_to_lens(const Eigen::Vector3d& v) {
  return {-v.y(), -v.z(), v.x()};
}

struct RecordedPictureRays::Packets {
  std::vector<PrimaryPacket> primary, primary_work;
  std::vector<ShadowPacket> shadow, shadow_work;
};

RecordedPictureRays::RecordedPictureRays() : packets_(std::make_unique<Packets>()) {}
RecordedPictureRays::~RecordedPictureRays() = default;
RecordedPictureRays::RecordedPictureRays(RecordedPictureRays&&) noexcept = default;
RecordedPictureRays& RecordedPictureRays::operator=(RecordedPictureRays&&) noexcept = default;

std::size_t RecordedPictureRays::primary_rays() const {
  std::size_t count = 0;
  for (const PrimaryPacket& packet : packets_->primary) {
    count += static_cast<std::size_t>(std::ranges::count(packet.active, -1));
  }
  return count;
}

std::size_t RecordedPictureRays::shadow_rays(ShadowRays which) const {
  std::size_t count = 0;
  for (const ShadowPacket& packet : packets_->shadow) {
    const auto& lanes = which == ShadowRays::all ? packet.active : packet.doubtful;
    count += static_cast<std::size_t>(std::ranges::count(lanes, -1));
  }
  return count;
}

void RecordedPictureRays::reset() {
  packets_->primary_work = packets_->primary;
  packets_->shadow_work = packets_->shadow;
}

void RecordedPictureRays::cast_bare(const Scene& scene, ShadowRays which) {
  const FlushDenormals flush;
  RTCIntersectContext context = coherent();
  // Primary rays and their shadow rays in turns, as the camera casts them.
  std::size_t shadow = 0;
  const std::size_t count = packets_->primary_work.size();
  for (std::size_t i = 0; i < count; ++i) {
    PrimaryPacket& packet = packets_->primary_work[i];
    scene.internals().intersect(packet.active.data(), context, packet.rays);
    for (const std::size_t end = packets_->shadow_work.size() * (i + 1) / count; shadow < end;
         ++shadow) {
      ShadowPacket& towards_sun = packets_->shadow_work[shadow];
      const bool all = which == ShadowRays::all;
      if (all || std::ranges::any_of(towards_sun.doubtful, [](int lane) { return lane != 0; })) {
        occlude(scene.internals(), (all ? towards_sun.active : towards_sun.doubtful).data(),
                towards_sun.rays);
      }
    }
  }
}

Duration exposure_span(const PictureJob& job, const ImageSensorParameters& sensor) {
  const int rows = std::max(1, job.read_out.region.height / std::max(1, job.read_out.binning_y));
  return sensor.row_time * ((rows - 1) * job.read_out.binning_y) + job.read_out.exposure;
}

struct CameraRenderer::Internals {
  Internals(const CameraParameters& given, std::uint64_t seed, std::string_view name)
      : parameters(valid(given)),
        lens(given.lens, given.sensor.pixel_pitch_m, given.sensor.width_px, given.sensor.height_px),
        sensor(given.sensor, given.lens.f_number, seed, name),
        key(key_of(seed, name)),
        pool(given.threads, PoolPriority::spare_time),
        pixels(lens, given.sensor) {}

  /// One packet of pixels through one sample, its hits, and what is visible of them.
  struct Packet {
    PixelPacket pixels;
    TexturedPacket surfaces;
    ShadowPacket shadow;
    bool met = false;     ///< There is something.
    bool in_sun = false;  ///< Some of it may be: there are rays towards it.
    LaneArray seen;       ///< Share of the sun,
    LaneArray sky;        ///< of the sky.
    std::array<LaneArray, 3> luminance;
    std::array<LaneArray, 3> sum;  ///< Over the samples.
  };
  /// Mean of the parts of a pixel.
  struct PartsLight {
    std::size_t pixel = 0;  ///< Index among all rendered pixels.
    std::array<float, 3> luminance{};
  };
  /// What all packets of a picture have in common.
  struct Frame {
    const Scene::Internals* in = nullptr;
    const PictureJob* job = nullptr;
    /// What is rendered: the job's region, and what the blur takes from beside it.
    ReadOut read_out;
    int width = 0;
    int height = 0;
    int left = 0;  ///< Columns that are rendered before the region's first.
    int top = 0;   ///< Rows.
    std::uint64_t key = 0;
    PictureLimits limits;
    LightTerms light;
    RenderedPicture* picture = nullptr;
    float* luminance = nullptr;  ///< Luminance of all rendered pixels.
    float full_cd = 0.0F;        ///< Luminance on the axis that fills the range of numbers.
    RecordedPictureRays::Packets* record = nullptr;
    std::array<float, 3> airlight{};
    std::array<float, 3> dustlight{};
    /// From the lattice of `job->sky` to Embree's origin.
    Eigen::Vector3f sky_offset = Eigen::Vector3f::Zero();
    /// Points of the sun's disc, for several samples.
    std::array<Eigen::Vector3f, kSunPoints> on_sun;
  };

  /// `margin`: pixels that are rendered beside the region, where the sensor has them.
  void prepare(const Scene& scene, const PictureJob& job, const PixelSamples& samples,
               int margin = 0);
  void prepare_region(const PictureJob& job, int margin);
  void prepare_rows(const Scene::Internals& in, const PictureJob& job, const PixelSamples& samples);
  void blur(int first_row, int end_row) const;
  void render_strip(std::span<Packet> packets) const;
  void shade(std::span<Packet> packets) const;
  void find_edges(int row, std::vector<PixelPlace>& edges) const;
  void render_parts(int first_row, int end_row, std::vector<PartsLight>& found) const;
  void refine_edges();
  [[nodiscard]] bool has_parts() const {
    return parameters.samples == 1 && parameters.edge_ratio > 0.0;
  }
  void aim_shadow(Packet& packet) const;
  void light(Packet& packet) const;
  void see_sky(Packet& packet) const;
  void look_for_sky(Packet& packet) const;
  void see_nothing(Packet& packet) const;
  void pass_air(Packet& packet) const;
  void tell_truth(Packet& packet) const;
  template <class Work>
  void each_strip(std::size_t tile, const Work& work) const;
  void collect_rays(Packet& packet, PictureRays& found) const;
  [[nodiscard]] std::size_t tiles() const {
    return static_cast<std::size_t>((frame.width + kTileWidth - 1) / kTileWidth) *
           static_cast<std::size_t>((frame.height + kTileHeight - 1) / kTileHeight);
  }
  /// Returns the index of a lane's pixel among the rendered pixels.
  [[nodiscard]] std::size_t pixel_at(const PixelPacket& packet, std::size_t lane) const {
    return static_cast<std::size_t>(packet.row + static_cast<int>(lane) / kPacketWidth) *
               static_cast<std::size_t>(frame.width) +
           static_cast<std::size_t>(packet.column + static_cast<int>(lane) % kPacketWidth);
  }

  CameraParameters parameters;
  Lens lens;
  ImageSensor sensor;
  std::uint64_t key;
  WorkerPool pool;

  // State of the picture that is being rendered; memory is used again.
  Frame frame;
  PixelRays pixels;
  SceneLooks looks;
  ShadowCeiling ceiling;
  std::vector<PixelRays::RowPose> row_poses;
  std::vector<float> sharp;                    ///< Luminance before the blur.
  std::vector<std::vector<PartsLight>> parts;  ///< By strip of rows.
};

void CameraRenderer::Internals::prepare_rows(const Scene::Internals& in, const PictureJob& job,
                                             const PixelSamples& samples) {
  // Under a global shutter one pose is that of all rows.
  const bool together = parameters.sensor.row_time == Duration{0};
  row_poses.resize(together ? 1 : static_cast<std::size_t>(frame.height));
  const Duration half = job.read_out.exposure / 2;
  for (std::size_t row = 0; row < row_poses.size(); ++row) {
    const auto rows = (static_cast<Duration::rep>(row) - frame.top) * job.read_out.binning_y;
    // Rows beside the region may be exposed where no pose is known any more.
    const SimTime middle =
        std::clamp(job.exposure_start + half + parameters.sensor.row_time * rows,
                   std::max(job.poses.front().time, in.t0), std::min(job.poses.back().time, in.t1));
    row_poses[row] = {mount_at(job.poses, middle), in.slice_fraction(middle)};
  }
  pixels.prepare(frame.read_out, samples, row_poses, in.origin_W, 1.0 / to_seconds(in.t1 - in.t0),
                 frame.limits, frame.key);
}

void CameraRenderer::Internals::prepare_region(const PictureJob& job, int margin) {
  const ReadOut& r = job.read_out;
  frame.read_out = r;
  PixelRectangle& grown = frame.read_out.region;
  const auto beside = [margin](int columns, int binning) {
    return std::min(margin, columns / binning);
  };
  frame.left = beside(r.region.x, r.binning_x);
  frame.top = beside(r.region.y, r.binning_y);
  const int right = beside(parameters.sensor.width_px - r.region.x - r.region.width, r.binning_x);
  const int bottom =
      beside(parameters.sensor.height_px - r.region.y - r.region.height, r.binning_y);
  grown.x -= frame.left * r.binning_x;
  grown.y -= frame.top * r.binning_y;
  grown.width += (frame.left + right) * r.binning_x;
  grown.height += (frame.top + bottom) * r.binning_y;
  frame.width = grown.width / r.binning_x;
  frame.height = grown.height / r.binning_y;
}

void CameraRenderer::Internals::prepare(const Scene& scene, const PictureJob& job,
                                        const PixelSamples& samples, int margin) {
  validate(job.read_out, parameters.sensor);
  require(job.light != nullptr, "there is no light");
  require(job.wetness >= 0.0 && job.wetness <= 1.0,
          "found wetness " + std::to_string(job.wetness) + ", allowed 0 .. 1");
  require(job.poses.size() >= 2,
          "at least two poses are needed, found " + std::to_string(job.poses.size()));
  for (std::size_t i = 0; i < job.poses.size(); ++i) {
    require(finite(job.poses[i].mount), "pose " + std::to_string(i) + " is not finite");
    require(i == 0 || job.poses[i - 1].time < job.poses[i].time, "poses are not in order of time");
  }
  const Scene::Internals& in = scene.internals();
  const SimTime end = job.exposure_start + exposure_span(job, parameters.sensor);
  require(job.poses.front().time <= job.exposure_start && end <= job.poses.back().time,
          "the poses do not span the exposure");
  require(in.t0 <= job.exposure_start && end <= in.t1,
          "the scene's slice does not span the exposure");

  frame = {};
  frame.in = &in;
  frame.job = &job;
  prepare_region(job, margin);
  frame.full_cd = static_cast<float>(sensor.full_luminance_cd(job.read_out));
  frame.key = counter_bits(key, job.read_out.frame);
  const Eigen::Vector3f& total = job.light->total_lx();
  const auto around = static_cast<float>(job.light->parameters().ground_albedo);
  frame.light = light_terms(*job.light, job.wetness);
  frame.limits = {static_cast<float>(parameters.near_m), static_cast<float>(parameters.far_m),
                  job.mask};
  for (int band = 0; band < 3; ++band) {
    // Air lit from all round sends on the mean of what comes from above and from below.
    const float mean = total[band] * (1.0F + around) * 0.5F * std::numbers::inv_pi_v<float>;
    frame.airlight[static_cast<std::size_t>(band)] = mean;
    frame.dustlight[static_cast<std::size_t>(band)] =
        mean * kDustColour[static_cast<std::size_t>(band)];
  }
  if (job.sky != nullptr) {
    frame.sky_offset << (in.origin_W.head<2>() - job.sky->origin_m()).cast<float>(),
        static_cast<float>(in.origin_W.z());
  }
  if (samples.count > 1) {
    lay_on_sun(job.light->to_sun_W(), frame.on_sun);
  }
  looks.prepare(in, parameters.looks);
  if (samples.count > 0 && job.light->sun_shines()) {
    ceiling.prepare(in, job.light->to_sun_W(),
                    samples.count > 1 ? double{Daylight::kSunRadius_rad} : 0.0);
  }
  prepare_rows(in, job, samples);
}

void CameraRenderer::Internals::see_nothing(Packet& packet) const {
  const RTCRay8& ray = packet.pixels.rays.ray;
  const Daylight& light = *frame.job->light;
  std::array<LaneArray, 3> above;
  light.luminance(ray.dir_x, ray.dir_y, ray.dir_z, above);
  const RTCHit8& hit = packet.pixels.rays.hit;
  const Eigen::Vector3f& to_sun = light.to_sun_W();
  constexpr float kDisc = Daylight::kSunRadius_rad * Daylight::kSunRadius_rad;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    const float apart = square(ray.dir_x[i] - to_sun.x()) + square(ray.dir_y[i] - to_sun.y()) +
                        square(ray.dir_z[i] - to_sun.z());
    // A disc smaller than the pixel fills its share of it.
    const float pixel = square(packet.pixels.pixel_rad[i]);
    float sun = 0.0F;
    if (light.sun_shines() && apart < std::max(kDisc, 0.3F * pixel)) {
      sun = std::min(1.0F, std::numbers::pi_v<float> * kDisc / pixel);
    }
    for (std::size_t band = 0; band < 3; ++band) {
      packet.luminance[band][i] =
          above[band][i] +
          sun * (sun > 0.0F ? light.sun_luminance()[static_cast<int>(band)] : 0.0F);
    }
  }
}

void CameraRenderer::Internals::pass_air(Packet& packet) const {
  const CameraAir& air = *frame.job->air;
  const RTCRay8& ray = packet.pixels.rays.ray;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (packet.pixels.active[i] == 0) {
      continue;
    }
    const Eigen::Vector3d start =
        frame.in->origin_W +
        Eigen::Vector3f(ray.org_x[i], ray.org_y[i], ray.org_z[i]).cast<double>();
    const Eigen::Vector3d direction =
        Eigen::Vector3f(ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]).cast<double>();
    double length_m = static_cast<double>(ray.tfar[i]);
    if (packet.pixels.rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
      length_m = std::min(kFarthestAir_m, kAirHeight_m / std::max(direction.z(), 1e-3));
    }
    const CameraAir::Depth depth = air.depth(start, direction, length_m);
    const double sum = depth.even + depth.dust;
    if (sum <= 0.0) {
      continue;
    }
    // Koschmieder, the airlight shared by depth between white media and dust.
    const auto through = static_cast<float>(std::exp(-sum));
    const float even = (1.0F - through) * static_cast<float>(depth.even / sum);
    const float dust = (1.0F - through) * static_cast<float>(depth.dust / sum);
    for (std::size_t band = 0; band < 3; ++band) {
      packet.luminance[band][i] = packet.luminance[band][i] * through +
                                  even * frame.airlight[band] + dust * frame.dustlight[band];
    }
  }
}

/// Aims rays from the packet's hits towards the sun.
void CameraRenderer::Internals::aim_shadow(Packet& packet) const {
  const PictureJob& job = *frame.job;
  packet.in_sun = false;
  if (!packet.met || !job.light->sun_shines()) {
    return;
  }
  // A point of the sun's disc for all of the packet; neighbours blend it over the samples.
  const Eigen::Vector3f& to_sun =
      parameters.samples == 1 ? job.light->to_sun_W()
                              : frame.on_sun[counter_bits(frame.key ^ 0x5D15CULL,
                                                          packet.pixels.number() + (1ULL << 62U)) %
                                             kSunPoints];
  packet.in_sun = aim_at_sun(packet.surfaces.met, packet.surfaces.lit, packet.pixels.rays, to_sun,
                             packet.shadow.rays, packet.shadow.active);
}

/// How much of the sky is open above each point, by its lattice or by rays.
void CameraRenderer::Internals::see_sky(Packet& packet) const {
  const PictureJob& job = *frame.job;
  if (parameters.sky_rays > 0) {
    look_for_sky(packet);
  } else if (job.sky != nullptr && !job.sky->everywhere()) {
    const MetSurfaces& met = packet.surfaces.met;
    job.sky->at(met.x, met.y, met.z, frame.sky_offset, packet.sky);
  } else {
    packet.sky.fill(1.0F);
  }
}

void CameraRenderer::Internals::look_for_sky(Packet& packet) const {
  const MetSurfaces& met = packet.surfaces.met;
  LaneArray open;
  open.fill(0.0F);
  for (int k = 0; k < parameters.sky_rays; ++k) {
    ShadowPacket& rays = packet.shadow;
    (void)aim_at_sun(met, packet.surfaces.lit, packet.pixels.rays, frame.job->light->to_sun_W(),
                     rays.rays, rays.active);
    for (std::size_t i = 0; i < kLanes; ++i) {
      // By the cosine around the normal.
      const std::uint64_t draw =
          counter_bits(frame.key ^ (0x5C1ULL + static_cast<std::uint64_t>(k)),
                       packet.pixels.number() * kLanes + i);
      const float angle =
          2.0F * std::numbers::pi_v<float> * static_cast<float>(draw >> 40U) * 0x1.0p-24F;
      const float place =
          (static_cast<float>(k) + static_cast<float>(draw & 0xFFFFFFU) * 0x1.0p-24F) /
          static_cast<float>(parameters.sky_rays);
      const float out = std::sqrt(place);
      const Eigen::Vector3f n(met.nx[i], met.ny[i], met.nz[i]);
      const bool there = packet.pixels.active[i] != 0 && n.squaredNorm() > 0.5F;
      rays.active[i] = there ? -1 : 0;
      if (there) {
        const Eigen::Vector3f side = n.unitOrthogonal();
        const Eigen::Vector3f to =
            out * (std::cos(angle) * side + std::sin(angle) * n.cross(side)) +
            std::sqrt(1.0F - place) * n;
        rays.rays.dir_x[i] = to.x();
        rays.rays.dir_y[i] = to.y();
        rays.rays.dir_z[i] = to.z();
        const float off = 2e-3F + 1e-4F * met.range_m[i];
        rays.rays.org_x[i] = met.x[i] + off * met.gx[i];
        rays.rays.org_y[i] = met.y[i] + off * met.gy[i];
        rays.rays.org_z[i] = met.z[i] + off * met.gz[i];
      }
    }
    rays.doubtful = rays.active;
    if (frame.record != nullptr) {
      frame.record->shadow.push_back(rays);
    }
    occlude(*frame.in, rays.doubtful.data(), rays.rays);
    for (std::size_t i = 0; i < kLanes; ++i) {
      open[i] += rays.rays.tfar[i] >= 0.0F ? 1.0F : 0.0F;
    }
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    packet.sky[i] = open[i] / static_cast<float>(parameters.sky_rays);
  }
}

void CameraRenderer::Internals::light(Packet& packet) const {
  const RTCRayHit8& rays = packet.pixels.rays;
  if (packet.met) {
    if (packet.in_sun) {
      see_through(packet.shadow.rays, packet.shadow.active, packet.seen);
    } else {
      packet.seen.fill(0.0F);
    }
    see_sky(packet);
    light_up(packet.surfaces.met, packet.surfaces.lit, rays, frame.light, packet.seen, packet.sky,
             packet.luminance);
  }
  unsigned most = 0;
  for (const unsigned part : rays.hit.geomID) {
    most = std::max(most, part);
  }
  if (most == RTC_INVALID_GEOMETRY_ID) {
    see_nothing(packet);
  }
  if (frame.job->air != nullptr && !frame.job->air->clear()) {
    pass_air(packet);
  }
}

void CameraRenderer::Internals::tell_truth(Packet& packet) const {
  // Through the pixel's middle at the middle of the exposure.
  pixels.aim_middle(packet.pixels);
  RTCIntersectContext context = coherent();
  RTCRayHit8& rays = packet.pixels.rays;
  frame.in->intersect(packet.pixels.active.data(), context, rays);
  const SurfaceNumbers number(rays.hit);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (packet.pixels.valid[i] == 0) {
      continue;
    }
    const int column = packet.pixels.column + static_cast<int>(i) % kPacketWidth - frame.left;
    const int row = packet.pixels.row + static_cast<int>(i) / kPacketWidth - frame.top;
    const int width = frame.picture->width;
    if (column < 0 || row < 0 || column >= width || row >= frame.picture->height) {
      continue;
    }
    const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column);
    const bool met = packet.pixels.active[i] != 0 && number[i] != RTC_INVALID_GEOMETRY_ID;
    const float range_m = rays.ray.tfar[i];
    frame.picture->range_m[at] = met ? range_m : 0.0F;
    frame.picture->depth_m[at] = met ? pixels.along_axis(packet.pixels, i) * range_m : 0.0F;
    frame.picture->instance[at] = met ? frame.in->instance_of[number[i]] : ~0U;
  }
}

template <class Work>
void CameraRenderer::Internals::each_strip(std::size_t tile, const Work& work) const {
  const FlushDenormals flush;
  const int tiles_across = (frame.width + kTileWidth - 1) / kTileWidth;
  const int first_column = static_cast<int>(tile) % tiles_across * kTileWidth;
  const int first_row = static_cast<int>(tile) / tiles_across * kTileHeight;
  const int end_column = std::min(first_column + kTileWidth, frame.width);
  const int end_row = std::min(first_row + kTileHeight, frame.height);
  std::array<Packet, kTileWidth / kPacketWidth> packets;
  for (Packet& packet : packets) {
    packet.pixels.limit(frame.limits);
  }
  for (int row = first_row; row < end_row; row += kPacketHeight) {
    std::size_t count = 0;
    for (int column = first_column; column < end_column; column += kPacketWidth) {
      pixels.turn_to(column, row, packets[count++].pixels);
    }
    work(std::span(packets).first(count));
  }
}

/// Casts all rays of a packet's pixels, one packet of samples after the other, and writes what each
/// hit and the optical depth of the air up to there.
void CameraRenderer::Internals::collect_rays(Packet& packet, PictureRays& found) const {
  HitSurfaces surfaces;
  const RTCRayHit8& rays = packet.pixels.rays;
  for (int k = 0; k < found.rays; ++k) {
    pixels.aim(k, packet.pixels);
    RTCIntersectContext context = coherent();
    frame.in->intersect(packet.pixels.active.data(), context, packet.pixels.rays);
    meet_surfaces(frame.in->shading.data(), rays, surfaces);
    const SurfaceNumbers number(rays.hit);
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (packet.pixels.valid[i] == 0) {
        continue;
      }
      const std::size_t at = pixel_at(packet.pixels, i) * static_cast<std::size_t>(found.rays) +
                             static_cast<std::size_t>(k);
      const bool met = packet.pixels.active[i] != 0 && number[i] != RTC_INVALID_GEOMETRY_ID;
      const RTCRay8& ray = rays.ray;
      found.range_m[at] = met ? ray.tfar[i] : 0.0F;
      found.cosine[at] = met ? surfaces.cosine[i] : 0.0F;
      found.reflectance[at] = met ? surfaces.reflectance[i] : 0.0F;
      if (met && !found.depth.empty()) {
        const CameraAir::Depth depth = frame.job->air->depth(
            frame.in->origin_W +
                Eigen::Vector3f(ray.org_x[i], ray.org_y[i], ray.org_z[i]).cast<double>(),
            Eigen::Vector3f(ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]).cast<double>(),
            static_cast<double>(ray.tfar[i]));
        found.depth[at] = static_cast<float>(depth.even + depth.dust);
      }
    }
  }
}

/// Packets beside each other are taken through each step together: the ray caster and the shading
/// keep their own parts of the caches for longer.
void CameraRenderer::Internals::shade(std::span<Packet> packets) const {
  RTCIntersectContext context = coherent();
  for (Packet& packet : packets) {
    PixelPacket& of = packet.pixels;
    if (frame.record != nullptr) {
      frame.record->primary.push_back({of.rays, of.active});
    }
    frame.in->intersect(of.active.data(), context, of.rays);
  }
  for (Packet& packet : packets) {
    packet.met = looks.texture_hits(packet.pixels.rays, packet.pixels.pixel_rad, frame.light,
                                    packet.surfaces);
    aim_shadow(packet);
  }
  for (Packet& packet : packets) {
    if (!packet.in_sun) {
      continue;
    }
    ShadowPacket& shadow = packet.shadow;
    const bool some = ceiling.doubt(shadow.rays, shadow.active, shadow.doubtful);
    if (frame.record != nullptr) {
      frame.record->shadow.push_back(shadow);
    }
    if (some) {
      occlude(*frame.in, shadow.doubtful.data(), shadow.rays);
    }
  }
  for (Packet& packet : packets) {
    light(packet);
  }
}

void CameraRenderer::Internals::render_strip(std::span<Packet> packets) const {
  const float weight = 1.0F / static_cast<float>(parameters.samples);
  for (int sample = 0; sample < parameters.samples; ++sample) {
    for (Packet& packet : packets) {
      pixels.aim(sample, packet.pixels);
    }
    shade(packets);
    for (Packet& packet : packets) {
      add_up(packet.luminance, packet.pixels.active, sample == 0, weight, packet.sum);
    }
  }
  for (Packet& packet : packets) {
    store(packet.sum, packet.pixels.valid, static_cast<std::size_t>(frame.width),
          frame.luminance + 3 * pixel_at(packet.pixels, 0));
    if (frame.job->truth) {
      tell_truth(packet);
    }
  }
}

/// Pixels of a row whose light is more than edge_ratio times that of one of four neighbours, or
/// less than its inverse. Light that fills the pixel counts as full.
void CameraRenderer::Internals::find_edges(int row, std::vector<PixelPlace>& edges) const {
  const auto width = static_cast<std::size_t>(frame.width);
  const auto ratio = static_cast<float>(parameters.edge_ratio);
  const float dark = static_cast<float>(kDarkShare) * 3.0F * frame.full_cd;
  const auto light_at = [&](std::size_t pixel) {
    const float* const at = frame.luminance + 3 * pixel;
    return std::min(at[0] + at[1] + at[2], 3.0F * frame.full_cd) + dark;
  };
  const std::size_t first = static_cast<std::size_t>(row) * width;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t pixel = first + i;
    const float here = light_at(pixel);
    const float left = i > 0 ? light_at(pixel - 1) : here;
    const float right = i + 1 < width ? light_at(pixel + 1) : here;
    const float above = row > 0 ? light_at(pixel - width) : here;
    const float below = row + 1 < frame.height ? light_at(pixel + width) : here;
    const float least = std::min({left, right, above, below});
    const float most = std::max({left, right, above, below});
    if (most > ratio * here || here > ratio * least) {
      edges.push_back({static_cast<int>(i), row});
    }
  }
}

/// Edges of these rows, their parts shaded.
void CameraRenderer::Internals::render_parts(int first_row, int end_row,
                                             std::vector<PartsLight>& found) const {
  const FlushDenormals flush;
  std::vector<PixelPlace> edges;
  for (int row = first_row; row < end_row; ++row) {
    find_edges(row, edges);
  }
  std::array<Packet, kPartPackets> packets;
  for (Packet& packet : packets) {
    packet.pixels.limit(frame.limits);
  }
  found.clear();
  for (std::size_t begin = 0; begin < edges.size();) {
    const std::size_t count = std::min(edges.size() - begin, kPartPackets * kPixelsInParts);
    const std::size_t filled = (count + kPixelsInParts - 1) / kPixelsInParts;
    for (std::size_t k = 0; k < filled; ++k) {
      std::array<PixelPlace, kPixelsInParts> places;
      for (std::size_t i = 0; i < kPixelsInParts; ++i) {
        places[i] = edges[begin + std::min(k * kPixelsInParts + i, count - 1)];
      }
      pixels.aim_parts(places, packets[k].pixels);
    }
    shade(std::span(packets).first(filled));
    for (std::size_t i = 0; i < count; ++i) {
      const Packet& packet = packets[i / kPixelsInParts];
      const std::size_t lane = i % kPixelsInParts * kParts;
      const PixelPlace& place = edges[begin + i];
      PartsLight& of = found.emplace_back();
      of.pixel = static_cast<std::size_t>(place.row) * static_cast<std::size_t>(frame.width) +
                 static_cast<std::size_t>(place.column);
      for (std::size_t band = 0; band < 3 && packet.pixels.active[lane] != 0; ++band) {
        for (std::size_t part = 0; part < kParts; ++part) {
          of.luminance[band] += packet.luminance[band][lane + part] * (1.0F / kParts);
        }
      }
    }
    begin += count;
  }
}

/// Edges are found in what one ray per pixel saw, all of them, before any is changed.
void CameraRenderer::Internals::refine_edges() {
  const auto strips = static_cast<std::size_t>((frame.height + kRowsAtOnce - 1) / kRowsAtOnce);
  parts.resize(strips);
  const auto render = [this](std::size_t strip) {
    const int first = static_cast<int>(strip) * kRowsAtOnce;
    render_parts(first, std::min(first + kRowsAtOnce, frame.height), parts[strip]);
  };
  if (frame.record != nullptr) {
    for (std::size_t strip = 0; strip < strips; ++strip) {
      render(strip);
    }
  } else {
    pool.run(strips, render);
  }
  for (const std::vector<PartsLight>& strip : parts) {
    for (const PartsLight& of : strip) {
      std::ranges::copy(of.luminance, frame.luminance + 3 * of.pixel);
    }
  }
}

CameraRenderer::CameraRenderer(const CameraParameters& parameters, std::uint64_t seed,
                               std::string_view name)
    : internals_(std::make_unique<Internals>(parameters, seed, name)) {}

CameraRenderer::~CameraRenderer() = default;

const CameraParameters& CameraRenderer::parameters() const {
  return internals_->parameters;
}
const Lens& CameraRenderer::lens() const {
  return internals_->lens;
}
const ImageSensor& CameraRenderer::sensor() const {
  return internals_->sensor;
}

/// Rows of the picture's luminance, from what was rendered.
void CameraRenderer::Internals::blur(int first_row, int end_row) const {
  const float weight = neighbour_weight(parameters.lens.mtf, parameters.samples > 1);
  std::vector<float> row_sum(3 * static_cast<std::size_t>(frame.width));
  const std::size_t width = 3 * static_cast<std::size_t>(frame.picture->width);
  for (int row = first_row; row < end_row; ++row) {
    blur_row(
        sharp, {frame.width, frame.height}, frame.left, row + frame.top, weight, row_sum,
        std::span(frame.picture->luminance).subspan(width * static_cast<std::size_t>(row), width));
  }
}

/// Renders the luminance in tiles and pixels on edges anew with four rays each (refine_edges()),
/// then blurs (lens_blur.h) and exposes (image_sensor.h) it in strips of rows. Tiles and strips are
/// shared by the threads.
void CameraRenderer::render(const Scene& scene, const PictureJob& job, RenderedPicture& picture) {
  Internals& in = *internals_;
  const bool blurred = neighbour_weight(in.parameters.lens.mtf, in.parameters.samples > 1) > 0.0F;
  const int margin = (blurred ? kBlurMargin : 0) + (in.has_parts() ? kEdgeMargin : 0);
  in.prepare(scene, job, {in.parameters.samples, 0, in.has_parts()}, margin);
  in.frame.picture = &picture;
  const int width = job.read_out.region.width / job.read_out.binning_x;
  const int height = job.read_out.region.height / job.read_out.binning_y;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  resize(picture, width, height, pixels, job.truth ? pixels : 0);
  in.sharp.resize(margin > 0 ? 3 * static_cast<std::size_t>(in.frame.width) *
                                   static_cast<std::size_t>(in.frame.height)
                             : 0);
  in.frame.luminance = margin > 0 ? in.sharp.data() : picture.luminance.data();
  in.pool.run(in.tiles(), [&in](std::size_t tile) {
    in.each_strip(tile, [&in](std::span<Internals::Packet> packets) { in.render_strip(packets); });
  });
  if (in.has_parts()) {
    in.refine_edges();
  }

  std::array<float, 3> haze{};
  for (int band = 0; band < 3; ++band) {
    haze[static_cast<std::size_t>(band)] =
        job.light->total_lx()[band] * std::numbers::inv_pi_v<float>;
  }
  const auto strips = static_cast<std::size_t>((height + kRowsAtOnce - 1) / kRowsAtOnce);
  in.pool.run(strips, [&](std::size_t strip) {
    const int first = static_cast<int>(strip) * kRowsAtOnce;
    const int end = std::min(first + kRowsAtOnce, height);
    if (margin > 0) {
      in.blur(first, end);
    }
    in.sensor.expose(picture.luminance, in.pixels.falloff(), haze, job.read_out, first, end,
                     picture.numbers);
  });
  picture.mean = mean_share(picture.numbers, job.read_out);
  in.frame = {};
}

void CameraRenderer::measure(const Scene& scene, const PictureJob& job, RenderedPicture& picture) {
  Internals& in = *internals_;
  in.prepare(scene, job, {});
  in.frame.picture = &picture;
  resize(picture, in.frame.width, in.frame.height, 0,
         static_cast<std::size_t>(in.frame.width) * static_cast<std::size_t>(in.frame.height));
  in.pool.run(in.tiles(), [&in](std::size_t tile) {
    in.each_strip(tile, [&in](std::span<Internals::Packet> packets) {
      for (Internals::Packet& packet : packets) {
        in.tell_truth(packet);
      }
    });
  });
  picture.mean = 0.0;
  in.frame = {};
}

void CameraRenderer::cast(const Scene& scene, const PictureJob& job, int rays_across,
                          PictureRays& found) {
  Internals& in = *internals_;
  require(rays_across >= 1 && rays_across <= kMostRaysAcross,
          "found " + std::to_string(rays_across) + " rays across a pixel, allowed 1 .. " +
              std::to_string(kMostRaysAcross));
  in.prepare(scene, job, {rays_across * rays_across, rays_across});
  found.width = in.frame.width;
  found.height = in.frame.height;
  found.rays = rays_across * rays_across;
  const std::size_t all = static_cast<std::size_t>(found.width) *
                          static_cast<std::size_t>(found.height) *
                          static_cast<std::size_t>(found.rays);
  found.range_m.resize(all);
  found.cosine.resize(all);
  found.reflectance.resize(all);
  found.depth.assign(job.air != nullptr && !job.air->clear() ? all : 0, 0.0F);
  in.pool.run(in.tiles(), [&in, &found](std::size_t tile) {
    in.each_strip(tile, [&in, &found](std::span<Internals::Packet> packets) {
      for (Internals::Packet& packet : packets) {
        in.collect_rays(packet, found);
      }
    });
  });
  in.frame = {};
}

RecordedPictureRays CameraRenderer::record(const Scene& scene, const PictureJob& job) {
  Internals& in = *internals_;
  in.prepare(scene, job, {in.parameters.samples, 0, in.has_parts()});
  RecordedPictureRays recorded;
  RenderedPicture picture;
  picture.luminance.resize(3 * static_cast<std::size_t>(in.frame.width) *
                           static_cast<std::size_t>(in.frame.height));
  PictureJob without_truth = job;
  without_truth.truth = false;
  in.frame.job = &without_truth;
  in.frame.picture = &picture;
  in.frame.luminance = picture.luminance.data();
  in.frame.record = recorded.packets_.get();
  for (std::size_t tile = 0; tile < in.tiles(); ++tile) {
    in.each_strip(tile, [&in](std::span<Internals::Packet> packets) { in.render_strip(packets); });
  }
  if (in.has_parts()) {
    in.refine_edges();
  }
  in.frame = {};
  recorded.reset();
  return recorded;
}

}  // namespace rigwire::sim
