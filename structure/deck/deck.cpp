#include "structure/deck/deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace strake::structure::deck {
namespace {

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

}  // namespace

std::string probe_table(const Model& m) {
  std::string text = "probe,node,weight\n";
  for (Eigen::Index p = 0; p < m.probe_weights.outerSize(); ++p)
    for (Weights::InnerIterator it(m.probe_weights, p); it; ++it)
      text += fmt::format("{},{},{:.12g}\n", m.probe[static_cast<std::size_t>(p)], it.col() + 1, it.value());
  return text;
}

std::vector<std::string> explanation(const Model& m, const std::optional<LoadHistory>& history,
                                     const Story& story) {
  std::vector<std::string> lines = {
      one_line(story.title), "from " + one_line(story.origin),
      "SI units: m, kg, s, N, Pa" + std::string(m.dimension == 2 ? "; forces per metre of depth" : "")};
  const Eigen::Vector3d& v = m.support_velocity;
  lines.push_back(
      fmt::format("frame: that of the supports, which move at ({:g}, {:g}, {:g}) m/s: an inertial one, in",
                  v.x(), v.y(), v.z()));
  lines.push_back(
      "which they are held and the body is at rest at the start. Displacements are deflections; add "
      "velocity");
  lines.push_back("times time for what an observer at rest sees.");
  if (history) {
    lines.push_back(fmt::format(
        "load: recorded, {} windows to {:.6g} s, mapped to nodes by the transposed shape functions;",
        history->time.size() - 1, history->end()));
    lines.push_back(
        "a value at a window's end is the mean of the two windows that meet there, so that the trapezoidal "
        "sum");
    lines.push_back(
        "is the recorded impulse. Strake's finite elements feel each window's mean in its middle.");
    lines.push_back("time: Newmark 1/4-1/2 without damping of its own, one increment per window.");
  }
  if (m.degree == 2)
    lines.push_back(
        "elements: quadratic, mid-side nodes; Strake's have one more node in the middle of each face and "
        "cell.");
  else
    lines.push_back(
        "elements: linear; programs differ in how these are kept from locking. Compare with degree 2.");
  for (std::size_t p = 0; p < m.probe.size(); ++p) {
    const Eigen::Vector3d at = m.probe_at.col(static_cast<Eigen::Index>(p));
    std::string sum;
    for (Weights::InnerIterator it(m.probe_weights, static_cast<Eigen::Index>(p)); it; ++it)
      sum += fmt::format("{}{:.6g} u({})", sum.empty() ? "" : " + ", it.value(), it.col() + 1);
    const std::string line =
        fmt::format("probe {} at ({:g}, {:g}, {:g}) m: ", m.probe[p], at.x(), at.y(), at.z());
    lines.push_back(line +
                    (line.size() + sum.size() < 110 ? sum : "its nodes and weights stand in probes.csv"));
  }
  return lines;
}

double plane_thickness(const Model& m) {
  const bool stress =
      std::any_of(m.parts.begin(), m.parts.end(), [](const Part& p) { return p.material.plane_stress; });
  return m.dimension == 2 && stress ? 0.01 * shortest_edge(m) : 1;
}

std::string part_label(const Model& m, std::size_t part) {
  std::string label = fmt::format("P{}_", part + 1);
  for (const unsigned char c : m.parts[part].name)
    label += std::isalnum(c) != 0 ? static_cast<char>(std::toupper(c)) : '_';
  return label.substr(0, 30);
}

}  // namespace strake::structure::deck
