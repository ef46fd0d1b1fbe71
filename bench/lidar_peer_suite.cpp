#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "bench/lidar_peer.h"
#include "bench/suites.h"

namespace rigwire::bench {

nlohmann::json bench_lidar_peer(std::ostream& text) {
  constexpr int kRounds = 15;
  const char* folder = std::getenv("RIGWIRE_PEER_FOLDER");
  const LidarPeerFigures figures =
      measure_and_write_for_peers(folder == nullptr ? "" : folder, kRounds);
  const auto rays = static_cast<double>(figures.rays);
  text << fmt::format(
      "pit of {} triangles, {} rays, {} hits: stage {:.0f} rays/s, bare Embree {:.0f} rays/s, one "
      "thread\n",
      figures.triangles, figures.rays, figures.hits, rays / figures.stage_s, rays / figures.bare_s);
  text << (folder == nullptr ? "scripts/lidar-peer.py runs other ray casters on the same rays\n"
                             : fmt::format("scene and rays are in {}\n", folder));
  return {{"triangles", figures.triangles},
          {"rays", figures.rays},
          {"hits", figures.hits},
          {"stage_rays_per_s", rays / figures.stage_s},
          {"bare_rays_per_s", rays / figures.bare_s}};
}

}  // namespace rigwire::bench
