// Everything that is chosen about a satellite receiver's antenna and navigation engine.
#pragma once

#include <cstdint>
#include <vector>

#include "fields/rules.h"
#include "sim/gnss/carrier_solution.h"
#include "sim/gnss/dilution.h"
#include "sim/gnss/gnss_fault.h"
#include "sim/gnss/multipath.h"
#include "sim/gnss/navigation_filter.h"
#include "sim/gnss/range_errors.h"
#include "sim/gnss/receiver_clock.h"
#include "sim/gnss/sky_view.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::sim {

/// The paper's rule: 3D degrades to 2D when one of four sectors of the sky has no satellite.
enum class QuadrantRule : unsigned char {
  off,       ///< Default. Under open sky the rule alone costs 35 % of all 3D fixes at 49 deg north.
  cardinal,  ///< Sectors centred on north, east, south, west.
  diagonal,  ///< Sectors centred on north-east, south-east, south-west, north-west.
};

enum class ErrorModel : unsigned char {
  engine,    ///< Default. Errors of each measurement, and what a receiver's filter makes of them.
  coloured,  ///< Errors of pseudoranges as in `engine`; each epoch solved alone by least squares.
  paper,     ///< Wolf et al. 2020, Eq. 1 to 3: dilution times noise; crowns block, edges are sharp.
};

/// Satellite systems that the receiver uses.
struct GnssSystems {
  bool gps = true;
  bool glonass = false;
  bool galileo = false;
  bool beidou = false;
  bool sbas = false;
  bool qzss = false;

  [[nodiscard]] bool receives(GnssSystem system) const;
};
void visit(fields::Visitor& v, GnssSystems& p);

struct GnssParameters {
  ErrorModel error_model = ErrorModel::engine;
  DilutionKind dilution = DilutionKind::regression;  ///< Paper; the others go by geometry.
  QuadrantRule quadrant_rule = QuadrantRule::off;
  GnssSystems systems;
  SkyViewParameters sky;
  double circular_error_m = 2.5;     ///< Paper: CEP under open sky, data sheet, GPS only; >= 0.
  double correlation_time_s = 60.0;  ///< Paper: of the position error; 0 = white.
  RangeErrorParameters ranges;       ///< Engine and coloured.
  MultipathParameters multipath;     ///< Engine and coloured.
  NavigationParameters navigation;   ///< Engine.
  double speed_sigma_mps = 0.05;     ///< Paper and coloured: of a range rate, white.
  bool errors = true;                ///< False: position, velocity and ranges without any error.
  CorrectionParameters corrections;
  std::vector<GnssFault> faults;
  ReceiverClockParameters clock;
  bool raw_measurements = false;  ///< Fill GnssSample::measurements.
  bool second_signals = false;    ///< The radio part has the second carriers too: L2, E5b, B2.
  bool ionosphere = true;         ///< Raw ranges are delayed by the model that is broadcast.
  bool troposphere = true;        ///< Raw ranges are delayed by Saastamoinen's model.
};
void visit(fields::Visitor& v, GnssParameters& p);

/// Throws std::invalid_argument naming the key, its value and what is allowed.
void validate(const GnssParameters& parameters);

}  // namespace rigwire::sim
