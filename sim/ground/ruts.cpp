#include "sim/ground/ruts.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kFarthest_m = 1e8;
constexpr double kLeastHalf_m = 1.5 * Ruts::kCell_m;
constexpr double kGreatestHalf_m = 5.0;

bool reachable(const Eigen::Vector2d& p_W) {
  return p_W.cwiseAbs().maxCoeff() < kFarthest_m;  // false for not-a-number, too
}

/// Returns the index of the cell that contains the coordinate.
std::int32_t cell_of(double coordinate_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / Ruts::kCell_m));
}

/// Returns the index of a cell in its page, row by row; a page has 16 by 16 cells.
std::size_t cell_within_page(std::int32_t column, std::int32_t row) {
  return static_cast<std::size_t>(row & 15) * 16 + static_cast<std::size_t>(column & 15);
}

}  // namespace

Ruts::Ruts(std::size_t pages)
    : pages_(pages), buckets_(pages == 0 ? 0 : std::bit_ceil(2 * pages), kNone) {}

std::size_t Ruts::bucket(std::int32_t column, std::int32_t row) const {
  // Two odd multipliers spread neighbours; their high bits are the better ones.
  const std::uint32_t hash = static_cast<std::uint32_t>(column) * 0x9E3779B1U ^
                             static_cast<std::uint32_t>(row) * 0x85EBCA77U;
  return (hash ^ hash >> 15U) & (buckets_.size() - 1);
}

std::uint32_t Ruts::find(std::int32_t column, std::int32_t row) const {
  std::uint32_t at = buckets_[bucket(column, row)];
  while (at != kNone && (pages_[at].column != column || pages_[at].row != row)) {
    at = pages_[at].next;
  }
  return at;
}

Ruts::Page& Ruts::take(std::int32_t column, std::int32_t row) {
  const std::uint32_t known = find(column, row);
  if (known != kNone) {
    return pages_[known];
  }
  std::uint32_t at = static_cast<std::uint32_t>(used_);
  if (used_ < pages_.size()) {
    ++used_;
  } else {
    // Out of its bucket's chain, then over to the new place.
    at = static_cast<std::uint32_t>(oldest_);
    oldest_ = (oldest_ + 1) % pages_.size();
    std::uint32_t* link = &buckets_[bucket(pages_[at].column, pages_[at].row)];
    while (*link != at) {
      link = &pages_[*link].next;
    }
    *link = pages_[at].next;
  }
  Page& page = pages_[at];
  page = {};
  page.column = column;
  page.row = row;
  std::uint32_t& head = buckets_[bucket(column, row)];
  page.next = head;
  head = at;
  return page;
}

double Ruts::cell_depth_m(std::int32_t column, std::int32_t row) const {
  // Arithmetic shift and mask: floor and remainder by 16, also below 0.
  const std::uint32_t at = find(column >> 4, row >> 4);
  return at == kNone ? 0.0 : static_cast<double>(pages_[at].depth_m[cell_within_page(column, row)]);
}

double Ruts::depth_m(const Eigen::Vector2d& p_W) const {
  if (used_ == 0 || !reachable(p_W)) {
    return 0.0;
  }
  const double u = p_W.x() / kCell_m - 0.5;
  const double v = p_W.y() / kCell_m - 0.5;
  const double fx = u - std::floor(u);
  const double fy = v - std::floor(v);
  const auto column = static_cast<std::int32_t>(std::floor(u));
  const auto row = static_cast<std::int32_t>(std::floor(v));
  return (1.0 - fy) *
             ((1.0 - fx) * cell_depth_m(column, row) + fx * cell_depth_m(column + 1, row)) +
         fy * ((1.0 - fx) * cell_depth_m(column, row + 1) + fx * cell_depth_m(column + 1, row + 1));
}

void Ruts::press(const Eigen::Vector2d& p_W, const Eigen::Vector2d& forward, double half_length_m,
                 double half_width_m, double depth_m) {
  if (pages_.empty() || !reachable(p_W) || !(depth_m > 0.0)) {
    return;
  }
  const double along = std::clamp(half_length_m, kLeastHalf_m, kGreatestHalf_m);
  const double across = std::clamp(half_width_m, kLeastHalf_m, kGreatestHalf_m);
  // Box about the turned rectangle.
  const Eigen::Vector2d half(std::abs(forward.x()) * along + std::abs(forward.y()) * across,
                             std::abs(forward.y()) * along + std::abs(forward.x()) * across);
  const auto depth = static_cast<float>(depth_m);
  Page* page = nullptr;
  for (std::int32_t row = cell_of(p_W.y() - half.y()); row <= cell_of(p_W.y() + half.y()); ++row) {
    for (std::int32_t column = cell_of(p_W.x() - half.x()); column <= cell_of(p_W.x() + half.x());
         ++column) {
      const Eigen::Vector2d from = kCell_m * Eigen::Vector2d(column + 0.5, row + 0.5) - p_W;
      if (std::abs(from.dot(forward)) > along ||
          std::abs(from.x() * forward.y() - from.y() * forward.x()) > across) {
        continue;
      }
      if (page == nullptr || page->column != column >> 4 || page->row != row >> 4) {
        page = &take(column >> 4, row >> 4);
      }
      float& cell = page->depth_m[cell_within_page(column, row)];
      cell = std::max(cell, depth);
    }
  }
}

void Ruts::forget(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m) {
  if (used_ == 0 || !reachable(lower_m) || !reachable(upper_m)) {
    return;
  }
  for (std::int32_t row = cell_of(lower_m.y()); row <= cell_of(upper_m.y()); ++row) {
    for (std::int32_t column = cell_of(lower_m.x()); column <= cell_of(upper_m.x()); ++column) {
      const std::uint32_t at = find(column >> 4, row >> 4);
      if (at != kNone) {
        pages_[at].depth_m[cell_within_page(column, row)] = 0.0F;
      }
    }
  }
}

}  // namespace rigwire::sim
