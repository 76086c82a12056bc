#pragma once

#include "structure/body/parameters.hpp"
#include "structure/failure/failure_record.hpp"
#include "structure/fem/element/assembly.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake::structure::fem {

/// Computes the failure of finite elements (structure/THEORY.md (S32)–(S35)). A cell softens as a whole, once
/// the mean of its Cauchy stress reaches the strength. Y is the mean of its energy density (softening.hpp).
///
/// The crack band l_c is the length over which a crack opens in the cell, along its normal n. n is the
/// direction of the largest principal stress at that moment:
///   l_c = 1/(∇φ·n), φ = 1 in the corners beyond the cell's middle (Oliver 1989, recalled)
/// Across a square of side h it is h/max(|n_x|, |n_y|), across a column of leaning cells its width along n.
/// So a crack that follows the columns of a mesh dissipates G_c. It follows the columns even where stresses
/// would turn it, and two cracks that miss each other dissipate G_c twice.
///
/// A cell without remaining strength is eroded. It keeps the share `residual` of its stiffness, linear, so
/// that nodes that only it has stay near their neighbours, and all of its mass.
template <int dim>
class Damage {
 public:
  static constexpr double residual = Assembly<dim>::residual;
  struct State {
    Eigen::VectorXd onset, peak, end;  // cells: y_0 (0: not yet), largest y, y_f [√Pa]; empty: no failure
    std::int64_t eroded = 0;           // cells
    double released = 0;               // [J] ([J/m])
    FailureRecord record;
  };

  /// Throws Error(case_file) where a cell is too wide for the softening.
  Damage(const FailureKeys&, const Mesh<dim>&, const Assembly<dim>&);
  State intact() const;
  /// True if a displacement adds damage, which is then in the state. The owner of a cell computes its damage.
  bool look(const Eigen::VectorXd& displacement, double time, State&) const;
  /// Share of its stiffness that each cell still has, 1 − D.
  Eigen::VectorXd integrity(const State&) const;
  /// D in the nodes, the largest of the cells that meet there.
  Eigen::RowVectorXd in_nodes(const State&) const;
  std::vector<std::string> lines() const;

 private:
  double extent(int cell, const Eigen::Vector3d& direction) const;
  double band(int cell, const Eigen::Vector3d& normal) const;  // [m]
  Eigen::Vector3d middle(int cell) const;
  /// A cell in which something happens: what it counts among others, its number with a minus, its middle.
  using Event = Eigen::Matrix<double, 5, 1>;
  bool eroded(const State&, int cell) const;
  void note_parting(double time, State&) const;

  FailureKeys keys_;
  const Mesh<dim>& mesh_;
  const Assembly<dim>& assembly_;
  double narrowest_, widest_;  // [m] of the cells' extents along the axes
};

}  // namespace strake::structure::fem
