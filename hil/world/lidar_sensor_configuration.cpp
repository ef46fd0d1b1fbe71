#include "hil/world/lidar_sensor_configuration.h"

#include <array>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::hil {
namespace {

constexpr std::array<fields::Choice<LidarMethod>, 2> kLidarMethods{
    {{LidarMethod::rays, "rays", "Every shot is a ray at its own instant."},
     {LidarMethod::depth_image, "depth_image", "Shots are read from images of virtual cameras."}}};

}  // namespace

void visit(fields::Visitor& v, LidarSensorConfiguration& p) {
  v.choice("method", p.method, kLidarMethods, "How shots are simulated.");
  visit(v, p.beam);
  v.section("images", p.images, "Virtual cameras of the method depth_image.");
  v.section("rotor", p.rotor, "The head's motor.");
}

void validate(const LidarSensorConfiguration& configuration) {
  fields::check(configuration);
  validate(configuration.beam);
}

}  // namespace rigwire::hil
