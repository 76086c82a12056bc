#include "fluid/mps/pressure_equation.hpp"

namespace strake::fluid {

double drift_factor(const Scheme& scheme, double dt) {
  return scheme.tau > 0 ? dt / scheme.tau : scheme.gamma;
}

namespace {

// Returns f of assemble_pressure, times −s ρ.
double right_side(const PressureTerms& terms, const Scheme& scheme, double scale, double gamma,
                  std::int64_t i) {
  const double dt = terms.dt;
  const double stiffness = terms.reference_density * terms.sound_speed * terms.sound_speed;  // ρc² [Pa]
  const double compression = terms.old_pressure[i] / stiffness;                              // pⁿ/(ρc²)
  double f = 0;
  switch (scheme.source) {
    case Source::divergence:
      f = terms.divergence[i] / dt - compression / (dt * dt);
      break;
    case Source::mixed:
      f = (1 - gamma) * terms.divergence[i] / dt - compression / (dt * dt) -
          gamma * (terms.deviation[i] - compression) / (dt * dt);
      break;
  }
  return -scale * terms.reference_density * f;
}

/// Numbers the unknowns, and makes room for a row of each.
void number_unknowns(const Neighbours& neighbours, std::span<const Row> row, PressureSystem& system) {
  auto& own = system.own;
  system.particle.clear();
  own.unknown_of.assign(row.size(), -1);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] != Row::unknown) continue;
    own.unknown_of[i] = static_cast<std::int32_t>(system.particle.size());
    system.particle.push_back(static_cast<std::int32_t>(i));
  }
  own.start.resize(system.particle.size());
  own.stop.resize(system.particle.size());
  own.column.resize(neighbours.column().size());
  own.value.resize(neighbours.column().size());
  system.diagonal.resize(system.size());
  system.right.resize(system.size());
}

}  // namespace

template <int dim>
void assemble_pressure(const Neighbours& neighbours, const PressureTerms& terms, const Scheme& scheme,
                       const LatticeConstants& laplacian, PressureSystem& system) {
  const auto n = static_cast<std::int64_t>(terms.row.size());
  auto& own = system.own;
  number_unknowns(neighbours, terms.row, system);
  const std::int64_t unknowns = system.size();
  const double scale = laplacian.n0 * laplacian.lambda0 / (2.0 * dim);
  const double gamma = drift_factor(scheme, terms.dt);
  const double radius = laplacian.radius, inverse_radius = 1.0 / radius;
  const double c_dt = terms.sound_speed * terms.dt;
  const double rho = terms.reference_density;
  const std::int64_t solids = n - terms.solid_density.size();
  const auto density = [&](std::int64_t i) { return i < solids ? rho : terms.solid_density[i - solids]; };

#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < unknowns; ++k) {
    const std::int64_t i = system.particle[static_cast<std::size_t>(k)];
    const std::int64_t first = neighbours.start()[static_cast<std::size_t>(i)];
    std::int64_t at = first;
    double diagonal = 0;
    const auto columns = neighbours.row(i);
    const auto inverses = neighbours.inverses(i);
    for (std::size_t e = 0; e < columns.size(); ++e) {
      const std::int32_t j = columns[e];
      const Row role = terms.row[static_cast<std::size_t>(j)];
      if (role == Row::none || inverses[e] <= inverse_radius) continue;
      const double between =
          density(i) == rho || density(j) == rho ? 1.0 : 2.0 * rho / (density(i) + density(j));
      const auto w = static_cast<float>((radius * inverses[e] - 1.0) * between);
      diagonal += w;
      if (role == Row::zero) continue;
      own.column[static_cast<std::size_t>(at)] = own.unknown_of[static_cast<std::size_t>(j)];
      own.value[static_cast<std::size_t>(at)] = -w;
      ++at;
    }
    own.start[static_cast<std::size_t>(k)] = first;
    own.stop[static_cast<std::size_t>(k)] = at;
    system.diagonal[k] = diagonal + scale / (c_dt * c_dt);
    system.right[k] = right_side(terms, scheme, scale, gamma, i);
    if (system.diagonal[k] <= 0) {  // no neighbour and no compressibility: the pressure is undetermined
      system.diagonal[k] = 1;
      system.right[k] = 0;
    }
  }
  system.start = own.start;
  system.stop = own.stop;
  system.column = own.column;
  system.value = own.value;
}

template void assemble_pressure<2>(const Neighbours&, const PressureTerms&, const Scheme&,
                                   const LatticeConstants&, PressureSystem&);
template void assemble_pressure<3>(const Neighbours&, const PressureTerms&, const Scheme&,
                                   const LatticeConstants&, PressureSystem&);

}  // namespace strake::fluid
