#include "emulators/gige_camera/gige_camera.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "protocols/bytes.h"
#include "protocols/gige_vision/chunk.h"

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = camera_register;
using gev::Status;
using protocols::load_big;
using protocols::store_big;

constexpr std::string_view kDescriptionFile = "rigwire_camera.xml";
constexpr std::string_view kDeviceVersion = "1.0";
constexpr std::string_view kInformation = "Simulated; not certified";
constexpr std::uint32_t kMemoryMark = 0x5247'4341;  // "RGCA"
constexpr std::uint32_t kTicksPerSecond = 1'000'000'000;
constexpr std::uint32_t kLinkSpeed_mbps = 1000;
constexpr std::uint32_t kHeartbeat_ms = 3000;
constexpr std::size_t kNameBytes = 16;
constexpr std::uint64_t kTriggerStream = 0x7472'6967;  // "trig": the faults' second random stream
constexpr double kMillimetresPerMetre = 1000.0;

constexpr std::uint32_t kCapability =
    gev::Capability::kUserDefinedName | gev::Capability::kSerialNumber |
    gev::Capability::kHeartbeatDisable | gev::Capability::kLinkSpeed |
    gev::Capability::kPrimaryApplication | gev::Capability::kExtendedStatus |
    gev::Capability::kPacketResend | gev::Capability::kWriteMemory |
    gev::Capability::kConcatenation;
constexpr std::uint32_t kConfigurationBits =
    gev::Configuration::kHeartbeatDisable | gev::Configuration::kExtendedStatus;
constexpr std::uint32_t kIpConfigurations =
    gev::IpConfiguration::kPersistent | gev::IpConfiguration::kLinkLocal;

/// Size of a chunk's value, and of the tags around it.
constexpr std::size_t kChunkValueBytes = 8;

std::uint32_t chunk_enable_register(CameraChunk chunk) {
  return reg::kChunkEnable + 4 * static_cast<std::uint32_t>(chunk);
}

Duration from_microseconds(double span) {
  return Duration{std::llround(span * 1e3)};
}

GigeCameraSettings validated(const GigeCameraSettings& settings) {
  validate(settings);
  return settings;
}

/// Whether two pictures divide into the same blocks.
bool alike(const Picture& a, const Picture& b) {
  return std::ranges::equal(a.parts, b.parts, [](const PicturePart& p, const PicturePart& q) {
    return p.component == q.component && p.source == q.source && p.format == q.format &&
           p.region.width == q.region.width && p.region.height == q.region.height;
  });
}

/// Whether its bytes are as many as its geometry says.
bool complete(const PicturePart& part) {
  return part.region.width > 0 && part.region.height > 0 &&
         part.bytes.size() == static_cast<std::size_t>(part.region.width) *
                                  static_cast<std::size_t>(part.region.height) *
                                  bytes_per_pixel(part.format);
}

constexpr std::array kQuantities{
    Quantity{"time stamp", "s", 0.0, 9.2e9, 1e-9},
    Quantity{"exposure", "s", 1e-6, 10.0, 1e-9},
    Quantity{"gain", "dB", 0.0, 48.0, 0.0},
};

}  // namespace

GigeCamera::GigeCamera(const GigeCameraSettings& settings, NonvolatileMemory& memory,
                       DatagramOutput& control, DatagramOutput& stream)
    : settings_(validated(settings)),
      faults_(settings.faults),
      supply_({.power_on = Duration{0}, .faults = settings_.supply_faults}),
      memory_(memory),
      components_(camera_components(settings.kind)),
      description_(gev::write_description({settings.vendor, settings.model, kInformation},
                                          camera_features(settings))),
      bank_(camera_features(settings), description_, kDescriptionAddress),
      control_(bank_, *this, control, settings_.permitted),
      cable_(stream, faults_, settings.seed, kPacketSizeMaximum),
      stream_(cable_,
              {.queued = static_cast<std::size_t>(settings.queued_frames),
               .retained = static_cast<std::size_t>(settings.retained_frames),
               .blocks = components_.size()},
              kPacketSizeMaximum),
      trigger_faults_(settings.seed ^ kTriggerStream) {
  power_up();
  if (supply_.next_change() <= kStart) {
    supply_.change();
  }
}

// --- Power-up and memory. ------------------------------------------------------------------------

void GigeCamera::identify() {
  bank_.set_word(boot::kVersion, gev::kVersion20);
  bank_.set_word(boot::kDeviceMode, gev::kDeviceModeTransmitter);
  const gev::MacAddress& mac = settings_.mac;
  bank_.set_word(boot::kMacHigh, load_big<std::uint16_t>(mac, 0));
  bank_.set_word(boot::kMacLow, load_big<std::uint32_t>(mac, 2));
  bank_.set_text(boot::kManufacturerName, settings_.vendor);
  bank_.set_text(boot::kModelName, settings_.model);
  bank_.set_text(boot::kDeviceVersion, kDeviceVersion);
  bank_.set_text(boot::kManufacturerInformation, kInformation);
  bank_.set_text(boot::kSerialNumber, settings_.serial_number);
  bank_.set_text(boot::kFirstUrl,
                 gev::local_url(kDescriptionFile, kDescriptionAddress, description_.size()));
  bank_.set_word(boot::kIpCapability, kIpConfigurations);
  bank_.set_word(boot::kInterfaceCount, 1);
  bank_.set_word(boot::kLinkSpeed, kLinkSpeed_mbps);
  bank_.set_word(boot::kStreamChannelCount, 1);
  bank_.set_word(boot::kActiveLinkCount, 1);
  bank_.set_word(boot::kStreamCapability,
                 gev::StreamCapability::kSourcePort | gev::StreamCapability::kShortIds);
  bank_.set_word(boot::kCapability, kCapability);
  bank_.set_word(boot::kTickFrequencyLow, kTicksPerSecond);
  bank_.set_word(boot::kStreamChannelCapability,
                 components_.size() > 1 ? gev::StreamChannel::kMultipart : 0);
}

void GigeCamera::power_up() {
  identify();
  recall();
  bank_.set_word(boot::kHeartbeatTimeout, kHeartbeat_ms);
  bank_.set_word(boot::kConfiguration, 0);
  stream_.set_extended_status(false);
  bank_.set_word(boot::kStreamConfiguration, 0);
  bank_.set_word(boot::kTimestampHigh, 0);
  bank_.set_word(boot::kTimestampLow, 0);
  bank_.set_word(boot::kStreamPacketSize, static_cast<std::uint32_t>(settings_.packet_size) |
                                              gev::PacketSize::kDoNotFragment);
  bank_.set_word(boot::kStreamPacketDelay, 0);
  bank_.set_word(boot::kStreamDestination, 0);
  bank_.set_word(boot::kStreamPort, 0);
  bank_.set_word(boot::kStreamChannelConfiguration, 0);

  bank_.set_word(reg::kSensorWidth, static_cast<std::uint32_t>(settings_.width));
  bank_.set_word(reg::kSensorHeight, static_cast<std::uint32_t>(settings_.height));
  bank_.set_word(reg::kBinningHorizontal, 1);
  bank_.set_word(reg::kBinningVertical, 1);
  reset_region();
  bank_.set_word(reg::kPixelFormat,
                 static_cast<std::uint32_t>(pixel_format_code(settings_.formats.front())));
  for (std::size_t i = 0; components_.size() > 1 && i < components_.size(); ++i) {
    const auto place = static_cast<std::uint32_t>(4 * i);
    // What only the calibration needs is off at first.
    bank_.set_word(reg::kComponentEnable + place, components_[i].source == 0 ? 1 : 0);
    bank_.set_word(reg::kComponentId + place, components_[i].id);
  }
  bank_.set_word(reg::kAcquisitionMode, static_cast<std::uint32_t>(AcquisitionMode::continuous));
  bank_.set_word(reg::kAcquisitionFrameCount, 1);
  bank_.set_word(reg::kFrameRateEnable, 1);
  bank_.set_real(reg::kFrameRate, 1e9 / static_cast<double>(settings_.frame_period.count()));
  bank_.set_word(reg::kTriggerMode, 0);
  bank_.set_word(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::software));
  bank_.set_real(reg::kTriggerDelay, 0.0);
  bank_.set_word(reg::kExposureAuto, settings_.exposure_auto ? 1 : 0);
  bank_.set_real(reg::kExposureTime, microseconds(settings_.exposure));
  bank_.set_word(reg::kGainAuto, settings_.gain_auto ? 1 : 0);
  bank_.set_real(reg::kGain, settings_.gain_db);
  bank_.set_real(reg::kBlackLevel, settings_.black_level);
  bank_.set_word(reg::kChunkModeActive, 0);
  for (const CameraChunk chunk : kCameraChunks) {
    bank_.set_word(chunk_enable_register(chunk), 1);
  }
  bank_.set_word(reg::kThroughputMode, 1);
  bank_.set_word(reg::kThroughputLimit,
                 static_cast<std::uint32_t>(std::llround(settings_.throughput_bps / 8)));
  if (settings_.kind != GigeCameraKind::camera) {
    const CameraGeometry& geometry = settings_.geometry;
    const bool stereo = settings_.kind == GigeCameraKind::stereo;
    // Disparities are in pixels, ranges in millimetres.
    const double unit = stereo ? 1.0 : kMillimetresPerMetre;
    bank_.set_word(reg::kScan3dDistanceUnit, stereo ? 1 : 0);
    bank_.set_word(reg::kScan3dOutputMode, stereo ? 1 : 0);
    bank_.set_word(reg::kScan3dInvalidFlag, 1);
    bank_.set_real(reg::kScan3dScale, geometry.coding.scale * unit);
    bank_.set_real(reg::kScan3dOffset, geometry.coding.offset * unit);
    bank_.set_real(reg::kScan3dInvalidValue, geometry.coding.invalid);
    bank_.set_real(reg::kScan3dFocalLength, geometry.focal_length_px);
    if (stereo) {
      bank_.set_real(reg::kScan3dBaseline, geometry.baseline_m);
    }
    bank_.set_real(reg::kScan3dPrincipalU, geometry.principal_point_u_px);
    bank_.set_real(reg::kScan3dPrincipalV, geometry.principal_point_v_px);
  }
  asked_exposure_ = settings_.exposure;
  stuck_exposure_ = settings_.exposure;
  asked_gain_db_ = settings_.gain_db;
  derive();
}

void GigeCamera::recall() {
  bank_.set_text(boot::kUserDefinedName, settings_.user_name);
  bank_.set_word(boot::kIpConfiguration, kIpConfigurations);
  bank_.set_word(boot::kPersistentAddress, settings_.address.address);
  bank_.set_word(boot::kPersistentMask, settings_.address.mask);
  bank_.set_word(boot::kPersistentGateway, settings_.address.gateway);
  set_address(settings_.address);
  const auto content = unseal(kMemoryMark, memory_.content());
  if (!content || content->size() != kNameBytes + 4 * sizeof(std::uint32_t)) {
    return;
  }
  const std::span<const std::uint8_t> name = content->first(kNameBytes);
  bank_.set_text(boot::kUserDefinedName,
                 std::string(name.begin(), std::ranges::find(name, std::uint8_t{0})));
  const auto word = [&content](std::size_t index) {
    return load_big<std::uint32_t>(*content, kNameBytes + 4 * index);
  };
  bank_.set_word(boot::kIpConfiguration, word(0));
  bank_.set_word(boot::kPersistentAddress, word(1));
  bank_.set_word(boot::kPersistentMask, word(2));
  bank_.set_word(boot::kPersistentGateway, word(3));
  set_address(configured_address());
}

CameraAddress GigeCamera::configured_address() const {
  const CameraAddress persistent{bank_.word(boot::kPersistentAddress),
                                 bank_.word(boot::kPersistentMask),
                                 bank_.word(boot::kPersistentGateway)};
  const bool used = (bank_.word(boot::kIpConfiguration) & gev::IpConfiguration::kPersistent) != 0;
  return used && settings_.permitted.contains(persistent.address) ? persistent : settings_.address;
}

bool GigeCamera::keep() {
  std::array<std::uint8_t, kNameBytes + 4 * sizeof(std::uint32_t)> content{};
  std::ranges::copy(bank_.text(boot::kUserDefinedName), content.begin());
  std::size_t at = kNameBytes;
  for (const std::uint32_t address : {boot::kIpConfiguration, boot::kPersistentAddress,
                                      boot::kPersistentMask, boot::kPersistentGateway}) {
    store_big(std::span<std::uint8_t>(content), at, bank_.word(address));
    at += sizeof(std::uint32_t);
  }
  return memory_.store(seal(kMemoryMark, content));
}

void GigeCamera::restart() {
  reset_asked_ = false;
  control_.end_control(now_);
  end_acquisition();
  time_zero_ = now_;
  const CameraAddress before = address();
  power_up();
  address_changes_ += before == address() ? 0U : 1U;
}

// --- Time. ---------------------------------------------------------------------------------------

SimTime GigeCamera::next_event() const {
  return std::min(supply_.next_change(), next_work());
}

SimTime GigeCamera::next_work() const {
  return std::min(
      {control_.next_event(), acquisition_.next_event(), stream_.next_event(),
       faults_.next_change<ExposureStuckFault, OverTemperatureFault, SlowPicturesFault>(now_)});
}

void GigeCamera::live_until(SimTime now) {
  while (supply_.next_change() <= now) {
    work_until(supply_.next_change());
    switch_supply();
  }
  work_until(now);
}

void GigeCamera::switch_supply() {
  supply_.change();
  if (supply_.on()) {
    const std::uint32_t before = address_changes_;
    restart();
    if (address_changes_ != before) {
      moved_();
    }
    return;
  }
  control_.end_control(now_);
  control_.forget();
  end_acquisition();
  stream_.close();
  cable_.clear();
  last_picture_.reset();
}

void GigeCamera::work_until(SimTime now) {
  for (SimTime next = next_work(); next <= now; next = next_work()) {
    now_ = std::max(now_, next);
    step();
  }
  now_ = now;
}

void GigeCamera::step() {
  control_.advance(now_);
  acquisition_.advance(now_);
  if (!faults_.empty()) {
    if (temperature_degc() > settings_.temperature_limit_degc) {
      end_acquisition();
    }
    derive_command();
    pace_acquisition();
  }
  command_.software_triggers = acquisition_.software_exposures();
  stream_.advance(now_);
}

GigeCameraFaults::Id GigeCamera::begin(const GigeCameraFault& fault) {
  const auto id = faults_.add(fault);
  step();
  return id;
}

bool GigeCamera::end(GigeCameraFaults::Id id, SimTime now) {
  live_until(now);
  const bool ended = faults_.end(id, now);
  step();
  return ended;
}

void GigeCamera::advance(SimTime now) {
  live_until(now);
}

void GigeCamera::receive(SimTime now, const UdpEnd& from, std::span<const std::uint8_t> datagram) {
  live_until(now);
  if (link_down() || !supply_.on()) {
    ++counters_.lost_datagrams;
    return;
  }
  control_.receive(now, from, datagram);
  if (reset_asked_) {
    restart();
  }
  // What is due at this very instant.
  live_until(now);
}

std::uint64_t GigeCamera::ticks(SimTime instant) const {
  return instant < time_zero_ ? 0 : static_cast<std::uint64_t>((instant - time_zero_).count());
}

double GigeCamera::temperature_degc() const {
  const auto* const hot = faults_.first<OverTemperatureFault>(now_);
  return hot != nullptr ? hot->temperature_degc : settings_.temperature_degc;
}

double GigeCamera::nominal_rate_hz() const {
  if (!acquisition_.running() || !stream_.is_open() || plan_.first == kNever) {
    return 0.0;
  }
  const std::size_t room = gev::payload_room(packet_size(), false, false);
  const std::size_t payload = bank_.word(reg::kPayloadSize);
  const std::size_t packets = 2 + (payload + room - 1) / room;  // with leader and trailer
  return static_cast<double>(packets) / to_seconds(plan_.period);
}

std::span<const Quantity> GigeCamera::quantities() const {
  return kQuantities;
}

GigeCameraCounters GigeCamera::counters() const {
  GigeCameraCounters all = counters_;
  all.ignored_triggers = acquisition_.ignored_triggers();
  all.lost_datagrams += cable_.lost();
  all.stream = stream_.counters();
  return all;
}

// --- Network. ------------------------------------------------------------------------------------

void GigeCamera::set_stream_port(std::uint16_t port) {
  bank_.set_word(boot::kStreamSourcePort, port);
}

CameraAddress GigeCamera::address() const {
  return {bank_.word(boot::kCurrentAddress), bank_.word(boot::kCurrentMask),
          bank_.word(boot::kCurrentGateway)};
}

void GigeCamera::set_address(const CameraAddress& address) {
  bank_.set_word(boot::kCurrentAddress, address.address);
  bank_.set_word(boot::kCurrentMask, address.mask);
  bank_.set_word(boot::kCurrentGateway, address.gateway);
}

Status GigeCamera::force_ip(SimTime /*now*/, const gev::ForceIp& command) {
  if (command.mac != settings_.mac) {
    return Status::invalid_address;
  }
  const CameraAddress wanted = command.address == 0
                                   ? configured_address()
                                   : CameraAddress{command.address, command.mask, command.gateway};
  if (!settings_.permitted.contains(wanted.address)) {
    return Status::invalid_parameter;
  }
  set_address(wanted);
  ++address_changes_;
  return Status::success;
}

void GigeCamera::control_ended(SimTime /*now*/) {
  end_acquisition();
  bank_.set_word(boot::kStreamPort, 0);
  follow_stream_registers();
}

void GigeCamera::resend(SimTime now, const gev::PacketResend& command) {
  stream_.resend(now, command);
}

// --- Registers. ----------------------------------------------------------------------------------

void GigeCamera::refresh(const BankRegister& target) {
  switch (target.row.address) {
    case reg::kTemperature:
      bank_.set_real(reg::kTemperature, temperature_degc());
      break;
    case reg::kLineStatus:
      bank_.set_word(reg::kLineStatus, settings_.line.level(now_) ? 1 : 0);
      break;
    default:
      break;
  }
}

Status GigeCamera::written(const BankRegister& target) {
  if (faults_.first<RefusedWritesFault>(now_) != nullptr) {
    return Status::access_denied;
  }
  if (target.feature != nullptr && target.feature->locked_by_stream && acquiring()) {
    return Status::access_denied;
  }
  return target.feature == nullptr ? written_bootstrap(target) : written_feature(target);
}

Status GigeCamera::written_bootstrap(const BankRegister& target) {
  const std::uint32_t address = target.row.address;
  // Strings have no value as a number.
  const std::uint32_t value = target.row.length == 4 ? bank_.word(address) : 0;
  switch (address) {
    case boot::kIpConfiguration:
      if ((value & ~kIpConfigurations) != 0) {
        return Status::invalid_parameter;
      }
      bank_.set_word(address, value | gev::IpConfiguration::kLinkLocal);
      return keep() ? Status::success : Status::error;
    case boot::kUserDefinedName:
      bank_.set_text(address, std::string(bank_.text(address)));
      return keep() ? Status::success : Status::error;
    case boot::kPersistentAddress:
    case boot::kPersistentMask:
    case boot::kPersistentGateway:
      return keep() ? Status::success : Status::error;
    case boot::kHeartbeatTimeout:
      bank_.set_word(address, std::max(value, kHeartbeatMinimum_ms));
      return Status::success;
    case boot::kTimestampControl:
      if ((value & ~(gev::TimestampControl::kLatch | gev::TimestampControl::kReset)) != 0) {
        return Status::invalid_parameter;
      }
      if ((value & gev::TimestampControl::kLatch) != 0) {
        latch_time();
      }
      if ((value & gev::TimestampControl::kReset) != 0) {
        time_zero_ = now_;
      }
      return Status::success;
    case boot::kConfiguration:
      if ((value & ~kConfigurationBits) != 0) {
        return Status::invalid_parameter;
      }
      stream_.set_extended_status((value & gev::Configuration::kExtendedStatus) != 0);
      return Status::success;
    case boot::kStreamConfiguration:
      if (acquiring()) {
        return Status::access_denied;
      }
      return (value & ~gev::StreamConfiguration::kExtendedIds) != 0 ? Status::invalid_parameter
                                                                    : Status::success;
    case boot::kControlPrivilege:
      return control_.privilege_written(now_, value);
    case boot::kStreamPort:
      return written_stream_port();
    case boot::kStreamPacketSize:
      return written_packet_size();
    case boot::kStreamPacketDelay:
      derive();
      return Status::success;
    case boot::kStreamDestination:
      return written_destination();
    case boot::kStreamChannelConfiguration:
      if (acquiring()) {
        return Status::access_denied;
      }
      if ((value & ~bank_.word(boot::kStreamChannelCapability)) != 0) {
        return Status::invalid_parameter;
      }
      derive();
      return Status::success;
    default:
      return Status::write_protect;
  }
}

void GigeCamera::latch_time() {
  const std::uint64_t value = ticks(now_);
  bank_.set_word(boot::kTimestampHigh, static_cast<std::uint32_t>(value >> 32U));
  bank_.set_word(boot::kTimestampLow, static_cast<std::uint32_t>(value));
}

Status GigeCamera::written_stream_port() {
  constexpr std::uint32_t kPort = 0xFFFF;
  if ((bank_.word(boot::kStreamPort) & ~kPort) != 0) {
    return Status::invalid_parameter;
  }
  follow_stream_registers();
  return Status::success;
}

Status GigeCamera::written_destination() {
  const std::uint32_t destination = bank_.word(boot::kStreamDestination);
  if (destination != 0 && !settings_.permitted.contains(destination)) {
    return Status::invalid_parameter;
  }
  follow_stream_registers();
  return Status::success;
}

void GigeCamera::follow_stream_registers() {
  const UdpEnd to{bank_.word(boot::kStreamDestination),
                  static_cast<std::uint16_t>(bank_.word(boot::kStreamPort))};
  if (to.address == 0 || to.port == 0) {
    stream_.close();
  } else if (stream_.is_open()) {
    stream_.set_destination(to);
  } else {
    stream_.open(to);
  }
}

Status GigeCamera::written_packet_size() {
  const std::uint32_t value = bank_.word(boot::kStreamPacketSize);
  const std::uint32_t size = value & gev::PacketSize::kSize;
  const std::uint32_t flags = gev::PacketSize::kFireTest | gev::PacketSize::kDoNotFragment;
  if ((value & ~(flags | gev::PacketSize::kSize)) != 0 || size < kPacketSizeMinimum ||
      size > kPacketSizeMaximum) {
    return Status::invalid_parameter;
  }
  const std::uint32_t stepped = size - size % kPacketSizeStep;
  const bool fire = (value & gev::PacketSize::kFireTest) != 0;
  const UdpEnd to{bank_.word(boot::kStreamDestination),
                  static_cast<std::uint16_t>(bank_.word(boot::kStreamPort))};
  // Blocks of one acquisition are divided alike.
  if (acquiring() && stepped != command_packet_size_) {
    return Status::access_denied;
  }
  if (fire && (to.address == 0 || to.port == 0)) {
    return Status::invalid_parameter;
  }
  bank_.set_word(boot::kStreamPacketSize, (value & gev::PacketSize::kDoNotFragment) | stepped);
  derive();
  if (fire) {
    stream_.fire_test_packet(now_, to, stepped);
  }
  return Status::success;
}

Status GigeCamera::written_feature(const BankRegister& target) {
  const std::uint32_t address = target.row.address;
  switch (address) {
    case reg::kAcquisitionStart:
      bank_.set_word(address, 0);
      return start_acquisition();
    case reg::kAcquisitionStop:
      bank_.set_word(address, 0);
      end_acquisition();
      return Status::success;
    case reg::kTriggerSoftware:
      bank_.set_word(address, 0);
      return trigger();
    case reg::kDeviceReset:
      bank_.set_word(address, 0);
      reset_asked_ = true;
      return Status::success;
    case reg::kBinningHorizontal:
    case reg::kBinningVertical:
      reset_region();
      break;
    case reg::kExposureTime:
      if (on(reg::kExposureAuto)) {
        return Status::access_denied;
      }
      asked_exposure_ = from_microseconds(bank_.real(reg::kExposureTime));
      break;
    case reg::kGain:
      if (on(reg::kGainAuto)) {
        return Status::access_denied;
      }
      asked_gain_db_ = bank_.real(reg::kGain);
      break;
    case reg::kExposureAuto:
      asked_exposure_ = from_microseconds(bank_.real(reg::kExposureTime));
      break;
    case reg::kGainAuto:
      asked_gain_db_ = bank_.real(reg::kGain);
      break;
    case reg::kChunkModeActive:
      ++chunk_layout_;
      break;
    default:
      if (target.feature->name == "ChunkEnable") {
        ++chunk_layout_;
      }
      break;
  }
  derive();
  return Status::success;
}

Status GigeCamera::start_acquisition() {
  if (acquiring()) {
    return Status::success;
  }
  const bool hot = temperature_degc() > settings_.temperature_limit_degc;
  const bool nothing_to_send = bank_.word(reg::kPayloadSize) == 0;
  if (hot || nothing_to_send) {
    return Status::access_denied;
  }
  acquisition_.start(now_, means());
  plan_ = acquisition_.plan();
  return Status::success;
}

void GigeCamera::end_acquisition() {
  acquisition_.stop();
  plan_ = acquisition_.plan();
}

Status GigeCamera::trigger() {
  const bool waits =
      acquiring() && on(reg::kTriggerMode) &&
      bank_.word(reg::kTriggerSource) == static_cast<std::uint32_t>(TriggerSource::software);
  if (!waits) {
    return Status::access_denied;
  }
  const auto lost = faults_.first_grown<LostTriggerFault>(now_);
  if (lost && trigger_faults_.uniform() < lost->share) {
    ++counters_.lost_triggers;
  } else {
    acquisition_.trigger(now_);
    command_.software_triggers = acquisition_.software_exposures();
  }
  return Status::success;
}

// --- What follows from the registers. ------------------------------------------------------------

void GigeCamera::derive() {
  derive_image();
  derive_rates();
  derive_command();
}

void GigeCamera::reset_region() {
  // Binned pixels fill whole steps of the region.
  const auto binned = [this](std::uint32_t side, std::uint32_t binning, int step) {
    const std::uint32_t pixels = bank_.word(side) / bank_.word(binning);
    return pixels - pixels % static_cast<std::uint32_t>(step);
  };
  const std::uint32_t width = binned(reg::kSensorWidth, reg::kBinningHorizontal, kWidthStep);
  const std::uint32_t height = binned(reg::kSensorHeight, reg::kBinningVertical, kHeightStep);
  bank_.set_word(reg::kWidthMax, width);
  bank_.set_word(reg::kHeightMax, height);
  bank_.set_word(reg::kWidth, width);
  bank_.set_word(reg::kHeight, height);
  bank_.set_word(reg::kOffsetX, 0);
  bank_.set_word(reg::kOffsetY, 0);
}

bool GigeCamera::component_enabled(std::size_t index) const {
  return components_.size() == 1 ||
         on(reg::kComponentEnable + static_cast<std::uint32_t>(4 * index));
}

bool GigeCamera::chunk_enabled(CameraChunk chunk) const {
  return on(reg::kChunkModeActive) && on(reg::kChunkEnable + 4 * static_cast<std::uint32_t>(chunk));
}

bool GigeCamera::multipart() const {
  return (bank_.word(boot::kStreamChannelConfiguration) & gev::StreamChannel::kMultipart) != 0;
}

std::size_t GigeCamera::chunk_bytes(bool with_image) const {
  std::size_t bytes = with_image && on(reg::kChunkModeActive) ? gev::kChunkTagSize : 0;
  for (const CameraChunk chunk :
       {CameraChunk::timestamp, CameraChunk::frame, CameraChunk::exposure, CameraChunk::gain}) {
    bytes += chunk_enabled(chunk) ? kChunkValueBytes + gev::kChunkTagSize : 0;
  }
  return bytes;
}

std::uint32_t GigeCamera::packet_size() const {
  return bank_.word(boot::kStreamPacketSize) & gev::PacketSize::kSize;
}

void GigeCamera::derive_image() {
  const std::uint32_t width = bank_.word(reg::kWidth);
  const std::uint32_t height = bank_.word(reg::kHeight);
  bank_.set_word(reg::kWidthRoom, bank_.word(reg::kWidthMax) - bank_.word(reg::kOffsetX));
  bank_.set_word(reg::kHeightRoom, bank_.word(reg::kHeightMax) - bank_.word(reg::kOffsetY));
  bank_.set_word(reg::kOffsetXRoom, bank_.word(reg::kWidthMax) - width);
  bank_.set_word(reg::kOffsetYRoom, bank_.word(reg::kHeightMax) - height);

  // A multi-part block holds all components, others one each.
  const std::size_t pixels = std::size_t{width} * height;
  const auto format = static_cast<gev::PixelFormatCode>(bank_.word(reg::kPixelFormat));
  std::size_t longest = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    if (!component_enabled(i)) {
      continue;
    }
    std::size_t bits = gev::bits_per_pixel(format);
    if (components_[i].component == PictureComponent::confidence) {
      bits = 8;
    } else if (components_[i].component != PictureComponent::intensity) {
      bits = 16;
    }
    longest = std::max(longest, pixels * bits / 8);
    all += pixels * bits / 8;
  }
  const std::size_t payload = multipart() ? all : longest;
  bank_.set_word(
      reg::kPayloadSize,
      payload == 0 ? 0 : static_cast<std::uint32_t>(payload + chunk_bytes(!multipart())));
  bytes_per_exposure_ = all;
}

Duration GigeCamera::shortest_period() const {
  // Exposure and read-out overlap; the network is busy for each packet of all blocks.
  const Duration readout =
      bank_.word(reg::kHeight) * bank_.word(reg::kBinningVertical) * settings_.row_time;
  const std::size_t room = gev::payload_room(packet_size(), extended_ids(), multipart());
  const auto packets = static_cast<std::int64_t>(2 + (bytes_per_exposure_ + room - 1) / room);
  return std::max({command_exposure(), readout, packets * stream_.time_of(packet_size())});
}

Duration GigeCamera::frame_period() const {
  const Duration shortest = shortest_period();
  return on(reg::kFrameRateEnable)
             ? std::max(shortest, from_seconds(1.0 / bank_.real(reg::kFrameRate)))
             : shortest;
}

AcquisitionMeans GigeCamera::means() const {
  AcquisitionMeans means;
  means.mode = static_cast<AcquisitionMode>(bank_.word(reg::kAcquisitionMode));
  means.frames = bank_.word(reg::kAcquisitionFrameCount);
  means.triggered = on(reg::kTriggerMode);
  means.source = static_cast<TriggerSource>(bank_.word(reg::kTriggerSource));
  means.trigger_delay = from_microseconds(bank_.real(reg::kTriggerDelay));
  const auto* const slow = faults_.first<SlowPicturesFault>(now_);
  means.period =
      slow == nullptr ? frame_period() : from_seconds(to_seconds(frame_period()) / slow->share);
  means.shortest = shortest_period();
  means.line = settings_.line;
  return means;
}

void GigeCamera::derive_rates() {
  const double limit =
      on(reg::kThroughputMode) ? static_cast<double>(bank_.word(reg::kThroughputLimit)) : 0.0;
  stream_.set_pace(Duration{bank_.word(boot::kStreamPacketDelay)}, limit);
  stream_.set_do_not_fragment(
      (bank_.word(boot::kStreamPacketSize) & gev::PacketSize::kDoNotFragment) != 0);
  command_packet_size_ = packet_size();
  bank_.set_real(reg::kFrameRateRoom, 1.0 / to_seconds(shortest_period()));
  bank_.set_real(reg::kResultingFrameRate, 1.0 / to_seconds(frame_period()));
  pace_acquisition();
}

void GigeCamera::pace_acquisition() {
  acquisition_.change(now_, means());
  plan_ = acquisition_.plan();
}

Duration GigeCamera::command_exposure() const {
  const bool stuck = faults_.first<ExposureStuckFault>(now_) != nullptr;
  return stuck ? stuck_exposure_ : asked_exposure_;
}

bool GigeCamera::extended_ids() const {
  return multipart() ||
         (bank_.word(boot::kStreamConfiguration) & gev::StreamConfiguration::kExtendedIds) != 0;
}

void GigeCamera::derive_command() {
  const auto code = static_cast<gev::PixelFormatCode>(bank_.word(reg::kPixelFormat));
  command_.format = *std::ranges::find(settings_.formats, code,
                                       [](PixelFormat f) { return pixel_format_code(f); });
  command_.region = {
      static_cast<int>(bank_.word(reg::kOffsetX)), static_cast<int>(bank_.word(reg::kOffsetY)),
      static_cast<int>(bank_.word(reg::kWidth)), static_cast<int>(bank_.word(reg::kHeight))};
  command_.binning_horizontal = static_cast<int>(bank_.word(reg::kBinningHorizontal));
  command_.binning_vertical = static_cast<int>(bank_.word(reg::kBinningVertical));
  stuck_exposure_ = command_exposure();
  command_.exposure = stuck_exposure_;
  command_.exposure_auto = on(reg::kExposureAuto);
  command_.gain_db = asked_gain_db_;
  command_.gain_auto = on(reg::kGainAuto);
  command_.black_level = bank_.real(reg::kBlackLevel);
  for (std::size_t i = 0; i < components_.size(); ++i) {
    command_.*components_[i].wanted = component_enabled(i);
  }
}

// --- Pictures. -----------------------------------------------------------------------------------

void GigeCamera::update(const PictureSample& sample) {
  // What is ready at the very instant at which the supply goes is taken before.
  live_until(sample.time - Duration{1});
  supply_.on() ? work_until(sample.time) : live_until(sample.time);
  if (!sample.picture) {
    ++counters_.skipped_pictures;
    return;
  }
  const bool by_line = on(reg::kTriggerMode) && bank_.word(reg::kTriggerSource) ==
                                                    static_cast<std::uint32_t>(TriggerSource::line);
  const auto lost = faults_.first_grown<LostTriggerFault>(sample.exposure_start);
  if (by_line && lost && trigger_faults_.uniform() < lost->share) {
    ++counters_.lost_triggers;
    return;
  }
  if (!acquisition_.admit(sample.exposure_start)) {
    return;
  }
  plan_ = acquisition_.plan();
  ++counters_.pictures;
  counters_.late_pictures += sample.late ? 1 : 0;
  const Picture& exposed = *sample.picture;
  if (on(reg::kExposureAuto)) {
    bank_.set_real(reg::kExposureTime, microseconds(exposed.exposure));
  }
  if (on(reg::kGainAuto)) {
    bank_.set_real(reg::kGain, exposed.gain_db);
  }
  const bool frozen = faults_.first<FrozenFrameFault>(sample.exposure_start) != nullptr &&
                      last_picture_ != nullptr && alike(*last_picture_, exposed);
  if (!frozen) {
    last_picture_ = sample.picture;
  }
  if (stream_.is_open()) {
    send(last_picture_, exposed);
    live_until(sample.time);
  }
}

// Queues the enabled and complete components of a picture: in multi-part mode as one block,
// otherwise as one block each. Chunks are appended if active. The time stamp is the begin of the
// exposure, in ticks.
void GigeCamera::send(const std::shared_ptr<const Picture>& shown, const Picture& exposed) {
  std::array<StreamBlock, StreamBlock::kPartsMaximum> blocks;
  std::size_t count = 0;
  StreamBlock block;
  block.picture = shown;
  block.timestamp = ticks(exposed.exposure_start);
  block.multipart = multipart();
  block.extended_ids = extended_ids();
  block.packet_size = packet_size();
  for (std::size_t p = 0; p < shown->parts.size(); ++p) {
    const PicturePart& part = shown->parts[p];
    const auto component =
        std::ranges::find_if(components_, [&part](const CameraComponent& candidate) {
          return candidate.component == part.component && candidate.source == part.source;
        });
    if (component == components_.end() || !complete(part) ||
        !component_enabled(static_cast<std::size_t>(component - components_.begin())) ||
        block.part_count + count == std::min(StreamBlock::kPartsMaximum, components_.size())) {
      continue;
    }
    block.parts[block.part_count] = static_cast<std::uint8_t>(p);
    block.purposes[block.part_count] = component->id;
    ++block.part_count;
    if (!block.multipart) {
      blocks[count++] = block;
      block.part_count = 0;
    }
  }
  if (block.part_count > 0) {
    blocks[count++] = std::move(block);
  }
  const std::span<StreamBlock> all = std::span(blocks).first(count);
  if (on(reg::kChunkModeActive)) {
    for (std::size_t i = 0; i < count; ++i) {
      append_chunks(all[i], stream_.next_number() + i, exposed);
    }
  }
  if (count > 0) {
    stream_.offer(now_, all);
  }
}

void GigeCamera::append_chunks(StreamBlock& block, std::uint64_t number,
                               const Picture& exposed) const {
  const std::span<std::uint8_t> out(block.chunks);
  std::size_t at = 0;
  const auto tag = [&](std::uint32_t id, std::size_t length) {
    at += gev::write_chunk_tag(out.subspan(at), {id, static_cast<std::uint32_t>(length)});
  };
  const auto value = [&](CameraChunk chunk, std::uint64_t bits) {
    if (chunk_enabled(chunk)) {
      store_big(out, at, bits);
      at += kChunkValueBytes;
      tag(chunk_id(chunk), kChunkValueBytes);
    }
  };
  // The image is the first chunk; in a multi-part block it is a part of its own.
  if (!block.multipart) {
    tag(kImageChunkId, block.picture->parts[block.parts[0]].bytes.size());
  }
  value(CameraChunk::timestamp, ticks(exposed.exposure_start));
  value(CameraChunk::frame, number);
  value(CameraChunk::exposure, std::bit_cast<std::uint64_t>(microseconds(exposed.exposure)));
  value(CameraChunk::gain, std::bit_cast<std::uint64_t>(exposed.gain_db));
  block.chunk_bytes = at;
  block.chunk_layout = chunk_layout_;
}

}  // namespace rigwire::emulators
