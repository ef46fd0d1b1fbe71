#include "sim/camera/camera_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/rules.h"
#include "sim/camera/shading_lanes.h"
#include "sim/lidar/beam_hits.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/hit_surface.h"
#include "sim/lidar/worker_pool.h"
#include "sim/random.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

// A packet is four pixels wide and two high.
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = 2;
constexpr int kTileWidth = 32;
constexpr int kTileHeight = 8;
constexpr int kRowsAtOnce = 8;
constexpr int kMostRaysAcross = 32;
/// Where a path through fog or rain ends for rays that meet nothing.
constexpr double kFarthestAir_m = 5000.0;
constexpr double kAirHeight_m = 1500.0;
/// Dust's own colour: its share of the light, red, green, blue (mineral dust scatters 0.9 and more
/// of the light, less of the blue).
constexpr std::array<float, 3> kDustColour{0.92F, 0.80F, 0.62F};

/// Which way a pixel's middle looks, unit vector in S.
struct alignas(16) PixelDirection {
  float x = 1.0F, y = 0.0F, z = 0.0F;
  float angle_rad = 0.0F;  ///< To the next pixel of its row; 0: no picture here.
};

/// The camera at the middle of a row's exposure, in Embree's coordinates.
struct RowPose {
  std::array<float, 9> R{};  ///< R_WS, column by column.
  std::array<float, 3> p{}, v{}, w{};
  float time = 0.0F;  ///< Share of the slice.
};

struct Slopes {
  float x = 0.0F, y = 0.0F;
};

/// A terrain's slopes at its nodes.
struct TerrainSlopes {
  Eigen::Vector2f offset_m;  ///< Of Embree's origin from the first node.
  float per_m = 1.0F;
  int columns = 0;
  int rows = 0;
  std::vector<Slopes> nodes;

  [[nodiscard]] Slopes at(float x_m, float y_m) const {
    const float x =
        std::clamp((x_m + offset_m.x()) * per_m, 0.0F, static_cast<float>(columns - 1) * 0.999999F);
    const float y =
        std::clamp((y_m + offset_m.y()) * per_m, 0.0F, static_cast<float>(rows - 1) * 0.999999F);
    const int column = std::min(static_cast<int>(x), columns - 2);
    const int row = std::min(static_cast<int>(y), rows - 2);
    const float a = x - static_cast<float>(column);
    const float b = y - static_cast<float>(row);
    const Slopes* const n = nodes.data() + row * columns + column;
    const auto blend = [&](float Slopes::*member) {
      return (1.0F - b) * ((1.0F - a) * n[0].*member + a * n[1].*member) +
             b * ((1.0F - a) * n[columns].*member + a * n[columns + 1].*member);
    };
    return {blend(&Slopes::x), blend(&Slopes::y)};
  }
};

/// How terrain looks: by the soil of a cell and by its slope.
struct TerrainLooks {
  const Scene::Internals::Cover* cover = nullptr;  ///< Null: the material everywhere.
  std::vector<std::uint16_t> of_label;             ///< Look by the cover's label.
};

/// Coordinates of something with panes, and how they stand in its sides.
struct PaneFrame {
  std::array<float, 12> X{};  ///< Of the mesh in Embree's coordinates, column by column.
  Eigen::AlignedBox3f bounds_M;
  Panes panes;
};

/// A value in [-1, 1) that wavers over the plane: one octave of value noise.
float waver(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x);
  const float fy = std::floor(y);
  const auto value = [&](float dx, float dy) {
    const auto ix = static_cast<std::uint32_t>(static_cast<std::int32_t>(fx + dx));
    const auto iy = static_cast<std::uint32_t>(static_cast<std::int32_t>(fy + dy));
    std::uint32_t mixed = ix * 0x9E3779B1U ^ iy * 0x85EBCA77U ^ seed;
    mixed ^= mixed >> 15U;
    mixed *= 0x2C1B3C6DU;
    mixed ^= mixed >> 13U;
    return static_cast<float>(static_cast<std::int32_t>(mixed * 0x297A2D39U)) * 0x1.0p-31F;
  };
  const float a = x - fx;
  const float b = y - fy;
  const float u = a * a * (3.0F - 2.0F * a);
  const float v = b * b * (3.0F - 2.0F * b);
  return (1.0F - v) * ((1.0F - u) * value(0.0F, 0.0F) + u * value(1.0F, 0.0F)) +
         v * ((1.0F - u) * value(0.0F, 1.0F) + u * value(1.0F, 1.0F));
}

/// Share of the stretch [from, from + length] that lies in [begin, end] of a period of 1.
float share_within(float from, float length, float begin, float end) {
  const auto sum = [&](float x) {
    const float whole = std::floor(x);
    return whole * (end - begin) + std::clamp(x - whole - begin, 0.0F, end - begin);
  };
  return (sum(from + length) - sum(from)) / length;
}

const Stones& no_stones() {
  static const Stones kNone = [] {
    Stones none{};
    none.tone.fill(1.0F);
    none.gap.fill(1.0F);
    return none;
  }();
  return kNone;
}

TerrainSlopes slopes_of(const HeightField& field, const Eigen::Vector3d& origin_W) {
  TerrainSlopes slopes;
  slopes.offset_m = (origin_W.head<2>() - field.origin_m).cast<float>();
  slopes.per_m = static_cast<float>(1.0 / field.cell_m);
  slopes.columns = static_cast<int>(field.columns);
  slopes.rows = static_cast<int>(field.rows);
  slopes.nodes.resize(field.columns * field.rows);
  for (std::size_t r = 0; r < field.rows; ++r) {
    const std::size_t south = r == 0 ? 0 : r - 1;
    const std::size_t north = std::min(r + 1, field.rows - 1);
    const double per_row = 1.0 / (field.cell_m * static_cast<double>(north - south));
    for (std::size_t c = 0; c < field.columns; ++c) {
      const std::size_t west = c == 0 ? 0 : c - 1;
      const std::size_t east = std::min(c + 1, field.columns - 1);
      // Central differences.
      slopes.nodes[r * field.columns + c] = {
          static_cast<float>((field.node(east, r) - field.node(west, r)) /
                             (field.cell_m * static_cast<double>(east - west))),
          static_cast<float>((field.node(c, north) - field.node(c, south)) * per_row)};
    }
  }
  return slopes;
}

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

/// Which of the rays are stopped has tfar below 0 afterwards; rays already stopped stay so.
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

struct ShadowPacket {
  RTCRay8 rays;
  alignas(32) std::array<int, kLanes> active;
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

std::size_t RecordedPictureRays::shadow_rays() const {
  std::size_t count = 0;
  for (const ShadowPacket& packet : packets_->shadow) {
    count += static_cast<std::size_t>(std::ranges::count(packet.active, -1));
  }
  return count;
}

void RecordedPictureRays::reset() {
  packets_->primary_work = packets_->primary;
  packets_->shadow_work = packets_->shadow;
}

void RecordedPictureRays::cast_bare(const Scene& scene) {
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
      occlude(scene.internals(), packets_->shadow_work[shadow].active.data(),
              packets_->shadow_work[shadow].rays);
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
        pool(given.threads) {
    look_through_lens();
  }

  void look_through_lens();
  void prepare(const Scene& scene, const PictureJob& job);
  void prepare_looks(const Scene::Internals& in);
  void prepare_rows(const Scene::Internals& in, const PictureJob& job);

  /// One packet of pixels through one sample, and what it met.
  struct Packet;
  /// What all packets of a picture have in common.
  struct Frame {
    const Scene::Internals* in = nullptr;
    const PictureJob* job = nullptr;
    int width = 0;
    int height = 0;
    std::uint64_t key = 0;
    LightTerms light;
    RenderedPicture* picture = nullptr;
    RecordedPictureRays::Packets* record = nullptr;
    double exposure_s = 0.0;
    float slices_per_s = 0.0F;
    std::array<float, 3> airlight{};
    std::array<float, 3> dustlight{};
    Eigen::Vector2f sky_offset = Eigen::Vector2f::Zero();
  };

  [[nodiscard]] std::size_t table_at(int column, int row) const {
    return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(sensor_width() + 2) +
           static_cast<std::size_t>(column + 1);
  }
  [[nodiscard]] int sensor_width() const { return parameters.sensor.width_px; }
  void render_tile(std::size_t tile) const;
  void aim(int column, int row, int sample, int samples, Packet& packet) const;
  void aim_sample(Packet& packet, LaneArray& sx, LaneArray& sy, LaneArray& sz, LaneArray& dt) const;
  void shade(Packet& packet) const;
  LookLanes find_looks(Packet& packet) const;
  [[nodiscard]] std::uint32_t ground_look(const SurfaceInfo& info, const Slopes& slope,
                                          const Eigen::Vector2f& at_m, float footprint_m) const;
  void refine(Packet& packet) const;
  void glaze(const Packet& packet, LitLanes& lit) const;
  void see_nothing(Packet& packet, std::size_t lane) const;
  void pass_air(Packet& packet) const;
  void tell_truth(int column, int row) const;
  template <class Work>
  void each_packet(std::size_t tile, const Work& work) const;
  void collect_rays(int column, int row, PictureRays& found) const;
  [[nodiscard]] std::size_t tiles() const {
    return static_cast<std::size_t>((frame.width + kTileWidth - 1) / kTileWidth) *
           static_cast<std::size_t>((frame.height + kTileHeight - 1) / kTileHeight);
  }

  CameraParameters parameters;
  Lens lens;
  ImageSensor sensor;
  std::uint64_t key;
  WorkerPool pool;
  std::vector<PixelDirection> directions;  ///< One pixel more on each side.
  std::vector<float> falloff;

  // Of the picture that is being rendered; memory is used again.
  Frame frame;
  std::vector<RowPose> rows;
  std::vector<SurfaceInfo> infos;
  std::vector<PreparedLook> looks;
  std::vector<TerrainSlopes> terrains;
  std::vector<TerrainLooks> terrain_looks;
  std::uint16_t face = 0;  ///< Look of bare slopes.
  std::vector<PaneFrame> pane_frames;
  StoneAnchor stone_anchor;
};

struct CameraRenderer::Internals::Packet {
  int column = 0;
  int row = 0;
  int sample = 0;
  int samples = 1;
  int lattice = 0;  ///< Samples across a pixel that stand in rows; 0: they are scattered.
  /// Of the packet among the samples of a picture.
  [[nodiscard]] std::uint64_t number() const {
    return (static_cast<std::uint64_t>(row) << 30U) + (static_cast<std::uint64_t>(column) << 12U) +
           static_cast<std::uint64_t>(sample);
  }
  alignas(32) std::array<int, kLanes> valid;    ///< Pixels of the picture.
  alignas(32) std::array<int, kLanes> active;   ///< Those that the lens fills.
  LaneArray pixel_rad;                          ///< Angle between neighbours.
  bool on_bodies = false;                       ///< Some met what moves: X is filled there.
  bool stony = false;                           ///< Some have stones,
  bool glazed = false;                          ///< some panes.
  std::array<Slopes, kLanes> slope;             ///< Of terrain.
  std::array<std::array<float, 12>, kLanes> X;  ///< Poses of the links, column by column.
  RTCRayHit8 rays;
  MetSurfaces met;
  std::array<LaneArray, 3> luminance;
};

void CameraRenderer::Internals::look_through_lens() {
  const int width = sensor_width();
  const int height = parameters.sensor.height_px;
  const bool all_round = parameters.lens.model == LensModel::equirectangular;
  const auto upright_rad = static_cast<float>(1.0 / lens.focal_length_px());
  directions.resize(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height + 2) +
                    kPacketWidth);
  falloff.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = -1; row <= height; ++row) {
    for (int column = -1; column <= width; ++column) {
      auto direction = lens.direction(Eigen::Vector2d(column, row));
      const bool within = row >= 0 && row < height && column >= 0 && column < width;
      if (!direction && !within) {
        // Beside the sensor, where the model may end: as the pixel next to it.
        direction = lens.direction(
            Eigen::Vector2d(std::clamp(column, 0, width - 1), std::clamp(row, 0, height - 1)));
      }
      PixelDirection& to = directions[table_at(column, row)];
      if (direction) {
        const Eigen::Vector3f d = lens_to_mount(*direction).cast<float>();
        to = {d.x(), d.y(), d.z(), 1.0F};
        if (column > -1) {
          PixelDirection& before = directions[table_at(column - 1, row)];
          const float angle_rad = std::sqrt((before.x - to.x) * (before.x - to.x) +
                                            (before.y - to.y) * (before.y - to.y) +
                                            (before.z - to.z) * (before.z - to.z));
          // The last one of a row has that of its neighbour; pixels are never wider than 0.2 rad.
          // Near the poles of an equirectangular picture they are as high as everywhere.
          to.angle_rad = std::clamp(all_round ? upright_rad : angle_rad, 1e-7F, 0.2F);
          before.angle_rad = before.angle_rad > 0.0F ? to.angle_rad : 0.0F;
        }
      }
      if (within) {
        falloff[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(column)] =
            direction ? static_cast<float>(lens.falloff(*direction)) : 0.0F;
      }
    }
  }
}

void CameraRenderer::Internals::prepare_looks(const Scene::Internals& in) {
  looks.clear();
  const auto add_look = [&](const Shade& shade) {
    PreparedLook& look = looks.emplace_back();
    look.shade = shade;
    GrainAnchor anchor;
    anchor.set(0, in.origin_W, static_cast<double>(shade.frequency_pm),
               static_cast<double>(shade.upright));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      look.cell[axis] = anchor.cell[axis][0];
      look.share[axis] = anchor.share[axis][0];
    }
    return static_cast<std::uint16_t>(looks.size() - 1);
  };
  for (const Material& material : in.materials) {
    add_look(shade_of(material, parameters.looks));
  }
  face = add_look(cut_face());
  stone_anchor = StoneAnchor(in.origin_W);
  pane_frames.clear();
  infos.assign(in.instance_of.size(), {});
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const std::uint32_t instance = in.instance_of[i];
    if (instance >= in.instances.size()) {
      continue;
    }
    infos[i].look = static_cast<std::uint16_t>(in.instances[instance].material);
    const Scene::Internals::Placed& placed = in.placed_of(instance);
    infos[i].on_body = placed.body != Scene::Internals::kFixed;
    for (std::size_t t = 0; t < in.terrains.size(); ++t) {
      if (in.terrains[t].instance == instance) {
        infos[i].terrain = static_cast<std::uint8_t>(t + 1);
      }
    }
    const Panes& panes = looks[infos[i].look].shade.panes;
    if (panes.across_m > 0.0F) {
      PaneFrame& frame_of = pane_frames.emplace_back();
      const Eigen::Matrix3f R = placed.X_PM.linear().cast<float>();
      const Eigen::Vector3f p = (placed.X_PM.translation() - in.origin_W).cast<float>();
      std::copy_n(R.data(), 9, frame_of.X.data());
      std::copy_n(p.data(), 3, frame_of.X.data() + 9);
      const auto scale = static_cast<float>(placed.scale);
      frame_of.bounds_M = {scale * placed.bounds_M.min(), scale * placed.bounds_M.max()};
      frame_of.panes = panes;
      infos[i].panes = static_cast<std::uint32_t>(pane_frames.size());
    }
  }
  terrains.clear();
  terrain_looks.clear();
  for (const Scene::Internals::Terrain& terrain : in.terrains) {
    terrains.push_back(slopes_of(terrain.field, in.origin_W));
    TerrainLooks& of = terrain_looks.emplace_back();
    const auto own = static_cast<std::uint16_t>(in.instances[terrain.instance].material);
    if (!terrain.cover) {
      continue;
    }
    of.cover = terrain.cover.get();
    for (const std::string& label : terrain.cover->labels) {
      const auto shade = shade_of_soil(label, parameters.looks);
      of.of_label.push_back(shade ? add_look(*shade) : own);
    }
  }
}

void CameraRenderer::Internals::prepare_rows(const Scene::Internals& in, const PictureJob& job) {
  rows.resize(static_cast<std::size_t>(frame.height));
  const Duration half = job.read_out.exposure / 2;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const SimTime middle =
        job.exposure_start + half +
        parameters.sensor.row_time * (static_cast<Duration::rep>(row) * job.read_out.binning_y);
    RowPose& pose = rows[row];
    if (row > 0 && parameters.sensor.row_time == Duration{0}) {
      pose = rows.front();
      continue;
    }
    const LinkMotion mount = mount_at(job.poses, middle);
    const Eigen::Matrix3f R = mount.X_WL.linear().cast<float>();
    const Eigen::Vector3f p = (mount.X_WL.translation() - in.origin_W).cast<float>();
    std::copy_n(R.data(), 9, pose.R.data());
    std::copy_n(p.data(), 3, pose.p.data());
    std::copy_n(mount.v_WL_W.cast<float>().eval().data(), 3, pose.v.data());
    std::copy_n(mount.w_WL_W.cast<float>().eval().data(), 3, pose.w.data());
    pose.time = in.slice_fraction(middle);
  }
}

void CameraRenderer::Internals::prepare(const Scene& scene, const PictureJob& job) {
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
  frame.width = job.read_out.region.width / job.read_out.binning_x;
  frame.height = job.read_out.region.height / job.read_out.binning_y;
  frame.key = counter_bits(key, job.read_out.frame);
  const Eigen::Vector3f& total = job.light->total_lx();
  const auto around = static_cast<float>(job.light->parameters().ground_albedo);
  frame.light = light_terms(*job.light, job.wetness);
  frame.exposure_s = to_seconds(job.read_out.exposure);
  frame.slices_per_s = static_cast<float>(1.0 / to_seconds(in.t1 - in.t0));
  for (int band = 0; band < 3; ++band) {
    // Air lit from all round sends on the mean of what comes from above and from below.
    const float mean = total[band] * (1.0F + around) * 0.5F * std::numbers::inv_pi_v<float>;
    frame.airlight[static_cast<std::size_t>(band)] = mean;
    frame.dustlight[static_cast<std::size_t>(band)] =
        mean * kDustColour[static_cast<std::size_t>(band)];
  }
  if (job.sky != nullptr) {
    frame.sky_offset = (in.origin_W.head<2>() - job.sky->origin_m()).cast<float>();
  }
  prepare_looks(in);
  prepare_rows(in, job);
}

/// Directions of one sample of several, or of binned pixels, interpolated between the middles of
/// sensor pixels, and instants beside the middle of the exposure.
void CameraRenderer::Internals::aim_sample(Packet& packet, LaneArray& sx, LaneArray& sy,
                                           LaneArray& sz, LaneArray& dt) const {
  const ReadOut& r = frame.job->read_out;
  const int sample = packet.sample;
  const int samples = packet.samples;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const int inside_c =
        std::min(packet.column + static_cast<int>(i) % kPacketWidth, frame.width - 1);
    const int inside_w =
        std::min(packet.row + static_cast<int>(i) / kPacketWidth, frame.height - 1);
    // Place in the pixel by the R2 sequence (M. Roberts, 2018), turned for each pixel by a number
    // of its own; instants in strata.
    double across = 0.5;
    double down = 0.5;
    double when = 0.5;
    if (samples > 1) {
      const auto pixel = static_cast<std::uint64_t>(r.region.y + inside_w * r.binning_y) << 32U |
                         static_cast<std::uint32_t>(r.region.x + inside_c * r.binning_x);
      const std::uint64_t own = counter_bits(frame.key, pixel);
      const auto wrap = [](double x) { return x - std::floor(x); };
      across = wrap(0.7548776662466927 * sample + static_cast<double>(own & 0xFFFFU) * 0x1.0p-16);
      down =
          wrap(0.5698402909980532 * sample + static_cast<double>(own >> 16U & 0xFFFFU) * 0x1.0p-16);
      if (packet.lattice > 0) {
        across = (sample % packet.lattice + 0.5) / packet.lattice;
        down = (sample / packet.lattice + 0.5) / packet.lattice;
      }
      const std::uint64_t stratum =
          (static_cast<std::uint64_t>(sample) + (own >> 56U)) % static_cast<std::uint64_t>(samples);
      when =
          (static_cast<double>(stratum) + static_cast<double>(own >> 32U & 0xFFFFU) * 0x1.0p-16) /
          samples;
    }
    const double x = r.region.x + inside_c * r.binning_x - 0.5 + across * r.binning_x;
    const double y = r.region.y + inside_w * r.binning_y - 0.5 + down * r.binning_y;
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const auto a = static_cast<float>(x - x0);
    const auto b = static_cast<float>(y - y0);
    const std::size_t at = table_at(x0, y0);
    const std::size_t below = table_at(x0, y0 + 1);
    const PixelDirection& d00 = directions[at];
    const PixelDirection& d10 = directions[at + 1];
    const PixelDirection& d01 = directions[below];
    const PixelDirection& d11 = directions[below + 1];
    const auto blend = [&](float PixelDirection::*m) {
      return (1.0F - b) * ((1.0F - a) * d00.*m + a * d10.*m) +
             b * ((1.0F - a) * d01.*m + a * d11.*m);
    };
    const float least = std::min({d00.angle_rad, d10.angle_rad, d01.angle_rad, d11.angle_rad});
    PixelDirection d{blend(&PixelDirection::x), blend(&PixelDirection::y),
                     blend(&PixelDirection::z), least};
    const float size = 1.0F / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    d.x *= size;
    d.y *= size;
    d.z *= size;
    packet.pixel_rad[i] = d.angle_rad * static_cast<float>(r.binning_x);
    sx[i] = d.x;
    sy[i] = d.y;
    sz[i] = d.z;
    dt[i] = static_cast<float>((when - 0.5) * frame.exposure_s);
  }
}

/// Rays of a packet: directions in S, turned into the world at the pixel's own instant.
void CameraRenderer::Internals::aim(int column, int row, int sample, int samples,
                                    Packet& packet) const {
  const PictureJob& job = *frame.job;
  const ReadOut& r = job.read_out;
  packet.column = column;
  packet.row = row;
  packet.sample = sample;
  packet.samples = samples;
  LaneArray sx, sy, sz, dt;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const int c = column + static_cast<int>(i) % kPacketWidth;
    const int w = row + static_cast<int>(i) / kPacketWidth;
    packet.valid[i] = c < frame.width && w < frame.height ? -1 : 0;
  }
  if (samples == 1 && r.binning_x == 1 && r.binning_y == 1) {
    for (int half = 0; half < kPacketHeight; ++half) {
      // Beyond the end of a row lies more of the table.
      const PixelDirection* const d =
          directions.data() +
          table_at(r.region.x + column, r.region.y + std::min(row + half, frame.height - 1));
      for (std::size_t k = 0; k < kPacketWidth; ++k) {
        const std::size_t i = static_cast<std::size_t>(half) * kPacketWidth + k;
        sx[i] = d[k].x;
        sy[i] = d[k].y;
        sz[i] = d[k].z;
        packet.pixel_rad[i] = d[k].angle_rad;
        dt[i] = 0.0F;
      }
    }
  } else {
    aim_sample(packet, sx, sy, sz, dt);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    packet.active[i] = packet.pixel_rad[i] > 0.0F ? packet.valid[i] : 0;
  }
  RTCRay8& ray = packet.rays.ray;
  for (int half = 0; half < kPacketHeight; ++half) {
    const RowPose pose = rows[static_cast<std::size_t>(std::min(row + half, frame.height - 1))];
    const std::size_t first = static_cast<std::size_t>(half) * kPacketWidth;
#pragma GCC ivdep
    for (std::size_t i = first; i < first + kPacketWidth; ++i) {
      const float x = pose.R[0] * sx[i] + pose.R[3] * sy[i] + pose.R[6] * sz[i];
      const float y = pose.R[1] * sx[i] + pose.R[4] * sy[i] + pose.R[7] * sz[i];
      const float z = pose.R[2] * sx[i] + pose.R[5] * sy[i] + pose.R[8] * sz[i];
      // Turned and moved on since the middle of the exposure.
      ray.dir_x[i] = x + dt[i] * (pose.w[1] * z - pose.w[2] * y);
      ray.dir_y[i] = y + dt[i] * (pose.w[2] * x - pose.w[0] * z);
      ray.dir_z[i] = z + dt[i] * (pose.w[0] * y - pose.w[1] * x);
      ray.org_x[i] = pose.p[0] + dt[i] * pose.v[0];
      ray.org_y[i] = pose.p[1] + dt[i] * pose.v[1];
      ray.org_z[i] = pose.p[2] + dt[i] * pose.v[2];
      const float time = pose.time + dt[i] * frame.slices_per_s;
      ray.time[i] = time < 0.0F ? 0.0F : (time > 1.0F ? 1.0F : time);
    }
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    ray.tnear[i] = static_cast<float>(parameters.near_m);
    ray.tfar[i] = static_cast<float>(parameters.far_m);
    ray.mask[i] = job.mask;
    ray.id[i] = 0;
    ray.flags[i] = 0;
    packet.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.hit.primID[i] = 0;
  }
}

/// Of ground at a place of the plane, in Embree's coordinates. Soils meet in ragged edges, and
/// steep slopes are bare.
std::uint32_t CameraRenderer::Internals::ground_look(const SurfaceInfo& info, const Slopes& slope,
                                                     const Eigen::Vector2f& at_m,
                                                     float footprint_m) const {
  const std::size_t t = info.terrain - 1U;
  const TerrainSlopes& field = terrains[t];
  const TerrainLooks& ground = terrain_looks[t];
  // What wavers ends at the pixel as grain does.
  const auto fading = [&](float cell_m) {
    return std::clamp(cell_m / footprint_m * (1.0F / 1.5F) - 0.5F, 0.0F, 1.0F);
  };
  const auto place = [&](const Eigen::Vector2f& p) {
    return Eigen::Vector2f((p + field.offset_m) * field.per_m);
  };
  Eigen::Vector2f at = place(at_m);
  std::uint32_t look = info.look;
  if (ground.cover != nullptr) {
    const Scene::Internals::Cover& cover = *ground.cover;
    const int columns = field.columns - 1;
    const int rows_there = field.rows - 1;
    const auto cell = [&](float x, float y) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(y), 0, rows_there - 1)) *
                 static_cast<std::size_t>(columns) +
             static_cast<std::size_t>(std::clamp(static_cast<int>(x), 0, columns - 1));
    };
    std::size_t here = cell(at.x(), at.y());
    if (cover.near_edge[here] != 0) {
      constexpr float kCoarse_m = 0.9F;
      constexpr float kFine_m = 0.16F;
      const Eigen::Vector2f world = at / field.per_m;
      // Hard surfaces are laid along a line.
      constexpr auto kReach = static_cast<float>(Scene::Internals::kCoverReach);
      bool laid = false;
      for (const float dx : {-kReach, 0.0F, kReach}) {
        for (const float dy : {-kReach, 0.0F, kReach}) {
          laid =
              laid ||
              looks[ground.of_label[cover.cells[cell(at.x() + dx, at.y() + dy)]]].shade.bare_from ==
                  0.0F;
        }
      }
      const float coarse = (laid ? 0.04F : 0.25F) * fading(kCoarse_m);
      const float fine = (laid ? 0.03F : 0.07F) * fading(kFine_m);
      const Eigen::Vector2f aside(coarse * waver(world.x() / kCoarse_m, world.y() / kCoarse_m, 1U) +
                                      fine * waver(world.x() / kFine_m, world.y() / kFine_m, 2U),
                                  coarse * waver(world.x() / kCoarse_m, world.y() / kCoarse_m, 3U) +
                                      fine * waver(world.x() / kFine_m, world.y() / kFine_m, 4U));
      at += aside * field.per_m;
      // The one of the four nearest cells that weighs most here.
      const float x = at.x() - 0.5F;
      const float y = at.y() - 0.5F;
      const float a = x - std::floor(x);
      const float b = y - std::floor(y);
      const std::array<std::size_t, 4> corner{cell(std::floor(x), std::floor(y)),
                                              cell(std::floor(x) + 1.0F, std::floor(y)),
                                              cell(std::floor(x), std::floor(y) + 1.0F),
                                              cell(std::floor(x) + 1.0F, std::floor(y) + 1.0F)};
      const std::array<float, 4> weight{(1.0F - a) * (1.0F - b), a * (1.0F - b), (1.0F - a) * b,
                                        a * b};
      float most = 0.0F;
      for (std::size_t i = 0; i < 4; ++i) {
        float sum = 0.0F;
        for (std::size_t k = 0; k < 4; ++k) {
          sum += cover.cells[corner[k]] == cover.cells[corner[i]] ? weight[k] : 0.0F;
        }
        if (sum > most) {
          most = sum;
          here = corner[i];
        }
      }
    }
    look = ground.of_label[cover.cells[here]];
  }
  const float bare_from = looks[look].shade.bare_from;
  if (bare_from > 0.0F) {
    const float steep = std::sqrt(slope.x * slope.x + slope.y * slope.y);
    constexpr float kPatch_m = 0.5F;
    const float reach = 0.25F * bare_from;
    if (steep > bare_from + reach) {
      look = face;
    } else if (steep > bare_from - reach) {
      const Eigen::Vector2f patch = at / (field.per_m * kPatch_m);
      const float ragged = reach * fading(kPatch_m) * waver(patch.x(), patch.y(), 5U);
      look = steep + ragged > bare_from ? face : look;
    }
  }
  return look;
}

/// Looks of what was met, slopes of terrain by the way.
LookLanes CameraRenderer::Internals::find_looks(Packet& packet) const {
  const SurfaceNumbers number(packet.rays.hit);
  const RTCRay8& ray = packet.rays.ray;
  LookLanes look;
  packet.stony = false;
  packet.glazed = false;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (number[i] == RTC_INVALID_GEOMETRY_ID) {
      look[i] = ~0U;
      continue;
    }
    const SurfaceInfo& info = infos[number[i]];
    look[i] = info.look;
    if (info.terrain != 0) {
      const float t = ray.tfar[i];
      const Eigen::Vector2f at(ray.org_x[i] + t * ray.dir_x[i], ray.org_y[i] + t * ray.dir_y[i]);
      packet.slope[i] = terrains[info.terrain - 1U].at(at.x(), at.y());
      // Ground lies flatter than the ray mostly: a pixel is as long there as the slant makes it.
      const float cosine = std::max(std::abs(ray.dir_z[i]), 0.05F);
      look[i] = ground_look(info, packet.slope[i], at,
                            t * packet.pixel_rad[i] / std::sqrt(cosine) + 1e-6F);
    }
    packet.stony = packet.stony || looks[look[i]].shade.stones > 0.0F;
    packet.glazed = packet.glazed || info.panes != 0;
  }
  return look;
}

/// Panes of glass in what is lit.
void CameraRenderer::Internals::glaze(const Packet& packet, LitLanes& lit) const {
  const SurfaceNumbers number(packet.rays.hit);
  const MetSurfaces& met = packet.met;
  static const Shade kGlass = shade_of(SurfaceKind::glass);
  constexpr float kUpright = 0.35F;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (number[i] == RTC_INVALID_GEOMETRY_ID || infos[number[i]].panes == 0) {
      continue;
    }
    const SurfaceInfo& info = infos[number[i]];
    const PaneFrame& pane = pane_frames[info.panes - 1U];
    const std::array<float, 12>& X = info.on_body ? packet.X[i] : pane.X;
    const auto turned_back = [&](float x, float y, float z) {
      return Eigen::Vector3f(X[0] * x + X[1] * y + X[2] * z, X[3] * x + X[4] * y + X[5] * z,
                             X[6] * x + X[7] * y + X[8] * z);
    };
    const Eigen::Vector3f n = turned_back(met.gx[i], met.gy[i], met.gz[i]);
    if (std::abs(n.z()) > kUpright) {
      continue;
    }
    const Eigen::Vector3f p =
        turned_back(met.x[i] - X[9], met.y[i] - X[10], met.z[i] - X[11]) - pane.bounds_M.min();
    const Eigen::Vector3f size = pane.bounds_M.sizes();
    const int along = std::abs(n.x()) > std::abs(n.y()) ? 1 : 0;
    const float columns = std::max(1.0F, std::round(size[along] / pane.panes.across_m));
    const float rows_of = std::max(1.0F, std::round(size.z() / pane.panes.up_m));
    const float per_x = columns / size[along];
    const float per_z = rows_of / size.z();
    // Averaged over the pixel's width.
    const float wide = met.points.footprint_m[i];
    const float u = p[along] * per_x;
    const float v = p.z() * per_z;
    const float glass =
        share_within(u - 0.5F * wide * per_x, wide * per_x, pane.panes.left, pane.panes.right) *
        share_within(v - 0.5F * wide * per_z, wide * per_z, pane.panes.bottom, pane.panes.top);
    lit.red[i] += glass * (kGlass.red - lit.red[i]);
    lit.green[i] += glass * (kGlass.green - lit.green[i]);
    lit.blue[i] += glass * (kGlass.blue - lit.blue[i]);
    lit.gloss[i] += glass * (kGlass.gloss - lit.gloss[i]);
    lit.sharpness[i] += glass * (kGlass.sharpness - lit.sharpness[i]);
    lit.nx[i] += glass * (met.nx[i] - lit.nx[i]);
    lit.ny[i] += glass * (met.ny[i] - lit.ny[i]);
    lit.nz[i] += glass * (met.nz[i] - lit.nz[i]);
  }
}

/// Smooth normals of terrain, and the own frame of what moves.
void CameraRenderer::Internals::refine(Packet& packet) const {
  const SurfaceNumbers number(packet.rays.hit);
  MetSurfaces& met = packet.met;
  packet.on_bodies = false;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (number[i] == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    const SurfaceInfo& info = infos[number[i]];
    if (info.terrain != 0) {
      const Slopes& slope = packet.slope[i];
      const float size = 1.0F / std::sqrt(1.0F + slope.x * slope.x + slope.y * slope.y);
      const float side = met.gz[i] < 0.0F ? -size : size;
      met.nx[i] = -slope.x * side;
      met.ny[i] = -slope.y * side;
      met.nz[i] = side;
    } else if (info.on_body) {
      // Where the link is at the ray's instant: columns of the linear part, then the origin.
      packet.on_bodies = true;
      std::array<float, 12>& X = packet.X[i];
      rtcGetGeometryTransform(frame.in->placed_of(frame.in->instance_of[number[i]]).geometry.get(),
                              packet.rays.ray.time[i], RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, X.data());
      const float x = met.x[i] - X[9];
      const float y = met.y[i] - X[10];
      const float z = met.z[i] - X[11];
      met.points.x[i] = X[0] * x + X[1] * y + X[2] * z;
      met.points.y[i] = X[3] * x + X[4] * y + X[5] * z;
      met.points.z[i] = X[6] * x + X[7] * y + X[8] * z;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // Each part has a pattern of its own.
        met.anchor.cell[axis][i] = static_cast<std::int32_t>(number[i] * 977U);
        met.anchor.share[axis][i] = 0.0F;
      }
      const RTCHit8& hit = packet.rays.hit;
      const float gx = X[0] * hit.Ng_x[i] + X[3] * hit.Ng_y[i] + X[6] * hit.Ng_z[i];
      const float gy = X[1] * hit.Ng_x[i] + X[4] * hit.Ng_y[i] + X[7] * hit.Ng_z[i];
      const float gz = X[2] * hit.Ng_x[i] + X[5] * hit.Ng_y[i] + X[8] * hit.Ng_z[i];
      const RTCRay8& ray = packet.rays.ray;
      const float along = gx * ray.dir_x[i] + gy * ray.dir_y[i] + gz * ray.dir_z[i];
      const float length = std::sqrt(gx * gx + gy * gy + gz * gz);
      const float size = (along > 0.0F ? -1.0F : 1.0F) / std::max(length, 1e-20F);
      met.nx[i] = met.gx[i] = gx * size;
      met.ny[i] = met.gy[i] = gy * size;
      met.nz[i] = met.gz[i] = gz * size;
    }
  }
}

void CameraRenderer::Internals::see_nothing(Packet& packet, std::size_t lane) const {
  const RTCRay8& ray = packet.rays.ray;
  const Eigen::Vector3f direction(ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]);
  const Daylight& light = *frame.job->light;
  Eigen::Vector3f seen = light.luminance(direction);
  const float apart = (direction - light.to_sun_W()).squaredNorm();
  constexpr float kDisc = Daylight::kSunRadius_rad * Daylight::kSunRadius_rad;
  // A disc smaller than the pixel fills its share of it.
  const float pixel = packet.pixel_rad[lane] * packet.pixel_rad[lane];
  if (light.sun_shines() && apart < std::max(kDisc, 0.3F * pixel)) {
    seen += light.sun_luminance() * std::min(1.0F, std::numbers::pi_v<float> * kDisc / pixel);
  }
  for (int band = 0; band < 3; ++band) {
    packet.luminance[static_cast<std::size_t>(band)][lane] = seen[band];
  }
}

void CameraRenderer::Internals::pass_air(Packet& packet) const {
  const CameraAir& air = *frame.job->air;
  const RTCRay8& ray = packet.rays.ray;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (packet.active[i] == 0) {
      continue;
    }
    const Eigen::Vector3d start =
        frame.in->origin_W +
        Eigen::Vector3f(ray.org_x[i], ray.org_y[i], ray.org_z[i]).cast<double>();
    const Eigen::Vector3d direction =
        Eigen::Vector3f(ray.dir_x[i], ray.dir_y[i], ray.dir_z[i]).cast<double>();
    double length_m = static_cast<double>(ray.tfar[i]);
    if (packet.rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
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

void CameraRenderer::Internals::shade(Packet& packet) const {
  const Scene::Internals& in = *frame.in;
  const PictureJob& job = *frame.job;
  const SurfaceNumbers number(packet.rays.hit);
  bool any = false;
  for (std::size_t i = 0; i < kLanes; ++i) {
    any = any || number[i] != RTC_INVALID_GEOMETRY_ID;
  }
  if (any) {
    MetSurfaces& met = packet.met;
    meet(in.shading.data(), looks.data(), find_looks(packet), packet.rays, met);
    refine(packet);
    const RTCRay8& ray = packet.rays.ray;
    for (std::size_t i = 0; i < kLanes; ++i) {
      // A pixel's width on the surface, between that across and that along its slant.
      const float cosine =
          std::abs(met.nx[i] * ray.dir_x[i] + met.ny[i] * ray.dir_y[i] + met.nz[i] * ray.dir_z[i]);
      const float range = number[i] == RTC_INVALID_GEOMETRY_ID ? 1e6F : ray.tfar[i];
      met.points.footprint_m[i] =
          range * packet.pixel_rad[i] / std::sqrt(std::max(cosine, 0.05F)) + 1e-6F;
    }
    Grain grain;
    sum_grain(met.points, met.anchor, grain);
    for (std::size_t i = 0; packet.on_bodies && i < kLanes; ++i) {
      if (number[i] != RTC_INVALID_GEOMETRY_ID && infos[number[i]].on_body) {
        const std::array<float, 12>& X = packet.X[i];
        const float x = grain.slope_x[i];
        const float y = grain.slope_y[i];
        const float z = grain.slope_z[i];
        grain.slope_x[i] = X[0] * x + X[3] * y + X[6] * z;
        grain.slope_y[i] = X[1] * x + X[4] * y + X[7] * z;
        grain.slope_z[i] = X[2] * x + X[5] * y + X[8] * z;
      }
    }
    Stones stones;
    if (packet.stony) {
      lay_stones(met.points, stone_anchor, met.stones, stones);
    }
    LitLanes lit;
    texture(met, grain, packet.stony ? stones : no_stones(), frame.light, lit);
    if (packet.glazed) {
      glaze(packet, lit);
    }
    LaneArray seen;
    seen.fill(0.0F);
    if (job.light->sun_shines()) {
      ShadowPacket shadow;
      Eigen::Vector3f to_sun = job.light->to_sun_W();
      if (packet.samples > 1) {
        // A point of the sun's disc for all of the packet; neighbours blend it over the samples.
        const std::uint64_t draw =
            counter_bits(frame.key ^ 0x5D15CULL, packet.number() + (1ULL << 62U));
        const float angle =
            2.0F * std::numbers::pi_v<float> * static_cast<float>(draw >> 40U) * 0x1.0p-24F;
        const float out =
            Daylight::kSunRadius_rad * std::sqrt(static_cast<float>(draw & 0xFFFFFFU) * 0x1.0p-24F);
        const Eigen::Vector3f side = to_sun.unitOrthogonal();
        to_sun = (to_sun + out * (std::cos(angle) * side + std::sin(angle) * to_sun.cross(side)))
                     .normalized();
      }
      if (aim_at_sun(met, lit, packet.rays, to_sun, shadow.rays, shadow.active)) {
        if (frame.record != nullptr) {
          frame.record->shadow.push_back(shadow);
        }
        occlude(in, shadow.active.data(), shadow.rays);
        for (std::size_t i = 0; i < kLanes; ++i) {
          seen[i] = shadow.active[i] != 0 && shadow.rays.tfar[i] >= 0.0F ? 1.0F : 0.0F;
        }
      }
    }
    LaneArray sky;
    sky.fill(1.0F);
    if (parameters.sky_rays > 0) {
      LaneArray open;
      open.fill(0.0F);
      for (int k = 0; k < parameters.sky_rays; ++k) {
        ShadowPacket rays;
        (void)aim_at_sun(met, lit, packet.rays, job.light->to_sun_W(), rays.rays, rays.active);
        for (std::size_t i = 0; i < kLanes; ++i) {
          // By the cosine around the normal.
          const std::uint64_t draw = counter_bits(
              frame.key ^ (0x5C1ULL + static_cast<std::uint64_t>(k)), packet.number() * kLanes + i);
          const float angle =
              2.0F * std::numbers::pi_v<float> * static_cast<float>(draw >> 40U) * 0x1.0p-24F;
          const float place =
              (static_cast<float>(k) + static_cast<float>(draw & 0xFFFFFFU) * 0x1.0p-24F) /
              static_cast<float>(parameters.sky_rays);
          const float out = std::sqrt(place);
          const Eigen::Vector3f n(met.nx[i], met.ny[i], met.nz[i]);
          const bool there = packet.active[i] != 0 && n.squaredNorm() > 0.5F;
          rays.active[i] = there ? -1 : 0;
          if (there) {
            const Eigen::Vector3f side = n.unitOrthogonal();
            const Eigen::Vector3f to =
                out * (std::cos(angle) * side + std::sin(angle) * n.cross(side)) +
                std::sqrt(1.0F - place) * n;
            rays.rays.dir_x[i] = to.x();
            rays.rays.dir_y[i] = to.y();
            rays.rays.dir_z[i] = to.z();
            const float off = 2e-3F + 1e-4F * ray.tfar[i];
            rays.rays.org_x[i] = met.x[i] + off * met.gx[i];
            rays.rays.org_y[i] = met.y[i] + off * met.gy[i];
            rays.rays.org_z[i] = met.z[i] + off * met.gz[i];
          }
        }
        if (frame.record != nullptr) {
          frame.record->shadow.push_back(rays);
        }
        occlude(in, rays.active.data(), rays.rays);
        for (std::size_t i = 0; i < kLanes; ++i) {
          open[i] += rays.rays.tfar[i] >= 0.0F ? 1.0F : 0.0F;
        }
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        sky[i] = open[i] / static_cast<float>(parameters.sky_rays);
      }
    } else if (job.sky != nullptr && !job.sky->everywhere()) {
      const auto height = static_cast<float>(in.origin_W.z());
      for (std::size_t i = 0; i < kLanes; ++i) {
        if (number[i] != RTC_INVALID_GEOMETRY_ID) {
          sky[i] = job.sky->at(met.x[i] + frame.sky_offset.x(), met.y[i] + frame.sky_offset.y(),
                               met.z[i] + height);
        }
      }
    }
    light_up(met, lit, packet.rays, frame.light, seen, sky, packet.luminance);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (number[i] == RTC_INVALID_GEOMETRY_ID) {
      see_nothing(packet, i);
    }
  }
  if (job.air != nullptr && !job.air->clear()) {
    pass_air(packet);
  }
}

void CameraRenderer::Internals::tell_truth(int column, int row) const {
  Packet packet;
  // Through the pixel's middle at the middle of the exposure.
  aim(column, row, 0, 1, packet);
  RTCIntersectContext context = coherent();
  frame.in->intersect(packet.active.data(), context, packet.rays);
  const SurfaceNumbers number(packet.rays.hit);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (packet.valid[i] == 0) {
      continue;
    }
    const std::size_t at = static_cast<std::size_t>(row + static_cast<int>(i) / kPacketWidth) *
                               static_cast<std::size_t>(frame.width) +
                           static_cast<std::size_t>(column + static_cast<int>(i) % kPacketWidth);
    const bool met = packet.active[i] != 0 && number[i] != RTC_INVALID_GEOMETRY_ID;
    const RTCRay8& ray = packet.rays.ray;
    // The axis is the mount's x, the first column of R_WS.
    const RowPose& pose = rows[static_cast<std::size_t>(row + static_cast<int>(i) / kPacketWidth)];
    const float along =
        pose.R[0] * ray.dir_x[i] + pose.R[1] * ray.dir_y[i] + pose.R[2] * ray.dir_z[i];
    frame.picture->range_m[at] = met ? ray.tfar[i] : 0.0F;
    frame.picture->depth_m[at] = met ? along * ray.tfar[i] : 0.0F;
    frame.picture->instance[at] = met ? frame.in->instance_of[number[i]] : ~0U;
  }
}

template <class Work>
void CameraRenderer::Internals::each_packet(std::size_t tile, const Work& work) const {
  const FlushDenormals flush;
  const int tiles_across = (frame.width + kTileWidth - 1) / kTileWidth;
  const int first_column = static_cast<int>(tile) % tiles_across * kTileWidth;
  const int first_row = static_cast<int>(tile) / tiles_across * kTileHeight;
  const int end_column = std::min(first_column + kTileWidth, frame.width);
  const int end_row = std::min(first_row + kTileHeight, frame.height);
  for (int row = first_row; row < end_row; row += kPacketHeight) {
    for (int column = first_column; column < end_column; column += kPacketWidth) {
      work(column, row);
    }
  }
}

void CameraRenderer::Internals::collect_rays(int column, int row, PictureRays& found) const {
  Packet packet;
  packet.lattice = static_cast<int>(std::lround(std::sqrt(found.rays)));
  HitSurfaces surfaces;
  for (int k = 0; k < found.rays; ++k) {
    aim(column, row, k, found.rays, packet);
    RTCIntersectContext context = coherent();
    frame.in->intersect(packet.active.data(), context, packet.rays);
    meet_surfaces(frame.in->shading.data(), packet.rays, surfaces);
    const SurfaceNumbers number(packet.rays.hit);
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (packet.valid[i] == 0) {
        continue;
      }
      const std::size_t pixel =
          static_cast<std::size_t>(row + static_cast<int>(i) / kPacketWidth) *
              static_cast<std::size_t>(frame.width) +
          static_cast<std::size_t>(column + static_cast<int>(i) % kPacketWidth);
      const std::size_t at =
          pixel * static_cast<std::size_t>(found.rays) + static_cast<std::size_t>(k);
      const bool met = packet.active[i] != 0 && number[i] != RTC_INVALID_GEOMETRY_ID;
      const RTCRay8& ray = packet.rays.ray;
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

void CameraRenderer::Internals::render_tile(std::size_t tile) const {
  const float weight = 1.0F / static_cast<float>(parameters.samples);
  RTCIntersectContext context = coherent();
  Packet packet;
  each_packet(tile, [&](int column, int row) {
    std::array<LaneArray, 3> sum;
    for (LaneArray& band : sum) {
      band.fill(0.0F);
    }
    for (int sample = 0; sample < parameters.samples; ++sample) {
      aim(column, row, sample, parameters.samples, packet);
      if (frame.record != nullptr) {
        frame.record->primary.push_back({packet.rays, packet.active});
      }
      frame.in->intersect(packet.active.data(), context, packet.rays);
      shade(packet);
      for (std::size_t band = 0; band < 3; ++band) {
        for (std::size_t i = 0; i < kLanes; ++i) {
          sum[band][i] += packet.active[i] != 0 ? packet.luminance[band][i] * weight : 0.0F;
        }
      }
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (packet.valid[i] != 0) {
        const std::size_t at =
            static_cast<std::size_t>(row + static_cast<int>(i) / kPacketWidth) *
                static_cast<std::size_t>(frame.width) +
            static_cast<std::size_t>(column + static_cast<int>(i) % kPacketWidth);
        float* const to = frame.picture->luminance.data() + 3 * at;
        for (std::size_t band = 0; band < 3; ++band) {
          to[band] = sum[band][i];
        }
      }
    }
    if (frame.job->truth) {
      tell_truth(column, row);
    }
  });
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

void CameraRenderer::render(const Scene& scene, const PictureJob& job, RenderedPicture& picture) {
  Internals& in = *internals_;
  in.prepare(scene, job);
  in.frame.picture = &picture;
  const int width = in.frame.width;
  const int height = in.frame.height;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  resize(picture, width, height, pixels, job.truth ? pixels : 0);
  in.pool.run(in.tiles(), [&in](std::size_t tile) { in.render_tile(tile); });

  std::array<float, 3> haze{};
  for (int band = 0; band < 3; ++band) {
    haze[static_cast<std::size_t>(band)] =
        job.light->total_lx()[band] * std::numbers::inv_pi_v<float>;
  }
  const auto strips = static_cast<std::size_t>((height + kRowsAtOnce - 1) / kRowsAtOnce);
  in.pool.run(strips, [&](std::size_t strip) {
    const int first = static_cast<int>(strip) * kRowsAtOnce;
    in.sensor.expose(picture.luminance, in.falloff, haze, job.read_out, first,
                     std::min(first + kRowsAtOnce, height), picture.numbers);
  });
  double sum = 0.0;
  for (const std::uint16_t number : picture.numbers) {
    sum += number;
  }
  const double black = job.read_out.black_level * (1 << (job.read_out.bits - 8));
  const double white = (1 << job.read_out.bits) - 1;
  picture.mean = std::max(0.0, sum / static_cast<double>(pixels) - black) / white;
  in.frame = {};
}

void CameraRenderer::measure(const Scene& scene, const PictureJob& job, RenderedPicture& picture) {
  Internals& in = *internals_;
  in.prepare(scene, job);
  in.frame.picture = &picture;
  resize(picture, in.frame.width, in.frame.height, 0,
         static_cast<std::size_t>(in.frame.width) * static_cast<std::size_t>(in.frame.height));
  in.pool.run(in.tiles(), [&in](std::size_t tile) {
    in.each_packet(tile, [&in](int column, int row) { in.tell_truth(column, row); });
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
  in.prepare(scene, job);
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
    in.each_packet(tile,
                   [&in, &found](int column, int row) { in.collect_rays(column, row, found); });
  });
  in.frame = {};
}

RecordedPictureRays CameraRenderer::record(const Scene& scene, const PictureJob& job) {
  Internals& in = *internals_;
  in.prepare(scene, job);
  RecordedPictureRays recorded;
  RenderedPicture picture;
  picture.luminance.resize(3 * static_cast<std::size_t>(in.frame.width) *
                           static_cast<std::size_t>(in.frame.height));
  PictureJob without_truth = job;
  without_truth.truth = false;
  in.frame.job = &without_truth;
  in.frame.picture = &picture;
  in.frame.record = recorded.packets_.get();
  for (std::size_t tile = 0; tile < in.tiles(); ++tile) {
    in.render_tile(tile);
  }
  in.frame = {};
  recorded.reset();
  return recorded;
}

}  // namespace rigwire::sim
