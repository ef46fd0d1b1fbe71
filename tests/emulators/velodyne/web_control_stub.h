// A sensor behind the web interface that only remembers.
#pragma once

#include <string>

#include "emulators/velodyne/velodyne_control.h"

namespace rigwire::emulators {

struct WebControlStub final : VelodyneControl {
  [[nodiscard]] std::string_view model_name() const override { return model; }
  [[nodiscard]] std::string_view serial_number() const override { return serial; }
  [[nodiscard]] const VelodyneLiveSettings& live_settings() const override { return live; }
  void apply(SimTime now, const VelodyneLiveSettings& settings) override {
    live = settings;
    last_applied = now;
    ++applied;
  }
  void save(SimTime) override { saved = live; }
  void reset(SimTime) override {
    live = saved;
    ++resets;
  }
  [[nodiscard]] VelodyneReadings readings(SimTime) const override { return measured; }

  std::string model = "VLP-16";
  std::string serial = "11001191157192";
  VelodyneLiveSettings live;
  VelodyneLiveSettings saved;
  VelodyneReadings measured;
  SimTime last_applied{};
  int applied = 0;
  int resets = 0;
};

}  // namespace rigwire::emulators
