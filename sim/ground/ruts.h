// What the ground remembers of wheels: how deep its soft part was pressed, by cells of 0.1 m.
//
// Cells lie on a grid of W of their own, finer than the terrain's; they are kept in pages of 16 by
// 16, found by a table of fixed size. All pages are allocated at construction. When none is left,
// the page that was taken first is given up: its ruts are forgotten, the newest never. 4096 pages
// are 6.5 km of one wheel's track and 4 MB.
//
// Depths are below the untouched surface and only grow, until the ground is dug there. What is
// pressed and read does not depend on anything but the calls and their order.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigwire::sim {

class Ruts {
 public:
  static constexpr double kCell_m = 0.1;
  static constexpr std::size_t kPages = 4096;

  /// Without pages there is no memory: nothing is pressed, every depth is 0.
  explicit Ruts(std::size_t pages = 0);

  /// Bilinear between the middles of cells. 0 where nothing was pressed, also for coordinates that
  /// are not finite or beyond 100 000 km.
  [[nodiscard]] double depth_m(const Eigen::Vector2d& p_W) const;

  /// Presses every cell whose middle lies in the rectangle about `p_W` to at least that depth.
  /// `forward` is a unit vector; half lengths along and across it are at least one and a half
  /// cells, so that depth_m() finds the depth at `p_W`, and at most 5 m. Never allocates.
  void press(const Eigen::Vector2d& p_W, const Eigen::Vector2d& forward, double half_length_m,
             double half_width_m, double depth_m);

  /// Forgets what was pressed in the rectangle: the ground was dug.
  void forget(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m);

  /// Pages in use.
  [[nodiscard]] std::size_t pages() const { return used_; }

 private:
  static constexpr std::int32_t kSide = 16;
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  struct Page {
    std::int32_t column = 0;
    std::int32_t row = 0;
    std::uint32_t next = kNone;  ///< Next page of the same bucket.
    std::array<float, kSide * kSide> depth_m{};
  };

  [[nodiscard]] std::size_t bucket(std::int32_t column, std::int32_t row) const;
  [[nodiscard]] std::uint32_t find(std::int32_t column, std::int32_t row) const;
  [[nodiscard]] Page& take(std::int32_t column, std::int32_t row);
  [[nodiscard]] double cell_depth_m(std::int32_t column, std::int32_t row) const;

  std::vector<Page> pages_;
  std::vector<std::uint32_t> buckets_;
  std::size_t used_ = 0;
  std::size_t oldest_ = 0;
};

}  // namespace rigwire::sim
