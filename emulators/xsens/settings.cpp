// Keys and checks of the unit's settings.
#include <stdexcept>
#include <string>

#include "emulators/xsens/mti_600.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::in;

namespace {

/// What the unit's 400 samples a second give.
constexpr std::array<fields::Choice<std::uint16_t>, 16> kRates{{{0, "off", "Not sent."},
                                                                {400, "1 Hz", ""},
                                                                {200, "2 Hz", ""},
                                                                {100, "4 Hz", ""},
                                                                {80, "5 Hz", ""},
                                                                {50, "8 Hz", ""},
                                                                {40, "10 Hz", ""},
                                                                {25, "16 Hz", ""},
                                                                {20, "20 Hz", ""},
                                                                {16, "25 Hz", ""},
                                                                {10, "40 Hz", ""},
                                                                {8, "50 Hz", ""},
                                                                {5, "80 Hz", ""},
                                                                {4, "100 Hz", ""},
                                                                {2, "200 Hz", ""},
                                                                {1, "400 Hz", ""}}};

constexpr std::array<fields::Choice<MtiSampleTime>, 2> kSampleTimes{
    {{MtiSampleTime::ticks_100us, "100us", "Ticks of 100 us, as the maker's documents say today."},
     {MtiSampleTime::microseconds, "us", "Microseconds, as the older xsens.dbc says."}}};

void refuse(const std::string& what) {
  throw std::invalid_argument("Xsens MTi-600: " + what);
}

}  // namespace

void visit(fields::Visitor& v, MtiSettings& p) {
  v.group(
      "outputs",
      [&p](fields::Visitor& w) {
        for (MtiOutput& output : p.outputs) {
          w.choice(protocols::xsens::message(output.id).name, output.divider, kRates,
                   "How often this message is sent.");
        }
      },
      "Messages and their rates.");
  v.choice("sample_time", p.sample_time, kSampleTimes, "What the sample time (005) counts.");
  v.boolean("extended", p.extended, "29-bit identifiers instead of 11-bit ones.");
  v.number("heading", p.heading_rad, in("deg").between(-360, 360),
           "Heading of the unit's filter at power-on, from east, left positive; nothing corrects "
           "it.");
  v.number("rate_range", p.rate_range_radps, in("deg/s").above(0).at_most(4000),
           "Angular rate beyond which the reading is clamped and marked.");
  v.number("acceleration_range", p.acceleration_range_mps2, in("m/s2").above(0).at_most(1000),
           "Acceleration beyond which the reading is clamped and marked.");
  visit(v, p.supply);
  v.duration("start_up", p.start_up, {0, 60'000'000'000}, "From power-on to the first sample.");
  v.duration("processing_delay", p.processing_delay, {0, 1'000'000'000},
             "From a sample to its messages.");
}

void validate(const MtiSettings& settings) {
  for (std::size_t i = 0; i < kMtiOutputs.size(); ++i) {
    if (settings.outputs[i].id != kMtiOutputs[i].id) {
      refuse("outputs are not in the order of kMtiOutputs");
    }
  }
  fields::check(settings);
  validate(settings.supply);
  if (!(settings.magnetic_range_t > 0.0) || !(settings.magnetic_reference_t > 0.0)) {
    refuse("magnetic range and reference must be greater than 0");
  }
  if (!(settings.pressure_pa >= 0.0) || settings.pressure_pa > 125000.0) {
    refuse("pressure is " + std::to_string(settings.pressure_pa) + " Pa, allowed is 0 .. 125000");
  }
}

}  // namespace rigwire::emulators
