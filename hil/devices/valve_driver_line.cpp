#include "hil/devices/valve_driver_line.h"

#include "emulators/valve_driver/valve_driver.h"
#include "hil/executive/station.h"

namespace rigwire::hil {
namespace {

ModbusLineConfiguration own_line(const ValveDriverConfiguration& configuration) {
  ModbusLineConfiguration line;
  line.address = configuration.address;
  line.port = configuration.port;
  line.allow_remote = configuration.allow_remote;
  line.response_delay.typical = configuration.processing_delay;
  return line;
}

class ValveLine final : public DeviceLine {
 public:
  ValveLine(const ValveDriverConfiguration& configuration, const LineContext& context,
            ModbusLine* shared)
      : own_(shared != nullptr
                 ? nullptr
                 : make_modbus_line(own_line(configuration), context.io, context.device_seed)),
        line_(shared != nullptr ? *shared : *own_),
        driver_(driver_settings(configuration)),
        station_(driver_, driver_) {
    line_.add_unit(configuration.unit, driver_.unit());
  }

  DeviceIndex enlist(Executive& executive) override {
    const DeviceIndex index = executive.add(station_);
    if (own_ != nullptr) {
      own_->start(executive);
    }
    return index;
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return line_.endpoint(); }
  /// Requests to this unit; the rest of the statistics is the line's.
  [[nodiscard]] std::uint64_t frames() const override {
    const emulators::ReceiveCounters requests = driver_.received();
    return requests.accepted + requests.ignored + requests.malformed;
  }
  [[nodiscard]] std::uint64_t dropped() const override { return line_.statistics().dropped; }
  [[nodiscard]] const WireStatistics& statistics() const override { return line_.statistics(); }
  [[nodiscard]] const emulators::Device& device() const override { return driver_; }

 private:
  std::unique_ptr<ModbusLine> own_;
  ModbusLine& line_;
  emulators::ValveDriver driver_;
  ValveStation station_;
};

}  // namespace

std::unique_ptr<DeviceLine> make_line(const ValveDriverConfiguration& configuration,
                                      const LineContext& context, ModbusLine* shared) {
  return std::make_unique<ValveLine>(configuration, context, shared);
}

}  // namespace rigwire::hil
