#include "sim/camera/camera_kinds.h"

namespace rigwire::sim {
namespace {

/// One answer for each kind.
template <class... Answers>
struct ForEach : Answers... {
  using Answers::operator()...;
};
template <class... Answers>
ForEach(Answers...) -> ForEach<Answers...>;

std::vector<PixelFormat> image_formats(bool colour) {
  const auto formats = sensor_formats(colour);
  return {formats.begin(), formats.end()};
}

CameraAbilities of_sensor(const ImageSensorParameters& sensor) {
  CameraAbilities abilities;
  abilities.width_px = sensor.width_px;
  abilities.height_px = sensor.height_px;
  abilities.formats = image_formats(sensor.colour);
  abilities.row_time = sensor.row_time;
  return abilities;
}

}  // namespace

const CameraParameters& optics_of(const CameraKind& kind) {
  return std::visit(ForEach{[](const CameraParameters& p) -> const CameraParameters& { return p; },
                            [](const auto& p) -> const CameraParameters& { return p.camera; }},
                    kind);
}

CameraAbilities abilities_of(const CameraKind& kind) {
  return std::visit(ForEach{[](const CameraParameters& p) {
                              validate(p);
                              CameraAbilities abilities = of_sensor(p.sensor);
                              abilities.binning = !p.sensor.colour;
                              return abilities;
                            },
                            [](const StereoCameraParameters& p) {
                              validate(p);
                              CameraAbilities abilities = of_sensor(p.camera.sensor);
                              abilities.parts = kStereoParts;
                              abilities.geometry = stereo_geometry(p);
                              return abilities;
                            },
                            [](const DepthCameraParameters& p) {
                              validate(p);
                              CameraAbilities abilities = of_sensor(p.camera.sensor);
                              abilities.parts = kDepthParts;
                              abilities.geometry = depth_geometry(p);
                              return abilities;
                            },
                            [](const AllRoundCameraParameters& p) {
                              validate(p);
                              CameraAbilities abilities = of_sensor(p.camera.sensor);
                              abilities.width_px = p.width_px;
                              abilities.height_px = p.height_px;
                              if (p.camera.sensor.colour) {
                                abilities.formats = {PixelFormat::rgb8};
                              }
                              return abilities;
                            }},
                    kind);
}

std::unique_ptr<CameraSensor> make_camera(const CameraKind& kind, std::uint64_t seed,
                                          std::string_view name) {
  return std::visit(
      ForEach{
          [&](const CameraParameters& p) { return make_plain_camera(p, seed, name); },
          [&](const StereoCameraParameters& p) { return make_stereo_camera(p, seed, name); },
          [&](const DepthCameraParameters& p) { return make_depth_camera(p, seed, name); },
          [&](const AllRoundCameraParameters& p) { return make_all_round_camera(p, seed, name); }},
      kind);
}

}  // namespace rigwire::sim
