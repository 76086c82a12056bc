#include "structure/particle/solver.hpp"

// How a particle solver steps: leapfrog of the particles and of the frame that their supports stand in.

namespace strake::structure {

/// Mass of what moves with the frame, along each axis: infinite where its motion is prescribed.
template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::frame_mass() const {
  Vector mass = Vector::Constant(std::numeric_limits<double>::infinity());
  for (int axis = 0; axis < dim; ++axis)
    if (frame_.is_free(axis)) mass[axis] = frame_.mass() + fixed_mass_;
  return mass;
}

// Leapfrog (velocity Verlet), second order and symplectic. The external force is constant over the step; c is
// the mass-proportional damping of the motion relative to the supports:
//   v_½ = v + ½h (f(u)/m + a),  u⁺ = u + h v_½,  v⁺ = v_½ + ½h (f(u⁺)/m + a)
// A free frame moves in the same way. Its mass is M and that of the fixed particles; their forces and the
// drag's reaction act on it. Supports that are equations between particles keep them after each half
// (RATTLE).
//
// The work of the loads is f_ext·(u⁺ − u). Along an axis whose motion is prescribed, the supports' force on
// the fixed particles, of mass m_f, is m_f dV/dt − (f + f_ext). Its work and that of the loads sum to
//   Δ½m_f V² − ½(f(u) + f(u⁺))·(u⁺ − u).
template <int dim>
void ParticleSolver<dim>::sub_step(double h, const Vectors<dim>& external, const Vector& gravity) {
  const Eigen::Index n = lattice_.size();
  const Vector mass = frame_mass();
  const FrameState old = state_.frame, told = frame_.prescribed(state_.time + h);
  const Vector D = old.displacement.template head<dim>(), V0 = old.velocity.template head<dim>();

  // 1. Half a kick, and the move.
  const Vector first_drag = kick(h, external, V0, true);
  const Vector first_pull = pull_on_frame(external, gravity);
  Vector V = V0;
  for (int axis = 0; axis < dim; ++axis)
    V[axis] = frame_.is_free(axis) ? V[axis] + (0.5 * h * first_pull[axis] + first_drag[axis]) / mass[axis]
                                   : (told.displacement[axis] - D[axis]) / h;
  const auto gap = constraints_.gap(state_.displacement, D);
  Vector impulse = constraints_.project(state_.velocity, V, &gap, h);
  state_.frame.angle = told.angle;
  state_.frame.angular_velocity = told.angular_velocity;
  Vector way = h * V;
  for (int axis = 0; axis < dim; ++axis) {
    double& place = state_.frame.displacement[axis];
    place = frame_.is_free(axis) ? D[axis] + way[axis] : told.displacement[axis];
    way[axis] = place - D[axis];
  }
  Vectors<dim> moved(dim, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)])
      moved.col(i) = held_place(state_.frame, i) - state_.displacement.col(i);
    else
      moved.col(i) = h * state_.velocity.col(i);
  }
  state_.displacement += moved;
  double work = 0;
  if (model_->spins()) work += turn_half(h, true);
  break_bonds(state_.time + h);
  const Vectors<dim> before = std::move(state_.elastic_force);
  find_elastic_force();

  // 2. Work of loads and supports, and their force on the fixed particles.
  Vector inside = Vector::Zero(), loads = Vector::Zero(), carried = Vector::Zero();
  double turned = 0;  // [J] work of supports that turn
  const double c = parameters_.damping.mass;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) {
      inside += 0.5 * (before.col(i) + state_.elastic_force.col(i));
      loads += external.col(i);
      if (frame_.turns()) {
        const double m = lattice_.inside[static_cast<std::size_t>(i)] ? mass_[i] : 0;
        const Vector before_v = constrained_velocity(old, i), after_v = constrained_velocity(told, i);
        turned += 0.5 * m * (after_v.squaredNorm() - before_v.squaredNorm()) -
                  0.5 * (before.col(i) + state_.elastic_force.col(i)).dot(moved.col(i));
        carried += m * (after_v - before_v);
      }
    } else {
      work += (external.col(i) - c * mass_[i] * (state_.velocity.col(i) - V)).dot(moved.col(i));
    }
  }

  // 3. The other half.
  const Vector second_drag = kick(h, external, V, false);
  const Vector second_pull = pull_on_frame(external, gravity);
  for (int axis = 0; axis < dim; ++axis)
    V[axis] = frame_.is_free(axis) ? V[axis] + (0.5 * h * second_pull[axis] + second_drag[axis]) / mass[axis]
                                   : told.velocity[axis];
  impulse += constraints_.project(state_.velocity, V, nullptr, h);
  for (Eigen::Index i = 0; i < n; ++i)
    if (lattice_.fixed[static_cast<std::size_t>(i)])
      state_.velocity.col(i) = frame_.turns() ? constrained_velocity(told, i) : V;
  state_.frame.velocity.template head<dim>() = V;
  state_.frame.acceleration.template head<dim>() = (V - V0) / h;
  if (model_->spins()) turn_half(h, false);

  work += turned;
  for (int axis = 0; axis < dim; ++axis) {
    const double gained = V[axis] - V0[axis];
    if (frame_.turns()) {
      state_.reaction[axis] = carried[axis] / h - inside[axis] - loads[axis];
    } else if (frame_.is_free(axis)) {
      const double weight = frame_.mass() * gravity[axis];
      work += (loads[axis] + weight + (first_drag[axis] + second_drag[axis]) / h) * way[axis];
      state_.reaction[axis] = weight - frame_.mass() * gained / h;
    } else {
      work += 0.5 * fixed_mass_ * gained * (V[axis] + V0[axis]) - inside[axis] * way[axis] +
              impulse[axis] / h * way[axis];
      state_.reaction[axis] = fixed_mass_ * gained / h - inside[axis] - loads[axis] + impulse[axis] / h;
    }
  }
  state_.external_work += work;
  ++state_.steps;
}

/// Displacement and velocity of a fixed particle.
template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::held_place(const FrameState& frame,
                                                                     Eigen::Index i) const {
  Vector u = frame.displacement.template head<dim>();
  if (!frame_.turns()) return u;
  return u + frame_.turned(frame, lattice_.place(i)).template head<dim>();
}

template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::constrained_velocity(const FrameState& frame,
                                                                               Eigen::Index i) const {
  return (frame.velocity + frame_.turning(frame, lattice_.place(i))).template head<dim>();
}

/// Half a kick of the particles that are not fixed; the drag's impulse on the supports comes back.
template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::kick(double h, const Vectors<dim>& external,
                                                               const Vector& V, bool first) {
  const double c = parameters_.damping.mass;
  Vector reaction = Vector::Zero();
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) continue;
    const Vector gained = 0.5 * h * (state_.elastic_force.col(i) + external.col(i)) / mass_[i];
    const Vector v = state_.velocity.col(i) + gained;
    if (c == 0) {
      state_.velocity.col(i) = v;
      continue;
    }
    const Vector slower = first ? Vector(v - 0.5 * h * c * (state_.velocity.col(i) - V))
                                : Vector(V + (v - V) / (1 + 0.5 * h * c));
    reaction += mass_[i] * (v - slower);
    state_.velocity.col(i) = slower;
  }
  return reaction;
}

/// Forces on what moves with the frame: its fixed particles and the lumped mass.
template <int dim>
typename ParticleSolver<dim>::Vector ParticleSolver<dim>::pull_on_frame(const Vectors<dim>& external,
                                                                        const Vector& gravity) const {
  Vector sum = frame_.mass() * gravity;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i)
    if (lattice_.fixed[static_cast<std::size_t>(i)]) sum += state_.elastic_force.col(i) + external.col(i);
  return sum;
}

// Turns the spins of R2 by half a step, in the same way:
//   ω_½ = ω + ½h (M/I − c ω), θ⁺ = θ + h ω_½
// The second call uses the new torque. Returns the damping's work −c I ω_½ · hω_½.
template <int dim>
double ParticleSolver<dim>::turn_half(double h, bool first) {
  const double c = parameters_.damping.mass;
  double work = 0;
  for (Eigen::Index i = 0; i < lattice_.size(); ++i) {
    if (lattice_.fixed[static_cast<std::size_t>(i)]) continue;  // supports move, they do not turn
    const double a = state_.torque[i] / inertia_[i];
    if (first) {
      state_.spin[i] += 0.5 * h * (a - c * state_.spin[i]);
      state_.turn[i] += h * state_.spin[i];
      work -= c * inertia_[i] * state_.spin[i] * h * state_.spin[i];
    } else {
      state_.spin[i] = (state_.spin[i] + 0.5 * h * a) / (1 + 0.5 * h * c);
    }
  }
  return work;
}

template Eigen::Vector2d ParticleSolver<2>::frame_mass() const;
template Eigen::Vector3d ParticleSolver<3>::frame_mass() const;
template void ParticleSolver<2>::sub_step(double, const Vectors<2>&, const Eigen::Vector2d&);
template void ParticleSolver<3>::sub_step(double, const Vectors<3>&, const Eigen::Vector3d&);

}  // namespace strake::structure
