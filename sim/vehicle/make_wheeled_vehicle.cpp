#include "sim/vehicle/full_vehicle.h"
#include "sim/vehicle/kinematic_vehicle.h"
#include "sim/vehicle/planar_vehicle.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

std::unique_ptr<WheeledVehicle> make_wheeled_vehicle(const WheeledVehicleParameters& parameters,
                                                     const Ground& ground,
                                                     std::unique_ptr<Driveline> driveline,
                                                     const VehiclePlace& place) {
  switch (parameters.level) {
    case VehicleLevel::kinematic:
      return std::make_unique<KinematicVehicle>(parameters, ground, std::move(driveline), place);
    case VehicleLevel::planar:
      return std::make_unique<PlanarVehicle>(parameters, ground, std::move(driveline), place);
    case VehicleLevel::full:
      break;
  }
  return std::make_unique<FullVehicle>(parameters, ground, std::move(driveline), place);
}

}  // namespace rigwire::sim
