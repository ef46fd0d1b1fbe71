#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "bench/carried_machine.h"
#include "bench/gnss_bench.h"
#include "emulators/device.h"
#include "emulators/ublox/receiver.h"
#include "hil/devices/ublox.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig.h"
#include "hil/world/sky.h"

namespace rigwire::bench {
namespace {

constexpr double kGnssReceiversSpeed_mps = 2.0;

/// The first u-blox of the rig.
const hil::UbloxConfiguration& ublox_of(const hil::RigConfiguration& rig) {
  for (const auto& [name, device] : rig.devices) {
    if (const hil::UbloxConfiguration* ublox = fields::as<hil::UbloxConfiguration>(device)) {
      return *ublox;
    }
  }
  throw std::invalid_argument("the rig has no u-blox receiver to measure");
}

sim::SkySamples sky_samples(int count) {
  switch (count) {
    case 1:
      return sim::SkySamples::one;
    case 4:
      return sim::SkySamples::four;
    default:
      return sim::SkySamples::sixteen;
  }
}

/// Satellites of one lap, epoch by epoch.
struct SampledLap {
  std::vector<std::vector<SatelliteView>> epochs;
  double epoch_us = 0.0;
};

SampledLap sampled_lap(const hil::RigConfiguration& rig, int samples) {
  constexpr double kSpacing_m = 2.0;
  const hil::UbloxConfiguration& ublox = ublox_of(rig);
  const hil::SensorMount mount = hil::sensor_mount(rig.machine, ublox.mount);
  sim::GnssParameters parameters = ublox.sensor;
  parameters.error_model = sim::ErrorModel::engine;
  parameters.multipath.enabled = false;  // the visibility rays alone
  parameters.sky.samples = sky_samples(samples);
  parameters.sky.cn0_sigma_db = 0.0;
  const Calendar calendar(rig.start);
  sim::GnssSensor sensor(parameters, hil::make_satellites(rig.satellites, calendar), calendar,
                         hil::make_local_frame(rig.origin), rig.seed, "bench");
  CarriedMachine machine(rig, kGnssReceiversSpeed_mps);
  SampledLap lap;
  std::vector<double> costs_us;
  SimTime time = kStart;
  for (double along_m = 0.0; along_m < machine.length_m(); along_m += kSpacing_m) {
    machine.place(time, along_m);
    const sim::LinkMotion antenna = machine.motion(mount);
    const double before_s = hil::thread_cpu_seconds();
    const GnssSample sample = sensor.sample(time, antenna, machine.scene());
    costs_us.push_back(1e6 * (hil::thread_cpu_seconds() - before_s));
    lap.epochs.push_back(sample.satellites);
    time += from_seconds(kSpacing_m / kGnssReceiversSpeed_mps);
  }
  std::ranges::nth_element(costs_us, costs_us.begin() + std::ssize(costs_us) / 2);
  lap.epoch_us = costs_us[costs_us.size() / 2];
  return lap;
}

ReceiverLoad measure_load(const hil::RigConfiguration& rig, const std::string& model,
                          const sim::GnssParameters& parameters, emulators::UbloxSettings settings,
                          int receivers, double rate_hz, int epochs) {
  const hil::UbloxConfiguration& ublox = ublox_of(rig);
  const hil::SensorMount mount = hil::sensor_mount(rig.machine, ublox.mount);
  const sim::LocalFrame frame = hil::make_local_frame(rig.origin);
  const Calendar calendar(rig.start);
  const auto satellites = hil::make_satellites(rig.satellites, calendar);
  settings.measurement_period = from_seconds(1.0 / rate_hz);
  settings.start_up = Duration{0};
  emulators::NullByteOutput silence;
  CarriedMachine machine(rig, kGnssReceiversSpeed_mps);
  std::vector<sim::GnssSensor> sensors;
  std::vector<std::unique_ptr<emulators::UbloxReceiver>> devices;
  std::vector<sim::LinkMotion> antennas;
  for (int i = 0; i < receivers; ++i) {
    sensors.push_back(sim::GnssSensor(parameters, satellites, calendar, frame, rig.seed,
                                      "bench " + std::to_string(i)));
    devices.push_back(std::make_unique<emulators::UbloxReceiver>(settings, calendar, silence));
    machine.place(kStart, machine.length_m() * i / receivers);
    antennas.push_back(machine.motion(mount));
  }
  ReceiverLoad load{.model = model, .receivers = receivers, .rate_hz = rate_hz};
  for (int epoch = 0; epoch <= epochs; ++epoch) {
    const SimTime time = kStart + (epoch + 1) * settings.measurement_period;
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const double begin_s = hil::thread_cpu_seconds();
      const GnssSample sample = sensors[i].sample(time, antennas[i], machine.scene());
      const double sampled_s = hil::thread_cpu_seconds();
      devices[i]->update(sample);
      devices[i]->advance(time + settings.measurement_period / 2);
      if (epoch > 0) {  // the first one warms up
        load.sensor_us += 1e6 * (sampled_s - begin_s);
        load.emulator_us += 1e6 * (hil::thread_cpu_seconds() - sampled_s);
      }
    }
  }
  const double samples = static_cast<double>(receivers) * epochs;
  load.sensor_us /= samples;
  load.emulator_us /= samples;
  load.core_share = 1e-6 * (load.sensor_us + load.emulator_us) * receivers * rate_hz;
  return load;
}

}  // namespace

std::vector<SkySampling> measure_sky_sampling(const hil::RigConfiguration& rig,
                                              const std::vector<int>& samples) {
  constexpr int kDensest = 16;
  const SampledLap reference = sampled_lap(rig, kDensest);
  std::vector<SkySampling> rows;
  for (const int count : samples) {
    const SampledLap lap = sampled_lap(rig, count);
    SkySampling row{.samples = count, .epoch_us = lap.epoch_us};
    double square_db2 = 0.0;
    std::size_t both = 0;
    std::size_t differing = 0;
    for (std::size_t k = 0; k < lap.epochs.size(); ++k) {
      for (std::size_t i = 0; i < lap.epochs[k].size(); ++i) {
        const SatelliteView& one = lap.epochs[k][i];
        const SatelliteView& dense = reference.epochs[k][i];
        ++row.views;
        differing += one.tracked != dense.tracked ? 1U : 0U;
        if (one.tracked && dense.tracked) {
          square_db2 += std::pow(one.cn0_dbhz - dense.cn0_dbhz, 2);
          ++both;
        }
      }
    }
    row.differing = static_cast<double>(differing) / static_cast<double>(row.views);
    row.cn0_error_db = std::sqrt(square_db2 / static_cast<double>(std::max<std::size_t>(1, both)));
    rows.push_back(row);
  }
  return rows;
}

std::vector<ReceiverLoad> measure_receivers(const hil::RigConfiguration& rig, int receivers,
                                            double rate_hz, int epochs) {
  sim::GnssParameters paper = ublox_of(rig).sensor;
  paper.error_model = sim::ErrorModel::paper;
  paper.raw_measurements = false;
  sim::GnssParameters coloured = paper;
  coloured.error_model = sim::ErrorModel::coloured;
  sim::GnssParameters engine = paper;
  engine.error_model = sim::ErrorModel::engine;
  sim::GnssParameters without_reflections = engine;
  without_reflections.multipath.enabled = false;
  sim::GnssParameters raw = engine;
  raw.raw_measurements = true;
  sim::GnssParameters all = raw;
  all.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
  all.second_signals = true;
  all.sky.maximum_channels = 72;
  emulators::UbloxSettings own = ublox_of(rig).receiver;
  own.baud = 230'400;
  emulators::UbloxSettings f9p;
  f9p.profile = &emulators::ublox_zed_f9p();
  f9p.baud = 921'600;
  f9p.nmea_sentences = own.nmea_sentences;
  f9p.ubx_messages = {"NAV-PVT", "RXM-RAWX", "RXM-SFRBX"};
  const auto load = [&](const char* model, const sim::GnssParameters& parameters,
                        const emulators::UbloxSettings& settings) {
    return measure_load(rig, model, parameters, settings, receivers, rate_hz, epochs);
  };
  return {load("paper", paper, own),
          load("coloured", coloured, own),
          load("engine, no reflections", without_reflections, own),
          load("engine", engine, own),
          load("engine, raw", raw, own),
          load("engine, ZED-F9P, RAWX, SFRBX", all, f9p)};
}

}  // namespace rigwire::bench
