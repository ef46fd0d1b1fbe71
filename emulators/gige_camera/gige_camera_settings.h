// Settings of an emulated GigE Vision camera: what it is, where it is on the network, and its state
// at power-on.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/gige_camera/gige_camera_fault.h"
#include "emulators/supply.h"
#include "fields/rules.h"
#include "protocols/gige_vision/gvcp.h"
#include "sim/samples/picture_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What the camera makes of an exposure.
enum class GigeCameraKind : std::uint8_t {
  camera,  ///< One image.
  stereo,  ///< Left and right image, disparity and its confidence.
  depth,   ///< Range and its confidence, with an image.
};

/// Pulses on the camera's input line, from the simulation's clock.
struct CameraLine {
  Duration first{0};   ///< From the start of the run to the first pulse.
  Duration period{0};  ///< 0: the line is low for ever.
  Duration width = std::chrono::microseconds{100};  ///< Length of a pulse.

  /// Whether the line is high.
  [[nodiscard]] bool level(SimTime now) const {
    const SimTime begin = kStart + first;
    return period > Duration::zero() && now >= begin && (now - begin) % period < width;
  }
  friend bool operator==(const CameraLine&, const CameraLine&) = default;
};

/// What the registers of a camera with a third coordinate say of its geometry (SFNC,
/// Scan3dControl), for its whole sensor without binning.
struct CameraGeometry {
  double focal_length_px = 0.0;
  double baseline_m = 0.0;  ///< Stereo only.
  double principal_point_u_px = 0.0;
  double principal_point_v_px = 0.0;
  CoordinateCoding coding;

  friend bool operator==(const CameraGeometry&, const CameraGeometry&) = default;
};

/// A network on IPv4 as numbers: address, mask, gateway.
struct CameraAddress {
  std::uint32_t address = 0x7F00'0002;  // 127.0.0.2
  std::uint32_t mask = 0xFF00'0000;
  std::uint32_t gateway = 0;

  /// Whether `other` is in the same network.
  [[nodiscard]] bool contains(std::uint32_t other) const {
    return (other & mask) == (address & mask);
  }
  friend bool operator==(const CameraAddress&, const CameraAddress&) = default;
};

struct GigeCameraSettings {
  GigeCameraKind kind = GigeCameraKind::camera;
  std::string vendor = "Rigwire";    ///< At most 31 bytes.
  std::string model = "AreaCamera";  ///< At most 31 bytes.
  std::string serial_number = "1";   ///< At most 15 bytes.
  std::string user_name;             ///< At most 15 bytes, until a client writes another one.

  /// Locally administered, so that no vendor owns it.
  protocols::gige_vision::MacAddress mac{0x02, 0x52, 0x57, 0x00, 0x00, 0x01};
  CameraAddress address;
  /// Network of the hosts that are answered and to which streams may go.
  CameraAddress permitted{0x7F00'0001, 0xFF00'0000, 0};

  int width = 640;   ///< Width of the sensor, pixels; a multiple of 8.
  int height = 480;  ///< Height of the sensor, pixels; a multiple of 4.
  /// Pixel formats of the image; the first is in force at power-on.
  std::vector<PixelFormat> formats{PixelFormat::mono8, PixelFormat::mono10, PixelFormat::mono12};
  bool binning = true;  ///< Whether the sensor can join 2 by 2 pixels.
  Duration row_time = std::chrono::microseconds{10};  ///< To read one row out.
  CameraGeometry geometry;                            ///< Stereo and depth.

  Duration frame_period = std::chrono::milliseconds{50};
  Duration exposure = std::chrono::milliseconds{5};
  Duration exposure_minimum = std::chrono::microseconds{10};
  Duration exposure_maximum = std::chrono::seconds{1};
  bool exposure_auto = false;
  double gain_db = 0.0;
  double gain_maximum_db = 24.0;
  bool gain_auto = false;
  double black_level = 0.0;
  CameraLine line;

  /// Packets leave no faster than this, headers of IP and UDP included.
  double throughput_bps = 500e6;
  int packet_size = 1500;  ///< At power-on, bytes with IP and UDP headers.
  /// Exposures that wait for the network, with all their blocks; what comes beyond them is lost.
  int queued_frames = 3;
  int retained_frames = 8;  ///< Exposures that have been sent and can be asked for again.

  double temperature_degc = 45.0;
  double temperature_limit_degc = 85.0;

  std::vector<GigeCameraFault> faults;
  std::vector<SupplyFault> supply_faults;
  std::uint64_t seed = 1;  ///< Seed of the faults that have a probability.
};

/// Keys of the camera's own; network, and what its sensor is, come from elsewhere.
void visit(fields::Visitor& v, CameraLine& p);
void visit(fields::Visitor& v, GigeCameraSettings& p);
/// Throws std::invalid_argument naming the member, the value found and what is allowed.
void validate(const GigeCameraSettings& settings);

/// "127.0.0.2"
[[nodiscard]] std::string address_text(std::uint32_t address);

}  // namespace rigwire::emulators
