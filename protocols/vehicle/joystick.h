// Joysticks: what an operator's hands do (BJM1, EJM1 for the first stick, BJM2, EJM2 for the
// second).
//
// An axis says in three switches on which side of its neutral position it is, and how far as a
// magnitude without sign; axis_share joins them. Every 100 ms and on change, but no faster than
// every 20 ms.
//
// Sources: SAE J1939 digital annex (positions, scale); ISO 11783-6 by general knowledge (that the
// magnitude ends at 1000).
#pragma once

#include <cmath>

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 0.1 %, ten bits.
inline constexpr Scale kAxis{0.1 * kPercent, 0.0, "1", kInPercent};

/// Basic Joystick Message 1 or 2: the stick itself. x: right positive, y: forward positive.
template <unsigned Stick>
struct BasicJoystick {
  static_assert(Stick == 1 || Stick == 2);
  static constexpr Group kGroup{Stick == 1 ? "BJM1" : "BJM2", Stick == 1 ? 64982U : 64984U, 3,
                                std::chrono::milliseconds{100}};

  Switch x_neutral = Switch::not_available;
  Switch x_negative = Switch::not_available;
  Switch x_positive = Switch::not_available;
  double x_share = kNotAvailable;  ///< 0 .. 1.
  Switch y_neutral = Switch::not_available;
  Switch y_negative = Switch::not_available;
  Switch y_positive = Switch::not_available;
  double y_share = kNotAvailable;
  Switch y_detent = Switch::not_available;
  Switch x_detent = Switch::not_available;
  Switch button_1 = Switch::not_available;
  Switch button_2 = Switch::not_available;
  Switch button_3 = Switch::not_available;
  Switch button_4 = Switch::not_available;
  Switch button_5 = Switch::not_available;
  Switch button_6 = Switch::not_available;
  Switch button_7 = Switch::not_available;
  Switch button_8 = Switch::not_available;
  Switch button_9 = Switch::not_available;
  Switch button_10 = Switch::not_available;
  Switch button_11 = Switch::not_available;
  Switch button_12 = Switch::not_available;

  static constexpr auto parameters() {
    using M = BasicJoystick;
    // The second stick's numbers are not in the available extract.
    constexpr auto spn = [](std::uint32_t first) { return Stick == 1 ? first : 0U; };
    return std::array{
        state("x neutral", spn(2675), {1, 1}, &M::x_neutral),
        state("x negative", spn(2670), {1, 3}, &M::x_negative),
        state("x positive", spn(2665), {1, 5}, &M::x_positive),
        number("x position", spn(2660), {1, 7}, 10, kAxis, &M::x_share),
        state("y neutral", spn(2676), {3, 1}, &M::y_neutral),
        state("y negative", spn(2671), {3, 3}, &M::y_negative),
        state("y positive", spn(2666), {3, 5}, &M::y_positive),
        number("y position", spn(2661), {3, 7}, 10, kAxis, &M::y_share),
        state("y detent", spn(2681), {5, 5}, &M::y_detent),
        state("x detent", spn(2680), {5, 7}, &M::x_detent),
        state("button 4", spn(2688), {6, 1}, &M::button_4),
        state("button 3", spn(2687), {6, 3}, &M::button_3),
        state("button 2", spn(2686), {6, 5}, &M::button_2),
        state("button 1", spn(2685), {6, 7}, &M::button_1),
        state("button 8", spn(2692), {7, 1}, &M::button_8),
        state("button 7", spn(2691), {7, 3}, &M::button_7),
        state("button 6", spn(2690), {7, 5}, &M::button_6),
        state("button 5", spn(2689), {7, 7}, &M::button_5),
        state("button 12", spn(2696), {8, 1}, &M::button_12),
        state("button 11", spn(2695), {8, 3}, &M::button_11),
        state("button 10", spn(2694), {8, 5}, &M::button_10),
        state("button 9", spn(2693), {8, 7}, &M::button_9),
    };
  }
};
using Bjm1 = BasicJoystick<1>;
using Bjm2 = BasicJoystick<2>;

/// Extended Joystick Message 1 or 2: the grip on the stick. theta: clockwise positive.
template <unsigned Stick>
struct ExtendedJoystick {
  static_assert(Stick == 1 || Stick == 2);
  static constexpr Group kGroup{Stick == 1 ? "EJM1" : "EJM2", Stick == 1 ? 64983U : 64985U, 3,
                                std::chrono::milliseconds{100}};

  Switch x_neutral = Switch::not_available;
  Switch x_negative = Switch::not_available;
  Switch x_positive = Switch::not_available;
  double x_share = kNotAvailable;  ///< 0 .. 1.
  Switch y_neutral = Switch::not_available;
  Switch y_negative = Switch::not_available;
  Switch y_positive = Switch::not_available;
  double y_share = kNotAvailable;
  Switch theta_neutral = Switch::not_available;
  Switch theta_negative = Switch::not_available;
  Switch theta_positive = Switch::not_available;
  double theta_share = kNotAvailable;
  Switch theta_detent = Switch::not_available;
  Switch y_detent = Switch::not_available;
  Switch x_detent = Switch::not_available;
  Switch button_13 = Switch::not_available;
  Switch button_14 = Switch::not_available;
  Switch button_15 = Switch::not_available;
  Switch button_16 = Switch::not_available;

  static constexpr auto parameters() {
    using M = ExtendedJoystick;
    constexpr auto spn = [](std::uint32_t first) { return Stick == 1 ? first : 0U; };
    return std::array{
        state("grip x neutral", spn(2677), {1, 1}, &M::x_neutral),
        state("grip x negative", spn(2672), {1, 3}, &M::x_negative),
        state("grip x positive", spn(2667), {1, 5}, &M::x_positive),
        number("grip x position", spn(2662), {1, 7}, 10, kAxis, &M::x_share),
        state("grip y neutral", spn(2678), {3, 1}, &M::y_neutral),
        state("grip y negative", spn(2673), {3, 3}, &M::y_negative),
        state("grip y positive", spn(2668), {3, 5}, &M::y_positive),
        number("grip y position", spn(2663), {3, 7}, 10, kAxis, &M::y_share),
        state("theta neutral", spn(2679), {5, 1}, &M::theta_neutral),
        state("theta negative", spn(2674), {5, 3}, &M::theta_negative),
        state("theta positive", spn(2669), {5, 5}, &M::theta_positive),
        number("theta position", spn(2664), {5, 7}, 10, kAxis, &M::theta_share),
        state("theta detent", spn(2684), {7, 3}, &M::theta_detent),
        state("grip y detent", spn(2683), {7, 5}, &M::y_detent),
        state("grip x detent", spn(2682), {7, 7}, &M::x_detent),
        state("button 16", spn(6734), {8, 1}, &M::button_16),
        state("button 15", spn(6733), {8, 3}, &M::button_15),
        state("button 14", spn(6732), {8, 5}, &M::button_14),
        state("button 13", spn(6731), {8, 7}, &M::button_13),
    };
  }
};
using Ejm1 = ExtendedJoystick<1>;
using Ejm2 = ExtendedJoystick<2>;

/// What three switches and a magnitude mean: -1 .. 1; not available unless they agree (exactly one
/// switch on; in neutral the magnitude does not count).
[[nodiscard]] inline double axis_share(Switch neutral, Switch negative, Switch positive,
                                       double magnitude) {
  const int on = (neutral == Switch::on) + (negative == Switch::on) + (positive == Switch::on);
  if (on != 1) {
    return kNotAvailable;
  }
  if (neutral == Switch::on) {
    return 0.0;
  }
  return std::isfinite(magnitude) ? (positive == Switch::on ? magnitude : -magnitude)
                                  : kNotAvailable;
}

/// The switches for a share of -1 .. 1; within half a count of 0 the axis is neutral. NaN: not
/// available.
struct AxisSwitches {
  Switch neutral = Switch::not_available;
  Switch negative = Switch::not_available;
  Switch positive = Switch::not_available;
};
[[nodiscard]] inline AxisSwitches axis_switches(double share) {
  if (std::isnan(share)) {
    return {};
  }
  const bool neutral = std::abs(share) < 0.5 * kAxis.count;
  return {to_switch(neutral), to_switch(!neutral && share < 0.0),
          to_switch(!neutral && share > 0.0)};
}

}  // namespace rigwire::protocols::vehicle
