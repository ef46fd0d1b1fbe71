// Distribution of soils in a scene: a soil for all of the terrain, soils of tracks, and regions
// painted over both.
#pragma once

#include "fields/rules.h"

#include <Eigen/Core>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/ground/ground.h"
#include "sim/scene/height_field.h"
#include "sim/scene/track.h"

namespace rigwire::sim {

struct SoilDisc {
  static constexpr fields::Named kNamed{"disc", "A disc."};

  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 5.0;
};
void visit(fields::Visitor& v, SoilDisc& p);

struct SoilRectangle {
  static constexpr fields::Named kNamed{"rectangle", "A rectangle."};

  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d size_m{10.0, 10.0};  ///< Full lengths along its own axes.
  double yaw_rad = 0.0;                ///< Direction of its first axis, left from east.
};
void visit(fields::Visitor& v, SoilRectangle& p);

/// A part of a track, across all of its width.
struct SoilStretch {
  static constexpr fields::Named kNamed{"stretch", "A part of a track."};

  std::string track;
  double from_m = 0.0;  ///< Along the track's line.
  double to_m = 10.0;   ///< Not below from_m.
};
void visit(fields::Visitor& v, SoilStretch& p);

struct SoilRegion {
  std::string soil;  ///< Name of one of the scene's soils.
  std::variant<SoilDisc, SoilRectangle, SoilStretch> shape;
};
void visit(fields::Visitor& v, SoilRegion& p);

/// Throw std::invalid_argument naming the key, the value and what is allowed.
void validate(const SoilStretch& stretch);
void validate(const SoilRegion& region);

/// A track with its line, computed once.
struct LaidTrack {
  Track track;
  TrackLine line;
};

/// The first soil lies everywhere; tracks with a soil are painted over it in their order, then the
/// regions. A cell has the soil of its middle. Throws std::invalid_argument when a soil or a track
/// that is named does not exist, naming those that do, or when there are more than 256 soils.
[[nodiscard]] SoilMap make_soil_map(const HeightField& field, std::vector<SoilParameters> soils,
                                    std::span<const LaidTrack> tracks,
                                    std::span<const SoilRegion> regions);

}  // namespace rigwire::sim
