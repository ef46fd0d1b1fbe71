#include "hil/world/shapes.h"

#include "fields/visitor.h"

namespace rigwire::hil {

using fields::in;
using fields::plain;

void visit(fields::Visitor& v, RollPitchYaw& p) {
  v.number("roll", p.roll_rad, in("deg").between(-360, 360), "Rotation about x, applied first.");
  v.number("pitch", p.pitch_rad, in("deg").between(-360, 360),
           "Rotation about y, second; nose down positive.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Rotation about z, last; left positive.");
}

Eigen::Isometry3d pose(const Vector3& position_m, const RollPitchYaw& rotation) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = (Eigen::AngleAxisd(rotation.yaw_rad, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(rotation.pitch_rad, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(rotation.roll_rad, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  X.translation() << position_m.x, position_m.y, position_m.z;
  return X;
}

void visit(fields::Visitor& v, BoxShape& p) {
  v.vector3("size", p.size_m, in("m").between(0.001, 1e5), "Full lengths along its x, y, z.");
}

void visit(fields::Visitor& v, MeshShape& p) {
  v.required("file");
  v.file("file", p.file, fields::FileKind::mesh,
         "Mesh file, relative to this file: OBJ, STL, PLY or glTF, in metres.");
  v.number("scale", p.scale, plain().between(1e-6, 1e6), "Metres per unit of the file.");
}

void visit(fields::Visitor& v, PlacedShape& p) {
  v.required("type");
  v.variant("type", p.shape, "Kind of shape.");
  v.vector3("position", p.position_m, in("m").between(-100, 100), "Place of the shape's origin.");
  v.section("rotation", p.rotation, "Rotation of the shape's axes.");
  v.number("reflectance", p.reflectance, plain().between(0, 1), "Diffuse reflectance at 905 nm.");
  v.text("label", p.label, "What the surface is, for recordings.");
  v.number("retro_gain", p.retro_gain, plain().between(0, 1),
           "Gain of a retro-reflector; 1 is an ideal one, 0 is none.");
}

using fields::in;

void visit(fields::Visitor& v, MountConfiguration& p) {
  v.text("link", p.link, "Link of the machine that carries it.");
  v.vector3("position", p.position_m, in("m").between(-100, 100),
            "Place in the link's frame: x forward, y left, z up.");
  v.section("rotation", p.rotation, "Rotation of the sensor's axes against the link's.");
}

}  // namespace rigwire::hil
