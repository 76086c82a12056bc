#include "structure/particle/failure.hpp"

#include "structure/failure/softening.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::structure {

double crack_constant(double radius, double lambda_over_mu) {
  struct Crossing {
    double opening, rows, weight, r2;  // at which it breaks for s_c = 1, Δx, w⁰, |r⁰|²
  };
  const int reach = static_cast<int>(std::floor(radius));
  double n0 = 0;
  std::vector<Crossing> bonds;
  for (int dx = -reach; dx <= reach; ++dx)
    for (int dy = -reach; dy <= reach; ++dy) {
      const double r = std::hypot(dx, dy);
      if (!(r > 0 && r < radius)) continue;
      n0 += radius / r - 1;
      if (dx > 0) bonds.push_back({r * r / dx, static_cast<double>(dx), radius / r - 1, r * r});
    }
  std::sort(bonds.begin(), bonds.end(),
            [](const Crossing& a, const Crossing& b) { return a.opening < b.opening; });
  const auto energy = [&](std::size_t first_alive) {  // at Δ = 1
    double sum = 0;
    for (std::size_t b = first_alive; b < bonds.size(); ++b)
      sum += 4 / n0 * bonds[b].rows * bonds[b].weight / bonds[b].r2;
    for (int row = 0; row < reach; ++row) {
      double trace = 0;
      for (std::size_t b = first_alive; b < bonds.size(); ++b)
        if (bonds[b].rows > row) trace += 2 / n0 * bonds[b].weight * bonds[b].rows / bonds[b].r2;
      sum += lambda_over_mu * trace * trace;  // ½ λ tr² on both sides
    }
    return sum;
  };
  double released = 0;
  for (std::size_t b = 0; b < bonds.size(); ++b)
    released += (energy(b) - energy(b + 1)) * bonds[b].opening * bonds[b].opening;
  return released;
}

CrackBand crack_band(int dimension, double radius, double hourglass) {
  const int reach = static_cast<int>(std::floor(radius)), deep = dimension == 3 ? reach : 0;
  double a = 0;
  std::vector<double> weight(static_cast<std::size_t>(reach), 0), moment = weight;  // Σ_{Δx>q} w⁰, w⁰ Δx
  for (int dx = -reach; dx <= reach; ++dx)
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dz = -deep; dz <= deep; ++dz) {
        const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
        if (!(r > 0 && r < radius)) continue;
        const double w = radius / r - 1;
        a += w * dx * dx;
        for (int q = 0; q < dx; ++q) {
          weight[static_cast<std::size_t>(q)] += w;
          moment[static_cast<std::size_t>(q)] += w * dx;
        }
      }
  const auto y = [&](std::size_t q) {
    const double h = moment[q] / a;
    return std::sqrt(0.5 * h * h + 0.25 * hourglass / a * (weight[q] - a * h * h));
  };
  double rows = 0;
  for (std::size_t q = 0; q < weight.size(); ++q) rows += y(q) / y(0) * (2 - y(q) / y(0));
  return {.width = 2 * rows, .opening = 1 / y(0)};
}

template <int dim>
Failure<dim>::Failure(const FailureKeys& keys, double hourglass, const Lattice<dim>& lattice,
                      Bonds<dim>& bonds)
    : keys_(keys),
      hourglass_(hourglass),
      band_(crack_band(dim, bonds.radius, hourglass).width * lattice.spacing),
      opening_(crack_band(dim, bonds.radius, hourglass).opening * lattice.spacing),
      lattice_(lattice),
      bonds_(bonds),
      weight_(bonds.weight),
      partner_(bonds.neighbour.size()) {
  for (const Part& part : lattice.parts)
    crack_constant_.push_back(
        crack_constant(bonds.radius, part.material.lame_lambda() / part.material.lame_mu()));
  for (Eigen::Index i = 0; i < bonds.size(); ++i)
    for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b) {
      const Eigen::Index j = bonds.to(b);
      const auto row = bonds.neighbour.begin();  // each row ascends, as particles are numbered
      partner_[static_cast<std::size_t>(b)] =
          std::lower_bound(row + bonds.first(j), row + bonds.end(j), i) - row;
    }
}

template <int dim>
typename Failure<dim>::State Failure<dim>::intact() const {
  State state;
  state.broken.assign(partner_.size(), 0);
  if (keys_.criterion != FailureCriterion::bond_strain)
    state.onset = state.peak = Eigen::VectorXd::Zero(bonds_.size());
  return state;
}

template <int dim>
double Failure<dim>::last(double onset) const {
  return keys_.fracture_energy / (band_ * onset);
}

template <int dim>
double Failure<dim>::softening(Eigen::Index i, const State& state) const {
  return 1 - integrity_after(state.onset[i], state.peak[i], state.onset[i] == 0 ? 0 : last(state.onset[i]));
}

//   Y = ψ(F) + ½ α E (dim/2)/(Σ w⁰|r⁰|²) Σ_j w⁰ |e_ij|²,   e_ij = u_ij − H r⁰_ij
template <int dim>
double Failure<dim>::undamaged_energy(Eigen::Index i, const Eigen::Matrix<double, dim, dim>& H,
                                      const Vectors<dim>& u) const {
  const Material& material = lattice_.material(i);
  double residual = 0;
  for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b)
    residual += bonds_.weight[b] * (u.col(bonds_.to(b)) - u.col(i) - H * bonds_.r0.col(b)).squaredNorm();
  return energy_density<dim>(material, Eigen::Matrix<double, dim, dim>::Identity() + H) +
         0.5 * hourglass_ * material.young * bonds_.inverse_moment[i] * residual;
}

template <int dim>
double Failure<dim>::critical_strain(Eigen::Index i, Eigen::Index bond, const State& state) const {
  const Eigen::Index j = bonds_.to(bond);
  const double infinity = std::numeric_limits<double>::infinity();
  if (keys_.criterion != FailureCriterion::bond_strain) {
    const auto limit = [&](Eigen::Index k) {
      if (state.onset[k] == 0) return infinity;
      const double y = last(state.onset[k]) / std::sqrt(uniaxial_modulus(lattice_.material(k), dim));
      const double whole_row = y * opening_ / bonds_.r0.col(bond).norm();
      return softening(k, state) < 1 ? whole_row : std::min(whole_row, std::sqrt(0.5) * y);
    };
    return std::min(limit(i), limit(j));
  }
  if (keys_.critical_strain > 0) return keys_.critical_strain;
  const auto of_part = [&](Eigen::Index k) {
    const double mu = lattice_.material(k).lame_mu();
    return std::sqrt(keys_.fracture_energy /
                     (crack_constant_[static_cast<std::size_t>(lattice_.part[static_cast<std::size_t>(k)])] *
                      mu * lattice_.spacing));
  };
  return lattice_.part[static_cast<std::size_t>(i)] == lattice_.part[static_cast<std::size_t>(j)]
             ? of_part(i)
             : 0.5 * (of_part(i) + of_part(j));
}

template <int dim>
bool Failure<dim>::soften(const Vectors<dim>& u, State& state) const {
  using Matrix = Eigen::Matrix<double, dim, dim>;
  const Eigen::Index n = bonds_.size();
  const Tensors<dim> gradient = displacement_gradient<dim>(bonds_, u);
  bool more = false;
#pragma omp parallel for schedule(static) reduction(|| : more) if (n >= parallel_from)
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!lattice_.inside[static_cast<std::size_t>(i)]) continue;
    const Matrix H = Eigen::Map<const Matrix>(gradient.col(i).data());
    if (state.onset[i] == 0) {
      const double stress = equivalent_stress(
          keys_.criterion, cauchy_stress<dim>(lattice_.material(i), Matrix::Identity() + H));
      if (!(stress > keys_.strength)) continue;
      state.onset[i] = state.peak[i] = std::sqrt(undamaged_energy(i, H, u));
    } else {
      const double y = std::sqrt(undamaged_energy(i, H, u));
      if (!(y > state.peak[i])) continue;
      state.peak[i] = y;
    }
    more = true;
  }
  return more;
}

template <int dim>
bool Failure<dim>::snap(const Vectors<dim>& u, State& state) const {
  std::int64_t broken = 0;
#pragma omp parallel for schedule(static) reduction(+ : broken) if (bonds_.size() >= parallel_from)
  for (Eigen::Index i = 0; i < bonds_.size(); ++i)
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      const auto k = static_cast<std::size_t>(b);
      const Eigen::Index j = bonds_.to(b);
      if (j < i || state.broken[k]) continue;  // the lower one counts for both
      const double length = bonds_.r0.col(b).norm();
      const double strain = (bonds_.r0.col(b) + u.col(j) - u.col(i)).norm() / length - 1;
      if (!(strain > critical_strain(i, b, state))) continue;
      state.broken[k] = state.broken[static_cast<std::size_t>(partner_[k])] = 1;
      ++broken;
    }
  state.bonds += broken;
  return broken > 0;
}

template <int dim>
bool Failure<dim>::look(const Vectors<dim>& u, double time, State& state) const {
  const bool softer = keys_.criterion != FailureCriterion::bond_strain && soften(u, state);
  const bool broken = snap(u, state);
  if (broken || (softer && !state.record.start.happened())) note(time, state);
  return broken || softer;
}

template <int dim>
void Failure<dim>::note(double time, State& state) const {
  FailureRecord& record = state.record;
  for (Eigen::Index i = 0; i < state.onset.size() && !record.start.happened(); ++i)
    if (state.onset[i] > 0) record.start = {time, lattice_.place(i)};
  if (state.bonds == 0 || record.parted.happened()) return;
  Pieces pieces(bonds_.size());
  const auto broken = [&](Eigen::Index b) { return state.broken[static_cast<std::size_t>(b)] != 0; };
  for (Eigen::Index i = 0; i < bonds_.size(); ++i)
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      if (broken(b) && !record.crack.happened())
        record.crack = {time, 0.5 * (lattice_.place(i) + lattice_.place(bonds_.to(b)))};
      if (!broken(b)) pieces.join(i, bonds_.to(b));
    }
  if (!record.start.happened()) record.start = record.crack;
  const std::vector<Eigen::Index> piece = pieces.large();
  if (!Pieces::more_than_one(piece)) return;
  Joint joint;
  for (Eigen::Index i = 0; i < bonds_.size(); ++i)
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b)
      joint.add(piece[static_cast<std::size_t>(i)], piece[static_cast<std::size_t>(bonds_.to(b))],
                lattice_.place(i));
  record.parted = {time, joint.middle_or(record.crack.at)};
}

template <int dim>
void Failure<dim>::apply(const State& state) {
#pragma omp parallel for schedule(static) if (bonds_.size() >= parallel_from)
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b)
      bonds_.weight[b] = state.broken[static_cast<std::size_t>(b)] ? 0 : weight_[b];
    find_shape<dim>(bonds_, i);
    if (state.peak.size() > 0) bonds_.integrity[i] = 1 - softening(i, state);
  }
}

template <int dim>
Eigen::RowVectorXd Failure<dim>::damage(const State& state) const {
  Eigen::RowVectorXd damage(bonds_.size());
  for (Eigen::Index i = 0; i < bonds_.size(); ++i) {
    double all = 0, alive = 0;
    for (Eigen::Index b = bonds_.first(i); b < bonds_.end(i); ++b) {
      all += weight_[b];
      if (!state.broken[static_cast<std::size_t>(b)]) alive += weight_[b];
    }
    const double softened = state.peak.size() > 0 ? softening(i, state) : 0;
    damage[i] = 1 - (1 - softened) * alive / all;
  }
  return damage;
}

template <int dim>
std::vector<std::string> Failure<dim>::lines(bool surface_coupling) const {
  std::vector<std::string> lines;
  if (keys_.criterion == FailureCriterion::bond_strain) {
    const std::string by = keys_.critical_strain > 0
                               ? fmt::format("a strain of {:.4g}", keys_.critical_strain)
                               : fmt::format("what takes G_c = {:.4g} J/m^2 of a crack drawn straight open",
                                             keys_.fracture_energy);
    lines.push_back("failure by bond strain: a bond breaks for good at " + by);
  } else {
    lines.push_back(
        fmt::format("failure by {} of {:.4g} Pa, then softening along a line that dissipates G_c = {:.4g} "
                    "J/m^2 in a band of "
                    "{:.4g} mm",
                    keys_.criterion == FailureCriterion::max_principal ? "a largest principal stress"
                                                                       : "a von Mises stress",
                    keys_.strength, keys_.fracture_energy, 1e3 * band_));
  }
  lines.push_back(
      keys_.criterion == FailureCriterion::bond_strain
          ? "failure is elastic and brittle: bonds take their own and their volumetric energy with "
            "them, what a body holds beyond G_c rings on"
          : "failure is elastic and softening, over the reach of the bonds");
  lines.push_back(
      "failure has no plastic flow, no contact between the faces of a crack, and paths that follow the "
      "lattice; no mass is lost");
  lines.push_back(surface_coupling
                      ? "the wet surface stays closed over a crack: the faces of a crack are not wetted"
                      : "water sees the particles themselves, those at the faces of a crack too");
  return lines;
}

template class Failure<2>;
template class Failure<3>;

}  // namespace strake::structure
