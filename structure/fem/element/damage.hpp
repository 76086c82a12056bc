#pragma once

#include "structure/body/parameters.hpp"
#include "structure/failure/failure_record.hpp"
#include "structure/fem/element/assembly.hpp"
#include "structure/fem/mesh/mesh.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strake::structure::fem {

/// Failure of finite elements (structure/THEORY.md (S32)–(S35)). A cell softens as a whole, from where the
/// mean of its Cauchy stress reaches the strength, with Y the mean of its energy density (softening.hpp). The
/// band of a crack is the length over which it opens in the cell, along the normal n that the largest
/// principal stress of that moment gives: 1/(∇φ·n) with φ = 1 in the corners beyond the cell's middle (Oliver
/// 1989, recalled): across a square of side h h/max(|n_x|, |n_y|), across a column of leaning cells its width
/// along n. A crack that follows the columns of a mesh takes G_c so; it follows them even where stresses
/// would turn it, and two that miss each other take it twice.
///
/// A cell that has lost all is eroded: `residual` of its stiffness stays, linear, so that nodes of its own
/// keep to their neighbours, and all of its mass.
template <int dim>
class Damage {
 public:
  static constexpr double residual = Assembly<dim>::residual;
  struct State {
    Eigen::VectorXd onset, peak, end;  // cells: y_0 (0: not yet), largest y, y_f [√Pa]; empty: no failure
                                       // asked for
    std::int64_t eroded = 0;           // cells
    double released = 0;               // [J] ([J/m])
    FailureRecord record;
  };

  /// Throws Error(case_file) where a cell is too wide for the softening.
  Damage(const FailureKeys&, const Mesh<dim>&, const Assembly<dim>&);
  State intact() const;
  /// Whether a displacement adds damage; the state then holds it.
  bool look(const Eigen::VectorXd& displacement, double time, State&) const;
  /// Share of its stiffness that each cell still has, 1 − D.
  Eigen::VectorXd held(const State&) const;
  /// D in the nodes, the largest of the cells that meet there.
  Eigen::RowVectorXd in_nodes(const State&) const;
  std::vector<std::string> lines() const;

 private:
  double extent(int cell, const Eigen::Vector3d& direction) const;
  double band(int cell, const Eigen::Vector3d& normal) const;  // [m]
  Eigen::Vector3d middle(int cell) const;
  void note_parting(double time, State&) const;

  FailureKeys keys_;
  const Mesh<dim>& mesh_;
  const Assembly<dim>& assembly_;
  double narrowest_, widest_;  // [m] of the cells' extents along the axes
};

}  // namespace strake::structure::fem
