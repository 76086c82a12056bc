#include "coupler/participant/precice/own_part.hpp"

#include "coupler/participant/precice/partner_surface.hpp"
#include "coupler/participant/precice/solver_loop.hpp"
#include "proto/mesh_files/mesh_text.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace own_part_test {

const char* const two_participants = R"(<precice-configuration>
  <data:vector name="Force" />
  <data:vector name="Motion" />
  <data:scalar name="Pressure" />
  <mesh name="Water-Mesh" dimensions="2"><use-data name="Force" /><use-data name="Motion" /><use-data name="Pressure" /></mesh>
  <mesh name="Solid-Mesh" dimensions="2"><use-data name="Force" /><use-data name="Motion" /></mesh>
  <participant name="Water">
    <provide-mesh name="Water-Mesh" />
    <write-data name="Force" mesh="Water-Mesh" />
    <read-data name="Motion" mesh="Water-Mesh" />
  </participant>
  <participant name="Solid">
    <provide-mesh name="Solid-Mesh" />
    <receive-mesh name="Water-Mesh" from="Water" />
    <write-data name="Motion" mesh="Solid-Mesh" />
    <read-data name="Force" mesh="Solid-Mesh" />
  </participant>
  <participant name="Far">
    <provide-mesh name="Solid-Mesh" />
    <receive-mesh name="Water-Mesh" from="Water" />
    <write-data name="Pressure" mesh="Water-Mesh" />
  </participant>
  <coupling-scheme:serial-implicit>
    <participants first="Water" second="Solid" />
    <exchange data="Force" mesh="Water-Mesh" from="Water" to="Solid" substeps="true" />
    <exchange data="Motion" mesh="Water-Mesh" from="Solid" to="Water" substeps="false" />
  </coupling-scheme:serial-implicit>
</precice-configuration>
)";

/// The refusal says what is wrong and what may be done.
void expect_refused_with(const std::function<void()>& act, const std::string& problem,
                         const std::string& fix) {
  const std::string text = text_of_error(act, ExitCode::case_file);
  EXPECT_NE(text.find(problem), std::string::npos) << "expected: " << problem << "\n" << text;
  EXPECT_NE(text.find(fix), std::string::npos) << "expected: " << fix << "\n" << text;
}

class OwnPartOf : public testing::Test {
 protected:
  OwnPart part(const std::string& name, const std::string& names = "Motion=displacement") const {
    const auto path = folder_ / "precice-config.xml";
    put(path, two_participants);
    return OwnPart::of(PreciceConfig::read(path), name, QuantityNames(names));
  }
  TemporaryFolder folder_;
};

TEST_F(OwnPartOf, AParticipantHasItsMeshAndItsDataWithStrakesQuantities) {
  const OwnPart water = part("Water"), solid = part("Solid");
  EXPECT_EQ(water.mesh, "Water-Mesh");
  EXPECT_EQ(water.dimension, 2);
  ASSERT_EQ(water.reads.size(), 1u);
  EXPECT_EQ(water.reads[0].name, "Motion");
  EXPECT_EQ(water.reads[0].quantity, "displacement");
  EXPECT_EQ(water.reads[0].components, 2);
  EXPECT_TRUE(water.writes_samples && solid.reads_samples);
  EXPECT_FALSE(water.reads_samples || solid.writes_samples);
  water.check_data("fluid", "x.xml");
  solid.check_data("structure", "x.xml");
}

TEST_F(OwnPartOf, WhatCannotBeIsRefusedWithWhatThereIs) {
  expect_refused_with([&] { part("Watr"); }, "has no participant \"Watr\"", "Water, Solid, Far");
  expect_refused_with([&] { part("Far"); }, "uses data \"Pressure\" on mesh \"Water-Mesh\"", "Solid-Mesh");
  expect_refused_with([&] { part("Water", "Motion=pressure"); }, "Strake's pressure is a scalar",
                      "data:vector");
  expect_refused_with([&] { part("Water", "").check_data("fluid", "x.xml"); },
                      "a fluid of Strake reads displacement, velocity",
                      "fluid.precice_names = [\"Motion=displacement\"]");
  expect_refused_with([&] { part("Water").check_data("structure", "x.xml"); },
                      "a structure of Strake reads force", "");
  expect_refused_with([&] { part("Water").check_dimension(3, "x.xml"); },
                      "mesh \"Water-Mesh\" has 2 dimensions, the case has 3", "dimensions=\"3\"");
}

TEST(WindowTimes, WindowsEndAtMultiplesOfTheFirst) {
  WindowTimes times;
  for (int i = 0; i < 7; ++i) times.end(times.begin(0.1));
  EXPECT_EQ(times.time(), 7 * 0.1) << "a sum is 0.7 less 1e-16";
  times.end(times.begin(0.05));
  EXPECT_EQ(times.time(), 7 * 0.1 + 0.05);
  times.end(times.begin(0.05));
  EXPECT_EQ(times.time(), 8 * 0.1);
  EXPECT_EQ(times.windows(), 9);
}

InterfaceMesh triangle_strip() {
  InterfaceMesh mesh;
  mesh.dimension = 3;
  mesh.position.resize(3, 4);
  mesh.position << 0, 1.0 / 3, 0, 1e-17, 0, 0, 2.0 / 7, 1, 0, 0.1, 0, -0.0;
  mesh.faces.resize(3, 2);
  mesh.faces << 0, 1, 1, 3, 2, 2;
  return mesh;
}

TEST(GmshText, ASurfaceReadsBackToTheSameNumbers) {
  const InterfaceMesh mesh = triangle_strip();
  const Eigen::MatrixXd velocity = mesh.position.array() / 3 - 1.0 / 7;
  const TemporaryFolder folder;
  const auto path = folder / "body.msh";
  put(path, gmsh_text(mesh, {{"velocity", "m/s", false, velocity}}));
  const strake::Setup setup =
      setup_with_body({.solver = "precice", .surface = path, .case_file = {}, .sets = {}}, 3);
  EXPECT_EQ(setup.partner_mesh.position, mesh.position);
  EXPECT_EQ(setup.partner_mesh.faces, mesh.faces);
  EXPECT_EQ(Eigen::MatrixXd(find(setup.partner_initial, "velocity")->value), velocity);
  EXPECT_EQ(find(setup.partner_initial, "displacement")->value.norm(), 0) << "the file has none";
}

TEST(GmshText, BrokenVectorsOnNodesAreRefusedWithTheirLine) {
  const std::string whole =
      gmsh_text(triangle_strip(), {{"velocity", "m/s", false, Eigen::MatrixXd::Ones(3, 4)}});
  EXPECT_EQ(read_gmsh_text(whole, "a.msh").node_data.at("velocity").size(), 4u);
  const std::size_t last = whole.rfind("4 1 1 1");
  ASSERT_NE(last, std::string::npos);
  const auto read = [](const std::string& text) { read_gmsh_text(text, "a.msh"); };
  expect_refused_with([&] { read(std::string(whole).replace(last, 7, "4 1 one")); }, "a.msh:28",
                      "NODE X Y Z");
  expect_refused_with([&] { read(whole.substr(0, last)); }, "the file ends here", "a value on a node");
}

TEST(SetupWithBody, ACaseWithoutABodyIsRefused) {
  const TemporaryFolder folder;
  expect_refused_with(
      [&] { setup_with_body({.solver = "none", .surface = {}, .case_file = "a.toml", .sets = {}}, 2); },
      "has no body", "structure.solver");
  expect_refused_with(
      [&] { setup_with_body({.solver = "/bin/ccx", .surface = {}, .case_file = "a.toml", .sets = {}}, 2); },
      "says nothing of the surface that /bin/ccx moves", "surface = \"body.msh\"");
  const auto path = folder / "body.msh";
  put(path, gmsh_text(triangle_strip(), {}));
  expect_refused_with(
      [&] { setup_with_body({.solver = "none", .surface = path, .case_file = {}, .sets = {}}, 2); },
      "holds no lines", "");
}

}  // namespace own_part_test
}  // namespace strake
