// Shapes that rays can hit, with their pose: for furnishing scenes and for the looks of machines.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <variant>

#include "fields/rules.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// Rotation by roll about x, then pitch about y, then yaw about z, all about the fixed axes of the
/// frame that the pose is given in: R = Rz(yaw) Ry(pitch) Rx(roll). Angles in rad.
struct RollPitchYaw {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;  ///< Positive turns x towards -z: nose down with x forward, z up.
  double yaw_rad = 0.0;    ///< Positive turns x towards y: left.
};
void visit(fields::Visitor& v, RollPitchYaw& p);

/// Returns the pose with that position and rotation.
[[nodiscard]] Eigen::Isometry3d pose(const Vector3& position_m, const RollPitchYaw& rotation);

/// A box centred on its own origin.
struct BoxShape {
  static constexpr fields::Named kNamed{"box", "A box of a given size."};

  Vector3 size_m{1.0, 1.0, 1.0};  ///< Full lengths along its x, y, z.
};
void visit(fields::Visitor& v, BoxShape& p);

/// Triangles from a file that assimp reads (OBJ, STL, PLY, glTF), in the file's own axes.
struct MeshShape {
  static constexpr fields::Named kNamed{"mesh", "Triangles from a file."};

  std::string file;
  double scale = 1.0;
};
void visit(fields::Visitor& v, MeshShape& p);

using Shape = std::variant<BoxShape, MeshShape>;

/// A shape with its pose in some frame and what its surface is.
struct PlacedShape {
  Shape shape;
  Vector3 position_m;  ///< Position of the shape's origin.
  RollPitchYaw rotation;
  double reflectance = 0.3;  ///< Diffuse reflectance at the lidar's wavelength (905 nm).
  std::string label = "object";
  /// Gain of a retro-reflector; 1 is an ideal one (sim/scene/scene.h).
  double retro_gain = 0.0;
};
void visit(fields::Visitor& v, PlacedShape& p);

/// Where a sensor sits: pose of its frame S in the frame of a link L of the machine (X_LS).
struct MountConfiguration {
  std::string link = "upper";
  Vector3 position_m;
  RollPitchYaw rotation;
};
void visit(fields::Visitor& v, MountConfiguration& p);

}  // namespace rigwire::hil
