// Dilution of precision behind one interface: the paper's regression over the number of satellites,
// and the exact geometry.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <span>

namespace rigwire::sim {

struct Dilution {
  double horizontal = std::numeric_limits<double>::quiet_NaN();
  double vertical = std::numeric_limits<double>::quiet_NaN();
  double position = std::numeric_limits<double>::quiet_NaN();
  double time = std::numeric_limits<double>::quiet_NaN();
  double north = std::numeric_limits<double>::quiet_NaN();  ///< From the geometry only.
  double east = std::numeric_limits<double>::quiet_NaN();   ///< From the geometry only.
};

enum class DilutionKind : unsigned char { regression, geometric };

class DilutionModel {
 public:
  virtual ~DilutionModel() = default;
  /// `directions_W`: unit vectors from the antenna to the satellites used, east-north-up.
  /// What a receiver reports; NaN when it is not available.
  [[nodiscard]] virtual Dilution reported(std::span<const Eigen::Vector3d> directions_W) const = 0;
  /// What scales the error: the same without rounding and clamp. Equals reported() where there is
  /// neither.
  [[nodiscard]] virtual Dilution amplitude(std::span<const Eigen::Vector3d> directions_W) const = 0;
};

/// Wolf, Groll, Hemer, Berns, SIMULTECH 2020, Eq. 1 and Table 1: max(round(a rn^n, 2 decimals),
/// 1.02) with n the number of satellites; not available for n < 3, where Eq. 3 gives no position.
/// The amplitude of Eq. 2 is unclamped. The three do not obey PDOP^2 = HDOP^2 + VDOP^2
/// (Table 1 does not). Against the exact geometry the regression is off by a factor 0.3 .. 2.1.
/// Time dilution is not in the paper: horizontal times 0.8, a usual ratio under open sky.
[[nodiscard]] std::unique_ptr<DilutionModel> make_regression_dilution();

/// Q = (G^T G)^-1 with rows [-e, 1]; horizontal sqrt(Q11 + Q22), vertical sqrt(Q33), position
/// sqrt(Q11 + Q22 + Q33), time sqrt(Q44). With three satellites the height is held and its column
/// dropped: vertical stays NaN and position equals horizontal. NaN with fewer, or when the
/// satellites lie on a cone (condition of G^T G above 1e10). One clock for all systems; with a
/// clock for each, position_solution.h has the dilutions.
[[nodiscard]] std::unique_ptr<DilutionModel> make_geometric_dilution();

[[nodiscard]] std::unique_ptr<DilutionModel> make_dilution(DilutionKind kind);

/// Eq. 1 and the product in Eq. 2 on their own.
struct RegressionTerm {
  double a = 0.0;
  double rn = 0.0;
  [[nodiscard]] double raw(int satellites) const;
  [[nodiscard]] double rounded(int satellites) const;
};
inline constexpr RegressionTerm kHorizontalRegression{5.59474, 0.854736};
inline constexpr RegressionTerm kVerticalRegression{10.2524, 0.858869};
inline constexpr RegressionTerm kPositionRegression{2.63625, 0.967947};

}  // namespace rigwire::sim
