#include "sim/lidar/echo_detector.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

/// The parts of one echo, summed up.
EchoPart merged(std::span<const EchoPart> parts) {
  const float nearest_m = parts.front().range_m;
  EchoPart sum{nearest_m, 0.0F, 0.0F, 0.0F};
  float behind = 0.0F;
  for (const EchoPart& part : parts) {
    sum.energy += part.energy;
    sum.brightness += part.brightness;
    // Mean range weighted by energy, counted from the nearest for the digits' sake.
    behind += part.energy * (part.range_m - nearest_m);
  }
  sum.range_m += behind / sum.energy;
  return sum;
}

/// Replaces the first parts by the echoes that are seen, in order of range; how many those are.
std::size_t link(std::span<EchoPart> parts, const EchoRules& rules) {
  std::ranges::sort(parts, {}, &EchoPart::range_m);
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t i = 1; i <= parts.size(); ++i) {
    if (i < parts.size()) {
      // Both must slant: a silhouette in front of a wall is no way to the wall.
      const float bridge_m = 2.0F * std::min(parts[i - 1].patch_m, parts[i].patch_m);
      if (parts[i].range_m - parts[i - 1].range_m <= rules.pulse_m + bridge_m) {
        continue;
      }
    }
    const EchoPart echo = merged(parts.subspan(first, i - first));
    first = i;
    if (echo.energy >= rules.threshold) {
      parts[count++] = echo;
    }
  }
  return count;
}

}  // namespace

/// Goes from the strongest echo down and drops each that is nearer than separation_m to a stronger
/// one that was kept.
DetectedEchoes detect_echoes(std::span<EchoPart> parts, const EchoRules& rules) {
  const std::span<EchoPart> echoes = parts.first(parts.empty() ? 0 : link(parts, rules));
  std::ranges::sort(echoes, [](const EchoPart& a, const EchoPart& b) {
    return a.energy != b.energy ? a.energy > b.energy : a.range_m < b.range_m;
  });
  DetectedEchoes result;
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    const EchoPart echo = echoes[i];
    const bool lost =
        std::ranges::any_of(echoes.first(result.count), [&](const EchoPart& stronger) {
          return std::abs(stronger.range_m - echo.range_m) < rules.separation_m;
        });
    if (lost) {
      continue;
    }
    echoes[result.count++] = echo;
    if (result.count == 1) {
      result.strongest = echo;
      result.last = echo;
      continue;
    }
    if (result.count == 2) {
      result.second = echo;
    }
    if (echo.range_m > result.last.range_m) {
      result.last = echo;
      result.last_is_strongest = false;
      result.last_is_second = result.count == 2;
    }
  }
  return result;
}

}  // namespace rigwire::sim
