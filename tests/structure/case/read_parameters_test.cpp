#include "structure/case/read_parameters.hpp"

#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "structure/body/parameters.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake::structure {
namespace read_parameters_test {

/// The paper's plate as a case file; `more` goes to the end.
CaseFile plate_case(const std::vector<std::string>& sets = {}, const std::string& more = {}) {
  return CaseFile::parse(R"(end_time = 0.03
[fluid]
spacing = 0.01
[structure]
velocity = [0.0, -6.26, 0.0]
[structure.plate]
length = 0.4
thickness = 0.02
supports = { left = "clamped", right = "clamped" }
)" + more,
                         "case.toml", sets);
}

Parameters read_plate_case(const std::string& kind, const std::vector<std::string>& sets = {}) {
  CaseFile file = plate_case(sets);
  Parameters p = read(file, kind);
  file.refuse_unknown("structure");
  return p;
}

/// What reading complains of; empty if it does not.
std::string complaint(const std::string& kind, const std::vector<std::string>& sets,
                      const std::string& more = {}) {
  try {
    CaseFile file = plate_case(sets, more);
    read(file, kind);
    file.refuse_unknown("structure");
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    return to_text(e);
  }
  return {};
}

TEST(StructureKeys, DefaultsFollowFluidAndModel) {
  const Parameters surface = read_plate_case("particle");
  EXPECT_EQ(surface.surface_spacing, 0.01);  // fluid.spacing
  EXPECT_EQ(surface.particle.model, ParticleModel::total_lagrangian);
  EXPECT_NEAR(surface.particle.spacing, 0.25 * surface.plate.thickness, 1e-12);  // four layers
  EXPECT_EQ(surface.particle.clamp, ClampColumn::inside);
  EXPECT_EQ(surface.gravity.y(), -9.81);
  EXPECT_EQ(surface.plate.left, Support::clamped);

  const Parameters volume = read_plate_case("particle", {"coupling.interface=volume"});
  EXPECT_EQ(volume.particle.spacing, 0.01);  // fluid.spacing
  EXPECT_EQ(volume.particle.model, ParticleModel::pair);
  EXPECT_EQ(volume.particle.clamp, ClampColumn::outside);
}

TEST(StructureKeys, WithoutAFluidThereIsNoGravityUnlessTheCaseSaysSo) {
  EXPECT_EQ(read_plate_case("fem", {"fluid.solver=none"}).gravity.norm(), 0);
  EXPECT_EQ(read_plate_case("fem", {"fluid.solver=none", "fluid.gravity=[0,-1,0]"}).gravity.y(), -1);
}

TEST(StructureKeys, EveryKindKnowsEveryTable) {
  for (const char* kind : {"fem", "particle", "rigid"})
    EXPECT_EQ(complaint(kind, {"structure.fem.degree=1", "structure.particle.radius=3.1",
                               "structure.replay.run=runs/x"}),
              "");
}

TEST(StructureKeys, ASolverThatKnowsNoFailureTakesTheBodyForIntact) {
  const std::vector<std::string> failing = {"structure.failure.criterion=max_principal",
                                            "structure.failure.strength=5e8",
                                            "structure.failure.fracture_energy=1e4"};
  for (const char* kind : {"rigid", "ccx"}) {
    const Parameters p = read_plate_case(kind, failing);
    EXPECT_EQ(p.failure.criterion, FailureCriterion::none) << kind;
    EXPECT_TRUE(p.stays_intact) << kind;
  }
  EXPECT_FALSE(read_plate_case("fem", failing).stays_intact);
}

TEST(StructureKeys, WrongValuesAreRefusedWithWhatWasExpected) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(complaint("fem", {"structure.material.young=0"}), "expected a number in Pa, greater than 0");
  says(complaint("fem", {"structure.material.poisson=0.5"}), "below 0.5");
  says(complaint("fem", {"structure.material.poisson=-1"}), "poisson");
  says(complaint("fem", {"structure.plate.lenght=1"}), "did you mean length");
  says(complaint("fem", {"structure.box=[{}]"}), "one shape, and structure.plate is given too");
  says(complaint("fem", {"structure.plate.thickness=0"}), "thickness");
  says(complaint("fem", {"structure.mass=40"}), "lumped.mass");
  says(complaint("fem", {"fluid.dimension=3"}), "a length along z");
  says(complaint("particle", {"structure.plane=stress", "structure.material.model=neo_hookean"}),
       "structure.plane");
  says(complaint("particle", {"structure.particle.spacing=0.003"}), "a whole number of particle layers");
  says(complaint("particle", {"structure.particle.spacing=0.02"}), "at least 2");
  says(complaint("particle", {"structure.plate.length=0.401"}), "a whole number of particle columns");
  EXPECT_EQ(complaint("particle", {"structure.plate.supports.left=pinned"}), "");
  says(complaint("particle", {"structure.damping.stiffness=1e-5"}), "mass-proportional");
  says(complaint("rigid", {"coupling.interface=volume"}), "structure.solver = \"particle\"");
  for (const std::string key : {"structure.loaded_faces", "structure.wet"}) {  // its older name
    EXPECT_EQ(complaint("fem", {key + "=[\"bottom\",\"left\"]"}), "");
    says(complaint("fem", {key + "=[\"botom\"]"}), "did you mean \"bottom\"?");
  }
  says(complaint("fem", {"structure.wet=[\"left\"]", "structure.loaded_faces=[\"bottom\"]"}), "older name");
  says(complaint("particle", {"structure.wet=[\"bottom\"]", "coupling.interface=volume"}),
       "every particle of the body meets the water");
  says(complaint("rigid", {"structure.analysis=modal"}), "no modes");
  for (const std::string analysis : {"structure.analysis=modal", "structure.analysis=static"}) {
    says(complaint("fem", {analysis}), "take no force of the water, and fluid.solver is \"mps\"");
    EXPECT_EQ(complaint("fem", {analysis, "fluid.solver=none"}), "");
  }
  says(complaint("fem", {"structure.analysis=static", "structure.plate.supports.left=free",
                         "structure.plate.supports.right=free"}),
       "no equilibrium");
  says(complaint("replay", {}), "structure.replay.run");
  says(complaint("fem", {"structure.failure.criterion=max_principal", "structure.failure.strength=1e6",
                         "structure.failure.fracture_energy=100", "structure.fem.strain=enhanced"}),
       "strains of its displacement alone");
  says(complaint("fem", {}, "[[output.probe]]\nname = \"mid\"\nof = \"structure\"\nat = [0.0, -0.1, 0.0]\n"),
       "outside the plate");
}

// A mesh has no structure.plate and no structure.box: what holds it is a [[structure.support]].
TEST(StructureKeys, AMeshWithoutSupportsIsToldOfKeysThatItHas) {
  const TemporaryFolder folder;
  put(folder / "a.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 0.1 0 0\n3 0.1 0.1 0\n4 0 0.1 0\n"
      "$EndNodes\n$Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n");
  const auto refusal = [](const std::string& shape, const std::string& more) {
    try {
      CaseFile file = CaseFile::parse(
          "end_time = 1\n[fluid]\nsolver = \"none\"\nspacing = 0.01\n[structure]\n"
          "analysis = \"static\"\n" +
          shape + more);
      read(file, "particle");
    } catch (const Error& e) {
      return to_text(e);
    }
    return std::string();
  };
  const std::string mesh = "mesh = \"" + (folder / "a.msh").string() + "\"\n";
  const std::string text = refusal(mesh, "");
  EXPECT_NE(text.find("no equilibrium"), std::string::npos) << text;
  EXPECT_NE(text.find("[[structure.support]] with on = \"left\" and kind = \"clamped\""), std::string::npos)
      << text;
  EXPECT_EQ(
      refusal(mesh, "[[structure.support]]\non = \"left\"\nkind = \"clamped\"\n").find("no equilibrium"),
      std::string::npos);
}

TEST(StructureKeys, AProbeOfStressIsNoHindranceToASolverWithoutStress) {
  for (const char* kind : {"fem", "particle", "rigid", "ccx"})
    EXPECT_EQ(complaint(kind, {},
                        "[[output.probe]]\nname = \"mid\"\nof = \"structure\"\nat = [0.0, 0.01, 0.0]\n"
                        "quantity = \"von_mises\"\n"),
              "")
        << kind;
}

TEST(StructureKeys, BoxesThatParticlesCannotFillAreRefused) {
  const auto of_boxes = [](const std::string& box, const std::vector<std::string>& sets = {}) {
    try {
      CaseFile file =
          CaseFile::parse("end_time = 0.03\n[fluid]\nspacing = 0.01\n[structure]\n" + box, "case.toml", sets);
      read(file, "particle");
    } catch (const Error& e) {
      return to_text(e);
    }
    return std::string();
  };
  const std::string
      floor = "[[structure.box]]\nname = \"floor\"\nmin = [0, 0, 0]\nmax = [0.3, 0.01, 0.1]\n",
      rib = "[[structure.box]]\nname = \"rib\"\nmin = [0.14, 0.01, 0]\nmax = [0.15, 0.0501, 0.1]\n";
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(of_boxes(floor), "");
  EXPECT_EQ(of_boxes(floor, {"fluid.dimension=3"}), "");
  says(of_boxes(floor + rib), "\"rib\" has a side at y = 0.0501 m");
  says(of_boxes(floor, {"structure.particle.spacing=0.01"}), "spacing = 0.005");
  EXPECT_EQ(of_boxes(floor + "supports = { left = \"pinned\", right = \"symmetry\" }\n"), "");
  says(of_boxes(floor, {"fluid.dimension=3", "structure.particle.model=pair"}), "rotation of the plane");
  says(of_boxes(floor, {"structure.particle.rotation=dynamic"}), "model = \"pair\"");
  says(of_boxes(floor, {"structure.analysis=static"}), "no equilibrium");
}

TEST(StructureKeys, FailureNeedsWhatItsCriterionIsMadeOf) {
  const auto says = [](const std::vector<std::string>& sets, const std::string& part,
                       const char* kind = "particle") {
    std::vector<std::string> all = {"structure.particle.spacing=0.0025"};
    all.insert(all.end(), sets.begin(), sets.end());
    const std::string text = complaint(kind, all);
    if (part.empty()) {
      EXPECT_EQ(text, "");
    } else {
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  };
  const std::string of = "structure.failure.";
  says({of + "criterion=bond_strain"}, "critical_strain");
  says({of + "criterion=bond_strain", of + "critical_strain=0.01"}, "");
  says({of + "criterion=bond_strain", of + "fracture_energy=1e4"}, "no energy of its own");
  says({of + "criterion=bond_strain", of + "fracture_energy=1e4", "structure.particle.model=pair"},
       "rotation = \"dynamic\"");
  says({of + "criterion=bond_strain", of + "fracture_energy=1e4", "structure.particle.model=pair",
        "structure.particle.rotation=dynamic"},
       "");
  says({of + "criterion=von_mises"}, "strength");
  says({of + "criterion=von_mises", of + "strength=5e8", of + "fracture_energy=1e4",
        "structure.particle.model=pair"},
       "the pair model has no stress of a particle");
  says({of + "criterion=von_mises", of + "strength=5e8"}, "fracture_energy");
  says({of + "criterion=von_mises", of + "strength=5e8", of + "fracture_energy=1e4"}, "");
  says({of + "criterion=von_mises", of + "strength=5e8", of + "fracture_energy=1e3"}, "spacing below");
  says({of + "criterion=max_principal", of + "strength=5e8", "structure.particle.model=pair",
        "structure.particle.rotation=dynamic"},
       "total_lagrangian");
  says({of + "criterion=bond_strain", of + "critical_strain=0.01"}, "have no bonds", "fem");
  says({of + "criterion=max_principal", of + "strength=5e8"}, "fracture_energy", "fem");
  says({of + "criterion=max_principal", of + "strength=5e8", of + "fracture_energy=1e4"}, "", "fem");
  says({of + "criterion=max_principal", of + "strength=5e8", of + "fracture_energy=1e4",
        "structure.damping.stiffness=1e-6"},
       "damping.mass", "fem");
  says({of + "criterion=bond_strain", of + "critical_strain=0.01", "structure.analysis=modal"}, "intact");
}

TEST(StructureKeys, ABodyInSpaceHasTwoCellsThroughTheThicknessUnlessTheCaseSaysOtherwise) {
  const std::vector<std::string> space = {"fluid.dimension=3", "structure.depth=0.4"};
  EXPECT_EQ(read_plate_case("fem").fem.refinement, 3);
  EXPECT_EQ(read_plate_case("fem", space).fem.refinement, 1);
  EXPECT_EQ(read_plate_case("fem", {space[0], space[1], "structure.fem.refinement=2"}).fem.refinement, 2);
}

TEST(StructureKeys, ASolidShellIsOneCellThickUnlessTheCaseSaysOtherwise) {
  const std::vector<std::string> space = {"fluid.dimension=3", "structure.depth=0.4",
                                          "structure.fem.strain=solid_shell"};
  const auto with = [&](const std::string& set) {
    std::vector<std::string> all = space;
    all.push_back(set);
    return all;
  };
  const Parameters p = read_plate_case("fem", space);
  EXPECT_EQ(p.fem.degree, 1);
  EXPECT_EQ(p.fem.refinement, 0);
  EXPECT_EQ(p.fem.cell_size, 0);
  EXPECT_EQ(read_plate_case("fem").fem.degree, 2);
  EXPECT_EQ(read_plate_case("fem", with("structure.fem.refinement=1")).fem.refinement, 1);
  EXPECT_EQ(read_plate_case("fem", with("structure.fem.cell_size=0.02")).fem.cell_size, 0.02);
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(complaint("fem", {"structure.fem.strain=solid_shell"}), "a solid_shell has three dimensions");
  says(complaint("fem", with("structure.fem.degree=2")), "a solid_shell has eight nodes");
  says(complaint("fem", with("structure.fem.cell_size=-1")), "cell_size");
  std::vector<std::string> fails = with("structure.failure.criterion=max_principal");
  fails.insert(fails.end(), {"structure.failure.strength=1e6", "structure.failure.fracture_energy=100"});
  says(complaint("fem", fails), "strains of its displacement alone");
}

TEST(StructureKeys, AnotherSolversCoarseParticlesDoNotMatter) {
  EXPECT_EQ(complaint("fem", {"structure.particle.spacing=0.003"}), "");
}

TEST(StructureKeys, DeclarationsAloneAskForNothing) {
  CaseFile nothing = CaseFile::declarations_only();
  EXPECT_NO_THROW(read(nothing, "replay"));
  EXPECT_GT(nothing.declared().size(), 40u);
}

TEST(StructureKeys, ABodyOutsideTheTankIsRefusedBeforeItIsBuilt) {
  const std::vector<std::string> tank = {"fluid.tank=[[-1.0, -0.5], [1.0, 0.7]]"};
  const auto with = [&tank](const std::string& set) { return std::vector<std::string>{tank[0], set}; };
  EXPECT_EQ(complaint("rigid", with("structure.plate.bottom=[0.8, 0.012, 0]")), "") << "its end at the wall";
  const std::string beside = complaint("rigid", with("structure.plate.bottom=[0.9, 0.012, 0]"));
  EXPECT_NE(beside.find("a body inside the tank: it reaches from (0.7, 0.012) to (1.1, 0.032) m, the tank "
                        "from (-1, -0.5) to (1, inf) m"),
            std::string::npos)
      << beside;
  EXPECT_EQ(complaint("fem", with("structure.plate.bottom=[0, 0.7, 0]")), "") << "no lid";
  EXPECT_NE(complaint("fem", {tank[0], "structure.plate.bottom=[0, 0.7, 0]", "fluid.open_top=false"}), "");
  EXPECT_EQ(complaint("fem", {tank[0], "structure.plate.bottom=[2, 0, 0]", "fluid.solver=none"}), "");
  const std::string seam = "fluid.periodic=[\"x\"]";
  EXPECT_EQ(complaint("fem", {tank[0], "structure.plate.bottom=[0.8, 0.012, 0]", seam}), "");
  EXPECT_NE(complaint("fem", {tank[0], "structure.plate.bottom=[0.9, 0.012, 0]", seam})
                .find("no body goes over the seam of a periodic tank"),
            std::string::npos);
  const std::string with_z = "fluid.tank=[[-1.4, -0.5, 0.0], [0.52, 1.4, 0.0]]";
  EXPECT_EQ(complaint("rigid", {with_z, "structure.plate.bottom=[0.3, 0.6, 0]"}), "");
  EXPECT_NE(complaint("rigid", {with_z, "structure.plate.bottom=[0.4, 0.6, 0]"}), "");
  const std::string polygon = "fluid.tank_polygon=[[-0.1, -1], [0.1, -1], [0.1, 1], [-0.1, 1]]";
  EXPECT_NE(complaint("rigid", {polygon}), "");
  EXPECT_EQ(complaint("rigid", {"fluid.tank_polygon=[[-1, -1, 0], [1, -1, 0], [1, 1, 0]]"}), "");
  EXPECT_NE(complaint("rigid", {"fluid.tank_polygon=[[-0.1, -1, 0], [0.1, -1, 0], [0.1, 1, 0]]"}), "");
}

}  // namespace read_parameters_test
}  // namespace strake::structure
