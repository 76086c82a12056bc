#include "structure/deck/deck.hpp"

#include <fmt/format.h>

#include <array>

namespace strake::structure::deck {
namespace {

using Buffer = std::string;
constexpr std::array<char, 3> axis_letter = {'X', 'Y', 'Z'};

template <class... Values>
void put(Buffer& out, fmt::format_string<Values...> text, Values&&... values) {
  out += fmt::format(text, std::forward<Values>(values)...);
}

/// Writes the element types of the body. All integrate fully. In two dimensions type 1 is plane strain and
/// type 2 plane stress.
void put_types(Buffer& out, const Model& m) {
  const bool quadratic = m.degree == 2;
  if (m.dimension == 3) {
    put(out, "ET,1,{}\nKEYOPT,1,2,{}       ! {}\n", quadratic ? "SOLID186" : "SOLID185", quadratic ? 1 : 2,
        quadratic ? "full integration" : "enhanced strain");
    return;
  }
  const char* name = quadratic ? "PLANE183" : "PLANE182";
  put(out,
      "ET,1,{0}\nKEYOPT,1,3,2       ! plane strain\nET,2,{0}\nKEYOPT,2,3,0       ! plane stress, 1 m thick\n",
      name);
}

void put_mesh(Buffer& out, const Model& m) {
  for (Eigen::Index i = 0; i < m.node.cols(); ++i)
    put(out, "N,{},{:.12g},{:.12g},{:.12g}\n", i + 1, m.node(0, i), m.node(1, i), m.node(2, i));
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    put(out, "TYPE,{}\nMAT,{}\n", m.dimension == 2 && m.parts[p].material.plane_stress ? 2 : 1, p + 1);
    for (Eigen::Index c = 0; c < m.cell.cols(); ++c) {
      if (m.part[static_cast<std::size_t>(c)] != static_cast<int>(p)) continue;
      put(out, "EN,{}", c + 1);
      for (Eigen::Index a = 0; a < m.cell.rows(); ++a)
        put(out, "{}{}", a > 0 && a % 8 == 0 ? "\nEMORE," : ",", m.cell(a, c) + 1);
      put(out, "\n");
    }
    put(out, "ESEL,S,MAT,,{}\nCM,{},ELEM\nALLSEL\n", p + 1, part_label(m, p));
  }
}

std::string label(const Model& m, int unknown, char kind) {
  return fmt::format("{}{}", kind, axis_letter[static_cast<std::size_t>(unknown % m.dimension)]);
}

int node_of(const Model& m, int unknown) {
  return unknown / m.dimension + 1;
}

/// Rows 1 … n of one column of a table (0: the times), ten values per command.
template <class Value>
void put_column(Buffer& out, const std::string& name, int column, std::size_t n, const Value& value) {
  for (std::size_t k = 0; k < n; ++k)
    put(out, "{}{:.9g}",
        k % 10 == 0 ? fmt::format("{}*SET,{}({},{}),", k > 0 ? "\n" : "", name, k + 1, column) : ",",
        value(k));
  put(out, "\n");
}

template <class Value>
void put_table(Buffer& out, const std::string& name, const std::vector<double>& time, const Value& value) {
  put(out, "*DIM,{},TABLE,{},1,1,TIME\n", name, time.size());
  put_column(out, name, 0, time.size(), [&](std::size_t k) { return time[k]; });
  put_column(out, name, 1, time.size(), value);
}

/// ACEL is the acceleration of the frame, so the opposite of gravity.
void put_gravity(Buffer& out, const Model& m, const std::optional<LoadHistory>& history) {
  if (m.gravity.norm() == 0) return;
  if (!history || m.gravity_ramp == 0) {
    put(out, "ACEL,{:.10g},{:.10g},{:.10g}\n", 0 - m.gravity.x(), 0 - m.gravity.y(), 0 - m.gravity.z());
    return;
  }
  put(out, "ACEL");
  for (const char axis : axis_letter) put(out, ",%G{}%", axis);
  put(out, "\n");
}

void put_dynamics(Buffer& out, const Model& m, const LoadHistory& history) {
  put(out, "! forces on nodes over time, one table each\n");
  const auto name = [&](int unknown) {
    return fmt::format("{}_{}", label(m, unknown, 'F'), node_of(m, unknown));
  };
  for (std::size_t row = 0; row < history.unknown.size(); ++row)
    put_table(out, name(history.unknown[row]), history.time, [&](std::size_t k) {
      return history.value(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
    });
  if (m.gravity.norm() > 0 && m.gravity_ramp > 0)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      put_table(out, fmt::format("G{}", axis_letter[static_cast<std::size_t>(axis)]), history.time,
                [&](std::size_t k) { return -history.gravity[k] * m.gravity(axis); });
  for (const int unknown : history.unknown)
    put(out, "F,{},{},%{}%\n", node_of(m, unknown), label(m, unknown, 'F'), name(unknown));
  put(out,
      "FINISH\n/SOLU\nANTYPE,TRANS\nTRNOPT,FULL\nTINTP,0             ! Newmark 1/4-1/2, no numerical "
      "damping\n");
  put(out, "AUTOTS,OFF\nKBC,0\nOUTRES,ERASE\nOUTRES,NSOL,ALL\n");
  if (m.damping.mass != 0) put(out, "ALPHAD,{:.10g}\n", m.damping.mass);
  if (m.damping.stiffness != 0) put(out, "BETAD,{:.10g}\n", m.damping.stiffness);
}

void put_probes(Buffer& out, const Model& m) {
  if (m.probe.empty()) return;
  put(out, "/POST26              ! displacement over time; weights of the nodes stand in probes.csv\n");
  put(out, "NUMVAR,200\n");
  int variable = 2;  // 1 is time
  for (Eigen::Index p = 0; p < m.probe_weights.outerSize(); ++p)
    for (Weights::InnerIterator it(m.probe_weights, p); it; ++it)
      for (int axis = 0; axis < m.dimension && variable <= 200; ++axis)
        put(out, "NSOL,{0},{1},U,{2},U{2}_{1}\n", variable++, it.col() + 1,
            axis_letter[static_cast<std::size_t>(axis)]);
  put(out, "FINISH\n");
}

}  // namespace

std::string ansys(const Model& m, const std::optional<LoadHistory>& history, const Story& story) {
  require_plain_materials(m);
  Buffer out;
  put(out,
      "! Ansys Mechanical APDL, read with /INPUT. Written by its documented commands; Strake's tests do not "
      "run Ansys:\n");
  put(out, "! they run the CalculiX deck of the same model and load, `strake export RUN --to ccx`.\n");
  for (const std::string& line : explanation(m, history, story)) put(out, "! {}\n", line);
  put(out, "/PREP7\n");
  put_types(out, m);
  for (std::size_t p = 0; p < m.parts.size(); ++p) {
    const Material& own = m.parts[p].material;
    put(out, "MP,EX,{0},{1:.10g}\nMP,PRXY,{0},{2:.10g}\nMP,DENS,{0},{3:.10g}\n", p + 1, own.young,
        own.poisson, own.density);
  }
  put_mesh(out, m);
  put(out, "! supports\n");
  for (const int unknown : m.fixed) put(out, "D,{},{},0\n", node_of(m, unknown), label(m, unknown, 'U'));
  const bool linear = m.parts.front().material.model == MaterialModel::linear;
  if (history) {
    put_dynamics(out, m, *history);
  } else {
    for (int i = 0; i < static_cast<int>(m.own_load.size()); ++i)
      if (m.own_load(i) != 0) put(out, "F,{},{},{:.10g}\n", node_of(m, i), label(m, i, 'F'), m.own_load(i));
    put(out, "FINISH\n/SOLU\n");
    put(out, "{}",
        m.analysis == Analysis::modal ? "ANTYPE,MODAL\nMODOPT,LANB,6\nMXPAND,6\n" : "ANTYPE,STATIC\n");
  }
  const bool modal = !history && m.analysis == Analysis::modal;
  if (!modal) {
    put(out, "NLGEOM,{}\n", linear ? "OFF" : "ON");
    put_gravity(out, m, history);
  }
  if (history) {
    for (const Stretch& stretch : stretches(*history))
      put(out, "DELTIM,{0:.12g},{0:.12g},{0:.12g}\nTIME,{1:.12g}\nSOLVE\n", stretch.dt, stretch.end);
  } else {
    put(out, "SOLVE\n");
  }
  put(out, "FINISH\n");
  if (history) put_probes(out, m);
  return out;
}

}  // namespace strake::structure::deck
