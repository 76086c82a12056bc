#pragma once

#include "fluid/particles/member_list.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace strake::fluid {

template <int dim>
using Vector = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Vectors = Eigen::Matrix<double, dim, Eigen::Dynamic>;  // dim×n

enum class Kind : std::uint8_t {
  fluid,            // water
  wall,             // first layer of the tank: own pressure, an unknown in the MPS schemes
  dummy_wall,       // layers behind it: fill the number density, no unknown
  interface,        // first layer inside the body's face, likewise
  dummy_interface,  // layers behind it
  solid,            // volume coupling: a structure particle
};
inline bool has_pressure(Kind kind) {
  return kind == Kind::fluid || kind == Kind::wall || kind == Kind::interface || kind == Kind::solid;
}

/// All data of the fluid that change in time. A rewind is an assignment, a checkpoint is this struct on disk.
/// What the participant measures of it is in diagnostics/measurements.hpp.
template <int dim>
struct State {
  double time = 0;           // [s]
  std::int64_t step = 0;     // steps taken
  Vectors<dim> position;     // dim×n [m]
  Vectors<dim> velocity;     // dim×n [m/s]
  Eigen::VectorXd pressure;  // n [Pa]
  Vectors<dim>
      pressure_acceleration;  // dim×n [m/s²] −∇p/ρ of the last step, of water (least-squares, oblique bodies)
  Eigen::VectorXd residual_divergence;  // n [1/s] that the projection of the last step left (least-squares)
  Eigen::VectorXd edge_divergence;      // n [1/s] its part that the ends of a body's faces leave (F94)
  Vectors<dim> residual_wall_velocity;  // dim×n [m/s] of the water past the walls it touches, left likewise
  double residual_step = 0;             // [s] length of the steps whose moves the velocity has not followed
  Eigen::VectorXd sps_k;         // n [m²/s²] sub-particle-scale energy (k model); static model: last value
  std::vector<Kind> kind;        // n
  std::vector<std::int64_t> id;  // n, identity of a particle whatever its place
  std::vector<std::uint8_t> surface;  // n, free-surface flag of the last step (hysteresis)
  Eigen::VectorXd face_lag;           // n [m/s], of water: approach that it may still have to faces newly met
  Eigen::VectorXd face_lag_rate;      // n [m/s²] how fast it falls
  std::vector<std::uint8_t>
      air_connected;  // n, of surface water: beside air that came from outside (voids.hpp)

  Eigen::VectorXd air_mass;              // [kg/m²] of each column of air under a body
  Eigen::VectorXd air_momentum;          // [kg/(m s)] column by column
  Eigen::VectorXd air_gap;               // [m]
  Eigen::VectorXd air_pressure;          // [Pa] less that of the open air
  Eigen::VectorXd air_surface;           // [m] level of the water below
  Eigen::VectorXd air_surface_velocity;  // [m/s] of that level less the water's first row (F95)
  double air_at_start = 0;               // [kg], in two dimensions [kg/m]
  double air_out = 0;                    // [kg], in two dimensions [kg/m], that has left
  double air_energy_due = 0;    // [J], in two dimensions [J/m]: of the start, and work, less what left
  double air_energy_given = 0;  // the same: of the start, and the work done on the air
  Eigen::VectorXd wet_part;     // of layer particles of bodies: part with which its face counts (F91)
  Vectors<dim> interface_displacement;  // dim×m [m] committed motion of the interface points
  Vectors<dim> interface_velocity;      // dim×m [m/s]
  Eigen::VectorXd rank_boxes;           // 6 per rank, see Partition; empty: one rank
  std::vector<std::int64_t>
      rank_buckets;  // of each particle, see Division; of the whole fluid of several ranks

  Vector<dim> impulse_on_bodies = Vector<dim>::Zero();  // [N s] momentum account, since t = 0
  Vector<dim> impulse_on_walls = Vector<dim>::Zero();
  Vector<dim> impulse_of_gravity = Vector<dim>::Zero();
  Vector<dim> impulse_of_collisions =
      Vector<dim>::Zero();  // ΣJ of the anti-penetration step (fluid/THEORY.md (F54)–(F56))
  Vector<dim> initial_momentum = Vector<dim>::Zero();  // of the water at t = 0
  double inner_fraction_min = 1;                       // smallest share of fluid particles not on the surface
  std::int64_t lost = 0;                               // particles that left the domain
  std::int64_t penetrations = 0;  // largest count of fluid particles inside a body's outline
  std::int64_t behind_walls = 0;  // times that water was put back from behind a wall of the tank

  /// Lists the members that hold one entry per particle, by their names in a checkpoint.
  static constexpr auto columns() {
    return std::tuple(std::pair("position", &State::position),  //
                      std::pair("velocity", &State::velocity),  //
                      std::pair("pressure", &State::pressure),  //
                      std::pair("pressure_acceleration", &State::pressure_acceleration),
                      std::pair("residual_divergence", &State::residual_divergence),   //
                      std::pair("edge_divergence", &State::edge_divergence),           //
                      std::pair("residual_approach", &State::residual_wall_velocity),  //
                      std::pair("sps_k", &State::sps_k),                               //
                      std::pair("kind", &State::kind),                                 //
                      std::pair("id", &State::id),                                     //
                      std::pair("surface", &State::surface),                           //
                      std::pair("face_lag", &State::face_lag),                         //
                      std::pair("face_lag_rate", &State::face_lag_rate),               //
                      std::pair("aired", &State::air_connected));
  }
  /// Lists all other members likewise.
  static constexpr auto values() {
    return std::tuple(std::pair("time", &State::time),                                      //
                      std::pair("step", &State::step),                                      //
                      std::pair("residual_step", &State::residual_step),                    //
                      std::pair("air_mass", &State::air_mass),                              //
                      std::pair("air_momentum", &State::air_momentum),                      //
                      std::pair("air_gap", &State::air_gap),                                //
                      std::pair("air_pressure", &State::air_pressure),                      //
                      std::pair("air_surface", &State::air_surface),                        //
                      std::pair("air_surface_velocity", &State::air_surface_velocity),      //
                      std::pair("air_at_start", &State::air_at_start),                      //
                      std::pair("air_out", &State::air_out),                                //
                      std::pair("air_energy_due", &State::air_energy_due),                  //
                      std::pair("air_energy_given", &State::air_energy_given),              //
                      std::pair("wet_part", &State::wet_part),                              //
                      std::pair("interface_displacement", &State::interface_displacement),  //
                      std::pair("interface_velocity", &State::interface_velocity),          //
                      std::pair("rank_boxes", &State::rank_boxes),                          //
                      std::pair("rank_buckets", &State::rank_buckets),                      //
                      std::pair("impulse_on_bodies", &State::impulse_on_bodies),            //
                      std::pair("impulse_on_walls", &State::impulse_on_walls),              //
                      std::pair("impulse_of_gravity", &State::impulse_of_gravity),          //
                      std::pair("impulse_of_collisions", &State::impulse_of_collisions),    //
                      std::pair("initial_momentum", &State::initial_momentum),              //
                      std::pair("inner_fraction_min", &State::inner_fraction_min),          //
                      std::pair("lost", &State::lost),                                      //
                      std::pair("penetrations", &State::penetrations),                      //
                      std::pair("behind_walls", &State::behind_walls));
  }
};
// A new member needs one line in one of the lists. In three dimensions no member needs padding, so that the
// sizes add up.
static_assert(listed_bytes(State<3>::columns()) + listed_bytes(State<3>::values()) == sizeof(State<3>),
              "a member of State is listed neither in columns() nor in values()");

/// Calls visit(name, column...) for each column of a state, or of several side by side.
template <class Visit, class State, class... More>
void for_each_column(Visit&& visit, State& state, More&... more) {
  for_each_member(State::columns(), visit, state, more...);
}
/// Calls visit(name, value...) for each other member.
template <class Visit, class State, class... More>
void for_each_value(Visit&& visit, State& state, More&... more) {
  for_each_member(State::values(), visit, state, more...);
}

}  // namespace strake::fluid
