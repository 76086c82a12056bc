#pragma once

#include "proto/probe.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace strake::fluid {

template <int dim>
using Vector = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Vectors = Eigen::Matrix<double, dim, Eigen::Dynamic>;  // dim×n

enum class Kind : std::uint8_t {
  fluid,            // water
  wall,             // tank row that carries its own pressure unknown
  dummy_wall,       // rows behind it: fill the number density, no unknown
  interface,        // first row inside the body's face: pressure unknown
  dummy_interface,  // rows behind it
  solid,            // volume coupling: a structure particle
};
inline bool has_pressure(Kind kind) {
  return kind == Kind::fluid || kind == Kind::wall || kind == Kind::interface || kind == Kind::solid;
}

/// Everything of the fluid that changes in time: rewind is an assignment, a checkpoint is this struct on
/// disk.
template <int dim>
struct State {
  double time = 0;                      // [s]
  std::int64_t step = 0;                // steps taken
  Vectors<dim> position;                // dim×n [m]
  Vectors<dim> velocity;                // dim×n [m/s]
  Eigen::VectorXd pressure;             // n [Pa]
  Eigen::VectorXd residual_divergence;  // n [1/s] that the projection of the last step left (least-squares)
  Vectors<dim> residual_approach;       // dim×n [m/s] of the water past the walls it touches, left likewise
  double residual_step = 0;             // [s] length of the steps whose moves the velocity has not followed
  Eigen::VectorXd sps_k;         // n [m²/s²] sub-particle-scale energy (k model); static model: last value
  std::vector<Kind> kind;        // n
  std::vector<std::int64_t> id;  // n, identity of a particle whatever its place
  std::vector<std::uint8_t> surface;  // n, free-surface flag of the last step (hysteresis)
  std::vector<std::uint8_t> aired;    // n, of surface water: beside air that came from outside (voids.hpp)

  Vectors<dim> interface_displacement;  // dim×m [m] committed motion of the interface points
  Vectors<dim> interface_velocity;      // dim×m [m/s]

  std::vector<ProbeRecord> probes;                      // accumulate at every step
  double contact_time = -1;                             // [s] t_c (proto/probe.hpp); < 0: none yet
  Vector<dim> impulse_on_bodies = Vector<dim>::Zero();  // [N s] momentum account, since t = 0
  Vector<dim> impulse_on_walls = Vector<dim>::Zero();
  Vector<dim> impulse_of_gravity = Vector<dim>::Zero();
  Vector<dim> impulse_of_collisions =
      Vector<dim>::Zero();  // ΣJ of the anti-penetration step (fluid/THEORY.md (F54)–(F56))
  Vector<dim> initial_momentum = Vector<dim>::Zero();  // of the water at t = 0
  double inner_fraction_min = 1;                       // smallest share of fluid particles not on the surface
  std::int64_t lost = 0;                               // particles that left the domain
  std::int64_t voids = 0;         // largest count of surface particles deeper than 5 l0, of the frames
  std::int64_t openings = 0;      // the same of those that are not aired
  std::int64_t penetrations = 0;  // largest count of fluid particles inside a body's outline
  std::int64_t behind_walls = 0;  // times that water was put back from behind a wall of the tank
};

}  // namespace strake::fluid
