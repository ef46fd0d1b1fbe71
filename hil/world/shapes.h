// Shapes that rays can meet, with their place: what scenes are furnished with and machines look
// like.
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <variant>

#include "fields/visitor.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// Rotation by roll about x, then pitch about y, then yaw about z, all about the fixed axes of the
/// frame that the pose is given in: R = Rz(yaw) Ry(pitch) Rx(roll). Angles in rad.
struct RollPitchYaw {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;  ///< Positive turns x towards -z: nose down with x forward, z up.
  double yaw_rad = 0.0;    ///< Positive turns x towards y: left.
};

/// A box centred on its own origin.
struct BoxShape {
  static constexpr fields::Named kNamed{"box", "A box of a given size."};

  Vector3 size_m{1.0, 1.0, 1.0};  ///< Full lengths along its x, y, z.
};

/// Triangles from a file that assimp reads (OBJ, STL, PLY, glTF), in the file's own axes.
struct MeshShape {
  static constexpr fields::Named kNamed{"mesh", "Triangles from a file."};

  std::string file;
  double scale = 1.0;
};

using Shape = std::variant<BoxShape, MeshShape>;

/// A shape with its pose in some frame and what its surface is.
struct PlacedShape {
  Shape shape;
  Vector3 position_m;  ///< Of the shape's origin.
  RollPitchYaw rotation;
  double reflectance = 0.3;  ///< Diffuse, at the lidar's wavelength (905 nm).
  std::string label = "object";
};

inline void visit(fields::Visitor& v, RollPitchYaw& p) {
  v.number("roll", p.roll_rad, fields::in("deg").between(-360, 360), "About x, applied first.");
  v.number("pitch", p.pitch_rad, fields::in("deg").between(-360, 360),
           "About y, second; nose down positive.");
  v.number("yaw", p.yaw_rad, fields::in("deg").between(-360, 360), "About z, last; left positive.");
}

inline void visit(fields::Visitor& v, BoxShape& p) {
  v.vector3("size", p.size_m, fields::in("m").above(0).at_most(1e5), "Full lengths along x, y, z.");
}

inline void visit(fields::Visitor& v, MeshShape& p) {
  v.required("file");
  v.file("file", p.file, "Mesh file, relative to this file: OBJ, STL, PLY or glTF, in metres.");
  v.number("scale", p.scale, fields::plain().above(0).at_most(1e6), "Metres per unit of the file.");
}

inline void visit(fields::Visitor& v, PlacedShape& p) {
  v.required("type");
  v.variant("type", p.shape, "box or mesh.");
  v.vector3("position", p.position_m, fields::in("m"), "Of the shape's origin.");
  v.section("rotation", p.rotation, "Of the shape's axes.");
  v.number("reflectance", p.reflectance, fields::plain().between(0, 1), "Diffuse, at 905 nm.");
  v.text("label", p.label, "What it is, for recordings.");
}

}  // namespace rigwire::hil
