#include "emulators/gige_camera/gige_camera_settings.h"

#include <algorithm>
#include <stdexcept>

#include "emulators/gige_camera/camera_features.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

using fields::in;
using fields::IntegerRule;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("gige camera: " + what);
}

void check_length(const char* member, const std::string& text, std::size_t maximum) {
  if (text.size() > maximum) {
    refuse(std::string(member) + " has " + std::to_string(text.size()) +
           " bytes, allowed: at most " + std::to_string(maximum));
  }
}

void check_multiple(const char* member, int value, int of) {
  if (value % of != 0) {
    refuse(std::string(member) + " is " + std::to_string(value) + ", allowed: multiples of " +
           std::to_string(of));
  }
}

void check_side(const char* member, int value, int of) {
  if (value < kSmallestSide || value > kLongestSide) {
    refuse(std::string(member) + " is " + std::to_string(value) +
           ", allowed: " + std::to_string(kSmallestSide) + " to " + std::to_string(kLongestSide));
  }
  check_multiple(member, value, of);
}

bool is_image(PixelFormat format) {
  return format != PixelFormat::coord3d_c16 && format != PixelFormat::confidence8;
}

}  // namespace

void visit(fields::Visitor& v, CameraLine& p) {
  v.duration("first", p.first, {0, fields::kYear_ns},
             "From the start of the run to the first pulse.");
  v.duration("period", p.period, {0, 3'600'000'000'000}, "From pulse to pulse; 0 = there is none.");
  v.duration("width", p.width, {1'000, 1'000'000'000}, "Length of a pulse.");
}

void visit(fields::Visitor& v, GigeCameraSettings& p) {
  v.text("serial", p.serial_number, "Serial number, at most 15 bytes.");
  v.text("user_name", p.user_name, "User-defined name at delivery, at most 15 bytes.");
  v.rate("rate", p.frame_period, in("Hz").between(0.01, 1000), "Frames per second at power-on.");
  v.duration("exposure", p.exposure, {1'000, 10'000'000'000}, "Exposure at power-on.");
  v.boolean("exposure_auto", p.exposure_auto, "Whether the camera chooses the exposure.");
  v.number("gain", p.gain_db, in("dB").between(0, 48), "Gain at power-on.");
  v.boolean("gain_auto", p.gain_auto, "Whether the camera chooses the gain.");
  v.number("black_level", p.black_level, fields::plain().between(0, 64),
           "Added to every pixel, in grey levels of 8 bits.");
  v.section("line", p.line, "Pulses on the input Line0, from the simulation's clock.");
  v.number("throughput", p.throughput_bps,
           in("Mbit/s").between(kThroughputMinimum_bps / 1e6, kThroughputMaximum_bps / 1e6),
           "How fast packets leave at most.");
  v.integer("packet_size", p.packet_size, IntegerRule{kPacketSizeMinimum, kPacketSizeMaximum},
            "Bytes of a stream packet at power-on, IP and UDP headers included.");
  v.integer("queued_frames", p.queued_frames, IntegerRule{1, 16},
            "Exposures that wait for the network; what comes beyond them is lost.");
  v.integer("retained_frames", p.retained_frames, IntegerRule{1, 32},
            "Exposures that have been sent and can be asked for again.");
  v.number("temperature", p.temperature_degc, in("degC").between(-40, 85),
           "Temperature of the camera's board.");
}

void validate(const GigeCameraSettings& settings) {
  fields::check(settings);
  fields::check(settings.line);
  check_length("vendor", settings.vendor, 31);
  check_length("model", settings.model, 31);
  check_length("serial_number", settings.serial_number, 15);
  check_length("user_name", settings.user_name, 15);
  check_side("width", settings.width, 2 * kWidthStep);
  check_side("height", settings.height, 2 * kHeightStep);
  if (settings.row_time <= Duration::zero()) {
    refuse("row_time is " + fields::print_duration(settings.row_time.count()) +
           ", allowed: above 0");
  }
  check_multiple("packet_size", settings.packet_size, kPacketSizeStep);
  if (settings.formats.empty() || !std::ranges::all_of(settings.formats, is_image)) {
    refuse(
        "formats holds none, or one that is no image's, allowed: formats of images, one at least");
  }
  if (settings.exposure < settings.exposure_minimum ||
      settings.exposure > settings.exposure_maximum) {
    refuse("exposure is " + fields::print_duration(settings.exposure.count()) +
           ", allowed: " + fields::print_duration(settings.exposure_minimum.count()) + " to " +
           fields::print_duration(settings.exposure_maximum.count()));
  }
  if (settings.gain_db > settings.gain_maximum_db) {
    refuse("gain_db is " + std::to_string(settings.gain_db) + ", allowed: at most " +
           std::to_string(settings.gain_maximum_db));
  }
  if (settings.line.period > Duration::zero() && settings.line.width >= settings.line.period) {
    refuse("line's width is " + fields::print_duration(settings.line.width.count()) +
           ", allowed: less than its period");
  }
  if (!settings.permitted.contains(settings.address.address)) {
    refuse("address is " + address_text(settings.address.address) +
           ", allowed: one of the permitted network");
  }
  for (const GigeCameraFault& fault : settings.faults) {
    fields::check(fault);
  }
  for (const SupplyFault& fault : settings.supply_faults) {
    fields::check(fault);
  }
}

std::string address_text(std::uint32_t address) {
  std::string text;
  for (unsigned shift = 32; shift > 0; shift -= 8) {
    text += std::to_string((address >> (shift - 8)) & 0xFFU) + (shift > 8 ? "." : "");
  }
  return text;
}

}  // namespace rigwire::emulators
