#include "sim/camera/pane_looks.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

/// Cosine to the vertical of sides that count as upright no more.
constexpr float kUpright = 0.35F;

/// Share of the stretch [from, from + length] that lies in [begin, end] of a period of 1.
float share_within(float from, float length, float begin, float end) {
  const auto sum = [&](float x) {
    const float whole = std::floor(x);
    return whole * (end - begin) + std::clamp(x - whole - begin, 0.0F, end - begin);
  };
  return (sum(from + length) - sum(from)) / length;
}

}  // namespace

void glaze(const PaneFrame& pane, const std::array<float, 12>& X, const MetSurfaces& met,
           std::size_t i, LitLanes& lit) {
  static const Shade kGlass = shade_of(SurfaceKind::glass);
  const auto turned_back = [&](float x, float y, float z) {
    return Eigen::Vector3f(X[0] * x + X[1] * y + X[2] * z, X[3] * x + X[4] * y + X[5] * z,
                           X[6] * x + X[7] * y + X[8] * z);
  };
  const Eigen::Vector3f n = turned_back(met.gx[i], met.gy[i], met.gz[i]);
  if (std::abs(n.z()) > kUpright) {
    return;
  }
  const Eigen::Vector3f p =
      turned_back(met.x[i] - X[9], met.y[i] - X[10], met.z[i] - X[11]) - pane.bounds_M.min();
  const Eigen::Vector3f size = pane.bounds_M.sizes();
  const int along = std::abs(n.x()) > std::abs(n.y()) ? 1 : 0;
  const float columns = std::max(1.0F, std::round(size[along] / pane.panes.across_m));
  const float rows = std::max(1.0F, std::round(size.z() / pane.panes.up_m));
  const float per_x = columns / size[along];
  const float per_z = rows / size.z();
  const float wide = met.points.footprint_m[i];
  const float u = p[along] * per_x;
  const float v = p.z() * per_z;
  const float glass =
      share_within(u - 0.5F * wide * per_x, wide * per_x, pane.panes.left, pane.panes.right) *
      share_within(v - 0.5F * wide * per_z, wide * per_z, pane.panes.bottom, pane.panes.top);
  lit.glossy = true;
  lit.red[i] += glass * (kGlass.one.red - lit.red[i]);
  lit.green[i] += glass * (kGlass.one.green - lit.green[i]);
  lit.blue[i] += glass * (kGlass.one.blue - lit.blue[i]);
  lit.gloss[i] += glass * (kGlass.gloss - lit.gloss[i]);
  lit.sharpness[i] += glass * (kGlass.sharpness - lit.sharpness[i]);
  lit.nx[i] += glass * (met.nx[i] - lit.nx[i]);
  lit.ny[i] += glass * (met.ny[i] - lit.ny[i]);
  lit.nz[i] += glass * (met.nz[i] - lit.nz[i]);
}

}  // namespace rigwire::sim
