// Values of one parameter: from a place in [0, 1) to the text that a key gets.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"

namespace rigwire::hil {

/// Each throws std::invalid_argument: no number, numbers of different units, nothing between them.
void check_spread(const ListedValues& p);
void check_spread(const SteppedRange& p);
void check_spread(const ValuesOfFile& p);
void check_spread(const WeightedChoice& p);
void check_spread(const UniformSpread& p);
void check_spread(const LogUniformSpread& p);
void check_spread(const NormalSpread& p);

/// The values of a spread that has a list of them, in its order; nothing for the others.
[[nodiscard]] std::optional<std::vector<std::string>> listed_values(
    const CampaignParameter& parameter);

/// The element that has `place` in its share, all shares being equal. The list is not empty.
[[nodiscard]] const std::string& element_at(const std::vector<std::string>& list, double place);

/// The value at `place`, which is evenly spread in [0, 1): the quantile of the spread there.
/// Numbers have nine significant digits and the unit of the file. Of a list every value is equally
/// likely.
[[nodiscard]] std::string value_at(const CampaignParameter& parameter, double place);

/// Quantile of the standard normal distribution, by bisection of erfc to an absolute error below
/// 1e-12 within its range, places of [1e-16, 1 - 1e-16]; beyond them their ends.
[[nodiscard]] double normal_quantile(double place);

}  // namespace rigwire::hil
