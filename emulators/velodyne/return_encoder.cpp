#include "emulators/velodyne/return_encoder.h"

namespace rigwire::emulators {
namespace {

VelodyneReflectivity scale_of(const protocols::velodyne::Model& model) {
  if (model.status_channel) {
    return VelodyneReflectivity::full;
  }
  return model.lasers.size() == kMaxLasers ? VelodyneReflectivity::to_110
                                           : VelodyneReflectivity::to_100;
}

}  // namespace

ReturnEncoder::ReturnEncoder(const protocols::velodyne::Model& model, VelodyneRangeWindow window,
                             VelodyneReflectivity scale)
    : minimum_m_(static_cast<float>(window.minimum_m)),
      maximum_m_(static_cast<float>(window.maximum_m)),
      counts_per_metre_(1000.0 / model.distance_unit_mm) {
  switch (scale == VelodyneReflectivity::model ? scale_of(model) : scale) {
    case VelodyneReflectivity::to_110:
      diffuse_top_ = 110.0F;
      retro_bottom_ = 111.0F;
      break;
    case VelodyneReflectivity::full:
      diffuse_top_ = 255.0F;
      retro_bottom_ = 255.0F;
      break;
    case VelodyneReflectivity::to_100:
    case VelodyneReflectivity::model:
      break;
  }
  retro_span_ = 255.0F - retro_bottom_;
}

}  // namespace rigwire::emulators
