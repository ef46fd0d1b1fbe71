#include "emulators/gige_camera/camera_features.h"

#include <limits>
#include <optional>
#include <utility>

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = camera_register;
using gev::Access;
using gev::BooleanFeature;
using gev::CommandFeature;
using gev::EnumerationFeature;
using gev::Feature;
using gev::FeatureKind;
using gev::FloatFeature;
using gev::IntegerFeature;
using gev::Place;
using gev::StringFeature;
using gev::Visibility;

constexpr std::int64_t kWordMaximum = std::numeric_limits<std::uint32_t>::max();
/// Adds features to a list, category by category.
class Table {
 public:
  void category(std::string_view name) { category_ = name; }

  Feature& add(std::string_view name, std::string_view text, FeatureKind kind, Place place,
               Visibility visibility = Visibility::beginner) {
    features_.push_back({name, category_, visibility, text, std::move(kind), place, false, false});
    return features_.back();
  }
  /// Read only, the same as long as the camera runs.
  void constant(std::string_view name, std::string_view text, FeatureKind kind,
                std::uint32_t address, std::uint32_t length = 4,
                Visibility visibility = Visibility::beginner) {
    add(name, text, std::move(kind), {address, length, Access::read_only, {}, {}, 0, {}},
        visibility)
        .constant = true;
  }
  /// Read only, and may change.
  Feature& reading(std::string_view name, std::string_view text, FeatureKind kind,
                   std::uint32_t address, std::uint32_t length = 4,
                   Visibility visibility = Visibility::beginner) {
    return add(name, text, std::move(kind), {address, length, Access::read_only, {}, {}, 0, {}},
               visibility);
  }
  Feature& setting(std::string_view name, std::string_view text, FeatureKind kind,
                   std::uint32_t address, std::uint32_t length = 4,
                   Visibility visibility = Visibility::beginner) {
    return add(name, text, std::move(kind), {address, length, Access::read_write, {}, {}, 0, {}},
               visibility);
  }
  /// Some bits of a bootstrap register.
  Feature& bits(std::string_view name, std::string_view text, FeatureKind kind,
                std::uint32_t address, gev::BitRange range, Access access,
                Visibility visibility = Visibility::expert) {
    return add(name, text, std::move(kind), {address, 4, access, range, {}, 0, {}}, visibility);
  }
  /// One register for each value of a selector.
  Feature& selected(std::string_view name, std::string_view text, FeatureKind kind,
                    std::uint32_t address, std::string_view selector, Access access) {
    constexpr std::uint32_t kStride = 4;
    return add(name, text, std::move(kind), {address, 4, access, {}, selector, kStride, {}},
               Visibility::expert);
  }
  /// Adds a value in a chunk of eight bytes.
  void chunk(std::string_view name, std::string_view text, FeatureKind kind, CameraChunk chunk) {
    add(name, text, std::move(kind), {0, 8, Access::read_only, {}, {}, 0, chunk_id(chunk)},
        Visibility::expert);
  }
  /// Adds a register that belongs to no category.
  void hidden(std::string_view name, std::string_view text, FeatureKind kind, std::uint32_t address,
              std::uint32_t length = 4) {
    reading(name, text, std::move(kind), address, length, Visibility::invisible).category = {};
  }

  [[nodiscard]] std::vector<Feature> take() { return std::move(features_); }

 private:
  std::string_view category_;
  std::vector<Feature> features_;
};

FeatureKind whole(std::int64_t minimum, std::int64_t maximum, std::int64_t increment = 1,
                  std::string_view maximum_of = {}, std::string_view unit = {}) {
  return IntegerFeature{minimum, maximum, increment, maximum_of, unit, {}};
}
FeatureKind shown_as(std::string_view representation, std::int64_t maximum = kWordMaximum) {
  return IntegerFeature{0, maximum, 1, {}, {}, representation};
}
FeatureKind real(double minimum, double maximum, std::string_view unit = {},
                 std::string_view maximum_of = {}) {
  return FloatFeature{minimum, maximum, maximum_of, unit};
}
FeatureKind choice(std::vector<gev::Entry> entries) {
  return EnumerationFeature{std::move(entries)};
}
FeatureKind off_or_continuous() {
  return choice({{0, "Off"}, {1, "Continuous"}});
}

void device_control(Table& t) {
  t.category("DeviceControl");
  t.constant("DeviceVendorName", "Maker of the device.", StringFeature{}, boot::kManufacturerName,
             32);
  t.constant("DeviceModelName", "Model of the device.", StringFeature{}, boot::kModelName, 32);
  t.constant("DeviceManufacturerInfo", "What the maker says of the device.", StringFeature{},
             boot::kManufacturerInformation, 48);
  t.constant("DeviceVersion", "Version of the device.", StringFeature{}, boot::kDeviceVersion, 32);
  t.constant("DeviceSerialNumber", "Serial number of the device.", StringFeature{},
             boot::kSerialNumber, 16);
  t.setting("DeviceUserID", "Name that a user has given to the device; it is kept.",
            StringFeature{}, boot::kUserDefinedName, 16);
  t.reading("DeviceTemperature", "Temperature of the board.", real(-273.15, 1000, "C"),
            reg::kTemperature, 8, Visibility::expert);
  t.setting("DeviceLinkThroughputLimitMode", "Whether the limit of the throughput holds.",
            choice({{0, "Off"}, {1, "On"}}), reg::kThroughputMode, 4, Visibility::expert);
  t.setting("DeviceLinkThroughputLimit", "Packets leave no faster than this.",
            whole(static_cast<std::int64_t>(kThroughputMinimum_bps / 8),
                  static_cast<std::int64_t>(kThroughputMaximum_bps / 8), 1, {}, "B/s"),
            reg::kThroughputLimit, 4, Visibility::expert);
  t.setting("DeviceReset", "Starts the device anew, with what it has at power-on.",
            CommandFeature{}, reg::kDeviceReset, 4, Visibility::guru);
  t.add("TimestampLatch", "Keeps the present time for TimestampLatchValue.",
        CommandFeature{gev::TimestampControl::kLatch},
        {boot::kTimestampControl, 4, Access::write_only, {}, {}, 0, {}}, Visibility::expert);
  t.add("TimestampReset", "The device's time begins anew.",
        CommandFeature{gev::TimestampControl::kReset},
        {boot::kTimestampControl, 4, Access::write_only, {}, {}, 0, {}}, Visibility::expert);
  t.reading("TimestampLatchValue", "The device's time when it was latched.",
            whole(0, std::numeric_limits<std::int64_t>::max(), 1, {}, "ns"), boot::kTimestampHigh,
            8, Visibility::expert);
}

void image_format_control(Table& t, const GigeCameraSettings& settings) {
  t.category("ImageFormatControl");
  t.constant("SensorWidth", "Columns of the sensor.", whole(0, settings.width, 1, {}, "px"),
             reg::kSensorWidth, 4, Visibility::expert);
  t.constant("SensorHeight", "Rows of the sensor.", whole(0, settings.height, 1, {}, "px"),
             reg::kSensorHeight, 4, Visibility::expert);
  t.reading("WidthMax", "Columns of the sensor after binning.",
            whole(0, settings.width, 1, {}, "px"), reg::kWidthMax, 4, Visibility::expert);
  t.reading("HeightMax", "Rows of the sensor after binning.",
            whole(0, settings.height, 1, {}, "px"), reg::kHeightMax, 4, Visibility::expert);
  t.setting("Width", "Columns of the picture.",
            whole(kSmallestSide, settings.width, kWidthStep, "WidthRoom", "px"), reg::kWidth)
      .locked_by_stream = true;
  t.setting("Height", "Rows of the picture.",
            whole(kSmallestSide, settings.height, kHeightStep, "HeightRoom", "px"), reg::kHeight)
      .locked_by_stream = true;
  t.setting("OffsetX", "First column of the picture.",
            whole(0, settings.width, kWidthStep, "OffsetXRoom", "px"), reg::kOffsetX);
  t.setting("OffsetY", "First row of the picture.",
            whole(0, settings.height, kHeightStep, "OffsetYRoom", "px"), reg::kOffsetY);
  const int binning = settings.binning ? 2 : 1;
  t.setting("BinningHorizontal", "Columns that are joined to one.", whole(1, binning),
            reg::kBinningHorizontal, 4, Visibility::expert)
      .locked_by_stream = true;
  t.setting("BinningVertical", "Rows that are joined to one.", whole(1, binning),
            reg::kBinningVertical, 4, Visibility::expert)
      .locked_by_stream = true;
  std::vector<gev::Entry> formats;
  for (const PixelFormat format : settings.formats) {
    const gev::PixelFormatCode code = pixel_format_code(format);
    formats.push_back({static_cast<std::int64_t>(code), gev::pixel_format_name(code)});
  }
  t.setting("PixelFormat", "Format of the image's pixels.", choice(std::move(formats)),
            reg::kPixelFormat)
      .locked_by_stream = true;

  const std::vector<CameraComponent> components = camera_components(settings.kind);
  if (components.size() > 1) {
    std::vector<gev::Entry> names;
    for (std::size_t i = 0; i < components.size(); ++i) {
      names.push_back({static_cast<std::int64_t>(i), components[i].name});
    }
    t.setting("ComponentSelector", "Component that the features below are of.",
              choice(std::move(names)), reg::kComponentSelector);
    t.selected("ComponentEnable", "Whether the component is sent.", BooleanFeature{},
               reg::kComponentEnable, "ComponentSelector", Access::read_write)
        .locked_by_stream = true;
    t.selected("ComponentIDValue", "Identifier of the component in a multi-part block.",
               whole(0, 0xFFFF), reg::kComponentId, "ComponentSelector", Access::read_only);
  }
  t.hidden("WidthRoom", "Columns right of OffsetX.", whole(0, settings.width), reg::kWidthRoom);
  t.hidden("HeightRoom", "Rows below OffsetY.", whole(0, settings.height), reg::kHeightRoom);
  t.hidden("OffsetXRoom", "Columns that are not in the picture.", whole(0, settings.width),
           reg::kOffsetXRoom);
  t.hidden("OffsetYRoom", "Rows that are not in the picture.", whole(0, settings.height),
           reg::kOffsetYRoom);
}

void acquisition_control(Table& t, const GigeCameraSettings& settings) {
  t.category("AcquisitionControl");
  t.setting("AcquisitionMode", "How many pictures an acquisition has.",
            choice({{static_cast<int>(AcquisitionMode::continuous), "Continuous"},
                    {static_cast<int>(AcquisitionMode::single_frame), "SingleFrame"},
                    {static_cast<int>(AcquisitionMode::multi_frame), "MultiFrame"}}),
            reg::kAcquisitionMode)
      .locked_by_stream = true;
  t.setting("AcquisitionStart", "Begins the acquisition.", CommandFeature{},
            reg::kAcquisitionStart);
  t.setting("AcquisitionStop", "Ends the acquisition after the present picture.", CommandFeature{},
            reg::kAcquisitionStop);
  t.setting("AcquisitionFrameCount", "Pictures of a MultiFrame acquisition.", whole(1, 65535),
            reg::kAcquisitionFrameCount);
  t.setting("AcquisitionFrameRateEnable",
            "Whether AcquisitionFrameRate holds; otherwise as fast as can be.", BooleanFeature{},
            reg::kFrameRateEnable, 4, Visibility::expert);
  t.setting("AcquisitionFrameRate", "Pictures per second without a trigger.",
            real(kFrameRateMinimum_hz, 0, "Hz", "AcquisitionFrameRateRoom"), reg::kFrameRate, 8);
  t.reading("AcquisitionResultingFrameRate",
            "Pictures per second that rate, exposure, read-out and network allow.",
            real(0, 1e6, "Hz"), reg::kResultingFrameRate, 8, Visibility::expert);
  t.setting("TriggerSelector", "What a trigger begins.", choice({{0, "FrameStart"}}),
            reg::kTriggerSelector);
  t.setting("TriggerMode", "Whether exposures wait for a trigger.", choice({{0, "Off"}, {1, "On"}}),
            reg::kTriggerMode);
  t.setting("TriggerSource", "What triggers.",
            choice({{static_cast<int>(TriggerSource::software), "Software"},
                    {static_cast<int>(TriggerSource::line), "Line0"}}),
            reg::kTriggerSource);
  t.setting("TriggerActivation", "Edge of the line that triggers.", choice({{0, "RisingEdge"}}),
            reg::kTriggerActivation);
  t.setting("TriggerSoftware", "Triggers one exposure.", CommandFeature{}, reg::kTriggerSoftware);
  t.setting("TriggerDelay", "From the trigger to the exposure.", real(0, 1e6, "us"),
            reg::kTriggerDelay, 8, Visibility::expert);
  t.setting("ExposureMode", "How the length of the exposure is set.", choice({{0, "Timed"}}),
            reg::kExposureMode);
  t.setting(
      "ExposureTime", "Length of the exposure; the camera's choice with ExposureAuto.",
      real(microseconds(settings.exposure_minimum), microseconds(settings.exposure_maximum), "us"),
      reg::kExposureTime, 8);
  t.setting("ExposureAuto", "Whether the camera chooses the exposure.", off_or_continuous(),
            reg::kExposureAuto);
  t.hidden("AcquisitionFrameRateRoom", "Greatest rate that exposure, read-out and network allow.",
           real(0, 1e6, "Hz"), reg::kFrameRateRoom, 8);
}

void analog_control(Table& t, const GigeCameraSettings& settings) {
  t.category("AnalogControl");
  t.setting("Gain", "Gain; the camera's choice with GainAuto.",
            real(0, settings.gain_maximum_db, "dB"), reg::kGain, 8);
  t.setting("GainAuto", "Whether the camera chooses the gain.", off_or_continuous(),
            reg::kGainAuto);
  t.setting("BlackLevel", "Added to every pixel, in grey levels of 8 bits.", real(0, 64),
            reg::kBlackLevel, 8, Visibility::expert);
}

void digital_control(Table& t) {
  t.category("DigitalIOControl");
  t.setting("LineSelector", "Line that the features below are of.", choice({{0, "Line0"}}),
            reg::kLineSelector, 4, Visibility::expert);
  t.reading("LineMode", "What the line is.", choice({{0, "Input"}}), reg::kLineMode, 4,
            Visibility::expert);
  t.reading("LineStatus", "Whether the line is high.", BooleanFeature{}, reg::kLineStatus, 4,
            Visibility::expert);
}

void chunk_control(Table& t) {
  t.category("ChunkDataControl");
  t.setting("ChunkModeActive", "Whether data is appended to pictures.", BooleanFeature{},
            reg::kChunkModeActive, 4, Visibility::expert)
      .locked_by_stream = true;
  t.setting("ChunkSelector", "Chunk that ChunkEnable is of.",
            choice({{static_cast<int>(CameraChunk::timestamp), "Timestamp"},
                    {static_cast<int>(CameraChunk::frame), "FrameID"},
                    {static_cast<int>(CameraChunk::exposure), "ExposureTime"},
                    {static_cast<int>(CameraChunk::gain), "Gain"}}),
            reg::kChunkSelector, 4, Visibility::expert);
  t.selected("ChunkEnable", "Whether the chunk is appended.", BooleanFeature{}, reg::kChunkEnable,
             "ChunkSelector", Access::read_write)
      .locked_by_stream = true;
  constexpr std::int64_t kMaximum = std::numeric_limits<std::int64_t>::max();
  t.chunk("ChunkTimestamp", "Start of the picture's exposure.", whole(0, kMaximum, 1, {}, "ns"),
          CameraChunk::timestamp);
  t.chunk("ChunkFrameID", "Number of the picture's block.", whole(0, kMaximum), CameraChunk::frame);
  t.chunk("ChunkExposureTime", "Length of the picture's exposure.", real(0, 1e9, "us"),
          CameraChunk::exposure);
  t.chunk("ChunkGain", "Gain of the picture.", real(0, 100, "dB"), CameraChunk::gain);
}

void scan_3d_control(Table& t, const GigeCameraSettings& settings) {
  const bool stereo = settings.kind == GigeCameraKind::stereo;
  t.category("Scan3dControl");
  t.constant("Scan3dDistanceUnit", "Unit of the third coordinate.",
             choice({stereo ? gev::Entry{1, "Pixel"} : gev::Entry{0, "Millimeter"}}),
             reg::kScan3dDistanceUnit);
  t.constant("Scan3dOutputMode", "What the third coordinate is.",
             choice({stereo ? gev::Entry{1, "DisparityC"} : gev::Entry{0, "CalibratedC"}}),
             reg::kScan3dOutputMode);
  const FeatureKind any = real(-1e9, 1e9);
  t.constant("Scan3dCoordinateScale", "Coordinate for each count of a pixel.", any,
             reg::kScan3dScale, 8);
  t.constant("Scan3dCoordinateOffset", "Coordinate of a pixel that is 0.", any, reg::kScan3dOffset,
             8);
  t.constant("Scan3dInvalidDataFlag", "Whether one value of a pixel means that there is none.",
             BooleanFeature{}, reg::kScan3dInvalidFlag);
  t.constant("Scan3dInvalidDataValue", "Value of a pixel that has no coordinate.", any,
             reg::kScan3dInvalidValue, 8);
  t.constant("Scan3dFocalLength", "Focal length of the rectified image, pixels.", any,
             reg::kScan3dFocalLength, 8);
  if (stereo) {
    t.constant("Scan3dBaseline", "From the left to the right projection centre.",
               real(-1e9, 1e9, "m"), reg::kScan3dBaseline, 8);
  }
  t.constant("Scan3dPrincipalPointU", "Column of the principal point.", any, reg::kScan3dPrincipalU,
             8);
  t.constant("Scan3dPrincipalPointV", "Row of the principal point.", any, reg::kScan3dPrincipalV,
             8);
}

void transport_layer_control(Table& t) {
  t.category("TransportLayerControl");
  t.reading("PayloadSize", "Bytes of the longest block.", whole(0, kWordMaximum, 1, {}, "B"),
            reg::kPayloadSize, 4, Visibility::expert);
  t.constant("GevVersionMajor", "Major version of the protocol.", whole(0, 0xFFFF), boot::kVersion);
  t.constant("GevStreamChannelCount", "Stream channels of the device.", whole(0, 1),
             boot::kStreamChannelCount, 4, Visibility::expert);
  t.constant("GevMACAddressLow", "Low word of the MAC address.", shown_as("HexNumber"),
             boot::kMacLow, 4, Visibility::expert);
  t.reading("GevCurrentIPAddress", "Address of the device.", shown_as("IPV4Address"),
            boot::kCurrentAddress);
  t.reading("GevCurrentSubnetMask", "Mask of the device's network.", shown_as("IPV4Address"),
            boot::kCurrentMask);
  t.reading("GevCurrentDefaultGateway", "Gateway of the device's network.", shown_as("IPV4Address"),
            boot::kCurrentGateway);
  t.bits("GevCurrentIPConfigurationPersistentIP", "Whether the persistent address is used.",
         BooleanFeature{}, boot::kIpConfiguration, {0, 0}, Access::read_write);
  t.setting("GevPersistentIPAddress", "Address from the next start on; it is kept.",
            shown_as("IPV4Address"), boot::kPersistentAddress);
  t.setting("GevPersistentSubnetMask", "Mask from the next start on; it is kept.",
            shown_as("IPV4Address"), boot::kPersistentMask);
  t.setting("GevPersistentDefaultGateway", "Gateway from the next start on; it is kept.",
            shown_as("IPV4Address"), boot::kPersistentGateway);
  t.constant("GevLinkSpeed", "Speed of the link.", whole(0, kWordMaximum, 1, {}, "Mbps"),
             boot::kLinkSpeed, 4, Visibility::expert);
  t.setting("GevHeartbeatTimeout", "A client that is silent for so long loses control.",
            whole(0, kWordMaximum, 1, {}, "ms"), boot::kHeartbeatTimeout, 4, Visibility::guru);
  t.bits("GevGVCPHeartbeatDisable", "Whether a silent client keeps control for ever.",
         BooleanFeature{}, boot::kConfiguration, {0, 0}, Access::read_write, Visibility::guru);
  t.bits("GevGVCPExtendedStatusCodes", "Whether answers use the newer codes.", BooleanFeature{},
         boot::kConfiguration, {2, 2}, Access::read_write, Visibility::guru);
  t.bits("GevGVSPExtendedIDMode", "Width of the identifiers in the stream.",
         choice({{0, "Off"}, {1, "On"}}), boot::kStreamConfiguration, {30, 30}, Access::read_write)
      .locked_by_stream = true;
  t.reading("GevTimestampTickFrequency", "Ticks of the time stamps per second.",
            whole(0, std::numeric_limits<std::int64_t>::max(), 1, {}, "Hz"),
            boot::kTickFrequencyHigh, 8, Visibility::expert)
      .constant = true;
  t.add("GevTimestampControlLatch", "Keeps the present time for GevTimestampValue.",
        CommandFeature{gev::TimestampControl::kLatch},
        {boot::kTimestampControl, 4, Access::write_only, {}, {}, 0, {}}, Visibility::expert);
  t.add("GevTimestampControlReset", "The device's time begins anew.",
        CommandFeature{gev::TimestampControl::kReset},
        {boot::kTimestampControl, 4, Access::write_only, {}, {}, 0, {}}, Visibility::expert);
  t.reading("GevTimestampValue", "The device's time when it was latched.",
            whole(0, std::numeric_limits<std::int64_t>::max(), 1, {}, "ns"), boot::kTimestampHigh,
            8, Visibility::expert);
  t.bits("GevSCPHostPort", "Port that the stream goes to; 0 = it is closed.", whole(0, 0xFFFF),
         boot::kStreamPort, {0, 15}, Access::read_write, Visibility::guru);
  t.bits("GevSCPSFireTestPacket", "Sends one packet of the set size.", CommandFeature{},
         boot::kStreamPacketSize, {31, 31}, Access::read_write, Visibility::guru);
  t.bits("GevSCPSDoNotFragment", "Whether packets must not be divided on their way.",
         BooleanFeature{}, boot::kStreamPacketSize, {30, 30}, Access::read_write, Visibility::guru);
  t.bits("GevSCPSPacketSize", "Bytes of a packet with its IP and UDP headers.",
         whole(kPacketSizeMinimum, kPacketSizeMaximum, kPacketSizeStep, {}, "B"),
         boot::kStreamPacketSize, {0, 15}, Access::read_write)
      .locked_by_stream = true;
  t.setting("GevSCPD", "Pause between packets, in ticks of the time stamps.",
            whole(0, kWordMaximum), boot::kStreamPacketDelay, 4, Visibility::expert);
  t.setting("GevSCDA", "Address that the stream goes to.", shown_as("IPV4Address"),
            boot::kStreamDestination, 4, Visibility::guru);
  t.bits("GevSCSP", "Port that the stream comes from.", whole(0, 0xFFFF), boot::kStreamSourcePort,
         {0, 15}, Access::read_only, Visibility::guru);
}

}  // namespace

std::vector<CameraComponent> camera_components(GigeCameraKind kind) {
  // Identifiers of SFNC; the right image has none there, hence one of the maker's.
  const CameraComponent left{"Intensity", 1, PictureComponent::intensity, 0,
                             &CameraCommand::intensity};
  const CameraComponent right{"IntensityRight", 0xFF00, PictureComponent::intensity, 1,
                              &CameraCommand::intensity_right};
  const CameraComponent disparity{"Disparity", 8, PictureComponent::disparity, 0,
                                  &CameraCommand::disparity};
  const CameraComponent range{"Range", 4, PictureComponent::range, 0, &CameraCommand::range};
  const CameraComponent confidence{"Confidence", 6, PictureComponent::confidence, 0,
                                   &CameraCommand::confidence};
  switch (kind) {
    case GigeCameraKind::camera:
      return {left};
    case GigeCameraKind::stereo:
      return {left, right, disparity, confidence};
    case GigeCameraKind::depth:
      return {left, range, confidence};
  }
  return {};
}

gev::PixelFormatCode pixel_format_code(PixelFormat format) {
  switch (format) {
    case PixelFormat::mono8:
      return gev::PixelFormatCode::mono8;
    case PixelFormat::mono10:
      return gev::PixelFormatCode::mono10;
    case PixelFormat::mono12:
      return gev::PixelFormatCode::mono12;
    case PixelFormat::mono16:
      return gev::PixelFormatCode::mono16;
    case PixelFormat::bayer_rg8:
      return gev::PixelFormatCode::bayer_rg8;
    case PixelFormat::bayer_rg10:
      return gev::PixelFormatCode::bayer_rg10;
    case PixelFormat::bayer_rg12:
      return gev::PixelFormatCode::bayer_rg12;
    case PixelFormat::bayer_rg16:
      return gev::PixelFormatCode::bayer_rg16;
    case PixelFormat::rgb8:
      return gev::PixelFormatCode::rgb8;
    case PixelFormat::coord3d_c16:
      return gev::PixelFormatCode::coord3d_c16;
    case PixelFormat::confidence8:
      return gev::PixelFormatCode::confidence8;
  }
  return gev::PixelFormatCode::mono8;
}

std::vector<Feature> camera_features(const GigeCameraSettings& settings) {
  Table t;
  device_control(t);
  image_format_control(t, settings);
  acquisition_control(t, settings);
  analog_control(t, settings);
  digital_control(t);
  chunk_control(t);
  if (settings.kind != GigeCameraKind::camera) {
    scan_3d_control(t, settings);
  }
  transport_layer_control(t);
  std::vector<Feature> features = t.take();
  features.push_back({"TLParamsLocked",
                      {},
                      Visibility::invisible,
                      "1 while the client streams.",
                      whole(0, 1),
                      std::nullopt,
                      false,
                      false});
  return features;
}

}  // namespace rigwire::emulators
