#include "sim/driveline/driveline.h"

#include "sim/driveline/cvt_driveline.h"
#include "sim/driveline/geared_driveline.h"

namespace rigwire::sim {

std::unique_ptr<Driveline> make_driveline(const DrivelineParameters& parameters) {
  if (const auto* geared = std::get_if<GearedParameters>(&parameters)) {
    return std::make_unique<GearedDriveline>(*geared);
  }
  return std::make_unique<CvtDriveline>(std::get<CvtParameters>(parameters));
}

}  // namespace rigwire::sim
