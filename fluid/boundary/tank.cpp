#include "fluid/boundary/tank.hpp"

#include "fluid/boundary/fill.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace strake::fluid {

namespace {

/// Wall particles by cells of one spacing, to find the nearest one.
template <int dim>
class Grid {
 public:
  Grid(const std::vector<WallParticle<dim>>& part, std::int64_t walls, double cell) : cell_(cell) {
    low_ = part.front().position;
    Vector<dim> high = low_;
    for (const auto& p : part) {
      low_ = low_.cwiseMin(p.position);
      high = high.cwiseMax(p.position);
    }
    std::size_t cells = 1;
    for (int d = 0; d < dim; ++d) {
      size_[static_cast<std::size_t>(d)] = static_cast<long>((high[d] - low_[d]) / cell_) + 1;
      cells *= static_cast<std::size_t>(size_[static_cast<std::size_t>(d)]);
    }
    head_.assign(cells, -1);
    next_.assign(static_cast<std::size_t>(walls), -1);
    for (std::int64_t w = walls - 1; w >= 0; --w) {  // so that a cell's list rises
      auto& head = head_[index(cell_of(part[static_cast<std::size_t>(w)].position))];
      next_[static_cast<std::size_t>(w)] = head;
      head = static_cast<std::int32_t>(w);
    }
  }

  /// The nearest wall particle, on equal distances the first.
  std::int32_t nearest(const std::vector<WallParticle<dim>>& part, const Vector<dim>& x) const {
    const auto centre = cell_of(x);
    const long farthest = *std::max_element(size_.begin(), size_.end());
    double best = std::numeric_limits<double>::infinity();
    std::int32_t found = -1;
    for (long shell = 0; shell <= farthest; ++shell) {
      // All particles that are left are at least `safe` away.
      if (const double safe = static_cast<double>(shell - 1) * cell_; shell > 0 && safe * safe > best) break;
      visit_shell(centre, shell, [&](std::int32_t head) {
        for (std::int32_t w = head; w >= 0; w = next_[static_cast<std::size_t>(w)]) {
          const double squared = (part[static_cast<std::size_t>(w)].position - x).squaredNorm();
          if (squared > best || (squared == best && w > found)) continue;
          best = squared;
          found = w;
        }
      });
    }
    return found;
  }

 private:
  using Cell = std::array<long, 3>;
  Cell cell_of(const Vector<dim>& x) const {
    Cell c{};
    for (int d = 0; d < dim; ++d)
      c[static_cast<std::size_t>(d)] = static_cast<long>((x[d] - low_[d]) / cell_);
    return c;
  }
  std::size_t index(const Cell& c) const {
    return static_cast<std::size_t>((c[2] * size_[1] + c[1]) * size_[0] + c[0]);
  }
  template <class Visit>
  void visit_shell(const Cell& centre, long shell, Visit&& visit) const {
    Cell c{};
    const auto range = [&](std::size_t d) {
      return std::pair{std::max(0L, centre[d] - shell), std::min(size_[d] - 1, centre[d] + shell)};
    };
    const auto [z0, z1] = range(2);
    const auto [y0, y1] = range(1);
    const auto [x0, x1] = range(0);
    for (c[2] = z0; c[2] <= z1; ++c[2])
      for (c[1] = y0; c[1] <= y1; ++c[1]) {
        const bool face = std::max(std::abs(c[2] - centre[2]), std::abs(c[1] - centre[1])) == shell;
        for (c[0] = x0; c[0] <= x1; ++c[0]) {
          if (!face && std::abs(c[0] - centre[0]) != shell) continue;
          if (const std::int32_t head = head_[index(c)]; head >= 0) visit(head);
        }
      }
  }

  double cell_;
  Vector<dim> low_;
  Cell size_{1, 1, 1};
  std::vector<std::int32_t> head_, next_;
};

}  // namespace

template <int dim>
Tank<dim>::Tank(const Parameters& p, double reach, const State<dim>& filled)
    : shape_(p),
      motion_(p.motion),
      spacing_(p.spacing),
      reach_(reach),
      dummy_rows_(dummy_rows(p.scheme)),
      absorbs_(p.absorbing_bottom || p.absorbing_sides),
      pivot_(p.motion.pivot.head<dim>()) {
  Vector<dim> period = Vector<dim>::Zero();
  for (int d = 0; d < dim; ++d)
    if (p.periodic[static_cast<std::size_t>(d)]) period[d] = shape_.high()[d] - shape_.low()[d];
  periodic_ = Periodic<dim>(period);
  first_ = std::count(filled.kind.begin(), filled.kind.end(), Kind::fluid);
  shape_.for_each_particle(dummy_rows_, [&](const WallParticle<dim>&, bool first_layer) {
    ++layers_of_whole_;
    walls_of_whole_ += first_layer ? 1 : 0;
  });
  // A rank has none of the layers at first.
  std::vector<std::int64_t> numbers(
      static_cast<std::size_t>(filled.position.cols() > first_ ? layers_of_whole_ : 0));
  std::iota(numbers.begin(), numbers.end(), 0);
  last_ = first_;
  select(numbers);
  assert(last_ <= filled.position.cols());
  if (motion_.moves()) acceleration_.setZero(dim, last_ - first_);
  // Beside the tank, beyond its walls and their reach wherever it moves.
  removed_from_ = shape_.low();
  removed_from_[0] = shape_.high()[0] + 4 * reach + period.norm();
  if (motion_.moves()) {
    removed_from_[0] += motion_.reach(p.end_time)[0];
    if (motion_.turns())
      removed_from_[0] += 2 * std::max((shape_.high() - pivot_).norm(), (shape_.low() - pivot_).norm());
  }
  adopt(filled);
}

template <int dim>
double Tank<dim>::past_seam(const Vector<dim>& x) const {
  double past = 0;
  for (int d = 0; d < dim; ++d)
    if (periodic_.along(d)) past = std::max({past, shape_.low()[d] - x[d], x[d] - shape_.high()[d]});
  return past;
}

template <int dim>
void Tank<dim>::wrap(State<dim>& state) const {
  if (!periodic_.any()) return;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < first_; ++i)
    if (!is_removed(state.position.col(i)))
      state.position.col(i) = periodic_.wrap(state.position.col(i), shape_.low());
}

template <int dim>
void Tank<dim>::find_masters() {
  master_.assign(part_.size(), -1);
  if (walls_ == 0) return;
  const Grid<dim> grid(part_, walls_, spacing_);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = walls_; i < static_cast<std::int64_t>(part_.size()); ++i)
    master_[static_cast<std::size_t>(i)] =
        static_cast<std::int32_t>(first_) + grid.nearest(part_, part_[static_cast<std::size_t>(i)].position);
}

template <int dim>
void Tank<dim>::set_first(std::int64_t water) {
  const std::int64_t shift = water - first_;
  first_ += shift;
  last_ += shift;
  for (std::int32_t& master : master_)
    if (master >= 0) master = static_cast<std::int32_t>(master + shift);
}

template <int dim>
void Tank<dim>::for_each_layer(
    const std::function<void(std::int64_t, const Vector<dim>&, bool)>& visit) const {
  assert(!moves());
  std::int64_t wall = 0, dummy = walls_of_whole_;
  shape_.for_each_particle(dummy_rows_, [&](const WallParticle<dim>& particle, bool first_layer) {
    visit(first_layer ? wall++ : dummy++, particle.position, first_layer);
  });
}

template <int dim>
bool Tank<dim>::select(std::span<const std::int64_t> numbers) {
  if (std::ranges::equal(numbers, selected_)) return false;
  selected_.assign(numbers.begin(), numbers.end());
  const auto begin = selected_.begin(), end = selected_.end(),
             first_dummy = std::lower_bound(begin, end, walls_of_whole_);
  walls_ = first_dummy - begin;
  last_ = first_ + std::ssize(selected_);
  part_.assign(selected_.size(), {});
  std::int64_t wall = 0, dummy = walls_of_whole_;
  auto next_wall = begin, next_dummy = first_dummy;  // each layer comes in the order of its numbers
  shape_.for_each_particle(dummy_rows_, [&](const WallParticle<dim>& particle, bool first_layer) {
    auto& next = first_layer ? next_wall : next_dummy;
    const std::int64_t number = first_layer ? wall++ : dummy++;
    if (next == (first_layer ? first_dummy : end) || *next != number) return;
    part_[static_cast<std::size_t>(next++ - begin)] = particle;
  });
  middle_.setZero();
  for (const WallParticle<dim>& particle : part_)
    middle_ += particle.position / static_cast<double>(part_.size());
  find_masters();
  return true;
}

template <int dim>
Vector<dim> Tank<dim>::normal_of(std::int64_t i) const {
  if (!has(i)) return Vector<dim>::Zero();
  return motion_.turns() ? turned(now_, part(i).normal) : part(i).normal;
}

template <int dim>
Vector<dim> Tank<dim>::area_of(std::int64_t i) const {
  if (!has(i)) return Vector<dim>::Zero();
  return motion_.turns() ? turned(now_, part(i).area) : part(i).area;
}

template <int dim>
Vector<dim> Tank<dim>::absorbing(std::int64_t i) const {
  if (!has(i)) return Vector<dim>::Zero();
  return motion_.turns() ? turned(now_, part(i).absorbing) : part(i).absorbing;
}

template <int dim>
Vector<dim> Tank<dim>::face_of(std::int64_t i) const {
  const Vector<dim>& area = part(i).area;
  const double size = area.norm();
  return size > 0 ? Vector<dim>(part(i).position + 0.5 * spacing_ / size * area) : part(i).position;
}

template <int dim>
std::int32_t Tank<dim>::master_of(std::int64_t i) const {
  return has(i) ? master_[static_cast<std::size_t>(i - first_)] : -1;
}

template <int dim>
Vector<dim> Tank<dim>::acceleration_of(std::int64_t i) const {
  if (acceleration_.cols() == 0 || !has(i)) return Vector<dim>::Zero();
  return acceleration_.col(i - first_);
}

template <int dim>
Vector<dim> Tank<dim>::acceleration() const {
  if (acceleration_.cols() == 0) return Vector<dim>::Zero();
  return acceleration_.rowwise().mean();
}

/// a = d²s/dt² + dω/dt e_z × r − ω² r , r in the plane of the turn
template <int dim>
Vector<dim> Tank<dim>::acceleration_of_frame() const {
  const Vector<dim> r = turned(now_, middle_ - pivot_);
  Vector<dim> a = now_.acceleration;
  a[0] -= now_.change * r[1] + now_.rate * now_.rate * r[0];
  a[1] += now_.change * r[0] - now_.rate * now_.rate * r[1];
  return a;
}

template <int dim>
auto Tank<dim>::frame_at(double time) const -> Frame {
  const RigidMotion motion = motion_.at(time);
  Vector<dim> shift = motion.displacement.head<dim>();
  for (int d = 0; d < dim; ++d)  // a floor may run past many periods
    if (periodic_.along(d)) shift[d] = std::remainder(shift[d], periodic_.length()[d]);
  return {shift,
          motion.velocity.head<dim>(),
          motion.acceleration.head<dim>(),
          std::sin(motion.angle),
          std::cos(motion.angle),
          motion.angular_velocity,
          motion.angular_acceleration};
}

template <int dim>
Vector<dim> Tank<dim>::turned(const Frame& frame, const Vector<dim>& r) const {
  Vector<dim> t = r;
  t[0] = frame.cosine * r[0] - frame.sine * r[1];
  t[1] = frame.sine * r[0] + frame.cosine * r[1];
  return t;
}

/// x = X_p + s + R (X − X_p)
template <int dim>
Vector<dim> Tank<dim>::place(const Frame& frame, const Vector<dim>& reference) const {
  return pivot_ + frame.shift + turned(frame, reference - pivot_);
}

/// v = ds/dt + ω e_z × (x − X_p − s)
template <int dim>
Vector<dim> Tank<dim>::velocity(const Frame& frame, const Vector<dim>& x) const {
  const Vector<dim> r = x - pivot_ - frame.shift;
  Vector<dim> v = frame.velocity;
  v[0] -= frame.rate * r[1];
  v[1] += frame.rate * r[0];
  return v;
}

/// Sets the velocity of the layers to their mean over the step, (xⁿ⁺¹ − xⁿ)/Δt. The water follows the same
/// rule, r = rⁿ + Δt uⁿ⁺¹. With another velocity a wall would drift against the water. The acceleration of
/// the layers is the change of that velocity over the step.
template <int dim>
void Tank<dim>::move(State<dim>& state, double time, bool positions) {
  if (!motion_.moves()) return;
  const Frame after = frame_at(time);
  const double dt = time - state.time;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = first_; i < last_; ++i) {
    const Vector<dim> x = place(after, part(i).position);
    if (positions) {
      state.position.col(i) = periodic_.wrap(x, shape_.low());
      continue;
    }
    const Vector<dim> v = periodic_.separation(state.position.col(i), x) / dt;
    acceleration_.col(i - first_) = (v - state.velocity.col(i)) / dt;
    state.velocity.col(i) = v;
  }
  if (positions) now_ = after;
}

template <int dim>
void Tank<dim>::adopt(const State<dim>& state) {
  if (motion_.moves()) now_ = frame_at(state.time);
}

template <int dim>
Vector<dim> Tank<dim>::velocity_at(const Vector<dim>& x) const {
  return velocity(now_, x);
}

template <int dim>
Vector<dim> Tank<dim>::in_tank(const Vector<dim>& x) const {
  if (!motion_.moves()) return x;
  Frame back = now_;
  back.sine = -back.sine;
  return pivot_ + turned(back, x - pivot_ - now_.shift);
}

template <int dim>
std::optional<WallFoot<dim>> Tank<dim>::behind(const Vector<dim>& x) const {
  auto foot = shape_.behind(in_tank(x));
  if (foot && motion_.moves()) {
    foot->position = place(now_, foot->position);
    foot->normal = turned(now_, foot->normal);
  }
  return foot;
}

template <int dim>
std::int64_t Tank<dim>::removed_per_column() const {
  return std::max<std::int64_t>(
      1, static_cast<std::int64_t>((shape_.high()[1] - shape_.low()[1]) / (2 * reach_)));
}

template <int dim>
Vector<dim> Tank<dim>::place_of_removed(std::int64_t number) const {
  Vector<dim> place = removed_from_;
  place[0] += 2 * reach_ * static_cast<double>(number / removed_per_column());
  place[1] += 2 * reach_ * static_cast<double>(number % removed_per_column());
  return place;
}

template <int dim>
bool Tank<dim>::is_place_of_removed(const Vector<dim>& x) const {
  const double across = (x[0] - removed_from_[0]) / (2 * reach_),
               up = (x[1] - removed_from_[1]) / (2 * reach_);
  if (!(across < 1e9 && up > -0.5 && up < static_cast<double>(removed_per_column()))) return false;
  return x == place_of_removed(std::llround(across) * removed_per_column() + std::llround(up));
}

template class Tank<2>;
template class Tank<3>;

}  // namespace strake::fluid
