// A mapping for each field where a participant has several meshes.

#include "coupler/case/mesh_transfer.hpp"

#include "coupler/case/case_scheme.hpp"
#include "coupler/coupling/assembly.hpp"
#include "coupler/mapping/mesh_part.hpp"
#include "proto/error.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace strake {
namespace mesh_transfer_test {

using Eigen::Index;
using Eigen::MatrixXd;

/// A participant of which only its announcement matters.
class Still : public models::Model<double> {
 public:
  Still(InterfaceMesh mesh, std::vector<Field> initial) {
    begin(std::move(mesh), 0);
    description_.initial = std::move(initial);
  }
  Description& announced() { return description_; }

 private:
  Advanced step(const Window&, const Input&) override { return {}; }
};

/// n faces between n + 1 points on the x axis from 0 to 1; their middles, without faces.
InterfaceMesh nodes(const std::string& name, Index n) {
  InterfaceMesh mesh = {name, 2, Points::Zero(3, n + 1), Eigen::MatrixXi(2, n), {}};
  mesh.position.row(0).setLinSpaced(n + 1, 0, 1);
  for (int f = 0; f < n; ++f) mesh.faces.col(f) << f, f + 1;
  return mesh;
}
InterfaceMesh middles(const std::string& name, Index n) {
  InterfaceMesh mesh = {name, 2, Points::Zero(3, n), Eigen::MatrixXi(2, 0), {}};
  const double half = 0.5 / static_cast<double>(n);
  mesh.position.row(0).setLinSpaced(n, half, 1 - half);
  return mesh;
}

/// Two meshes as one.
InterfaceMesh both(const InterfaceMesh& a, const InterfaceMesh& b) {
  InterfaceMesh mesh = {"joined",
                        2,
                        Points(3, a.position.cols() + b.position.cols()),
                        Eigen::MatrixXi(2, a.faces.cols() + b.faces.cols()),
                        {}};
  mesh.position << a.position, b.position;
  mesh.faces.leftCols(a.faces.cols()) = a.faces;
  mesh.faces.rightCols(b.faces.cols()) = b.faces.array() + static_cast<int>(a.position.cols());
  mesh.meshes = {{a.name, 0, 0}, {b.name, a.position.cols(), a.faces.cols()}};
  return mesh;
}

Field displacement(Index n) {
  return {"displacement", "m", false, MatrixXd::Zero(3, n)};
}
Field force(Index n) {
  return {"force", "N", true, MatrixXd::Zero(3, n)};
}

/// Random values on the columns [first, first + count), zero elsewhere.
Field random(Field field, Index first, Index count) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> number(-1, 1);
  field.value.edit().middleCols(first, count) =
      MatrixXd::NullaryExpr(field.value.rows(), count, [&] { return number(generator); });
  return field;
}

double dot(const Field& a, const Field& b) {
  return MatrixXd(a.value).cwiseProduct(MatrixXd(b.value)).sum();
}

/// The fluid takes the displacement on 21 nodes and gives the force on 20 middles. The structure has 11
/// nodes, and with `two` takes the force on 10 middles.
struct Panel {
  Still structure, fluid;
  explicit Panel(bool two = false)
      : structure(two ? both(nodes("moving", 10), middles("loaded", 10)) : nodes("panel", 10),
                  {displacement(two ? 21 : 11)}),
        fluid(both(nodes("wet", 20), middles("loading", 20)), {force(41)}) {
    fluid.announced().sent_on = {{"force", "loading"}};
    fluid.announced().taken_on = {{"displacement", "wet"}};
    if (!two) return;
    structure.announced().sent_on = {{"displacement", "moving"}};
    structure.announced().taken_on = {{"force", "loaded"}};
  }
  FieldTransfer transfer(const std::string& constraint = "conservative") const {
    return transfer_between_meshes(structure, fluid, [&](const InterfaceMesh& from, const InterfaceMesh& to) {
      MappingParameters parameters;
      parameters.constraint = constraint;
      if (takes_nearest(parameters, from) || constraint != "conservative")
        parameters.kind = "nearest-neighbour";
      return make_mapping(parameters, from, to);
    });
  }
};

TEST(MeshTransfer, ForceAndDisplacementGoBetweenTheirOwnMeshes) {
  const Panel panel;
  const FieldTransfer transfer = panel.transfer();
  const Field given = random(force(41), 21, 20), on_panel = transfer.onto_structure(given);
  EXPECT_LE((on_panel.value.rowwise().sum() - given.value.rowwise().sum()).norm(), 1e-14);
  EXPECT_EQ(on_panel.value.cols(), 11);
  Field moved = displacement(11);
  moved.value.edit().setConstant(0.25);
  const Field wet = transfer.onto_fluid(moved);
  EXPECT_LE((wet.value.leftCols(21).array() - 0.25).abs().maxCoeff(), 1e-15);
  EXPECT_EQ(wet.value.rightCols(20).norm(), 0);
  EXPECT_EQ(transfer.onto_structure(random(force(41), 0, 21)).value.norm(), 0)
      << "a force stands on its own mesh";
}

TEST(MeshTransfer, BothSidesHaveTheSameWork) {
  for (const bool two : {false, true}) {
    const Panel panel(two);
    const FieldTransfer transfer = panel.transfer();
    const Field given = random(force(41), 21, 20), moved = random(displacement(two ? 21 : 11), 0, 11);
    const double of_fluid = dot(given, transfer.where_fluid_loads(moved));
    const double of_structure = dot(transfer.onto_moving(transfer.onto_structure(given)), moved);
    EXPECT_NEAR(of_fluid, of_structure, 1e-15 * given.value.norm());
    EXPECT_GT(std::abs(of_fluid), 1e-3);
  }
}

TEST(MeshTransfer, AStructureTakesTheForceOnTheMeshThatItNames) {
  const Panel panel(true);
  const Field given = random(force(41), 21, 20), taken = panel.transfer().onto_structure(given);
  EXPECT_EQ(taken.value.leftCols(11).norm(), 0);
  EXPECT_LE((taken.value.rowwise().sum() - given.value.rowwise().sum()).norm(), 1e-14);
}

TEST(MeshTransfer, KeepsSumsByAreasToo) {
  for (const char* constraint : {"consistent", "scaled-consistent"}) {
    Panel panel;
    const FieldTransfer transfer = panel.transfer(constraint);
    Field given = force(41);
    given.value.edit().rightCols(20).setConstant(0.05);
    const Field taken = transfer.onto_structure(given);
    EXPECT_LE((taken.value.rowwise().sum() - given.value.rowwise().sum()).norm(),
              constraint[0] == 's' ? 1e-14 : 0.05);
    EXPECT_GT(taken.value.norm(), 0);
  }
}

TEST(MeshTransfer, QualityCountsThePointsOfTheTwoMeshesAlone) {
  const Panel panel(true);
  const FieldTransfer transfer = panel.transfer();
  const MappingQuality& load = quality_of_load(transfer);
  EXPECT_EQ(load.n_fluid, 20);
  EXPECT_EQ(load.n_structure, 10);
  EXPECT_EQ(load.without_load, 0);
  EXPECT_LE(load.row_sum_error, 1e-15);
  EXPECT_NEAR(load.largest_distance, 0.025, 1e-15);
  EXPECT_GE(load.farthest, 21) << "a point of the joined mesh";
  EXPECT_EQ(transfer.to_fluid().quality().n_fluid, 21);
  const auto lines = lines_of_crossings(transfer, MappingParameters{}, panel.structure, panel.fluid);
  EXPECT_EQ(lines.at(0), "displacement: moving of the structure, wet of the fluid");
  EXPECT_EQ(lines.at(5),
            "force: loaded of the structure, loading of the fluid, without faces: nearest points");
  EXPECT_EQ(lines.at(8), "  0 of 10 structure points feel no load");
}

TEST(MeshTransfer, WhatAPartnerDoesNotTakeIsZeroThere) {
  Panel panel;
  panel.structure.announced().initial.push_back({"stress", "Pa", false, MatrixXd::Zero(3, 11)});
  const FieldTransfer transfer = panel.transfer();
  EXPECT_EQ(transfer.onto_fluid({"stress", "Pa", false, MatrixXd::Ones(3, 11)}).value.norm(), 0);
  EXPECT_EQ(transfer.onto_fluid({"velocity", "m/s", false, MatrixXd::Ones(3, 11)}).value.norm(), 0);
  const auto lines = lines_of_crossings(transfer, {}, panel.structure, panel.fluid);
  EXPECT_EQ(lines.back(), "stress of the structure is not taken by its partner");
}

TEST(MeshTransfer, AConsistentFieldOfTheFluidGoesBackBetweenItsMeshes) {
  Panel panel;
  panel.fluid.announced().initial.push_back({"pressure", "Pa", false, MatrixXd::Zero(1, 41)});
  panel.fluid.announced().sent_on["pressure"] = "wet";
  const FieldTransfer transfer = panel.transfer();
  ASSERT_TRUE(transfer.to_structure());
  Field pressure = {"pressure", "Pa", false, MatrixXd::Zero(1, 41)};
  pressure.value.edit().leftCols(21).setConstant(3);
  const Field taken = transfer.onto_structure(pressure);
  EXPECT_LE((taken.value.array() - 3).abs().maxCoeff(), 1e-15);
}

TEST(MeshTransfer, NeedsAMeshForEachFieldThatIsSent) {
  Panel panel;
  panel.fluid.announced().sent_on.clear();
  try {
    panel.transfer();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "joins 2 meshes and does not say on which one it sends force");
  }
}

TEST(MeshTransfer, TheFluidIsToldOfTheMeshThatMoves) {
  Panel two(true);
  Still& structure = two.structure;
  structure.announced().initial[0].value.edit().leftCols(11).setConstant(0.5);
  structure.announced().initial.push_back({"heat", "W", false, MatrixXd::Zero(1, 21)});
  structure.announced().sent_on["heat"] = "loaded";
  EXPECT_EQ(mesh_for_fluid(structure).name, "moving");
  EXPECT_EQ(mesh_for_fluid(structure).faces.cols(), 10);
  const std::vector<Field> initial = initial_for_fluid(structure);
  ASSERT_EQ(initial.size(), 1u) << "heat lives on other points";
  EXPECT_EQ(MatrixXd(initial[0].value), MatrixXd::Constant(3, 11, 0.5));
  const Panel one;
  EXPECT_EQ(mesh_for_fluid(one.structure).position, one.structure.mesh().position);
  EXPECT_EQ(initial_for_fluid(one.structure).size(), 1u);
}

TEST(MeshTransfer, OneOfSeveralBodiesHasOneMesh) {
  Panel panel(true);
  try {
    Assembly({{"left", &panel.structure}, {"right", &panel.structure}}, {}, 0.1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "left");
    EXPECT_EQ(error.problem(), "has 2 meshes, and one of several bodies has one mesh");
  }
}

/// A participant whose mesh is followed by another one that nothing happens on.
class WithAnother : public Participant {
 public:
  WithAnother(Participant& own, Index more) : own_(own), more_(more), n_(own.mesh().position.cols()) {
    mesh_ = own.mesh();
    mesh_.meshes = {{"used", 0, 0}, {"other", n_, mesh_.faces.cols()}};
    mesh_.position.conservativeResize(3, n_ + more);
    mesh_.position.rightCols(more).setConstant(7);
    description_ = own.description();
    for (const char* name : {"displacement", "velocity", "force"})
      description_.sent_on[name] = description_.taken_on[name] = "used";
    for (Field& field : description_.initial) field = wide(field);
  }
  const InterfaceMesh& mesh() const override { return mesh_; }
  const Description& description() const override { return description_; }
  void start(const Window& window, const Input& input) override {
    Input narrow = input;
    for (Sample& sample : narrow.samples)
      for (Field& field : sample.fields) field = on_part(field, {0, n_, 0, 0});
    own_.start(window, narrow);
  }
  Advanced finish() override {
    Advanced answer = own_.finish();
    for (Field& field : answer.output) field = wide(field);
    return answer;
  }
  void rewind() override { own_.rewind(); }
  void commit(bool write) override { own_.commit(write); }
  void checkpoint(const std::filesystem::path&) override {}
  void resume(const std::filesystem::path&) override {}

 private:
  Field wide(const Field& field) const {
    MatrixXd value = MatrixXd::Zero(field.value.rows(), n_ + more_);
    value.leftCols(n_) = field.value;
    return {field.quantity, field.unit, field.conservative, std::move(value)};
  }
  Participant& own_;
  Index more_, n_;
  InterfaceMesh mesh_;
  Description description_;
};

/// Three masses that carry water. `more`: points of another mesh on each side.
struct MassesRun {
  static MatrixXd diagonal(double value) { return value * MatrixXd::Identity(3, 3); }
  Eigen::VectorXd start = Eigen::Vector3d(1e-3, 2e-3, -1e-3), still = Eigen::VectorXd::Zero(3);
  models::AddedMass water{diagonal(2) + MatrixXd::Ones(3, 3), still, models::Rule::trapezoidal};
  models::Oscillators masses{diagonal(1), diagonal(50), start, still, models::Rule::trapezoidal};

  std::vector<WindowReport> run(Index more, bool parallel) {
    water.place(start);
    WithAnother wide_water(water, std::max<Index>(more, 1)), wide_masses(masses, std::max<Index>(more, 1));
    Participant& fluid = more > 0 ? static_cast<Participant&>(wide_water) : water;
    Participant& structure = more > 0 ? static_cast<Participant&>(wide_masses) : masses;
    const MakeMapping make = [](const InterfaceMesh& from, const InterfaceMesh& to) {
      return nearest_neighbour(from, to);
    };
    SchemeParameters parameters;
    parameters.parallel = parallel;
    parameters.convergence = {1e-9, 1e-8, Measure::value, 1, 30, Unconverged::accept};
    Scheme scheme(fluid, structure,
                  more > 0 ? transfer_between_meshes(structure, fluid, make)
                           : FieldTransfer(make(structure.mesh(), fluid.mesh())),
                  parameters);
    std::vector<WindowReport> reports;
    for (int window = 0; window < 5; ++window) {
      reports.push_back(scheme.advance({0.01 * window, 0.01}));
      scheme.commit(false);
    }
    return reports;
  }
};

// The absolute limit is of the rms over the points on which a field lives: 40 idle points change nothing.
TEST(MeshTransfer, IdlePointsChangeNeitherResidualsNorWork) {
  for (const bool parallel : {false, true}) {
    const std::vector<WindowReport> one = MassesRun().run(0, parallel), two = MassesRun().run(40, parallel);
    for (std::size_t w = 0; w < one.size(); ++w) {
      EXPECT_EQ(one[w].iterations, two[w].iterations);
      EXPECT_TRUE(one[w].converged && two[w].converged);
      ASSERT_EQ(one[w].log.size(), two[w].log.size());
      for (std::size_t k = 0; k < one[w].log.size(); ++k)
        for (std::size_t f = 0; f < one[w].log[k].fields.size(); ++f) {
          const FieldResidual &a = one[w].log[k].fields[f], &b = two[w].log[k].fields[f];
          EXPECT_NEAR(a.residual, b.residual, 1e-12 + 1e-9 * a.residual) << w << " " << k << " " << f;
          EXPECT_NEAR(a.threshold, b.threshold, 1e-12 * a.threshold);
        }
      EXPECT_LE((one[w].displacement - two[w].displacement.leftCols(3)).norm(), 1e-12);
      EXPECT_EQ(two[w].displacement.rightCols(40).norm(), 0);
      EXPECT_NEAR(one[w].work.structure, two[w].work.structure, 1e-12);
      EXPECT_NEAR(one[w].work.fluid, two[w].work.fluid, 1e-12);
      EXPECT_NEAR(one[w].work.unconverged, two[w].work.unconverged, 1e-12);
    }
  }
}

// The water would refuse it too, after a minute of making particles.
TEST(MeshTransfer, ABodyInMillimetresIsRefusedBeforeTheWaterIsMade) {
  CaseView view;
  view.common.interface = "surface";
  view.fluid = SideView{.side = "fluid", .solver = "mps", .program = {}, .lines = {}, .echo = {}};
  view.structures.push_back(
      {.side = "structure", .solver = "./spring.py", .program = {}, .lines = {}, .echo = {}});
  view.value = {{"fluid.spacing", "0.05"}, {"fluid.open_top", "true"}};
  const Still in_m(nodes("floor", 4), {});
  InterfaceMesh mesh = nodes("floor", 4);
  mesh.position *= 1000;
  const Still in_mm(mesh, {});
  for (const auto& [key, value] : {std::pair("fluid.tank", "[[0, -0.05, 0], [1, 1.25, 0]]"),
                                   {"fluid.tank", "[[0, -0.05], [1, 1.25]]"},
                                   {"fluid.tank_polygon", "[[0, 1], [0, -1], [1, -1], [1, 1]]"}}) {
    CaseView one = view;
    one.value[key] = value;
    EXPECT_NO_THROW(check_within_tank(one, "structure", in_m)) << value;
    try {
      check_within_tank(one, "structure", in_mm);
      ADD_FAILURE() << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), "structure, t = 0 s");
      EXPECT_EQ(error.problem(), "the body starts at (250, 0) m, beyond the walls of the tank");
    }
    one.common.interface = "volume";
    EXPECT_NO_THROW(check_within_tank(one, "structure", in_mm)) << "the water does not ask there";
  }
}

TEST(MeshTransfer, VolumeCouplingHasOneMesh) {
  Panel panel;
  CouplingCase view;
  view.common.interface = "volume";
  EXPECT_THROW(transfer_of(view, panel.structure, panel.fluid), Error);
}

}  // namespace mesh_transfer_test
}  // namespace strake
