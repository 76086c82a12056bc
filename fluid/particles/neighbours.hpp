#pragma once

#include "fluid/particles/cell_list.hpp"
#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"

#include <cassert>
#include <cstdint>
#include <functional>
#include <list>
#include <ranges>
#include <span>
#include <vector>

namespace strake::fluid {

/// The data beside each column of a neighbour row.
enum class PairData : std::uint8_t {
  inverses,         // 1/|r_ij| [1/m], in double precision
  entries,          // 1 − R/|r_ij|, R the search's radius, in single precision: minus the weight
  single_inverses,  // 1/|r_ij| [1/m] of such entries
};

/// 1/|r_ij| of a row's pairs [1/m], of double or of single precision.
class InverseRow {
 public:
  InverseRow(const double* all, const float* single, std::size_t size)
      : double_(all), single_(single), size_(size) {}
  std::size_t size() const { return size_; }
  double operator[](std::size_t e) const { return double_ ? double_[e] : single_[e]; }
  InverseRow subspan(std::size_t from) const {
    return {double_ ? double_ + from : nullptr, double_ ? nullptr : single_ + from, size_ - from};
  }

 private:
  const double* double_;
  const float* single_;
  std::size_t size_;
};

/// Neighbour rows in compressed form. Particle i has the columns row(i), sorted by index; both i-j and j-i
/// are stored. The rows contain exactly the pairs with |r_ij| < radius at the positions of the last `update`.
/// A Verlet skin saves the cell search and never changes the rows. Rows are counted first and filled second,
/// so that no capacity can overflow. Beside each column is the inverse of its distance, so that no operator
/// computes a root or a division again. Or it is its entry, half as large, which is the pressure's matrix
/// without change.
class Neighbours {
 public:
  std::span<const std::int32_t> row(std::int64_t i) const { return part(column_, i); }
  InverseRow inverses(std::int64_t i) const {  // 1/|r_ij| [1/m]
    const auto first = start_[static_cast<std::size_t>(i)];
    const auto size = static_cast<std::size_t>(start_[static_cast<std::size_t>(i) + 1] - first);
    assert(data_ != PairData::entries);
    const bool single = data_ == PairData::single_inverses;
    return {single ? nullptr : inverse_.data() + first, single ? single_.data() + first : nullptr, size};
  }
  std::span<const float> entries(std::int64_t i) const { return part(single_, i); }
  /// Returns |r_ij| [m], computed by a division each time it is read.
  auto distances(std::int64_t i) const {
    const InverseRow row = inverses(i);
    return std::views::iota(std::size_t{0}, row.size()) |
           std::views::transform([row](std::size_t e) { return 1.0 / row[e]; });
  }
  std::span<const std::int64_t> start() const { return start_; }    // n+1
  std::span<const std::int32_t> column() const { return column_; }  // one per pair
  std::span<const double> inverse() const { return inverse_; }      // one per pair [1/m], or empty
  std::span<const float> entry() const { return single_; }          // the same
  PairData data() const { return data_; }
  double scale() const { return scale_; }  // 1/R of the entries [1/m]
  /// Returns 1/|r_ij| of a pair in the numbering of column(), from any kind of PairData.
  double inverse_of(std::int64_t pair) const {
    const auto e = static_cast<std::size_t>(pair);
    if (data_ == PairData::entries) return (1.0 - single_[e]) * scale_;
    return data_ == PairData::inverses ? inverse_[e] : single_[e];
  }
  std::int64_t size() const { return static_cast<std::int64_t>(start_.size()) - 1; }
  std::size_t bytes() const;
  /// Returns the directions in which the space of these pairs repeats itself. r_ij is `seams().separation`.
  template <int dim>
  Periodic<dim> seams() const {
    return Periodic<dim>(period_.head<dim>());
  }

 private:
  template <int dim>
  friend class NeighbourSearch;
  template <class T>
  std::span<const T> part(const std::vector<T>& all, std::int64_t i) const {
    const auto first = start_[static_cast<std::size_t>(i)];
    return {all.data() + first, static_cast<std::size_t>(start_[static_cast<std::size_t>(i) + 1] - first)};
  }
  std::vector<std::int64_t> start_{0};
  std::vector<std::int32_t> column_;
  std::vector<double> inverse_;
  std::vector<float> single_;
  PairData data_ = PairData::inverses;
  double scale_ = 1;
  Eigen::Vector3d period_ = Eigen::Vector3d::Zero();  // [m]; 0: not periodic
};

/// Whether a pair counts; symmetric in i and j. It is called at each update, at the new positions, for pairs
/// within the radius.
using KeepPair = std::function<bool(std::int32_t i, std::int32_t j)>;

/// Searches neighbours by a cell list with a Verlet skin. Throws Error(solver_fault) that names the particle
/// when a position is not finite.
template <int dim>
class NeighbourSearch {
 public:
  /// Sets the radii of the search. radius: largest interaction radius [m]. skin: the largest to use [m],
  /// 0.2 l0; it follows the motion and never changes the rows. data: of the rows of `update`; those of
  /// `within` have inverses, single ones where `update` has entries. Throws Error(case_file) when a period is
  /// shorter than 2 (radius + skin), where a particle would meet two images of another.
  NeighbourSearch(double radius, double skin, const Periodic<dim>& = {}, PairData data = PairData::inverses);
  /// Computes the rows of the largest radius. tag: empty, or one byte per particle (PairTag). Where
  /// fillers, absent or passive ones change, the candidates are found anew.
  const Neighbours& update(const Vectors<dim>& position, std::span<const std::uint8_t> tag = {},
                           const KeepPair& keep = {});
  /// Returns the pairs of the last update with |r_ij| < radius, at most the largest radius. They are made on
  /// first use, then kept until the next update. The reference stays valid as long as the search; its content
  /// changes with the next update.
  const Neighbours& within(double radius);
  /// Gives a pair of the last `update` another length [m], in the numbering of column(). Its columns stay.
  void lengthen(std::int64_t pair, double length);
  void invalidate();  // after set_state or re-ordering
  std::int64_t rebuilds() const { return rebuilds_; }
  const Periodic<dim>& periodic() const { return periodic_; }
  double radius() const { return radius_; }         // [m]
  double reach() const { return radius_ + skin_; }  // [m]
  std::size_t bytes() const;                        // of all rows, candidates and scratch

 private:
  struct Part {
    double radius;
    bool fresh = false;
    Neighbours rows{};
  };
  double moved(const Vectors<dim>& position) const;
  void rebuild(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double way);
  void mark_asked(std::span<const std::uint8_t> tag);
  void mark_beside_passive(std::span<const std::uint8_t> tag);
  template <bool seams>
  void select(const double* x, std::span<const std::uint8_t> tag, const KeepPair* keep);
  template <bool seams, bool single>
  void fill(const double* x);
  bool keeps_entries() const { return exact_.data_ == PairData::entries; }
  template <bool single>
  void gather_part(Part&) const;
  double radius_, skin_;
  Periodic<dim> periodic_;
  bool valid_ = false;
  double built_skin_ = 0;                    // of the present candidates [m]
  std::int64_t rebuilds_ = 0, updates_ = 0;  // updates: since the last rebuild
  Vectors<dim> built_at_;
  std::vector<std::uint8_t> built_tag_;
  CellList<dim> cells_;
  Candidates candidates_;
  std::vector<std::uint16_t> kept_;        // of the candidates' bits those that are in the exact rows
  std::vector<std::uint8_t> meets_asked_;  // particles with an asked one among their candidates
  Neighbours exact_;
  std::list<Part> parts_;  // stay where they are: references to their rows are handed out
};

}  // namespace strake::fluid
