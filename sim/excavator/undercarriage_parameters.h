// Running gear and attachments of a moving undercarriage: tyres with their brakes locked, or two
// tracks; a blade and outriggers, as rows of a list.
//
// Estimates for an 18 t machine (docs/machines/excavator.md). Frame of all positions: the
// undercarriage's, x forward, y left, origin on the ground below the swing axis.
#pragma once

#include <string>
#include <vector>

#include "fields/rules.h"
#include "sim/hydraulics/parameters.h"
#include "sim/tyre/tyre.h"

namespace rigwire::sim {

/// Running gear of a moving undercarriage.
enum class RunningGear {
  tyres,   ///< Four wheels with their brakes locked, axles rigid.
  tracks,  ///< Two tracks, each with a travel motor and a valve section.
};

/// Parameters of running gear `tyres`.
struct CarrierParameters {
  double wheelbase_m = 2.70;  ///< Wheels at half of it before and behind the swing axis.
  double track_m = 2.00;      ///< Between the middles of left and right tyres (twins as one).
  double tyre_pressure_pa = 7.0e5;
  TyreParameters tyre{.unloaded_radius_m = 0.53,
                      .width_m = 0.50,
                      .rim_radius_m = 0.254,
                      .vertical_damping_nspm = 1.5e4,
                      .reference_load_n = 4.5e4};
};
void visit(fields::Visitor& v, CarrierParameters& p);

/// Parameters of running gear `tracks`: both are equal, rigid frames with a travel motor each.
struct TrackParameters {
  double gauge_m = 2.00;       ///< Between the middles of the tracks.
  double length_m = 3.00;      ///< On hard ground, half before and half behind the swing axis.
  double shoe_width_m = 0.60;  ///< Width of the bearing area.
  double end_radius_m = 0.37;  ///< Radius of sprocket and idler, over the shoes.
  int stations = 7;            ///< Contact stations with the ground per track; odd.
  double stiffness_npm = 3e7;  ///< Stiffness of a whole track on hard ground.
  /// Damping ratio of a track under its share of the mass, along and across too.
  double damping_ratio = 0.7;
  double grip = 1.0;                     ///< Factor of the shoes on the ground's coefficient.
  double shear_way_m = 0.005;            ///< K of Janosi and Hanamoto on hard ground.
  double resistance = 0.04;              ///< Resistance of rollers and links: force over load.
  double moving_mass_kg = 1000.0;        ///< Moved mass at the shoes: belt, rollers, sprocket.
  double displacement_m3prad = 8.64e-4;  ///< Motor and gear together, per radian of the sprocket.
  double sprocket_radius_m = 0.36;       ///< Pitch circle.
  double brake_nm = 4.5e4;               ///< Parking brake, at the sprocket.
  SpoolParameters spool{.flow_max_m3ps = 200.0 / 6e4};  ///< Spool of each travel section.

  /// Oil per metre of track, m2.
  [[nodiscard]] double area_m2() const { return displacement_m3prad / sprocket_radius_m; }
};
void visit(fields::Visitor& v, TrackParameters& p);
/// Throws std::invalid_argument; also for an even number of stations and for tracks that overlap.
void validate(const TrackParameters& parameters);

/// A blade or a pair of outriggers that cylinders lower to the ground, square to the undercarriage.
/// It bears on two pads, left and right.
struct SupportParameters {
  std::string name = "blade";  ///< Name of its valve section.
  double x_m = 2.30;           ///< Position of the pads' middles.
  double spread_m = 1.60;      ///< From the left to the right pad's middle.
  double pad_length_m = 0.10;
  double pad_width_m = 0.80;
  double raised_m = 0.45;  ///< Height of the pads over the ground, cylinders retracted.
  double travel_m = 0.85;  ///< Downwards until they are extended.
  double mass_kg = 450.0;  ///< Moving mass; part of the undercarriage's mass.
  double friction = 0.8;   ///< Factor of the pads on the ground's coefficient.
  int cylinders = 2;
  double bore_m = 0.110;
  double rod_m = 0.070;
  double stroke_m = 0.425;  ///< Stroke of the cylinders, for the whole travel.
  SpoolParameters spool{.flow_max_m3ps = 60.0 / 6e4};

  /// Oil per metre of the pads' way, m2: lowering and raising.
  [[nodiscard]] double lowering_area_m2() const;
  [[nodiscard]] double raising_area_m2() const;
};
void visit(fields::Visitor& v, SupportParameters& p);
/// Throws std::invalid_argument; also for a rod as thick as the bore.
void validate(const SupportParameters& parameters);

}  // namespace rigwire::sim
