#pragma once

#include "fluid/geometry/tank_shape.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace strake::fluid {

/// The tank's layer particles [first, last) and its rigid motion in the laboratory frame. The class also
/// gives places beside the tank to particles that are removed.
template <int dim>
class Tank {
 public:
  /// filled: water and tank layers of `fill`, or water alone (`fill_share`). reach: largest radius of the
  /// scheme [m].
  Tank(const Parameters&, double reach, const State<dim>& filled);

  const TankShape<dim>& shape() const { return shape_; }
  std::int64_t first() const { return first_; }
  std::int64_t last() const { return last_; }
  /// Renumbers the layers, which follow that many water particles.
  void set_first(std::int64_t water);
  /// Calls visit(number, place, is in the first layer) for all layer particles of a tank at rest. Their
  /// numbers are those at the start, 0 for the first; they come in any order.
  void for_each_layer(
      const std::function<void(std::int64_t, const Vector<dim>&, bool first_layer)>& visit) const;
  std::int64_t layers_of_whole() const { return layers_of_whole_; }
  /// Keeps the layer particles with these numbers alone, which ascend. All first-layer particles that they
  /// extend must be among them. Returns whether others were kept before.
  bool select(std::span<const std::int64_t> numbers);
  /// Whether any wall absorbs sound.
  bool absorbs() const { return absorbs_; }
  bool moves() const { return motion_.moves(); }
  /// The directions in which the tank repeats itself.
  const Periodic<dim>& periodic() const { return periodic_; }
  /// How far a place lies beyond the end of a periodic axis [m]; 0: beyond none.
  double past_seam(const Vector<dim>& x) const;
  /// Brings the water back between the tank's periodic sides; call at the end of a step.
  void wrap(State<dim>&) const;

  /// Returns the normal, into the water, of the wall in front of layer particle i, where the tank is now. It
  /// is zero where two walls meet, and for particles that are not of the tank.
  Vector<dim> normal_of(std::int64_t i) const;
  /// Returns a direction of the tank as the case gives it, turned with the tank.
  Vector<dim> turned(const Vector<dim>& direction) const { return turned(now_, direction); }
  /// Returns the area of the faces that wall particle i represents, into the water [m, m² in 3-D].
  Vector<dim> area_of(std::int64_t i) const;
  /// Sum of the normals of the absorbing faces in front of layer particle i; zero: none absorbs.
  Vector<dim> absorbing(std::int64_t i) const;
  /// Returns the middle of the particle's face in the tank as the case gives it. A sensor is compared with
  /// this place.
  Vector<dim> face_of(std::int64_t i) const;
  /// Whether its load is the floor's: layers below the water.
  bool is_floor(std::int64_t i) const { return part(i).floor; }
  /// First-layer particle whose pressure and velocity dummy i extends; −1: i is no dummy of the tank.
  std::int32_t master_of(std::int64_t i) const;
  /// a_w: acceleration of layer particle i in the step that `move` began last [m/s²].
  Vector<dim> acceleration_of(std::int64_t i) const;
  /// Returns the mean of these accelerations. The pressure of water at rest in the tank has the gradient
  /// ρ(g − a) [Pa/m].
  Vector<dim> acceleration() const;
  /// Returns the acceleration of the tank's frame at the middle of its layers at the time of the last `adopt`
  /// or `move`. It follows from the motion alone, so that a step after a rewind is as long as it was.
  Vector<dim> acceleration_of_frame() const;

  /// Moves the layers in a step that ends at `time`. The first call (positions = false) sets their velocities
  /// and accelerations, the second (true) their positions. A tank at rest costs nothing.
  void move(State<dim>&, double time, bool positions);
  /// Adopts the time that `state` was saved at.
  void adopt(const State<dim>& state);
  /// Returns the velocity of the tank's frame at the place x of the laboratory [m/s]. The time is that of the
  /// last `adopt` or `move`.
  Vector<dim> velocity_at(const Vector<dim>& x) const;
  /// Returns the place of the laboratory point x in the tank as the case gives it.
  Vector<dim> in_tank(const Vector<dim>& x) const;

  /// Distance to the nearest wall, where the tank is now [m].
  double distance(const Vector<dim>& x) const { return shape_.distance(in_tank(x)); }
  /// The face that x lies behind, where the tank is now.
  std::optional<WallFoot<dim>> behind(const Vector<dim>& x) const;
  bool left(const Vector<dim>& x) const { return shape_.left(in_tank(x)); }
  /// Whether x is a place of a removed particle. A particle that leaves the tank is removed: it gets a place
  /// of its own, out of reach of all others.
  bool is_removed(const Vector<dim>& x) const { return x[0] >= removed_from_[0] && is_place_of_removed(x); }
  Vector<dim> place_of_removed(std::int64_t number) const;

 private:
  struct Frame {  // a rigid motion of the tank, ready for use
    Vector<dim> shift = Vector<dim>::Zero(), velocity = Vector<dim>::Zero(),
                acceleration = Vector<dim>::Zero();
    double sine = 0, cosine = 1, rate = 0, change = 0;  // change: of the rate [rad/s²]
  };
  const WallParticle<dim>& part(std::int64_t i) const { return part_[static_cast<std::size_t>(i - first_)]; }
  bool has(std::int64_t i) const { return i >= first_ && i < last_; }
  Frame frame_at(double time) const;
  Vector<dim> turned(const Frame&, const Vector<dim>& r) const;
  Vector<dim> place(const Frame&, const Vector<dim>& reference) const;
  Vector<dim> velocity(const Frame&, const Vector<dim>& x) const;
  void find_masters();
  bool is_place_of_removed(const Vector<dim>& x) const;
  std::int64_t removed_per_column() const;  // places above one another

  TankShape<dim> shape_;
  TankMotion motion_;
  Periodic<dim> periodic_;
  double spacing_, reach_;
  int dummy_rows_;
  std::int64_t first_ = 0, last_ = 0;
  std::int64_t layers_of_whole_ = 0, walls_of_whole_ = 0;
  std::vector<std::int64_t> selected_;  // numbers of the layers in the whole
  std::int64_t walls_ = 0;              // [first, first + walls) are the first layer
  std::vector<WallParticle<dim>> part_;
  std::vector<std::int32_t> master_;
  bool absorbs_;
  Frame now_;                                                        // of the particles' places
  Vectors<dim> acceleration_;                                        // empty for a tank at rest
  Vector<dim> pivot_, removed_from_, middle_ = Vector<dim>::Zero();  // middle_: of the layers' places
};

}  // namespace strake::fluid
