#include "structure/particle/constraints.hpp"

#include "structure/particle/sites.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

namespace strake::structure {
namespace {

using Eigen::Index;

/// A place of the body and the axes along which it is constrained.
template <int dim>
struct ConstrainedPlace {
  Eigen::Vector3d at;
  std::array<bool, dim> along{};
};

/// Places of a face, one to each line of lattice cells that crosses it.
template <int dim>
Points crossings(const Lattice<dim>& lattice, const Solid& solid, const SupportedFace& face, Index normal) {
  std::set<Eigen::Matrix<int, dim, 1>, Before> seen;
  std::vector<Eigen::Vector3d> places;
  const auto origin = lattice.origin();
  for (const int facet : face.facet)
    for_each_line<dim>(solid, facet, static_cast<int>(normal), origin, lattice.spacing,
                       [&](const Eigen::Matrix<int, dim, 1>& line, double crossing) {
                         if (!seen.insert(line).second) return;
                         Eigen::Vector3d X = Eigen::Vector3d::Zero();
                         X.head<dim>() =
                             origin + lattice.spacing * (line.template cast<double>().array() + 0.5).matrix();
                         X[normal] = origin[normal] + lattice.spacing * crossing;
                         places.push_back(X);
                       });
  Points points(3, static_cast<Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) points.col(static_cast<Index>(i)) = places[i];
  return points;
}

/// The middle line of a face, in space along the longer of its two directions. It is the line that finite
/// elements constrain.
template <int dim>
Points middle_line(const Solid& solid, const SupportedFace& face, Index normal, const Points& places,
                   Index& across) {
  const Eigen::Vector3d middle = middle_of(solid, face);
  across = normal == 0 ? 1 : 0;
  if constexpr (dim == 2) return middle;
  const Eigen::Vector3d size = places.rowwise().maxCoeff() - places.rowwise().minCoeff();
  for (Index axis = 0; axis < 3; ++axis)
    if (axis != normal && size[axis] < size[across]) across = axis;
  const Index along = 3 - normal - across;
  std::set<long long> seen;
  Points line(3, places.cols());
  Index n = 0;
  for (Index i = 0; i < places.cols(); ++i) {
    if (!seen.insert(std::llround(1e9 * places(along, i))).second) continue;
    line.col(n) = middle;
    line(along, n++) = places(along, i);
  }
  line.conservativeResize(Eigen::NoChange, n);
  return line;
}

template <int dim>
std::vector<ConstrainedPlace<dim>> constrained_places(const Lattice<dim>& lattice, const Solid& solid) {
  std::vector<ConstrainedPlace<dim>> places;
  for (const SupportedFace& face : solid.supported) {
    if (face.support == Support::free || face.support == Support::clamped) continue;
    const Index normal = axis_of(solid, face);
    Points points = crossings<dim>(lattice, solid, face, normal);
    Index across = 0;
    if (face.support != Support::symmetry) points = middle_line<dim>(solid, face, normal, points, across);
    for (Index i = 0; i < points.cols(); ++i) {
      ConstrainedPlace<dim> place{.at = points.col(i)};
      for (int axis = 0; axis < dim; ++axis)
        place.along[static_cast<std::size_t>(axis)] = face.support == Support::pinned ||
                                                      (face.support == Support::roller && axis == across) ||
                                                      (face.support == Support::symmetry && axis == normal);
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace

template <int dim>
Constraints<dim>::Constraints(const Lattice<dim>& lattice, const Solid& solid, const Eigen::VectorXd& mass,
                              const Vector& frame_mass)
    : mass_(mass) {
  const std::vector<ConstrainedPlace<dim>> places = constrained_places<dim>(lattice, solid);
  if (places.empty()) return;
  Points at(3, static_cast<Index>(places.size()));
  for (std::size_t k = 0; k < places.size(); ++k) at.col(static_cast<Index>(k)) = places[k].at;
  const SparseRows N = interpolation<dim>(lattice, at);
  for (std::size_t axis = 0; axis < dim; ++axis) {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> of_frame;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!places[k].along[axis]) continue;
      const auto row = static_cast<int>(of_frame.size());
      double sum = 0, size = 0;
      for (SparseRows::InnerIterator entry(N, static_cast<Index>(k)); entry; ++entry) {
        if (lattice.fixed[static_cast<std::size_t>(entry.col())]) continue;
        entries.emplace_back(row, static_cast<int>(entry.col()), entry.value());
        sum += entry.value();
        size += std::abs(entry.value());
      }
      if (size > 1e-9)
        of_frame.push_back(sum);  // else a clamp constrains the place already
      else
        while (!entries.empty() && entries.back().row() == row) entries.pop_back();
    }
    if (of_frame.empty()) continue;
    auto& a = axis_[axis];
    a = std::make_unique<Axis>();
    const auto m = static_cast<Index>(of_frame.size());
    a->weight.resize(m, lattice.size());
    a->weight.setFromTriplets(entries.begin(), entries.end());
    a->of_frame = Eigen::Map<const Eigen::VectorXd>(of_frame.data(), m);
    a->frame_mass = frame_mass[static_cast<Index>(axis)];
    Eigen::SparseMatrix<double> G = a->weight * mass.cwiseInverse().asDiagonal() * a->weight.transpose();
    if (std::isfinite(a->frame_mass)) {
      const Eigen::MatrixXd shared = a->of_frame * a->of_frame.transpose() / a->frame_mass;
      G += Eigen::SparseMatrix<double>(shared.sparseView());
    }
    // Two supports may give the same equation for the same particles. A pinned line that meets a plane of
    // symmetry does so. A small addition on the diagonal then divides the reaction between them.
    constexpr double shared_out = 1e-12;
    const double largest = G.diagonal().maxCoeff();
    for (Index k = 0; k < m; ++k) G.coeffRef(k, k) += shared_out * largest;
    a->factors.compute(G);
    assert(a->factors.info() == Eigen::Success);
  }
}

template <int dim>
bool Constraints<dim>::any() const {
  return std::any_of(axis_.begin(), axis_.end(), [](const auto& axis) { return axis != nullptr; });
}

template <int dim>
std::array<Eigen::VectorXd, dim> Constraints<dim>::gap(const Vectors<dim>& displacement,
                                                       const Vector& frame) const {
  std::array<Eigen::VectorXd, dim> gaps;
  for (std::size_t axis = 0; axis < dim; ++axis)
    if (const auto& a = axis_[axis])
      gaps[axis] = a->weight * displacement.row(static_cast<Index>(axis)).transpose() -
                   a->of_frame * frame[static_cast<Index>(axis)];
  return gaps;
}

//   (N M⁻¹ Nᵀ + b bᵀ/m) λ = −gap/dt − (N v − b V),   v += M⁻¹ Nᵀ λ,   V −= bᵀλ/m
template <int dim>
typename Constraints<dim>::Vector Constraints<dim>::project(Vectors<dim>& velocity, Vector& frame_velocity,
                                                            const std::array<Eigen::VectorXd, dim>* gap,
                                                            double dt) const {
  Vector impulse = Vector::Zero();
  const auto now = this->gap(velocity, frame_velocity);
  for (std::size_t axis = 0; axis < dim; ++axis) {
    const auto& a = axis_[axis];
    if (!a) continue;
    const auto k = static_cast<Index>(axis);
    Eigen::VectorXd wrong = now[axis];
    if (gap != nullptr) wrong += (*gap)[axis] / dt;
    const Eigen::VectorXd lambda = a->factors.solve(-wrong);
    velocity.row(k) += (a->weight.transpose() * lambda).cwiseQuotient(mass_).transpose();
    impulse[k] = a->of_frame.dot(lambda);
    if (std::isfinite(a->frame_mass)) frame_velocity[k] -= impulse[k] / a->frame_mass;
  }
  return impulse;
}

template <int dim>
SparseRows Constraints<dim>::rows(const std::vector<int>& first, int count) const {
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  for (std::size_t axis = 0; axis < dim; ++axis) {
    if (!axis_[axis]) continue;
    const SparseRows& weight = axis_[axis]->weight;
    for (Index k = 0; k < weight.rows(); ++k, ++row)
      for (SparseRows::InnerIterator entry(weight, k); entry; ++entry)
        entries.emplace_back(row, first[static_cast<std::size_t>(entry.col())] + static_cast<int>(axis),
                             entry.value());
  }
  SparseRows C(row, count);
  C.setFromTriplets(entries.begin(), entries.end());
  return C;
}

template class Constraints<2>;
template class Constraints<3>;

}  // namespace strake::structure
