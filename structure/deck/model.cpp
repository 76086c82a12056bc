#include "structure/deck/model.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "proto/error.hpp"

namespace strake::structure::deck {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// A node's place in its cell, 0 … degree along each axis.
using Place = std::array<int, 3>;

Place place_of(int index, int degree) {
  const int row = degree + 1;
  return {index % row, index / row % row, index / (row * row)};
}

int index_of(const Place& p, int degree) {
  const int row = degree + 1;
  return p[0] + row * (p[1] + row * p[2]);
}

int middles(const Place& p, int degree) {
  if (degree == 1) return 0;
  return (p[0] == 1) + (p[1] == 1) + (p[2] == 1);
}

/// The kept nodes of a cell in the decks' order.
std::vector<int> deck_order(int dimension, int degree) {
  const int d = degree;
  std::vector<Place> places;
  const int layers = dimension == 3 ? 2 : 1;
  for (int l = 0; l < layers; ++l)
    for (const auto& [x, y] : {std::pair{0, 0}, {d, 0}, {d, d}, {0, d}}) places.push_back({x, y, l * d});
  if (d == 2) {
    for (int l = 0; l < layers; ++l)
      for (const auto& [x, y] : {std::pair{1, 0}, {2, 1}, {1, 2}, {0, 1}}) places.push_back({x, y, l * d});
    if (dimension == 3)
      for (const auto& [x, y] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}}) places.push_back({x, y, 1});
  }
  std::vector<int> order;
  for (const Place& p : places) order.push_back(index_of(p, degree));
  return order;
}

/// Values of the serendipity shape functions in the middle of a face or a cell, at the nodes around it:
///   face, square   ½ in the middles of its 4 edges, −¼ in its 4 corners
///   cell, cube     ¼ in the middles of its 12 edges, −¼ in its 8 corners
std::vector<std::pair<int, double>> share_of(const Place& middle) {
  std::vector<std::pair<int, double>> share;
  const int n_middle = middles(middle, 2);
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) {
        const Place p = {x, y, z};
        bool around = true;  // differs from the middle along those axes only in which that is a middle
        for (std::size_t k = 0; k < 3; ++k) around = around && (middle[k] == 1 || p[k] == middle[k]);
        if (!around || middles(p, 2) > 1) continue;
        const double weight = middles(p, 2) == 0 ? -0.25 : n_middle == 2 ? 0.5 : 0.25;
        share.emplace_back(index_of(p, 2), weight);
      }
  return share;
}

/// The nodes of the new model as combinations of the old: old × new.
Weights combination(const Model& old, std::vector<int>& kept, std::vector<int>& number) {
  const int per_cell = static_cast<int>(old.cell.rows());
  number.assign(static_cast<std::size_t>(old.n_nodes()), -1);
  std::vector<bool> keep(number.size(), false);
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (int a = 0; a < per_cell; ++a)
      if (middles(place_of(a, old.degree), old.degree) < 2)
        keep[static_cast<std::size_t>(old.cell(a, c))] = true;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) {
      number[i] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(i));
    }

  Triplets entries;
  std::vector<bool> done(keep.size(), false);
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) entries.emplace_back(static_cast<int>(i), number[i], 1.0);
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (int a = 0; a < per_cell; ++a) {
      const auto node = static_cast<std::size_t>(old.cell(a, c));
      if (keep[node] || done[node]) continue;
      done[node] = true;
      for (const auto& [b, weight] : share_of(place_of(a, 2)))
        entries.emplace_back(static_cast<int>(node), number[static_cast<std::size_t>(old.cell(b, c))],
                             weight);
    }
  Weights matrix(old.n_nodes(), static_cast<Eigen::Index>(kept.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Texts as numbers: an archive holds no others.
std::vector<std::int64_t> letters(const std::vector<std::string>& texts) {
  std::vector<std::int64_t> all;
  for (const std::string& text : texts) {
    for (const char c : text) all.push_back(static_cast<unsigned char>(c));
    all.push_back(0);
  }
  return all;
}

std::vector<std::string> texts(const std::vector<std::int64_t>& all) {
  std::vector<std::string> list;
  std::string text;
  for (const std::int64_t c : all) {
    if (c != 0) {
      text += static_cast<char>(c);
      continue;
    }
    list.push_back(text);
    text.clear();
  }
  return list;
}

/// row, column, value of each entry.
Eigen::MatrixXd entries(const Weights& weights) {
  Eigen::MatrixXd list(3, weights.nonZeros());
  Eigen::Index at = 0;
  for (Eigen::Index row = 0; row < weights.outerSize(); ++row)
    for (Weights::InnerIterator it(weights, row); it; ++it)
      list.col(at++) << static_cast<double>(it.row()), static_cast<double>(it.col()), it.value();
  return list;
}

Weights weights(const Eigen::MatrixXd& list, Eigen::Index rows, Eigen::Index columns) {
  Triplets triplets;
  for (Eigen::Index k = 0; k < list.cols(); ++k)
    triplets.emplace_back(static_cast<int>(list(0, k)), static_cast<int>(list(1, k)), list(2, k));
  Weights matrix(rows, columns);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

constexpr Eigen::Index material_rows = 5;  // model, density, Young's modulus, Poisson's ratio, plane stress

}  // namespace

Model with_edge_nodes(Model old) {
  std::vector<int> kept, number;
  const Weights from_old = combination(old, kept, number);
  Model model = old;

  model.node.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i)
    model.node.col(static_cast<Eigen::Index>(i)) = old.node.col(kept[i]);
  const std::vector<int> order = deck_order(old.dimension, old.degree);
  model.cell.resize(static_cast<Eigen::Index>(order.size()), old.cell.cols());
  for (Eigen::Index c = 0; c < old.cell.cols(); ++c)
    for (std::size_t a = 0; a < order.size(); ++a)
      model.cell(static_cast<Eigen::Index>(a), c) = number[static_cast<std::size_t>(old.cell(order[a], c))];

  model.fixed.clear();
  for (const int unknown : old.fixed) {
    const int node = number[static_cast<std::size_t>(unknown / old.dimension)];
    if (node >= 0) model.fixed.push_back(old.dimension * node + unknown % old.dimension);
  }
  model.interface = old.interface * from_old;
  model.probe_weights = old.probe_weights * from_old;
  if (old.node_mass.size() > 0) model.node_mass = from_old.transpose() * old.node_mass;
  model.own_load = Eigen::VectorXd::Zero(model.dimension * model.node.cols());
  for (Eigen::Index row = 0; row < from_old.outerSize(); ++row)
    for (Weights::InnerIterator it(from_old, row); it; ++it)
      model.own_load.segment(old.dimension * it.col(), old.dimension) +=
          it.value() * old.own_load.segment(old.dimension * it.row(), old.dimension);
  return model;
}

Archive to_archive(const Model& m) {
  Archive archive;
  archive.integer["size"] = {m.dimension, m.degree, m.cell.rows(), m.cell.cols(),
                             static_cast<int>(m.analysis)};
  archive.real["node"] = m.node;
  archive.integer["cell"] = {};
  for (const int node : m.cell.reshaped()) archive.integer["cell"].push_back(node);
  archive.integer["part"] = {m.part.begin(), m.part.end()};
  std::vector<std::string> names;
  Eigen::MatrixXd material(material_rows, static_cast<Eigen::Index>(m.parts.size()));
  for (std::size_t i = 0; i < m.parts.size(); ++i) {
    const Material& own = m.parts[i].material;
    names.push_back(m.parts[i].name);
    material.col(static_cast<Eigen::Index>(i)) << static_cast<double>(own.model), own.density, own.young,
        own.poisson, static_cast<double>(own.plane_stress);
  }
  archive.integer["part_names"] = letters(names);
  archive.real["material"] = material;
  archive.integer["fixed"] = {m.fixed.begin(), m.fixed.end()};
  archive.real["interface_position"] = m.interface_position;
  archive.real["interface"] = entries(m.interface);
  archive.integer["probe_names"] = letters(m.probe);
  archive.real["probe_at"] = m.probe_at;
  archive.real["probe"] = entries(m.probe_weights);
  archive.real["support_velocity"] = m.support_velocity;
  archive.real["gravity"] = m.gravity;
  archive.real["own_load"] = m.own_load;
  archive.real["scalars"] =
      Eigen::Vector4d(m.gravity_ramp, m.own_load_ramp, m.damping.mass, m.damping.stiffness);
  return archive;
}

Model from_archive(const Archive& archive, const std::string& source) {
  const auto fault = [&](const std::string& name) {
    return Error(ExitCode::case_file, source,
                 "is no finite-element model: " + name + " is missing or has another size",
                 "write it with strake-structure-fem --export FILE --case CASE");
  };
  const auto real = [&](const std::string& name) -> const Eigen::MatrixXd& {
    const auto found = archive.real.find(name);
    if (found == archive.real.end()) throw fault(name);
    return found->second;
  };
  const auto integer = [&](const std::string& name) -> const std::vector<std::int64_t>& {
    const auto found = archive.integer.find(name);
    if (found == archive.integer.end()) throw fault(name);
    return found->second;
  };
  const auto integers = [&](const std::string& name) {
    std::vector<int> list;
    for (const std::int64_t value : integer(name)) list.push_back(static_cast<int>(value));
    return list;
  };

  Model m;
  const std::vector<int> size = integers("size"), cell = integers("cell");
  if (size.size() != 5) throw fault("size");
  m.dimension = size[0];
  m.degree = size[1];
  if (static_cast<int>(cell.size()) != size[2] * size[3]) throw fault("cell");
  m.cell = Eigen::Map<const Eigen::MatrixXi>(cell.data(), size[2], size[3]);
  m.analysis = static_cast<Analysis>(size[4]);
  m.node = real("node");
  m.part = integers("part");
  const std::vector<std::string> names = texts(integer("part_names"));
  const Eigen::MatrixXd& material = real("material");
  if (material.rows() != material_rows || material.cols() != static_cast<Eigen::Index>(names.size()))
    throw fault("material");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto of = material.col(static_cast<Eigen::Index>(i));
    m.parts.push_back({names[i],
                       {.model = static_cast<MaterialModel>(static_cast<int>(of(0))),
                        .density = of(1),
                        .young = of(2),
                        .poisson = of(3),
                        .plane_stress = of(4) != 0},
                       false});
  }
  m.fixed = integers("fixed");
  m.interface_position = real("interface_position");
  m.interface = weights(real("interface"), m.interface_position.cols(), m.node.cols());
  m.probe = texts(integer("probe_names"));
  m.probe_at = real("probe_at");
  m.probe_weights = weights(real("probe"), m.probe_at.cols(), m.node.cols());
  m.support_velocity = real("support_velocity");
  m.gravity = real("gravity");
  m.own_load = real("own_load");
  const Eigen::MatrixXd& scalars = real("scalars");
  if (scalars.size() != 4) throw fault("scalars");
  m.gravity_ramp = scalars(0);
  m.own_load_ramp = scalars(1);
  m.damping = {.mass = scalars(2), .stiffness = scalars(3)};
  return m;
}

double shortest_edge(const Model& m) {
  double shortest = std::numeric_limits<double>::infinity();
  for (Eigen::Index c = 0; c < m.cell.cols(); ++c)
    for (int a = 0; a < (m.dimension == 2 ? 4 : 8); ++a)
      for (int b = 0; b < a; ++b)
        shortest = std::min(shortest, (m.node.col(m.cell(a, c)) - m.node.col(m.cell(b, c))).norm());
  return shortest;
}

void require_plain_materials(const Model& m) {
  for (const Part& part : m.parts) {
    if (part.material.model == MaterialModel::neo_hookean)
      throw Error(ExitCode::case_file, "structure, part \"" + part.name + "\"",
                  "the neo-Hookean energy of this case has no counterpart in the other program",
                  "structure.material.model = \"saint_venant_kirchhoff\"");
    if ((part.material.model == MaterialModel::linear) !=
        (m.parts.front().material.model == MaterialModel::linear))
      throw Error(ExitCode::case_file, "structure, part \"" + part.name + "\"",
                  "linear and nonlinear parts in one body: the other programs know one kinematics for all",
                  "the same structure.material.model in every part");
  }
}

}  // namespace strake::structure::deck
