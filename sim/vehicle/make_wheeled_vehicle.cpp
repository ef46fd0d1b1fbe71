#include "sim/vehicle/full_vehicle.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

std::unique_ptr<WheeledVehicle> make_wheeled_vehicle(const WheeledVehicleParameters& parameters,
                                                     const Ground& ground,
                                                     std::unique_ptr<Driveline> driveline,
                                                     const VehiclePlace& place) {
  return std::make_unique<FullVehicle>(parameters, ground, std::move(driveline), place);
}

}  // namespace rigwire::sim
