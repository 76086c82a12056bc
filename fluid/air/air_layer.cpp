#include "fluid/air/air_layer.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

constexpr double courant = 0.45;  // of the flow's own steps; Heun's method needs less than 1
constexpr double fastest = 3;     // |u| of a column over c0: choked air reaches 0.91

/// Van Leer's slope of two differences: harmonic mean where they agree in sign, else 0.
double van_leer(double a, double b) {
  return a * b > 0 ? 2 * a * b / (a + b) : 0;
}

/// M⁺ of a sum of r⊗r/r². M of one direction n alone, M = λ n⊗n with λ = tr M: M/λ².
template <int plane>
Eigen::Matrix<double, plane, plane> pseudo_inverse(const Eigen::Matrix<double, plane, plane>& moment) {
  const double trace = moment.trace();
  if (!(trace > 0)) return Eigen::Matrix<double, plane, plane>::Zero();
  if (plane > 1 && moment.determinant() < 1e-9 * trace * trace) return moment / (trace * trace);
  return moment.inverse();
}

}  // namespace

double AirProperties::sound_speed() const {
  return std::sqrt(gamma * pressure / density);
}
double AirProperties::pressure_of(double mass, double gap) const {
  return pressure * std::pow(mass / (density * gap), gamma);
}
// ½ m u² + e, e = ∫ from h0 to h of (p0 − p) dh at constant m, h0 = m/ρ0: p h/(γ−1) + p0 h − γ/(γ−1) p0 h0
// (F83).
double AirProperties::energy_of(double mass, double gap, double speed_squared) const {
  const double g = gamma - 1, at_rest = mass / density;
  return 0.5 * mass * speed_squared + pressure_of(mass, gap) * gap / g +
         pressure * (gap - gamma / g * at_rest);
}
double AirProperties::sound_speed_of(double rho) const {
  return sound_speed() * std::pow(rho / density, 0.5 * (gamma - 1));
}

// f(h) = h − h* − C (p(m, h) − p0) rises and is concave: Newton steps from the left of its root come up to
// it.
double AirProperties::gap_of(double mass, double free_gap, double compliance) const {
  const auto value = [&](double h) { return h - free_gap - compliance * (pressure_of(mass, h) - pressure); };
  double h = mass / density;  // p = p0
  while (value(h) > 0) h *= 0.5;
  for (int step = 0; step < 100; ++step) {
    const double slope = 1 + compliance * gamma * pressure_of(mass, h) / h;
    const double change = -value(h) / slope;
    h += change;
    if (change <= 1e-14 * h) break;
  }
  return h;
}

template <int plane>
AirLayer<plane>::AirLayer(const AirProperties& air, AirColumns<plane> columns)
    : air_(air), columns_(std::move(columns)) {
  const int n = columns_.size();
  inverse_moments_.assign(static_cast<std::size_t>(n), Eigen::Matrix<double, plane, plane>::Zero());
  width_.setConstant(n, std::numeric_limits<double>::infinity());
  for (const auto& side : columns_.sides) {
    const double across =
        side.other < 0
            ? 2 * std::abs(side.normal.dot(side.middle - columns_.place.col(side.column)))
            : std::abs(side.normal.dot(columns_.place.col(side.other) - columns_.place.col(side.column)));
    width_[side.column] = std::min(width_[side.column], across);
    if (side.other < 0) continue;
    width_[side.other] = std::min(width_[side.other], across);
    const Place arm = columns_.place.col(side.other) - columns_.place.col(side.column);
    for (const int i : {side.column, side.other})
      inverse_moments_[static_cast<std::size_t>(i)] += arm * arm.transpose() / arm.squaredNorm();
  }
  for (auto& moment : inverse_moments_) moment = pseudo_inverse(moment);
}

template <int plane>
double AirLayer<plane>::pressure_at(double density) const {
  return air_.pressure * std::pow(density / air_.density, air_.gamma);
}

template <int plane>
Eigen::VectorXd AirLayer<plane>::pressure(const AirState<plane>& state) const {
  Eigen::VectorXd p(columns_.size());
  for (int i = 0; i < columns_.size(); ++i)
    p[i] = state.mass[i] > 0 ? air_.pressure_of(state.mass[i], state.gap[i]) : air_.pressure;
  return p;
}

template <int plane>
double AirLayer<plane>::energy(const AirState<plane>& state) const {
  double sum = 0;
  for (int i = 0; i < columns_.size(); ++i) {
    const double m = state.mass[i];
    if (!(m > 0)) continue;
    sum += columns_.area[i] * air_.energy_of(m, state.gap[i], (state.momentum.col(i) / m).squaredNorm());
  }
  return sum;
}

// g_i = [Σ r⊗r/r²]⁻¹ Σ r (v_j − v_i)/r² over the neighbours.
template <int plane>
auto AirLayer<plane>::gradient(const Eigen::VectorXd& values, const Eigen::VectorXd& mass) const -> Field {
  Field g = Field::Zero(plane, columns_.size());
  for (const auto& side : columns_.sides) {
    if (!joins(side, mass)) continue;
    const Place arm = columns_.place.col(side.other) - columns_.place.col(side.column);
    const Place part = arm * ((values[side.other] - values[side.column]) / arm.squaredNorm());
    g.col(side.column) += part;
    g.col(side.other) += part;
  }
  for (int i = 0; i < columns_.size(); ++i)
    g.col(i) = inverse_moments_[static_cast<std::size_t>(i)] * g.col(i);
  return g;
}

// Harten, Lax and van Leer 1983, with the slowest and fastest sound of both sides.
template <int plane>
auto AirLayer<plane>::hll(const Gas& left, const Gas& right, const Place& normal) const -> Flux {
  const auto flux = [&](const Gas& gas) {
    const double through = gas.density * gas.velocity.dot(normal);
    return Flux{through, through * gas.velocity + pressure_at(gas.density) * normal};
  };
  const double ul = left.velocity.dot(normal), ur = right.velocity.dot(normal);
  const double cl = air_.sound_speed_of(left.density), cr = air_.sound_speed_of(right.density);
  const double slow = std::min(ul - cl, ur - cr), fast = std::max(ul + cl, ur + cr);
  if (slow >= 0) return flux(left);
  if (fast <= 0) return flux(right);
  const Flux a = flux(left), b = flux(right);
  const double scale = 1 / (fast - slow);
  return {scale * (fast * a.mass - slow * b.mass + fast * slow * (right.density - left.density)),
          scale * (fast * a.momentum - slow * b.momentum +
                   fast * slow * (right.density * right.velocity - left.density * left.velocity))};
}

// The gas at the border (F80), from J = u + 2c/(γ−1) of the last column. Outflow: ρ0, u = J − 2c0/(γ−1), at
// most the speed of sound, which is then c = (γ−1)/(γ+1) J. Inflow: from the open air at rest, u²/2 +
// c²/(γ−1) = c0²/(γ−1).
template <int plane>
auto AirLayer<plane>::open_air(const Gas& last, const Place& normal) const -> Gas {
  const double g = air_.gamma - 1, c0 = air_.sound_speed();
  const double along = last.velocity.dot(normal), J = along + 2 * air_.sound_speed_of(last.density) / g;
  const auto density_at = [&](double c) { return air_.density * std::pow(c / c0, 2 / g); };
  double u = J - 2 * c0 / g, c = c0;
  if (u > c0) {
    u = c = g / (g + 2) * J;
  } else if (u < 0) {
    // c from J − 2c/g = u and u² + 2c²/g = 2c0²/g: (4/g² + 2/g) c² − (4J/g) c + J² − 2c0²/g = 0, the larger
    // root.
    const double a = 4 / (g * g) + 2 / g, half = 2 * J / g, rest = J * J - 2 * c0 * c0 / g;
    c = (half + std::sqrt(std::max(0.0, half * half - a * rest))) / a;
    const double slowest = c0 * std::sqrt(2 / (g + 2));  // where u = −c
    c = std::clamp(c, slowest, c0);
    u = c > slowest ? std::min(0.0, J - 2 * c / g) : -c;
    return {density_at(c), u * normal};
  }
  return {density_at(c), last.velocity + (u - along) * normal};
}

// u²/2 + (c² − c0²)/(γ−1), of what has left.
template <int plane>
double AirLayer<plane>::energy_over_open_air(const Gas& gas) const {
  const double c = air_.sound_speed_of(gas.density), c0 = air_.sound_speed();
  return 0.5 * gas.velocity.squaredNorm() + (c * c - c0 * c0) / (air_.gamma - 1);
}

// From the gas at the border. On air that is thinner than the open air and leaves faster than sound, the open
// air acts through a shock alone: the flux is that of a side between the two.
template <int plane>
auto AirLayer<plane>::border_flux(const Gas& last, const Place& normal, double outward) const -> Flux {
  const double along = outward * last.velocity.dot(normal);
  if (last.density < air_.density && along > air_.sound_speed_of(last.density)) {
    const Gas open{air_.density};
    Flux flux = outward > 0 ? hll(last, open, normal) : hll(open, last, normal);
    flux.energy = outward * flux.mass > 0 ? flux.mass * energy_over_open_air(last) : 0;
    return flux;
  }
  const Gas gas = open_air(last, outward * normal);
  const double through = gas.density * gas.velocity.dot(normal);
  return {through, through * gas.velocity + pressure_at(gas.density) * normal,
          through * energy_over_open_air(gas)};
}

// Fluxes of all sides, from values on both sides of each; on a line the limited value is van Leer's.
template <int plane>
auto AirLayer<plane>::side_flows(const Eigen::VectorXd& mass, const Field& momentum,
                                 const Eigen::VectorXd& gap, const std::vector<std::uint8_t>& vents) const
    -> SideFlows {
  const int n = columns_.size();
  SideFlows flows;
  flows.velocity.resize(plane, n);
  flows.velocity.setZero();
  for (int i = 0; i < n; ++i)
    if (mass[i] > 0) flows.velocity.col(i) = momentum.col(i) / mass[i];
  flows.leaving.setZero(n);
  const Eigen::VectorXd density = mass.cwiseQuotient(gap);
  const Field density_slope = gradient(density, mass);
  Field velocity_slope[plane];
  for (int k = 0; k < plane; ++k) velocity_slope[k] = gradient(flows.velocity.row(k).transpose(), mass);
  const auto at_side = [](const Place& slope, double here, double there, const Place& arm) {
    return here + 0.5 * van_leer(there - here, 2 * slope.dot(arm) - (there - here));
  };
  const auto gas_of = [&](int i, int j, const Place& arm) {
    Gas gas{at_side(density_slope.col(i), density[i], density[j], arm)};
    for (int k = 0; k < plane; ++k)
      gas.velocity[k] = at_side(velocity_slope[k].col(i), flows.velocity(k, i), flows.velocity(k, j), arm);
    return gas;
  };
  for (const auto& side : columns_.sides) {
    const int i = side.column, j = side.other;
    Flux flux;
    double h = 0;  // 0: a wall, whose pressure is that of the column
    if (joins(side, mass)) {
      const Place arm = columns_.place.col(j) - columns_.place.col(i);
      flux = hll(gas_of(i, j, arm), gas_of(j, i, -arm), side.normal);
      h = std::min(gap[i], gap[j]);
    } else if (const int last = outlet(side, mass, vents); last >= 0) {
      flux = border_flux({density[last], flows.velocity.col(last)}, side.normal, last == i ? 1 : -1);
      h = gap[last];
    }
    if (flux.mass > 0) flows.leaving[i] += side.length * h * flux.mass;
    if (flux.mass < 0 && j >= 0) flows.leaving[j] -= side.length * h * flux.mass;
    flows.flux.push_back(flux);
    flows.gap.push_back(h);
  }
  return flows;
}

// Sums the fluxes. p_i h n of each side balances the pressure at rest: together they are −h ∇p. A column
// keeps the film: what leaves it is scaled.
template <int plane>
auto AirLayer<plane>::rates(const Eigen::VectorXd& mass, const Field& momentum, const Eigen::VectorXd& gap,
                            const std::vector<std::uint8_t>& vents, double dt) const -> Rates {
  const int n = columns_.size();
  const SideFlows flows = side_flows(mass, momentum, gap, vents);
  Eigen::VectorXd share(n), p(n);
  for (int i = 0; i < n; ++i) {
    p[i] = mass[i] > 0 ? pressure_at(mass[i] / gap[i]) : air_.pressure;
    const double spare = std::max(0.0, mass[i] - air_.density * air_.film) * columns_.area[i];
    share[i] = flows.leaving[i] * dt > spare ? spare / (flows.leaving[i] * dt) : 1;
  }
  Rates rates{Eigen::VectorXd::Zero(n), Field::Zero(plane, n)};
  for (std::size_t s = 0; s < flows.flux.size(); ++s) {
    const auto& side = columns_.sides[s];
    const Flux& flux = flows.flux[s];
    const int i = side.column, j = side.other;
    const auto has_air = [&](int k) { return k >= 0 && mass[k] > 0; };
    const int upwind = flux.mass > 0 ? i : j, donor = has_air(upwind) ? upwind : -1;
    const double area = side.length * flows.gap[s], scale = donor < 0 ? 1 : share[donor];
    const double through = area * scale * flux.mass;
    // What the mass does not carry is the pressure of the side.
    Place carried = Place::Zero();
    if (donor >= 0) carried = flux.mass * flows.velocity.col(donor);
    const Place whole = area * (flux.momentum - (1 - scale) * carried);
    for (const auto& [k, sign] : {std::pair{i, 1.0}, std::pair{j, -1.0}}) {
      if (has_air(k)) {
        rates.mass[k] -= sign * through;
        rates.momentum.col(k) -= sign * (whole - area * p[k] * side.normal);
      } else {
        rates.out -= sign * through;
        rates.energy_out -= sign * area * scale * flux.energy;
      }
    }
  }
  rates.mass.array() /= columns_.area.array();
  for (int i = 0; i < n; ++i) rates.momentum.col(i) /= columns_.area[i];
  return rates;
}

// q' = q/(1 + Δt (λ/4)|u|/h), λ|u| = max(48 µ/(ρh), 0.316 |u| Re^(−1/4)), Re = 2h|u|ρ/µ (F79).
template <int plane>
void AirLayer<plane>::brake(AirState<plane>& state, double dt) const {
  for (int i = 0; i < columns_.size(); ++i) {
    const double h = state.gap[i], m = state.mass[i];
    if (!(m > 0)) continue;
    const double before = state.momentum.col(i).squaredNorm();
    if (air_.friction) {
      const double speed = state.momentum.col(i).norm() / m, reynolds = 2 * m * speed / air_.viscosity;
      const double laminar = 48 * air_.viscosity / m;
      const double turbulent = reynolds > 0 ? 0.316 * speed * std::pow(reynolds, -0.25) : 0;
      state.momentum.col(i) /= 1 + dt * 0.25 * std::max(laminar, turbulent) / h;
    }
    const double speed = state.momentum.col(i).norm() / m, most = fastest * air_.sound_speed();
    if (speed > most) state.momentum.col(i) *= most / speed;
    state.energy_out += 0.5 * columns_.area[i] * (before - state.momentum.col(i).squaredNorm()) / m;
  }
}

template <int plane>
double AirLayer<plane>::stable_step(const AirState<plane>& state) const {
  double step = std::numeric_limits<double>::infinity();
  for (int i = 0; i < columns_.size(); ++i) {
    if (!(state.mass[i] > 0)) continue;
    const double c = air_.sound_speed_of(state.mass[i] / state.gap[i]);
    step = std::min(step, courant * width_[i] / (state.momentum.col(i).norm() / state.mass[i] + c));
  }
  return step;
}

template <int plane>
void AirLayer<plane>::advance(AirState<plane>& state, const Eigen::VectorXd& gap_end, double dt) const {
  assert(state.mass.size() == columns_.size() && gap_end.size() == columns_.size() && gap_end.minCoeff() > 0);
  double left = dt;
  while (left > 0) {
    const double stable = stable_step(state);
    const double step = left <= stable * (1 + 1e-9) ? left : left / std::ceil(left / stable);
    const Eigen::VectorXd middle = state.gap + (0.5 * step / left) * (gap_end - state.gap);
    const Rates first = rates(state.mass, state.momentum, middle, state.vents, step);
    const Eigen::VectorXd mass = state.mass + step * first.mass;
    const Field momentum = state.momentum + step * first.momentum;
    const Rates second = rates(mass, momentum, middle, state.vents, step);
    state.mass += 0.5 * step * (first.mass + second.mass);
    state.momentum += 0.5 * step * (first.momentum + second.momentum);
    state.mass_out += 0.5 * step * (first.out + second.out);
    state.energy_out += 0.5 * step * (first.energy_out + second.energy_out);
    state.gap += (step / left) * (gap_end - state.gap);
    brake(state, step);
    left -= step;
    if (left < 1e-12 * dt) break;
  }
  state.gap = gap_end;
}

// ∇·(h∇ψ) = −V, ψ = 0 at the border, u = −∇ψ. Where the gap closes evenly ψ ~ 1/h, and Bernoulli's law from
// the border, where p0 reigns, gives p − p0 = ρ [ψ V/h + (u_b² − u²)/2].
template <int plane>
AirState<plane> AirLayer<plane>::start(const Eigen::VectorXd& gap, const Eigen::VectorXd& speed) const {
  const int n = columns_.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& side : columns_.sides) {
    const int i = side.column, j = side.other;
    const Place to = j < 0 ? side.middle : Place(columns_.place.col(j));
    const double h = j < 0 ? gap[i] : std::min(gap[i], gap[j]);
    const double flow =
        side.length * h / std::max(1e-12, std::abs(side.normal.dot(to - columns_.place.col(i))));
    entries.emplace_back(i, i, flow);
    if (j < 0) continue;
    entries.emplace_back(j, j, flow);
    entries.emplace_back(i, j, -flow);
    entries.emplace_back(j, i, -flow);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
  const Eigen::VectorXd psi = factors.solve(speed.cwiseProduct(columns_.area));

  // u of a column: A u = Σ flux of its sides (x_side − x), the momentum of the fluxes through them.
  Field velocity = Field::Zero(plane, n);
  double edge_square = 0, edge_flow = 0;
  for (const auto& side : columns_.sides) {
    const int i = side.column, j = side.other;
    const Place to = j < 0 ? side.middle : Place(columns_.place.col(j));
    const double through = (psi[i] - (j < 0 ? 0 : psi[j])) /
                           std::max(1e-12, std::abs(side.normal.dot(to - columns_.place.col(i))));
    velocity.col(i) += side.length * through * (side.middle - columns_.place.col(i));
    if (j >= 0) velocity.col(j) -= side.length * through * (side.middle - columns_.place.col(j));
    if (j < 0) {
      edge_square += side.length * std::abs(through) * through * through;
      edge_flow += side.length * std::abs(through);
    }
  }
  AirState<plane> state{Eigen::VectorXd(n), Field(plane, n), gap, {}};
  const double edge = edge_flow > 0 ? edge_square / edge_flow : 0;
  for (int i = 0; i < n; ++i) {
    const Place u = velocity.col(i) / columns_.area[i];
    const double rise = air_.density * (psi[i] * speed[i] / gap[i] + 0.5 * (edge - u.squaredNorm()));
    const double density = air_.density * std::pow(1 + std::max(-0.5, rise / air_.pressure), 1 / air_.gamma);
    state.mass[i] = density * gap[i];
    state.momentum.col(i) = state.mass[i] * u;
  }
  return state;
}

template class AirLayer<1>;
template class AirLayer<2>;

}  // namespace strake::fluid
