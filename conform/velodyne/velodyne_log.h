// What a Velodyne lidar sent over a while to its two ports, as the suite velodyne needs it: packets
// as bytes, the time that passed between them, the rotor's position.
//
// Fields are read here by their offsets (docs/devices/velodyne-packets.md) and not by the codec
// that the emulators send with; what a model is comes from the tables of protocols/velodyne.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "conform/datagram_line.h"
#include "conform/nmea/nmea_log.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/packet_layout.h"
#include "protocols/velodyne/position_packet.h"

namespace rigwire::conform {

struct VelodyneDatagram {
  std::chrono::nanoseconds at{};  ///< From the begin of listening.
  DatagramLine::Peer from;
  std::vector<std::uint8_t> bytes;
};

/// The fields of a data packet. Precondition: it has 1206 bytes.
class VelodyneData {
 public:
  explicit VelodyneData(const VelodyneDatagram& datagram) : datagram_(&datagram) {}

  [[nodiscard]] const VelodyneDatagram& datagram() const { return *datagram_; }
  [[nodiscard]] unsigned flag(std::size_t block) const { return u16(100 * block); }
  [[nodiscard]] unsigned azimuth(std::size_t block) const { return u16(100 * block + 2); }
  [[nodiscard]] unsigned distance(std::size_t block, std::size_t channel) const {
    return u16(100 * block + 4 + 3 * channel);
  }
  [[nodiscard]] unsigned reflectivity(std::size_t block, std::size_t channel) const {
    return byte(100 * block + 6 + 3 * channel);
  }
  [[nodiscard]] std::uint32_t timestamp_us() const { return u16(1200) | u16(1202) << 16U; }
  [[nodiscard]] std::uint8_t return_mode() const { return byte(1204); }
  [[nodiscard]] std::uint8_t product() const { return byte(1205); }

 private:
  [[nodiscard]] std::uint8_t byte(std::size_t at) const { return datagram_->bytes.at(at); }
  [[nodiscard]] unsigned u16(std::size_t at) const { return byte(at) | byte(at + 1) << 8U; }

  const VelodyneDatagram* datagram_;
};

/// The fields of a position packet. Precondition: it has 512 bytes.
class VelodynePosition {
 public:
  VelodynePosition(const VelodyneDatagram& datagram, std::size_t data_before)
      : datagram_(&datagram), data_before_(data_before) {}

  [[nodiscard]] const VelodyneDatagram& datagram() const { return *datagram_; }
  /// Data packets of the right length that had come before it.
  [[nodiscard]] std::size_t data_before() const { return data_before_; }
  [[nodiscard]] std::uint8_t byte(std::size_t at) const { return datagram_->bytes.at(at); }
  [[nodiscard]] unsigned u16(std::size_t at) const { return byte(at) | byte(at + 1) << 8U; }
  [[nodiscard]] std::uint32_t timestamp_us() const { return u16(198) | u16(200) << 16U; }
  [[nodiscard]] std::uint8_t pulse_state() const { return byte(202); }
  /// From its place up to the first zero: with CR and LF where it has them.
  [[nodiscard]] std::string sentence() const;

 private:
  const VelodyneDatagram* datagram_;
  std::size_t data_before_;
};

/// Behind a longer gap the rotor's position is ambiguous: half a turn at 1200 rpm is 25 ms.
inline constexpr std::int64_t kLongestRotorGap_ns = 20'000'000;

/// Where the rotor was at a firing that a block begins with.
struct VelodyneFiring {
  std::size_t packet = 0;
  std::int64_t time_ns = 0;  ///< Since the first packet's timestamp, by timestamps.
  int azimuth_counts = 0;
};

/// Claims of a sensor.
struct VelodyneClaims {
  std::string model;                   ///< Name in its data sheet; empty: by its factory bytes.
  std::string return_mode;             ///< strongest, last, dual; empty: not claimed.
  double rotor_rpm = 0.0;              ///< 0: not claimed.
  unsigned view_start_deg = 0;         ///< 0 .. 359; with 359 at the end all round.
  unsigned view_end_deg = 359;         ///< Included.
  std::uint16_t position_port = 8308;  ///< Port of position packets; 0: none.
  std::string pulse;                   ///< absent, synchronizing, locked; empty: not claimed.

  [[nodiscard]] bool all_round() const { return view_start_deg == 0 && view_end_deg == 359; }
};

class VelodyneLog {
 public:
  VelodyneLog() = default;
  VelodyneLog(VelodyneLog&&) = default;  // Packets know their datagrams, which stay where they are.
  VelodyneLog& operator=(VelodyneLog&&) = default;
  VelodyneLog(const VelodyneLog&) = delete;
  VelodyneLog& operator=(const VelodyneLog&) = delete;
  ~VelodyneLog() = default;

  /// In the order in which they came.
  void add_data(VelodyneDatagram datagram);
  void add_position(VelodyneDatagram datagram);
  /// More came than is kept: listening ended there. `allowed` says how much may come.
  void overflow(std::string allowed) { overflow_ = std::move(allowed); }
  /// Empty: everything that came is here.
  [[nodiscard]] const std::string& overflow() const { return overflow_; }
  /// To be called once, when listening ends. `lost_here`: what this machine did not take in time.
  void close(std::chrono::nanoseconds span, std::uint64_t lost_here, const VelodyneClaims& claims);

  [[nodiscard]] std::chrono::nanoseconds span() const { return span_; }
  [[nodiscard]] std::uint64_t lost_here() const { return lost_here_; }
  [[nodiscard]] const std::vector<VelodyneDatagram>& data_datagrams() const { return data_; }
  [[nodiscard]] const std::vector<VelodyneDatagram>& position_datagrams() const {
    return positions_;
  }
  /// Those of the right length.
  [[nodiscard]] const std::vector<VelodyneData>& data() const { return packets_; }
  [[nodiscard]] const std::vector<VelodynePosition>& positions() const { return position_packets_; }
  /// The sentences of position packets, each once.
  [[nodiscard]] const NmeaLog& sentences() const { return sentences_; }

  /// Returns the model, by claim or by the packets: product id, flags, and among models that share
  /// these the one whose packets last so long. Null: in doubt.
  [[nodiscard]] const protocols::velodyne::Model* model() const { return model_; }
  /// Returns the return mode of the packets; of an HDL-64E derived from pairs of blocks with one
  /// azimuth. Strongest if in doubt.
  [[nodiscard]] protocols::velodyne::ReturnMode mode() const { return mode_; }
  [[nodiscard]] bool dual() const { return mode_ == protocols::velodyne::ReturnMode::dual; }
  /// Returns the steps between the timestamps of successive packets, microseconds, the shorter way
  /// around the hour: one fewer than packets.
  [[nodiscard]] const std::vector<std::int64_t>& steps_us() const { return steps_us_; }
  /// Returns the time from one packet to the next, by the model. Precondition: the model is known.
  [[nodiscard]] double packet_period_us() const;
  /// Returns the firings at the begin of each packet's blocks; none without a model.
  [[nodiscard]] const std::vector<VelodyneFiring>& firings() const { return firings_; }
  /// Returns the mean speed of the rotor over all but long gaps, rpm; nullopt without firings.
  [[nodiscard]] std::optional<double> rotor_rpm() const;

 private:
  void find_model(const VelodyneClaims& claims);
  void find_firings();

  std::vector<VelodyneDatagram> data_;
  std::vector<VelodyneDatagram> positions_;
  std::vector<std::size_t> data_before_;  ///< Datagrams, of each position datagram.
  std::chrono::nanoseconds span_{};
  std::uint64_t lost_here_ = 0;
  std::vector<VelodyneData> packets_;
  std::vector<VelodynePosition> position_packets_;
  NmeaLog sentences_;
  const protocols::velodyne::Model* model_ = nullptr;
  protocols::velodyne::ReturnMode mode_ = protocols::velodyne::ReturnMode::strongest;
  std::vector<std::int64_t> steps_us_;
  std::vector<VelodyneFiring> firings_;
  std::string overflow_;
};

/// From one azimuth to another, counts, -18000 .. 17999.
[[nodiscard]] int azimuth_step(int from_counts, int to_counts);
/// From one timestamp to another, microseconds, the shorter way around the hour.
[[nodiscard]] std::int64_t timestamp_step_us(std::uint32_t from_us, std::uint32_t to_us);

}  // namespace rigwire::conform
