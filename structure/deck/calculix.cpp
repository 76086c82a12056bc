#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "structure/deck/deck.hpp"

namespace strake::structure::deck {
namespace {

using Buffer = fmt::memory_buffer;
constexpr std::array<char, 3> axis_letter = {'X', 'Y', 'Z'};
constexpr int n_modes = 9;  // three beside the six rigid motions of a free body

template <class... Values>
void put(Buffer& out, fmt::format_string<Values...> text, Values&&... values) {
  fmt::format_to(std::back_inserter(out), text, std::forward<Values>(values)...);
}

/// Plane elements become solids inside CalculiX, whatever their thickness; C3D8I has incompatible modes.
std::string element_type(const Model& m, const Part& part) {
  if (m.dimension == 3) return m.degree == 2 ? "C3D20" : "C3D8I";
  return fmt::format("CP{}{}", part.material.plane_stress ? 'S' : 'E', m.degree == 2 ? 8 : 4);
}

void put_mesh(Buffer& out, const Model& m) {
  put(out, "*NODE, NSET=NODES\n");
  for (Eigen::Index i = 0; i < m.node.cols(); ++i)
    put(out, "{},{:.12g},{:.12g},{:.12g}\n", i + 1, m.node(0, i), m.node(1, i), m.node(2, i));
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    put(out, "*ELEMENT, TYPE={}, ELSET={}\n", element_type(m, m.parts[p]), part_label(m, p));
    for (Eigen::Index c = 0; c < m.cell.cols(); ++c) {
      if (m.part[static_cast<std::size_t>(c)] != static_cast<int>(p)) continue;
      put(out, "{}", c + 1);
      for (Eigen::Index a = 0; a < m.cell.rows(); ++a)
        put(out, "{}{}", a == 10 ? ",\n" : ",", m.cell(a, c) + 1);
      put(out, "\n");
    }
  }
  put(out, "*ELSET, ELSET=BODY\n");
  for (std::size_t p = 0; p < m.parts.size(); ++p) put(out, "{}\n", part_label(m, p));
}

void put_materials(Buffer& out, const Model& m) {
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    const Material& own = m.parts[p].material;
    put(out, "*MATERIAL, NAME=M_{0}\n*ELASTIC\n{1:.10g},{2:.10g}\n*DENSITY\n{3:.10g}\n", part_label(m, p),
        own.young, own.poisson, own.density);
    if (m.damping.mass != 0 || m.damping.stiffness != 0)
      put(out, "*DAMPING, ALPHA={:.10g}, BETA={:.10g}\n", m.damping.mass, m.damping.stiffness);
  }
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    put(out, "*SOLID SECTION, ELSET={0}, MATERIAL=M_{0}\n", part_label(m, p));
    if (m.dimension == 2) put(out, "{:.10g}\n", plane_thickness(m, true));
  }
}

void put_supports(Buffer& out, const Model& m) {
  if (m.fixed.empty()) return;
  put(out, "*BOUNDARY\n");
  for (const int unknown : m.fixed)
    put(out, "{0},{1},{1}\n", unknown / m.dimension + 1, unknown % m.dimension + 1);
}

std::string amplitude_name(const Model& m, int unknown) {
  return fmt::format("F{}{}", unknown / m.dimension + 1,
                     axis_letter[static_cast<std::size_t>(unknown % m.dimension)]);
}

/// At most four pairs of time and value stand in a line.
template <class Value>
void put_amplitude(Buffer& out, const std::string& name, const std::vector<double>& time,
                   const Value& value) {
  put(out, "*AMPLITUDE, NAME={}, TIME=TOTAL TIME\n", name);
  for (std::size_t k = 0; k < time.size(); ++k)
    put(out, "{:.9g},{:.9g}{}", time[k], value(k), k % 4 == 3 || k + 1 == time.size() ? "\n" : ",");
}

void put_own_load(Buffer& out, const Model& m, double thickness) {
  put(out, "*CLOAD\n");
  for (int i = 0; i < static_cast<int>(m.own_load.size()); ++i)
    if (m.own_load(i) != 0)
      put(out, "{},{},{:.10g}\n", i / m.dimension + 1, i % m.dimension + 1, thickness * m.own_load(i));
}

void put_gravity(Buffer& out, const Model& m, bool by_amplitude) {
  const double g = m.gravity.norm();
  if (g == 0) return;
  const Eigen::Vector3d along = m.gravity / g;
  put(out, "*DLOAD{}\nBODY,GRAV,{:.10g},{:.10g},{:.10g},{:.10g}\n", by_amplitude ? ", AMPLITUDE=GRAVITY" : "",
      g, along.x(), along.y(), along.z());
}

/// Fields come out in the nodes that went in: plane elements are solids inside.
void put_field_output(Buffer& out, const Model& m) {
  const bool dynamic = m.analysis == Analysis::dynamic;
  put(out, "*NODE FILE{0}\nU{1}\n*EL FILE{0}\nS\n", m.dimension == 2 ? ", OUTPUT=2D" : "",
      dynamic ? ",V" : "");
}

void put_output(Buffer& out, const Model& m, bool whole_field, const std::optional<Wanted>& wanted) {
  if (wanted) {
    const bool dynamic = m.analysis == Analysis::dynamic;
    put(out, "*NODE PRINT, NSET=WANTED\nU{0}\n*EL PRINT, ELSET=BODY, TOTALS=ONLY\nELSE{1}\n",
        dynamic ? ",V" : "", dynamic ? ",ELKE" : "");
    if (whole_field)
      put_field_output(out, m);
    else
      put(out, "*NODE FILE\n*EL FILE\n");  // none: else those of the step before go on
    return;
  }
  if (!m.probe.empty()) put(out, "*NODE PRINT, NSET=PROBES\nU\n");
  if (whole_field) put(out, "*NODE FILE\nU\n");
}

void put_set(Buffer& out, const std::string& name, const std::vector<int>& nodes) {
  put(out, "*NSET, NSET={}\n", name);
  for (const int node : nodes) put(out, "{}\n", node + 1);
}

std::vector<int> probe_nodes(const Model& m) {
  std::vector<int> nodes;
  for (Eigen::Index p = 0; p < m.probe_weights.outerSize(); ++p)
    for (Weights::InnerIterator it(m.probe_weights, p); it; ++it) nodes.push_back(static_cast<int>(it.col()));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// A plane element's node that carries no force has its velocity written as zero: it hangs on the nodes of
/// the solid inside, and only those of loaded nodes are tied back. A force of zero ties it.
void put_zero_forces(Buffer& out, const Model& m, const std::vector<int>& loaded) {
  if (m.dimension == 3) return;
  put(out, "*CLOAD\n");
  for (int i = 0; i < m.dimension * m.n_nodes(); ++i)
    if (!std::binary_search(m.fixed.begin(), m.fixed.end(), i) &&
        !std::binary_search(loaded.begin(), loaded.end(), i))
      put(out, "{},{},0.\n", i / m.dimension + 1, i % m.dimension + 1);
}

// The programs' own tolerance, half a per cent of the mean force in each increment, would add up.
constexpr const char* strict_convergence = "*CONTROLS, PARAMETERS=FIELD\n1.e-6,1.e-3\n";

bool linear(const Model& m) {
  return m.parts.front().material.model == MaterialModel::linear;
}

/// Windows of one length as one or more steps. What is printed and what is written as a field have one
/// frequency in a step, so a window that ends with fields is a step of its own.
struct Piece {
  std::size_t windows = 0;
  bool fields = false;
};

std::vector<Piece> pieces(std::size_t windows, std::size_t done, const std::optional<Wanted>& wanted) {
  const std::size_t every = wanted ? static_cast<std::size_t>(wanted->field_every) : 1;
  if (every == 1) return {{windows, wanted.has_value()}};
  std::vector<Piece> list;
  for (const std::size_t end = done + windows; done < end; done += list.back().windows) {
    const std::size_t to_field = every - done % every;
    if (to_field == 1)
      list.push_back({1, true});
    else
      list.push_back({std::min(to_field - 1, end - done), false});
  }
  return list;
}

void put_dynamics(Buffer& out, const Model& m, const LoadHistory& history,
                  const std::optional<Wanted>& wanted) {
  const double thickness = plane_thickness(m, true);
  for (std::size_t row = 0; row < history.unknown.size(); ++row)
    put_amplitude(out, amplitude_name(m, history.unknown[row]), history.time, [&](std::size_t k) {
      return thickness * history.value(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
    });
  if (m.gravity.norm() > 0)
    put_amplitude(out, "GRAVITY", history.time, [&](std::size_t k) { return history.gravity[k]; });

  bool first = true;
  std::size_t done = 0;
  for (const Stretch& stretch : stretches(history))
    for (const Piece& piece : pieces(stretch.windows, done, wanted)) {
      put(out, "**\n*STEP, INC={}{}\n", piece.windows + 10, linear(m) ? "" : ", NLGEOM");
      put(out, "{}*DYNAMIC, DIRECT, ALPHA=0.\n{:.12g},{:.12g}\n", strict_convergence, stretch.dt,
          static_cast<double>(piece.windows) * stretch.dt);
      if (first) {
        for (const int unknown : history.unknown)
          put(out, "*CLOAD, AMPLITUDE={}\n{},{},1.\n", amplitude_name(m, unknown), unknown / m.dimension + 1,
              unknown % m.dimension + 1);
        if (wanted) put_zero_forces(out, m, history.unknown);
        put_gravity(out, m, true);
      }
      put_output(out, m, piece.fields, wanted);
      put(out, "*END STEP\n");
      done += piece.windows;
      first = false;
    }
}

void put_body(Buffer& out, const Model& m, const std::optional<Wanted>& wanted) {
  put_mesh(out, m);
  put_materials(out, m);
  put_supports(out, m);
  if (wanted)
    put_set(out, "WANTED", wanted->node);
  else if (!m.probe.empty())
    put_set(out, "PROBES", probe_nodes(m));
}

}  // namespace

std::string calculix_window(const Model& m, const Wanted& wanted, const WindowLoad& load) {
  require_plain_materials(m);
  Buffer out;
  if (load.windows_before == 0)
    put_body(out, m, wanted);
  else
    put(out, "*RESTART, READ, STEP={}\n", load.windows_before);
  put(out, "*STEP, INC=10, AMPLITUDE=STEP{}\n{}", linear(m) ? "" : ", NLGEOM", strict_convergence);
  put(out, "*DYNAMIC, DIRECT, ALPHA=0.\n{0:.15g},{0:.15g}\n*RESTART, WRITE, FREQUENCY=1\n", load.dt);
  const double thickness = plane_thickness(m, true);
  put(out, "*CLOAD, OP=NEW\n");
  for (int i = 0; i < static_cast<int>(load.force.size()); ++i)
    if (!std::binary_search(m.fixed.begin(), m.fixed.end(), i) && (m.dimension == 2 || load.force(i) != 0))
      put(out, "{},{},{:.12e}\n", i / m.dimension + 1, i % m.dimension + 1, thickness * load.force(i));
  if (const double g = load.gravity * m.gravity.norm(); g != 0) {
    const Eigen::Vector3d along = m.gravity.normalized();
    put(out, "*DLOAD, OP=NEW\nBODY,GRAV,{:.12g},{:.12g},{:.12g},{:.12g}\n", g, along.x(), along.y(),
        along.z());
  }
  put_output(out, m, true, wanted);
  put(out, "*END STEP\n");
  return fmt::to_string(out);
}

std::string calculix(const Model& m, const std::optional<LoadHistory>& history, const Story& story,
                     const std::optional<Wanted>& wanted) {
  require_plain_materials(m);
  Buffer out;
  put(out,
      "** CalculiX deck, for ccx 2.20 or later: ccx -i NAME (without .inp); displacements of probes in "
      "NAME.dat\n");
  for (const std::string& line : explanation(m, history, story)) put(out, "** {}\n", line);
  if (m.dimension == 2) {
    const double thickness = plane_thickness(m, true);
    put(out,
        "** plane elements {:g} m thick; a force on a plane element's node is that on its whole thickness",
        thickness);
    put(out, "{}\n", thickness == 1 ? "" : ": all forces are multiplied by it");
  }
  put_body(out, m, wanted);
  if (history) {
    put_dynamics(out, m, *history, wanted);
  } else if (m.analysis == Analysis::modal) {
    put(out, "*STEP\n*FREQUENCY\n{}\n{}*END STEP\n", n_modes, wanted ? "" : "*NODE FILE\nU\n");
  } else {
    put(out, "*STEP{}\n*STATIC\n", linear(m) ? "" : ", NLGEOM");
    put_own_load(out, m, plane_thickness(m, true));
    put_gravity(out, m, false);
    put_output(out, m, true, wanted);
    put(out, "*END STEP\n");
  }
  return fmt::to_string(out);
}

}  // namespace strake::structure::deck
