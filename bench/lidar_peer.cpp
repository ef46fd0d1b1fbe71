#include "bench/lidar_peer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/lidar_cases.h"
#include "hil/executive/cpu_time.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

class BinaryFile {
 public:
  explicit BinaryFile(const std::filesystem::path& path)
      : path_(path.string()), file_(path, std::ios::binary) {}
  void text(const std::string& words) { file_ << words; }
  template <class Number>
  void put(Number number) {
    file_.write(reinterpret_cast<const char*>(&number), sizeof(number));
  }
  void close() {
    file_.close();
    if (!file_) {
      throw std::runtime_error("lidar peer: cannot write " + path_);
    }
  }

 private:
  std::string path_;
  std::ofstream file_;
};

void write_scene(const std::filesystem::path& path, const WorldTriangles& world) {
  BinaryFile file(path);
  file.text("ply\nformat binary_little_endian 1.0\nelement vertex " +
            std::to_string(world.vertices_m.size()) +
            "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
            std::to_string(world.triangles.size()) +
            "\nproperty list uchar int vertex_indices\nend_header\n");
  for (const Eigen::Vector3d& vertex : world.vertices_m) {
    file.put(vertex.x());
    file.put(vertex.y());
    file.put(vertex.z());
  }
  for (const auto& triangle : world.triangles) {
    file.put(std::uint8_t{3});
    for (const std::uint32_t corner : triangle) {
      file.put(static_cast<std::int32_t>(corner));
    }
  }
  file.close();
}

void write_rays(const std::filesystem::path& path, const LidarCase& scene, const LidarPattern& head,
                const std::vector<LidarFiring>& firings) {
  BinaryFile file(path);
  const Eigen::Isometry3d& X_WS = scene.mount.X_WL;
  for (const LidarFiring& firing : firings) {
    for (const LaserGeometry& laser : head.lasers) {
      const double azimuth_rad =
          firing.rotor_azimuth_rad + firing.rotor_rate_radps * to_seconds(laser.time_offset);
      const double horizontal = std::cos(laser.elevation_rad);
      const Eigen::Vector3d start_W = X_WS * Eigen::Vector3d(0.0, 0.0, laser.vertical_offset_m);
      const Eigen::Vector3d direction_W =
          X_WS.linear() * Eigen::Vector3d(horizontal * std::cos(azimuth_rad),
                                          -horizontal * std::sin(azimuth_rad),
                                          std::sin(laser.elevation_rad));
      for (const Eigen::Vector3d& part : {start_W, direction_W}) {
        file.put(part.x());
        file.put(part.y());
        file.put(part.z());
      }
    }
  }
  file.close();
}

}  // namespace

// Times the lidar stage and Embree's bare calls in turns, minimum of the rounds, and writes scene,
// rays and ranges for other programs.
LidarPeerFigures measure_and_write_for_peers(const std::filesystem::path& folder, int rounds) {
  if (rounds < 1) {
    throw std::invalid_argument("lidar peer: found " + std::to_string(rounds) +
                                " rounds, allowed >= 1");
  }
  const LidarCase pit = pit_case();
  pit.begin_revolution();
  const LidarPattern head = bench_head();
  sim::SpinningLidar lidar({}, head, bench_firing_plan(), bench_rotor(), 1, "bench");
  const sim::LidarSlice slice{.t0 = kStart,
                              .t1 = kStart + kBenchRevolution,
                              .mount_at_t0 = pit.mount,
                              .mount_at_t1 = pit.mount};
  sim::RecordedRays recorded = lidar.record(*pit.scene, slice);
  std::vector<LidarFiring> firings;
  std::vector<sim::LidarBankTruth> truth;
  lidar.cast(*pit.scene, slice, nullptr, firings, &truth);

  LidarPeerFigures figures;
  figures.stage_s = figures.bare_s = std::numeric_limits<double>::max();
  for (int round = 0; round < rounds; ++round) {
    double stage_s = 0.0;
    double bare_s = 0.0;
    recorded.reset();
    {
      const hil::StageTimer timer(bare_s);
      recorded.cast_bare(*pit.scene);
    }
    {
      const hil::StageTimer timer(stage_s);
      lidar.cast(*pit.scene, slice, nullptr, firings, nullptr);
    }
    figures.stage_s = std::min(figures.stage_s, stage_s);
    figures.bare_s = std::min(figures.bare_s, bare_s);
  }
  figures.rays = firings.size() * head.lasers.size();
  for (const sim::LidarBankTruth& bank : truth) {
    figures.hits += static_cast<std::size_t>(std::ranges::count_if(
        bank, [](const sim::LidarShotTruth& shot) { return shot.range_m > 0.0F; }));
  }
  const WorldTriangles world = pit_triangles();
  figures.triangles = world.triangles.size();
  if (!folder.empty()) {
    std::filesystem::create_directories(folder);
    write_scene(folder / "scene.ply", world);
    write_rays(folder / "rays.f64", pit, head, firings);
    BinaryFile ranges(folder / "ranges.f32");
    for (const sim::LidarBankTruth& bank : truth) {
      for (const sim::LidarShotTruth& shot : bank) {
        ranges.put(shot.range_m);
      }
    }
    ranges.close();
  }
  return figures;
}

}  // namespace rigwire::bench
