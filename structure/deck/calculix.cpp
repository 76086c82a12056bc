#include "structure/deck/deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace strake::structure::deck {
namespace {

using Buffer = std::string;
constexpr std::array<char, 3> axis_letter = {'X', 'Y', 'Z'};
constexpr int n_modes = 9;  // three beside the six rigid motions of a free body

template <class... Values>
void put(Buffer& out, fmt::format_string<Values...> text, Values&&... values) {
  out += fmt::format(text, std::forward<Values>(values)...);
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
    if (m.dimension == 2) put(out, "{:.10g}\n", plane_thickness(m));
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

void put_output(Buffer& out, const Model& m, bool whole_field) {
  if (!m.probe.empty()) put(out, "*NODE PRINT, NSET=PROBES\nU\n");
  if (whole_field) put(out, "*NODE FILE\nU\n");
}

/// Requests fields in the nodes of the model: CalculiX expands plane elements to solids. Requests stay valid
/// from step to step until there is another one, which may be empty.
void put_wanted(Buffer& out, const Model& m, bool fields) {
  const bool dynamic = m.analysis == Analysis::dynamic;
  put(out, "*NODE PRINT, NSET=WANTED\nU{0}\n*EL PRINT, ELSET=BODY, TOTALS=ONLY\nELSE{1}\n",
      dynamic ? ",V" : "", dynamic ? ",ELKE" : "");
  if (fields)
    put(out, "*NODE FILE{0}\nU{1}\n*EL FILE{0}\nS\n", m.dimension == 2 ? ", OUTPUT=2D" : "",
        dynamic ? ",V" : "");
  else
    put(out, "*NODE FILE\n*EL FILE\n");
}

template <class Nodes>
void put_set(Buffer& out, const std::string& name, const Nodes& nodes) {
  put(out, "*NSET, NSET={}\n", name);
  for (const int node : nodes) put(out, "{}\n", node + 1);
}

// The programs' own tolerance, half a per cent of the mean force in each increment, would add up.
constexpr const char* strict_convergence = "*CONTROLS, PARAMETERS=FIELD\n1.e-6,1.e-3\n";

bool linear(const Model& m) {
  return m.parts.front().material.model == MaterialModel::linear;
}

void put_dynamics(Buffer& out, const Model& m, const LoadHistory& history) {
  const double thickness = plane_thickness(m);
  for (std::size_t row = 0; row < history.unknown.size(); ++row)
    put_amplitude(out, amplitude_name(m, history.unknown[row]), history.time, [&](std::size_t k) {
      return thickness * history.value(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
    });
  if (m.gravity.norm() > 0)
    put_amplitude(out, "GRAVITY", history.time, [&](std::size_t k) { return history.gravity[k]; });

  bool first = true;
  double begin = 0;
  for (const Stretch& stretch : stretches(history)) {
    put(out, "**\n*STEP, INC={}{}\n", stretch.windows + 10, linear(m) ? "" : ", NLGEOM");
    put(out, "{}*DYNAMIC, DIRECT, ALPHA=0.\n{:.12g},{:.12g}\n", strict_convergence, stretch.dt,
        stretch.end - begin);
    if (first) {
      for (const int unknown : history.unknown)
        put(out, "*CLOAD, AMPLITUDE={}\n{},{},1.\n", amplitude_name(m, unknown), unknown / m.dimension + 1,
            unknown % m.dimension + 1);
      put_gravity(out, m, true);
    }
    put_output(out, m, false);
    put(out, "*END STEP\n");
    begin = stretch.end;
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
    put_set(out, "PROBES", nodes_of(m.probe_weights));
}

/// A step of one increment under a constant load. `before`: the load of the step before in the same deck, so
/// that only what changes is written. A plane element's node without a force has its velocity written as
/// zero: CalculiX ties it to the nodes of its solid element only if it is loaded. A force of zero ties it.
void put_window(Buffer& out, const Model& m, const WindowLoad& load, const WindowLoad* before,
                const char* restart, bool fields) {
  put(out, "*STEP, INC=10, AMPLITUDE=STEP{}\n{}", linear(m) ? "" : ", NLGEOM", strict_convergence);
  put(out, "*DYNAMIC, DIRECT, ALPHA=0.\n{0:.15g},{0:.15g}\n{1}", load.dt, restart);
  const double thickness = plane_thickness(m);
  bool any = false;
  for (int i = 0; i < static_cast<int>(load.force.size()); ++i) {
    const bool said = before ? load.force(i) != before->force(i) : m.dimension == 2 || load.force(i) != 0;
    if (!said || std::binary_search(m.fixed.begin(), m.fixed.end(), i)) continue;
    if (!any) put(out, "*CLOAD, OP={}\n", before ? "MOD" : "NEW");
    put(out, "{},{},{:.12e}\n", i / m.dimension + 1, i % m.dimension + 1, thickness * load.force(i));
    any = true;
  }
  if (const double g = m.gravity.norm(); g != 0) {
    const Eigen::Vector3d along = m.gravity / g;
    put(out, "*DLOAD, OP=NEW\nBODY,GRAV,{:.12g},{:.12g},{:.12g},{:.12g}\n", load.gravity * g, along.x(),
        along.y(), along.z());
  }
  put_wanted(out, m, fields);
  put(out, "*END STEP\n");
}

}  // namespace

std::string calculix_window(const Model& m, const Wanted& wanted, const WindowLoad& load) {
  require_plain_materials(m);
  Buffer out;
  if (load.windows_before == 0)
    put_body(out, m, wanted);
  else
    put(out, "*RESTART, READ, STEP={}\n", load.windows_before);
  put_window(out, m, load, nullptr, "*RESTART, WRITE, FREQUENCY=1\n", true);
  return out;
}

std::string calculix_windows(const Model& m, const Wanted& wanted, const std::vector<WindowLoad>& loads) {
  require_plain_materials(m);
  Buffer out;
  put_body(out, m, wanted);
  const auto every = static_cast<std::size_t>(wanted.field_every);
  for (std::size_t w = 0; w < loads.size(); ++w)
    put_window(out, m, loads[w], w == 0 ? nullptr : &loads[w - 1], "", (w + 1) % every == 0);
  return out;
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
    const double thickness = plane_thickness(m);
    put(out,
        "** plane elements {:g} m thick; a force on a plane element's node is that on its whole thickness",
        thickness);
    put(out, "{}\n", thickness == 1 ? "" : ": all forces are multiplied by it");
  }
  put_body(out, m, wanted);
  if (history) {
    put_dynamics(out, m, *history);
  } else if (m.analysis == Analysis::modal) {
    put(out, "*STEP\n*FREQUENCY\n{}\n{}*END STEP\n", n_modes, wanted ? "" : "*NODE FILE\nU\n");
  } else {
    put(out, "*STEP{}\n*STATIC\n", linear(m) ? "" : ", NLGEOM");
    put_own_load(out, m, plane_thickness(m));
    put_gravity(out, m, false);
    if (wanted)
      put_wanted(out, m, true);
    else
      put_output(out, m, true);
    put(out, "*END STEP\n");
  }
  return out;
}

}  // namespace strake::structure::deck
