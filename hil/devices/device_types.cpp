#include "hil/devices/device_types.h"

#include <algorithm>
#include <array>

#include "hil/devices/dbc_node.h"
#include "hil/devices/gige_camera.h"
#include "hil/devices/replay.h"
#include "hil/devices/rotary_encoder.h"
#include "hil/devices/starfire.h"
#include "hil/devices/ublox.h"
#include "hil/devices/usb_joystick.h"
#include "hil/devices/valve_driver.h"
#include "hil/devices/velodyne.h"

namespace rigwire::hil {
namespace {

using Fresh = std::unique_ptr<DeviceConfiguration>;

template <class Type>
Fresh fresh() {
  return std::make_unique<Type>();
}
template <const emulators::UbloxProfile& (*profile)()>
Fresh ublox() {
  return std::make_unique<UbloxConfiguration>(profile());
}
template <std::size_t kSize>
struct Text {
  constexpr Text(const char (&text)[kSize]) {  // NOLINT: converts, so that a row can name a model
    std::copy_n(text, kSize, characters);
  }
  char characters[kSize]{};
};
template <Text kModel>
Fresh velodyne() {
  return std::make_unique<VelodyneConfiguration>(kModel.characters);
}
template <class Kind, Text kModel>
Fresh camera() {
  return std::make_unique<GigeCameraConfiguration>(Kind(), kModel.characters);
}
template <emulators::OpenImuVariant kVariant>
Fresh openimu() {
  return fresh_openimu(kVariant);
}

using emulators::OpenImuVariant;

constexpr std::array kTypes{
    DeviceType{{"ublox-neo-7p", "u-blox NEO-7P satellite receiver on a serial line (NMEA, UBX)."},
               ublox<emulators::ublox_neo_7p>},
    DeviceType{{"ublox-neo-m8", "u-blox NEO-M8 satellite receiver of several systems (NMEA, UBX)."},
               ublox<emulators::ublox_neo_m8>},
    DeviceType{{"ublox-neo-m8t", "u-blox NEO-M8T, the same with raw measurements (NMEA, UBX)."},
               ublox<emulators::ublox_neo_m8t>},
    DeviceType{
        {"ublox-zed-f9p", "u-blox ZED-F9P satellite receiver with carrier solution (NMEA, UBX)."},
        ublox<emulators::ublox_zed_f9p>},
    DeviceType{{"gnss-base", "Reference station on the ground that sends RTCM 3 to its rovers."},
               fresh_gnss_base},
    DeviceType{{"ntrip-caster", "NTRIP caster of the rig's base stations, a TCP server."},
               fresh_ntrip_caster},
    DeviceType{{"starfire-3000", "John Deere StarFire 3000 satellite receiver (NMEA, J1939)."},
               fresh<StarFireConfiguration>},
    DeviceType{{"velodyne-hdl-32e", "Velodyne HDL-32E spinning lidar on UDP."},
               velodyne<"HDL-32E">},
    DeviceType{{"velodyne-vlp-16", "Velodyne VLP-16 (Puck) spinning lidar on UDP, web interface."},
               velodyne<"VLP-16">},
    DeviceType{
        {"velodyne-puck-hi-res", "Velodyne Puck Hi-Res spinning lidar on UDP, web interface."},
        velodyne<"Puck Hi-Res">},
    DeviceType{
        {"velodyne-vlp-32c", "Velodyne VLP-32C (Ultra Puck) spinning lidar on UDP, web interface."},
        velodyne<"VLP-32C">},
    DeviceType{{"velodyne-hdl-64e", "Velodyne HDL-64E S2 spinning lidar on UDP."},
               velodyne<"HDL-64E S2">},
    DeviceType{{"velodyne-hdl-64e-s3", "Velodyne HDL-64E S3 spinning lidar on UDP, two returns."},
               velodyne<"HDL-64E S3">},
    DeviceType{{"velodyne-vls-128",
                "Velodyne VLS-128 (Alpha Prime) spinning lidar on UDP, web interface."},
               velodyne<"VLS-128">},
    DeviceType{{"openimu335ri", "ACEINNA OpenIMU335RI inertial unit on CAN (J1939)."},
               openimu<OpenImuVariant::openimu335ri>},
    DeviceType{{"valve-driver", "Eight-section hydraulic valve driver, Modbus TCP server."},
               fresh<ValveDriverConfiguration>},
    DeviceType{{"engine-controller", "Controller of an engine that drives pumps, on J1939."},
               fresh_engine_controller},
    DeviceType{{"vehicle-gateway",
                "Drive train, steering and brakes of a machine that drives, on CAN (J1939)."},
               fresh_vehicle_gateway},
    DeviceType{
        {"openimu300ri", "ACEINNA OpenIMU300RI inertial unit on CAN (J1939), with magnetometer."},
        openimu<OpenImuVariant::openimu300ri>},
    DeviceType{{"xsens-mti-600", "Xsens MTi-600 inertial unit on CAN."}, fresh_xsens},
    DeviceType{{"cia406-encoder", "Absolute rotary encoder on CANopen (CiA 406), at a joint."},
               fresh<EncoderConfiguration>},
    DeviceType{{"cia410-inclinometer", "Two-axis inclinometer on CANopen (CiA 410), on a link."},
               fresh_inclinometer},
    DeviceType{{"iso-valves", "Block of auxiliary valves with joysticks, on CAN (ISO 11783)."},
               fresh_iso_valves},
    DeviceType{{"dbc-node", "A device of your own on CAN, described by a DBC file and a binding."},
               fresh<DbcNodeConfiguration>},
    DeviceType{{"gige-camera", "Camera of one image, grey or colour, on GigE Vision."},
               camera<sim::CameraParameters, "AreaCamera">},
    DeviceType{{"gige-stereo", "Stereo camera with disparity and confidence on GigE Vision."},
               camera<sim::StereoCameraParameters, "StereoCamera">},
    DeviceType{{"gige-depth", "Depth camera by time of flight, with an image, on GigE Vision."},
               camera<sim::DepthCameraParameters, "DepthCamera">},
    DeviceType{{"gige-360", "Camera of one picture all round, on GigE Vision."},
               camera<sim::AllRoundCameraParameters, "PanoramaCamera">},
    DeviceType{
        {"usb-joystick", "Levers, pedals and buttons of an excavator's operator, a USB joystick."},
        fresh<UsbJoystickConfiguration>},
    DeviceType{
        {"usb-passthrough", "A real USB device of this machine, passed on by the rig's USB bus."},
        fresh_usb_passthrough},
    DeviceType{{"replay", "What passed on a wire, out of a recording, capture or log."},
               fresh<ReplayConfiguration>},
};

}  // namespace

std::span<const DeviceType> device_types() {
  return kTypes;
}

void visit(fields::Visitor& v, ConfiguredDevice& p) {
  v.required("type");
  fields::visit_chosen(v, "type", p, "Type of the device.");
}

}  // namespace rigwire::hil
