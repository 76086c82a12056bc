#include "structure/deck/deck.hpp"

#include "proto/error.hpp"
#include "structure/fem/fem.hpp"
#include "tests/structure/body/boxes.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure::deck {
namespace deck_test {

Parameters body(int dimension, int degree = 2) {
  std::vector<SolidBox> boxes = {soft_box("floor 1", {0, 0, 0}, {1, 0.1, 0.2}),
                                 soft_box("rib", {0.4, 0.1, 0}, {0.5, 0.3, 0.2})};
  boxes[0].support[0] = Support::clamped;
  boxes[1].material.young = 2e6;
  Parameters p;
  p.dimension = dimension;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(dimension, boxes);
  if (dimension == 2) p.shape.corner = outer_polygons(p.solid).front();
  p.fem.refinement = 0;
  p.fem.degree = degree;
  p.surface_spacing = 0.05;
  return p;
}

ProbeKeys probe(const Eigen::Vector3d& at) {
  return {.name = "tip", .of = "structure", .at = at, .quantity = "deflection", .diameter = 0};
}

const Story story{.title = "a title\nin two lines", .origin = "run"};

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

// The weights of each point reproduce linear fields. So forces on nodes keep sum and moment, though nodes in
// the middle of faces and cells are removed.
TEST(Deck, EdgeNodesCarryLoadsWithTheirSumAndMoment) {
  for (const int dimension : {2, 3})
    for (const int degree : {1, 2}) {
      const Eigen::Vector3d inside(0.43, 0.06, dimension == 3 ? 0.07 : 0);
      const Model m = fem::model(body(dimension, degree), {probe(inside)});
      EXPECT_EQ(m.cell.rows(), dimension == 2 ? 4 * degree : 12 * degree - 4);
      EXPECT_NEAR((m.probe_weights * m.node.transpose() - inside.transpose()).norm(), 0, 1e-12);
      const Points at = (m.interface * m.node.transpose()).transpose();
      EXPECT_NEAR((at - m.interface_position).norm(), 0, 1e-11);
      EXPECT_NEAR((m.interface * Eigen::VectorXd::Ones(m.n_nodes())).minCoeff(), 1, 1e-12);
      // Every node belongs to a cell.
      Eigen::VectorXi used = Eigen::VectorXi::Zero(m.n_nodes());
      for (const int node : m.cell.reshaped()) used(node) = 1;
      EXPECT_EQ(used.sum(), m.n_nodes());
    }
}

TEST(Deck, NodesOfACellStandInTheOrderOfTheOtherPrograms) {
  const Model m = fem::model(body(3), {});
  for (Eigen::Index c = 0; c < m.cell.cols(); ++c) {
    const auto at = [&](int a) -> Eigen::Vector3d { return m.node.col(m.cell(a, c)); };
    EXPECT_GT((at(1) - at(0)).cross(at(3) - at(0)).dot(at(4) - at(0)), 0);
    for (int a = 0; a < 4; ++a) {
      const int next = (a + 1) % 4;
      EXPECT_NEAR((at(8 + a) - 0.5 * (at(a) + at(next))).norm(), 0, 1e-12) << "an edge of the bottom";
      EXPECT_NEAR((at(12 + a) - 0.5 * (at(4 + a) + at(4 + next))).norm(), 0, 1e-12) << "an edge of the top";
      EXPECT_NEAR((at(16 + a) - 0.5 * (at(a) + at(4 + a))).norm(), 0, 1e-12) << "an upright edge";
    }
  }
}

TEST(Deck, TheLoadOfTheCaseKeepsItsSum) {
  Parameters p = body(2);
  p.load = {.kind = LoadKind::traction, .value = {0, -5, 0}, .face = "rib.top", .at = {}, .ramp = 0.1};
  EXPECT_NEAR(fem::model(p, {}).own_load.sum(), -5 * 0.1, 1e-12);
}

// Windows of unequal length: the trapezoidal sum of what the other program takes is the recorded impulse.
TEST(Deck, ValuesAtWindowEndsCarryTheRecordedImpulse) {
  const Model m = fem::model(body(2), {});
  const std::vector<Window> windows = {{0.5, 0.1}, {0.6, 0.1}, {0.7, 0.05}, {0.75, 0.05}, {0.8, 0.02}};
  std::vector<Points> force;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  for (std::size_t w = 0; w < windows.size(); ++w) {
    force.push_back(Points::Zero(3, m.interface_position.cols()));
    // Away from the clamped end, where a load would be lost in the support.
    for (Eigen::Index i = 0; i < force[w].cols(); ++i)
      if (m.interface_position(0, i) > 0.6) force[w].col(i) << std::cos(3.0 * static_cast<double>(w)), 1.0, 0;
    impulse += windows[w].dt * force[w].rowwise().sum();
  }
  const LoadHistory history = nodal_history(m, windows, force);
  ASSERT_EQ(history.time.size(), windows.size() + 1);
  EXPECT_EQ(history.time.front(), 0);
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();
  for (std::size_t row = 0; row < history.unknown.size(); ++row)
    for (std::size_t k = 0; k + 1 < history.time.size(); ++k) {
      const auto r = static_cast<Eigen::Index>(row), c = static_cast<Eigen::Index>(k);
      felt(history.unknown[row] % 2) +=
          0.5 * (history.value(r, c) + history.value(r, c + 1)) * (history.time[k + 1] - history.time[k]);
    }
  EXPECT_NEAR((felt - impulse).norm(), 0, 1e-12 * impulse.norm());
  const auto parts = stretches(history);
  ASSERT_EQ(parts.size(), 3u) << "a step of the deck for each length of window";
  EXPECT_EQ(parts[0].windows, 2u);
  EXPECT_NEAR(parts[1].dt, 0.05, 1e-15);
  EXPECT_EQ(count(calculix(m, history, story), "*DYNAMIC, DIRECT, ALPHA=0."), 3u);
  EXPECT_EQ(count(ansys(m, history, story), "DELTIM,"), 3u);
}

TEST(Deck, PartsKeepTheirMaterialsAndSupports) {
  const Model m = fem::model(body(2), {probe({1, 0.05, 0})});
  const std::string ccx = calculix(m, std::nullopt, story), apdl = ansys(m, std::nullopt, story);
  EXPECT_NE(ccx.find("*ELEMENT, TYPE=CPE8, ELSET=P1_FLOOR_1\n"), std::string::npos);
  EXPECT_NE(ccx.find("*MATERIAL, NAME=M_P2_RIB\n*ELASTIC\n2000000,0.3\n*DENSITY\n1000\n"), std::string::npos);
  EXPECT_NE(ccx.find("** a title in two lines\n"), std::string::npos);
  EXPECT_NE(apdl.find("ET,1,PLANE183\nKEYOPT,1,3,2"), std::string::npos);
  EXPECT_NE(apdl.find("MP,EX,2,2000000\n"), std::string::npos);
  EXPECT_EQ(count(apdl, "\nD,"), m.fixed.size());
  EXPECT_EQ(count(apdl, "\nEN,"), static_cast<std::size_t>(m.n_cells()));
  EXPECT_NE(apdl.find("do not run Ansys"), std::string::npos) << "what was tried and what was not";
  EXPECT_EQ(probe_table(m).substr(0, 22), "probe,node,weight\ntip,");
}

TEST(Deck, PlaneStressIsOfThinElements) {
  Parameters p = body(2);
  for (Part& part : p.solid.parts) part.material.plane_stress = true;
  p.load = {.kind = LoadKind::point, .value = {0, -7, 0}, .face = {}, .at = {1, 0.1, 0}, .ramp = 0};
  const Model m = fem::model(p, {});
  EXPECT_NEAR(plane_thickness(m), 0.01 * shortest_edge(m), 1e-15);
  const std::string ccx = calculix(m, std::nullopt, story), apdl = ansys(m, std::nullopt, story);
  EXPECT_NE(ccx.find("TYPE=CPS8"), std::string::npos);
  EXPECT_NE(apdl.find("TYPE,2\n"), std::string::npos);
  EXPECT_NE(apdl.find(",FY,-7\n"), std::string::npos) << "per metre of depth";
}

TEST(Deck, AMaterialThatNoDeckCanSayIsRefused) {
  Parameters p = body(2);
  p.solid.parts[1].material.model = MaterialModel::neo_hookean;
  EXPECT_THROW(calculix(fem::model(p, {}), std::nullopt, story), Error);
  p.solid.parts[1].material.model = MaterialModel::saint_venant_kirchhoff;
  EXPECT_THROW(ansys(fem::model(p, {}), std::nullopt, story), Error) << "beside a linear part";
}

}  // namespace deck_test
}  // namespace strake::structure::deck
