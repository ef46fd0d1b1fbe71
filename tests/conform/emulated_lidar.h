// An emulated lidar of any model that was listened to for a while, in its own time: nothing waits.
// What it sent may be damaged on the way, one packet at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "conform/velodyne/velodyne_suite.h"
#include "emulators/velodyne/velodyne_lidar.h"
#include "recorder.h"

namespace rigwire::conform {

using DatagramBytes = std::vector<std::uint8_t>;
using Datagrams = std::vector<DatagramBytes>;
/// Instead of a packet of either port: itself, another, several, or none. `number` counts that
/// port's packets.
using PacketChange = std::function<Datagrams(const DatagramBytes& packet, std::size_t number)>;

struct LidarScene {
  emulators::VelodyneSettings settings;
  Duration span = std::chrono::seconds{4};
  PacketChange change;
  std::uint16_t source_port = 0;  ///< Port that data packets come from; 0: the model's.
};

/// Two walls, one behind the other for every second degree, with a fix that the sensor hears of;
/// the full hour comes after two seconds.
inline VelodyneLog listened_to(const LidarScene& scene, const VelodyneClaims& claims = {}) {
  const Calendar calendar{parse_utc("2026-06-01T08:59:58Z")};
  test::ByteRecorder data;
  test::ByteRecorder position;
  emulators::VelodyneLidar lidar(scene.settings, calendar, data, position);
  GnssSample fix;
  fix.fix = GnssFix::three_d;
  fix.latitude_deg = 49.4;
  fix.longitude_deg = -7.75;
  lidar.observe_fix(fix);
  const SamplePlan plan = lidar.sample_plan();
  double azimuth_rad = 1.0;
  for (SimTime time = plan.first; time < kStart + scene.span; time += plan.period) {
    lidar.advance(time);
    const double rate = lidar.command().rotor_rate_radps;
    azimuth_rad = std::fmod(azimuth_rad + rate * to_seconds(plan.period), 2.0 * std::numbers::pi);
    for (std::size_t b = 0; b < lidar.pattern().banks(); ++b) {
      LidarFiring bank;
      bank.time = time;
      bank.rotor_azimuth_rad = azimuth_rad;
      bank.rotor_rate_radps = rate;
      bank.first_laser = b * kBankLasers;
      const bool two = static_cast<int>(azimuth_rad * 180.0 / std::numbers::pi) % 2 == 0;
      bank.strongest.fill({10.0F, 0.5F});
      bank.last.fill(two ? LidarReturn{20.0F, 0.25F} : LidarReturn{10.0F, 0.5F});
      bank.several = true;
      lidar.update(bank);
    }
  }
  struct Heard {
    SimTime due;
    bool data;
    DatagramBytes bytes;
  };
  std::vector<Heard> all;
  for (const bool is_data : {true, false}) {
    const auto& sent = is_data ? data.sent : position.sent;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      for (DatagramBytes& bytes :
           scene.change ? scene.change(sent[i].bytes, i) : Datagrams{sent[i].bytes}) {
        all.push_back({sent[i].due, is_data, std::move(bytes)});
      }
    }
  }
  std::ranges::stable_sort(all, {}, &Heard::due);
  const std::uint16_t models_port = emulators::model_of(scene.settings).source_port;
  const std::uint16_t port = scene.source_port != 0 ? scene.source_port
                             : models_port != 0     ? models_port
                                                    : std::uint16_t{2368};
  VelodyneLog log;
  for (Heard& each : all) {
    VelodyneDatagram datagram{each.due - kStart,
                              {"192.168.1.201", each.data ? port : std::uint16_t{8308}},
                              std::move(each.bytes)};
    if (each.data) {
      log.add_data(std::move(datagram));
    } else {
      log.add_position(std::move(datagram));
    }
  }
  log.close(scene.span, 0, claims);
  return log;
}

}  // namespace rigwire::conform
