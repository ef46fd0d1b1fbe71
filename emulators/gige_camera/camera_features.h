// The registers of the camera's own, beyond the bootstrap registers, and the table of its features:
// names after SFNC 2.x. Registers of floating-point features are of eight bytes.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "emulators/gige_camera/gige_camera_settings.h"
#include "protocols/gige_vision/genicam.h"
#include "protocols/gige_vision/pixel_format.h"
#include "sim/samples/picture_sample.h"

namespace rigwire::emulators {

// Steps and limits of what a client may set.
inline constexpr int kWidthStep = 4;
inline constexpr int kHeightStep = 2;
inline constexpr int kSmallestSide = 16;
inline constexpr int kLongestSide = 16'384;
inline constexpr int kPacketSizeMinimum = 576;
inline constexpr int kPacketSizeMaximum = 16356;
inline constexpr int kPacketSizeStep = 4;
inline constexpr std::uint32_t kHeartbeatMinimum_ms = 500;
inline constexpr double kThroughputMinimum_bps = 8e6;
inline constexpr double kThroughputMaximum_bps = 1000e6;
inline constexpr double kFrameRateMinimum_hz = 0.01;

/// Addresses.
/// Returns `span` in the unit of the camera's times.
[[nodiscard]] constexpr double microseconds(Duration span) {
  return static_cast<double>(span.count()) * 1e-3;
}

namespace camera_register {
inline constexpr std::uint32_t kSensorWidth = 0xA000;
inline constexpr std::uint32_t kSensorHeight = 0xA004;
inline constexpr std::uint32_t kWidthMax = 0xA008;
inline constexpr std::uint32_t kHeightMax = 0xA00C;
inline constexpr std::uint32_t kWidth = 0xA010;
inline constexpr std::uint32_t kHeight = 0xA014;
inline constexpr std::uint32_t kOffsetX = 0xA018;
inline constexpr std::uint32_t kOffsetY = 0xA01C;
inline constexpr std::uint32_t kWidthRoom = 0xA020;
inline constexpr std::uint32_t kHeightRoom = 0xA024;
inline constexpr std::uint32_t kOffsetXRoom = 0xA028;
inline constexpr std::uint32_t kOffsetYRoom = 0xA02C;
inline constexpr std::uint32_t kBinningHorizontal = 0xA030;
inline constexpr std::uint32_t kBinningVertical = 0xA034;
inline constexpr std::uint32_t kPixelFormat = 0xA038;
inline constexpr std::uint32_t kPayloadSize = 0xA03C;
inline constexpr std::uint32_t kComponentSelector = 0xA040;
inline constexpr std::uint32_t kComponentEnable = 0xA050;  // one for each component
inline constexpr std::uint32_t kComponentId = 0xA070;      // one for each component

inline constexpr std::uint32_t kAcquisitionMode = 0xA100;
inline constexpr std::uint32_t kAcquisitionStart = 0xA104;
inline constexpr std::uint32_t kAcquisitionStop = 0xA108;
inline constexpr std::uint32_t kAcquisitionFrameCount = 0xA10C;
inline constexpr std::uint32_t kFrameRateEnable = 0xA110;
inline constexpr std::uint32_t kFrameRate = 0xA118;
inline constexpr std::uint32_t kFrameRateRoom = 0xA120;
inline constexpr std::uint32_t kResultingFrameRate = 0xA128;
inline constexpr std::uint32_t kTriggerSelector = 0xA130;
inline constexpr std::uint32_t kTriggerMode = 0xA134;
inline constexpr std::uint32_t kTriggerSource = 0xA138;
inline constexpr std::uint32_t kTriggerActivation = 0xA13C;
inline constexpr std::uint32_t kTriggerSoftware = 0xA140;
inline constexpr std::uint32_t kTriggerDelay = 0xA148;
inline constexpr std::uint32_t kExposureMode = 0xA150;
inline constexpr std::uint32_t kExposureAuto = 0xA154;
inline constexpr std::uint32_t kExposureTime = 0xA158;

inline constexpr std::uint32_t kGainAuto = 0xA200;
inline constexpr std::uint32_t kGain = 0xA208;
inline constexpr std::uint32_t kBlackLevel = 0xA210;

inline constexpr std::uint32_t kChunkModeActive = 0xA300;
inline constexpr std::uint32_t kChunkSelector = 0xA304;
inline constexpr std::uint32_t kChunkEnable = 0xA310;  // one for each chunk

inline constexpr std::uint32_t kLineSelector = 0xA400;
inline constexpr std::uint32_t kLineMode = 0xA404;
inline constexpr std::uint32_t kLineStatus = 0xA408;

inline constexpr std::uint32_t kTemperature = 0xA500;
inline constexpr std::uint32_t kThroughputMode = 0xA508;
inline constexpr std::uint32_t kThroughputLimit = 0xA50C;
inline constexpr std::uint32_t kDeviceReset = 0xA510;

inline constexpr std::uint32_t kScan3dOutputMode = 0xA600;
inline constexpr std::uint32_t kScan3dDistanceUnit = 0xA604;
inline constexpr std::uint32_t kScan3dInvalidFlag = 0xA608;
inline constexpr std::uint32_t kScan3dScale = 0xA610;
inline constexpr std::uint32_t kScan3dOffset = 0xA618;
inline constexpr std::uint32_t kScan3dInvalidValue = 0xA620;
inline constexpr std::uint32_t kScan3dFocalLength = 0xA628;
inline constexpr std::uint32_t kScan3dBaseline = 0xA630;
inline constexpr std::uint32_t kScan3dPrincipalU = 0xA638;
inline constexpr std::uint32_t kScan3dPrincipalV = 0xA640;
}  // namespace camera_register

/// Where the description can be read.
inline constexpr std::uint32_t kDescriptionAddress = 0x0001'0000;

enum class AcquisitionMode : std::uint8_t { continuous, single_frame, multi_frame };
enum class TriggerSource : std::uint8_t { software, line };

/// Values of ChunkSelector. The image is a chunk that cannot be switched off, and none of them.
enum class CameraChunk : std::uint8_t { timestamp, frame, exposure, gain };
inline constexpr std::array kCameraChunks{CameraChunk::timestamp, CameraChunk::frame,
                                          CameraChunk::exposure, CameraChunk::gain};
/// Identifiers are of the maker's own choice: clients learn them from the description.
inline constexpr std::uint32_t kImageChunkId = 0x5257'0000;
[[nodiscard]] constexpr std::uint32_t chunk_id(CameraChunk chunk) {
  return kImageChunkId + 1 + static_cast<std::uint32_t>(chunk);
}

/// A component that a camera can send: its row in ComponentSelector.
struct CameraComponent {
  std::string_view name;
  std::uint16_t id = 0;  ///< ComponentIDValue (SFNC), and the purpose of its part on the wire.
  PictureComponent component = PictureComponent::intensity;
  std::uint8_t source = 0;
  bool CameraCommand::*wanted = &CameraCommand::intensity;
};
/// Returns the components of a kind of camera, in the order of its pictures' parts.
[[nodiscard]] std::vector<CameraComponent> camera_components(GigeCameraKind kind);

[[nodiscard]] protocols::gige_vision::PixelFormatCode pixel_format_code(PixelFormat format);

/// Everything that a client sees of the camera, in the order in which it lists it.
[[nodiscard]] std::vector<protocols::gige_vision::Feature> camera_features(
    const GigeCameraSettings& settings);

}  // namespace rigwire::emulators
