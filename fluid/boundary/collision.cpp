#include "fluid/boundary/collision.hpp"

#include "fluid/particles/simd_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace strake::fluid {

namespace {

/// Distance below which two particles inside the water collide in the least-squares scheme [l0]. Its
/// operators are accurate on disordered particles, and the shear of any flow brings them to 0.7 to 0.85 l0 of
/// one another. To separate those would remove energy from the flow: Taylor–Green vortices at Re 100 then
/// decay 6 % too fast on 100².
constexpr double water_to_water = 0.7;
/// Height over a body's face at which water from inside it is put back [l0]. Chosen.
constexpr double put_back_height = 0.05;

struct Pair {
  std::int32_t i, j;
  double square;  // of their distance [m²]
};

/// Whether any of the `columns` may lie nearer to particle i than `distance`. Eight are tested at a time,
/// before the exact test.
template <int dim>
bool any_within(const State<dim>& state, const Periodic<dim>& periodic, std::int64_t i,
                std::span<const std::int32_t> columns, double distance) {
  constexpr double round_off = 1e-9;
  const double limit = (1 + round_off) * distance * distance;
  const double* const x = state.position.data();
  std::uint32_t found = 0;
  for (std::size_t e = 0; e < columns.size(); e += simd::width) {
    const int n = static_cast<int>(std::min<std::size_t>(simd::width, columns.size() - e));
    const auto self = static_cast<std::int32_t>(i);
    found |= periodic.any() ? simd::between<dim, true>(x, self, columns.data() + e, n, periodic, 0, limit)
                            : simd::between<dim, false>(x, self, columns.data() + e, n, periodic, 0, limit);
  }
  return found != 0;
}

/// Finds the pairs with a water particle i < j that are too close and approach each other, the closest first.
/// The order of a chain decides what each particle gets. That of their numbers differs on the two sides of a
/// symmetric body, from rank to rank and with `reorder`: a wedge had a side force of some kN/m.
template <int dim>
class ClosePairs {
 public:
  /// distance, of_water: of any pair, and of two particles inside the water [m].
  ClosePairs(const State<dim>& state, const Boundary<dim>& boundary, double distance, double of_water)
      : state_(state),
        periodic_(boundary.tank().periodic()),
        water_(boundary.water()),
        distance_(distance),
        of_water_(of_water) {}

  /// margin: pairs farther apart when the rows were made are not tested [m]. A pair with a ghost is taken
  /// from the row of the other. Pairs of ghosts count where they may pass a collision on to an own particle.
  std::vector<Pair> find(const Neighbours& near, double margin, const CollidingRanks& ranks) const {
    const auto& owned = ranks.owned;
    const auto is_ghost = [&](std::int32_t k) {
      return !owned.empty() && k < water_ && owned[static_cast<std::size_t>(k)] == 0;
    };
    std::vector<Pair> all = of_rows(near, margin, is_ghost, !owned.empty());
    const auto with_ghost = [&](const Pair& pair) { return is_ghost(pair.i) || is_ghost(pair.j); };
    if (ranks.ghosts && std::ranges::any_of(all, with_ghost)) {
      const double reach = std::max(distance_, of_water_);
      const std::vector<Pair> ghosts = of_rows(ranks.ghosts(reach), reach, is_ghost, false);
      all.insert(all.end(), ghosts.begin(), ghosts.end());
    }
    std::ranges::sort(all, {}, [](const Pair& pair) { return std::tuple(pair.square, pair.i, pair.j); });
    return all;
  }

 private:
  bool collide(std::int64_t i, std::int64_t j, const Vector<dim>& r) const {
    const bool inside = j < water_ && !state_.surface[static_cast<std::size_t>(i)] &&
                        !state_.surface[static_cast<std::size_t>(j)];
    const double limit = inside ? of_water_ : distance_;
    return r.squaredNorm() < limit * limit && (state_.velocity.col(i) - state_.velocity.col(j)).dot(r) > 0;
  }

  /// Pairs of the rows of water: with the later columns, and with earlier ghosts where `with_earlier`.
  template <class IsGhost>
  std::vector<Pair> of_rows(const Neighbours& rows, double margin, const IsGhost& is_ghost,
                            bool with_earlier) const {
    constexpr std::int64_t block = 1024;
    const std::int64_t blocks = (water_ + block - 1) / block;
    std::vector<std::vector<Pair>> found(static_cast<std::size_t>(blocks));
#pragma omp parallel for schedule(static)
    for (std::int64_t b = 0; b < blocks; ++b) {
      std::vector<Pair>& pairs = found[static_cast<std::size_t>(b)];
      for (std::int64_t i = b * block; i < std::min(water_, (b + 1) * block); ++i) {
        const auto self = static_cast<std::int32_t>(i);
        const auto columns = rows.row(i);
        const auto inverses = rows.inverses(i);
        const auto later = std::upper_bound(columns.begin(), columns.end(), self);
        const std::size_t first = with_earlier ? 0 : static_cast<std::size_t>(later - columns.begin());
        if (!any_within<dim>(state_, periodic_, i, columns.subspan(first), std::max(distance_, of_water_)))
          continue;
        for (std::size_t e = first; e < columns.size(); ++e) {
          if (inverses[e] * margin < 1 || (columns[e] < self && !is_ghost(columns[e]))) continue;
          const auto [low, high] = std::minmax(self, columns[e]);
          const Vector<dim> r = periodic_.separation(state_.position.col(low), state_.position.col(high));
          if (collide(low, high, r)) pairs.push_back({low, high, r.squaredNorm()});
        }
      }
    }
    std::vector<Pair> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  const State<dim>& state_;
  const Periodic<dim>& periodic_;
  std::int64_t water_;
  double distance_, of_water_;
};

template <int dim>
void give(CollisionAccount<dim>& account, const Boundary<dim>& boundary, std::int64_t row,
          const Vector<dim>& impulse) {
  const int point = boundary.point_of(row);
  if (point >= 0)
    account.on_points.col(point) += impulse;
  else
    account.on_walls += impulse;
  account.on_water -= impulse;
}

/// Returns the reduced mass of a water particle and particle j, over the water particle's mass. This is
/// m_j/(m_i + m_j): ½ for two water particles, and 1 for layers of tank and body, whose mass is infinite.
template <int dim>
double mass_share(const State<dim>& state, const Boundary<dim>& boundary, std::int64_t j, double volume,
                  double particle_mass) {
  if (state.kind[static_cast<std::size_t>(j)] == Kind::solid) {
    const double heavy = boundary.solid_density()[j - boundary.first_of_bodies()] * volume;
    return heavy / (heavy + particle_mass);
  }
  return j < boundary.water() ? 0.5 : 1.0;
}

/// Puts water from behind a wall of the tank back onto its face, without its velocity into it. A corner needs
/// one pass per wall.
template <int dim>
void put_back_from_walls(State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                         double mass, std::span<const std::uint8_t> owned, CollisionAccount<dim>& account) {
  // A particle that passes a wall had layers among its neighbours before. It moves by less than a spacing in
  // a step.
  const auto beside = [&](std::int64_t i) {
    const auto columns = near.row(i);
    return !columns.empty() && columns.back() >= boundary.water();
  };
  bool any = false;
#pragma omp parallel for schedule(static) reduction(|| : any)
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    any = any || (beside(i) && boundary.tank().behind(state.position.col(i)));
  if (!any) return;
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!beside(i)) continue;
    for (int turn = 0; turn < dim; ++turn) {
      const auto foot = boundary.tank().behind(state.position.col(i));
      if (!foot) break;
      const bool counts = owned.empty() || owned[static_cast<std::size_t>(i)] != 0;
      account.behind_walls += counts && turn == 0 ? 1 : 0;
      state.position.col(i) = foot->position;
      const Vector<dim> past = state.velocity.col(i) - boundary.tank().velocity_at(foot->position);
      const double into = past.dot(foot->normal);
      if (into >= 0) continue;
      state.velocity.col(i) -= into * foot->normal;
      if (!counts) continue;
      account.on_walls += mass * into * foot->normal;
      account.on_water -= mass * into * foot->normal;
    }
  }
}

template <int dim>
void put_back(State<dim>& state, const Boundary<dim>& boundary, double spacing, double mass,
              std::span<const std::uint8_t> owned, CollisionAccount<dim>& account) {
  const BodySurface<dim>& body = boundary.body_surface();
  if (body.empty()) return;
  const std::int64_t water = boundary.water();
  bool any = false;
#pragma omp parallel for schedule(static) reduction(|| : any)
  for (std::int64_t i = 0; i < water; ++i) any = any || body.inside(state.position.col(i));
  if (!any) return;
  for (std::int64_t i = 0; i < water; ++i) {
    if (!body.inside(state.position.col(i))) continue;
    const bool counts = owned.empty() || owned[static_cast<std::size_t>(i)] != 0;
    account.inside += counts ? 1 : 0;
    const auto foot = body.nearest(state.position.col(i));
    const Vector<dim> n = body.normal(foot.point);
    state.position.col(i) = foot.position + put_back_height * spacing * n;
    const double into = (state.velocity.col(i) - body.velocity(foot.point)).dot(n);
    if (into >= 0) continue;
    state.velocity.col(i) -= into * n;
    if (!counts) continue;
    account.on_points.col(foot.point) += mass * into * n;
    account.on_water -= mass * into * n;
  }
}

}  // namespace

template <int dim>
CollisionAccount<dim> separate_particles(State<dim>& state, const Boundary<dim>& boundary,
                                         const Neighbours& near, const Scheme& scheme, double dt,
                                         double spacing, double particle_mass, const CollidingRanks& ranks) {
  const auto& owned = ranks.owned;
  CollisionAccount<dim> account;
  account.on_points = Vectors<dim>::Zero(dim, boundary.points());
  const std::int64_t water = boundary.water();
  const auto& periodic = boundary.tank().periodic();
  if (scheme.anti_penetration != AntiPenetration::none) {
    const double distance = scheme.collision_distance * spacing;
    const double of_water =
        scheme.gradient == Gradient::least_squares ? std::min(distance, water_to_water * spacing) : distance;
    // Rows of neighbours are those of the positions before the step. A pair that was farther apart than the
    // distance plus l0 is not tested.
    const auto pairs =
        ClosePairs<dim>(state, boundary, distance, of_water).find(near, distance + spacing, ranks);
    std::vector<int> count;
    if (scheme.anti_penetration == AntiPenetration::average) {
      count.assign(static_cast<std::size_t>(state.position.cols()), 0);
      for (const Pair& pair : pairs) {
        ++count[static_cast<std::size_t>(pair.i)];
        ++count[static_cast<std::size_t>(pair.j)];
      }
    }
    const double volume = std::pow(spacing, dim);
    for (const Pair& pair : pairs) {
      const Vector<dim> r = periodic.separation(state.position.col(pair.i), state.position.col(pair.j));
      const double length = r.norm();
      if (length == 0) continue;
      const Vector<dim> e = r / length;
      const Vector<dim> approach = state.velocity.col(pair.i) - state.velocity.col(pair.j);
      const double closing = approach.dot(e);
      if (closing <= 0) continue;  // an earlier collision has separated them
      const bool other_is_water = pair.j < water;
      const double share = mass_share<dim>(state, boundary, pair.j, volume, particle_mass);
      Vector<dim> change;  // of v_i
      if (scheme.anti_penetration == AntiPenetration::collision) {
        change = -(1 + scheme.restitution) * share * closing * e;
      } else {
        const int most =
            std::max(count[static_cast<std::size_t>(pair.i)], count[static_cast<std::size_t>(pair.j)]);
        change = -share * (2.0 / (1 + most)) * approach;
      }
      state.velocity.col(pair.i) += change;
      state.position.col(pair.i) += change * dt;
      if (other_is_water) {
        state.velocity.col(pair.j) -= change;
        state.position.col(pair.j) -= change * dt;
      } else if (owned.empty() || owned[static_cast<std::size_t>(pair.i)]) {
        give<dim>(account, boundary, pair.j, -particle_mass * change);
      }
    }
  }
  put_back<dim>(state, boundary, spacing, particle_mass, owned, account);
  put_back_from_walls<dim>(state, boundary, near, particle_mass, owned, account);
  return account;
}

template CollisionAccount<2> separate_particles<2>(State<2>&, const Boundary<2>&, const Neighbours&,
                                                   const Scheme&, double, double, double,
                                                   const CollidingRanks&);
template CollisionAccount<3> separate_particles<3>(State<3>&, const Boundary<3>&, const Neighbours&,
                                                   const Scheme&, double, double, double,
                                                   const CollidingRanks&);

}  // namespace strake::fluid
