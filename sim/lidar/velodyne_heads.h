// Measuring quality of the Velodyne models: sensitivity and errors of the receiver, unevenness of
// the rotor, as data. A further model is a further row.
//
// Measured from public captures of single units (MRPT/mrpt modules/mrpt_data/tests: HDL-32E of
// 2011, VLP-16 of 2016; tier4/nebula decoder_ground_truth: VLP-16 with two returns, VLP-32C,
// VLS-128). Range noise: second differences along azimuth over sqrt(6), by their median.
//
// | | HDL-32E | VLP-16 | VLP-32C | VLS-128 |
// | --- | --- | --- | --- | --- |
// | range noise, mm | 5.1 .. 5.5 | 5.6 .. 6.8 | 4.6 .. 5.0 | 9.5 .. 12.9 |
// | spread of the lasers' biases on common planes, mm | 7.9 | 7.1 (11.5 of 8 lasers) | 6.2 | 7.4 |
// | correlation of the biases between halves of the capture | 0.92 | 1.00 | 0.95 | 0.75 |
// | spread of the azimuth's steps from block to block, 0.01 deg | 0.59 | 0.87, 0.85 | 0.82 | 0.37 |
// | thereof the encoder's noise, white, without the rounding | 0.30 | 0.53 | 0.51 | 0.08 |
// | once in a turn, amplitude, 0.01 deg = rpm at 600 rpm / 10 | 3.2 | 8.2, 9.1 | 7 | 5.7 |
// | turns, rpm, of 600 but for the first | 542.3 | 599.08, 599.95 | 600.12 | 599.90 |
//
// Reflectivity, and range noise of faint echoes: a scan of an HDL-32E of a street
// (open-mmlab/mmdetection3d demo/data/nuscenes). Second differences of the byte along azimuth over
// sqrt(6), by their median: 4.8, 6.9, 4.8, 6.9 % of levels of 10 .. 15, 15 .. 20, 20 .. 30, 30 ..
// 40. Each laser's byte against the mean of its two neighbours' on upright surfaces, by the medians
// of nine lasers: spread 13.8 %, over sqrt(1.5) 11 % a laser. Range: link_budget.h, noise_growth().
//
// Focus, for fog: the width of the lens over the angle of a detector. The lasers' exits give the
// lenses' focal distances, 28.83 mm (HDL-32E), 41.91 mm (VLP-16) and 42.4 mm (VLP-32C); they are
// taken to be as wide as 1 / 1.2 of it, and detectors to see 3 mrad, the beam's own
// width: 8.0, 11.6 and 11.8 m. Both are estimates. The others are taken for a VLP-32C.
//
// The range of the data sheets (2 cm HDL, 3 cm VLP and VLS) bounds noise and bias together. Speeds
// of a unit stay within 0.1 rpm for the captures' 0.4 s: the wander is slow.
//
// Sensitivity, by the range at which a 90 % surface is just seen: HDL-32E 150 m, where its lasers
// at -4 degrees lose the road from 2.6 m height (89 % seen, none beyond 46 m); VLS-128 660 m, a
// quarter of its returns at 220 to 240 m have a byte of 10 % or less; HDL-64E 150 m, data sheet (50
// m at 10 %); VLP-16 and Puck Hi-Res as the HDL-32E, VLP-32C twice that, by the ranges of their
// data sheets, 100 and 200 m, because their captures were taken in rooms. No capture of an HDL-64E
// was available: its errors are the HDL-32E's.
#pragma once

#include <string_view>

#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/rotor.h"

namespace rigwire::sim {

struct SpinningHead {
  SpinningLidarParameters receiver;
  RotorParameters rotor;
};

/// By the model's name as the data sheet writes it. Throws std::invalid_argument for another one.
[[nodiscard]] SpinningHead velodyne_head(std::string_view model);

}  // namespace rigwire::sim
