// Settings of a GigE Vision camera that can be changed at run time: its features, by their
// registers.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "emulators/gige_camera/gige_camera.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/bootstrap.h"

namespace rigwire::emulators {

namespace gev = protocols::gige_vision;
namespace reg = camera_register;
using protocols::store_big;

namespace {

using Status = gev::Status;

std::string_view tell_word(GigeCamera& camera, SimTime now, std::uint32_t address,
                           std::uint32_t value) {
  std::array<std::uint8_t, 4> bytes{};
  store_big<std::uint32_t>(bytes, 0, value);
  return camera.configure(now, address, bytes);
}

std::string_view tell_real(GigeCamera& camera, SimTime now, std::uint32_t address, double value) {
  std::array<std::uint8_t, 8> bytes{};
  store_big<std::uint64_t>(bytes, 0, std::bit_cast<std::uint64_t>(value));
  return camera.configure(now, address, bytes);
}

}  // namespace

std::string_view GigeCamera::configure(SimTime now, std::uint32_t address,
                                       std::span<const std::uint8_t> bytes) {
  live_until(now);
  if (!supply_.on()) {
    return "the camera has no supply";
  }
  if (faults_.first<RefusedWritesFault>(now) != nullptr) {
    return "the camera refuses whatever would change it";
  }
  const RegisterBank::Written written = bank_.write(address, bytes, *this);
  live_until(now);
  switch (written.status) {
    case Status::access_denied:
      return "not while it acquires pictures, or chooses the value itself";
    case Status::invalid_parameter:
      return "beyond what the camera can as it is set";
    default:
      return gev::is_error(written.status) ? "the camera refuses it" : "";
  }
}

std::span<const GigeCamera::Live> GigeCamera::live_settings() {
  using Settings = GigeCameraSettings;
  static constexpr std::array<Live, 8> kRows{{
      {"rate", "AcquisitionFrameRate",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_real(camera, now, reg::kFrameRate, 1.0 / to_seconds(wanted.frame_period));
       }},
      {"exposure_auto", "ExposureAuto",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_word(camera, now, reg::kExposureAuto, wanted.exposure_auto ? 1 : 0);
       }},
      {"exposure", "ExposureTime",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_real(camera, now, reg::kExposureTime, 1e6 * to_seconds(wanted.exposure));
       }},
      {"gain_auto", "GainAuto",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_word(camera, now, reg::kGainAuto, wanted.gain_auto ? 1 : 0);
       }},
      {"gain", "Gain",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_real(camera, now, reg::kGain, wanted.gain_db);
       }},
      {"black_level", "BlackLevel",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_real(camera, now, reg::kBlackLevel, wanted.black_level);
       }},
      {"throughput", "DeviceLinkThroughputLimit",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_word(camera, now, reg::kThroughputLimit,
                          static_cast<std::uint32_t>(std::llround(wanted.throughput_bps / 8)));
       }},
      {"packet_size", "GevSCPSPacketSize",
       [](GigeCamera& camera, SimTime now, const Settings& wanted) {
         return tell_word(
             camera, now, gev::bootstrap::kStreamPacketSize,
             static_cast<std::uint32_t>(wanted.packet_size) | gev::PacketSize::kDoNotFragment);
       }},
  }};
  return kRows;
}

}  // namespace rigwire::emulators
