#include "tests/coupler/attachments/fmu/fmu_case.hpp"

namespace strake {
namespace fmu_refusals_test {

/// What is refused when the attachment is built, and a part of the message.
struct Refusal {
  std::string message, fix;  // texts that both stand in it
  std::function<void(FmuParameters&)> change;
};

TEST(FmuRefusals, NameWhatIsWrongInTheConnections) {
  const std::vector<Refusal> refusals = {
      {"the FMU has no variable end.v", "did you mean end.u?",
       [](FmuParameters& p) { p.inputs = {"end.v = displacement.y"}; }},
      {"force has the causality output, expected input", "end.u, end.w",
       [](FmuParameters& p) { p.inputs = {"force = displacement.y"}; }},
      {"mass[1].v has the causality local, expected output", "",
       [](FmuParameters& p) { p.outputs = {"force.y = mass[1].v"}; }},
      {"\"displacment\" is no motion of a point", "did you mean displacement?",
       [](FmuParameters& p) { p.inputs = {"end.u = displacment.y"}; }},
      {"\"z\" is no component", "x or y", [](FmuParameters& p) { p.inputs = {"end.u = displacement.z"}; }},
      {"\"\" is no component", "x or y", [](FmuParameters& p) { p.inputs = {"end.u = displacement"}; }},
      {"there is no point 2", "1 to 1", [](FmuParameters& p) { p.inputs = {"end.u = displacement.y.2"}; }},
      {"there is no point 0", "1 to 1", [](FmuParameters& p) { p.outputs = {"force.y.0 = force"}; }},
      {"there is no point 1x", "1 to 1", [](FmuParameters& p) { p.outputs = {"force.y.1x = force"}; }},
      {"end.u has the unit m, expected m/s", "SI units",
       [](FmuParameters& p) { p.inputs = {"end.u = velocity.y"}; }},
      {"thrust has the unit kN, expected N", "SI units",
       [](FmuParameters& p) { p.outputs = {"force.y = thrust"}; }},
      {"forces is an array", "one by one", [](FmuParameters& p) { p.outputs = {"force.y = forces"}; }},
      {"count is of the type Int32, expected Float64", "",
       [](FmuParameters& p) { p.outputs = {"force.y = count"}; }},
      {"\"moment.z\" is no force", "force.y = variable",
       [](FmuParameters& p) { p.outputs = {"moment.z = force"}; }},
      {"has no =", "variable = displacement.y", [](FmuParameters& p) { p.inputs = {"end.u"}; }},
      {"lacks a side", "variable = displacement.y",
       [](FmuParameters& p) { p.inputs = {"= displacement.y"}; }},
      {"is given twice", "leave one", [](FmuParameters& p) { p.inputs.push_back("end.u = displacement.x"); }},
      {"is given twice", "leave one", [](FmuParameters& p) { p.outputs.push_back("force.y = F"); }},
      {"gives no force", "outputs = ", [](FmuParameters& p) { p.outputs.clear(); }},
      {"\"two\" is no value of the type Float64", "its own is 1",
       [](FmuParameters& p) { p.parameters = {"m = two"}; }},
      {"\"1.5\" is no value of the type Int32", "", [](FmuParameters& p) { p.parameters = {"fault = 1.5"}; }},
      {"\"nan\" is no value", "", [](FmuParameters& p) { p.parameters = {"m = nan"}; }},
      {"the FMU has no variable longst", "did you mean longest?",
       [](FmuParameters& p) { p.parameters = {"longst = 1"}; }},
      {"label is of the type String", "", [](FmuParameters& p) { p.parameters = {"label = 1"}; }},
      {"n has the causality structuralParameter", "keep their values",
       [](FmuParameters& p) { p.parameters = {"n = 2"}; }},
  };
  for (const Refusal& refusal : refusals) {
    FmuParameters p = oscillator_of();
    refusal.change(p);
    const std::string said = error_of([&] { FmuAttachment(p, setup_of()); }, ExitCode::case_file);
    EXPECT_NE(said.find("attachments.damper.fmu."), std::string::npos) << refusal.message << "\n" << said;
    EXPECT_NE(said.find(refusal.message), std::string::npos) << refusal.message << "\n" << said;
    EXPECT_NE(said.find(refusal.fix), std::string::npos) << refusal.fix << "\n" << said;
  }
}

/// What the attachment says of a description in which one text is another.
std::string said_of(const std::string& from, const std::string& to, ExitCode code = ExitCode::case_file) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = changed_fmu(scratch, from, to);
  return error_of([&] { FmuAttachment(p, setup_of()); }, code);
}

TEST(FmuRefusals, NameWhatIsWrongInTheDescription) {
  const std::vector<std::array<std::string, 3>> changes = {
      {"fmiVersion=\"3.0\"", "fmiVersion=\"2.0\"", "is FMI 2.0, expected 3.0"},
      {"fmiVersion=\"3.0\"", "fmiVersion=\"3.0-beta.2\"", "is FMI 3.0-beta.2, expected 3.0"},
      {"fmiVersion=\"3.0\" ", "", "has no fmiVersion"},
      {"<CoSimulation ", "<ModelExchange ", "is no FMU for co-simulation"},
      {"canGetAndSetFMUState=\"true\"", "needsExecutionTool=\"true\"", "needs the program that exported it"},
      {"modelIdentifier=\"oscillator\"", "modelIdentifier=\"../oscillator\"", "is no identifier of C"},
      {"modelIdentifier=\"oscillator\"", "modelIdentifier=\"other\"", "has no binaries/"},
      {"modelIdentifier=\"oscillator\"", "modelIdentifier=\"oscillator\" fixedInternalStepSize=\"-1\"",
       "fixedInternalStepSize = -1"},
      {"valueReference=\"1\"", "valueReference=\"one\"", "valueReference = \"one\" is no number"},
      {"valueReference=\"1\"", "reference=\"1\"", "has no valueReference"},
      {"</ModelVariables>", "</Variables>", "modelDescription.xml:31:5: is no XML: mismatched tag"},
      {"<fmiModelDescription", "<html", "<html>: is no description of an FMU"},
      {"causality=\"input\" start", "causality=\"input\" clocks=\"7\" start", "belongs to a clock"},
  };
  for (const auto& [from, to, message] : changes) {
    const std::string said = said_of(from, to);
    EXPECT_NE(said.find(message), std::string::npos) << message << "\n" << said;
  }
  const std::string said = said_of("{oscillator-1}", "{another}", ExitCode::solver_fault);
  EXPECT_NE(said.find("made no instance of its model"), std::string::npos) << said;
  EXPECT_NE(said.find("the token of modelDescription.xml is not mine"), std::string::npos) << said;
}

TEST(FmuRefusals, ListThePlatformsOfAnFmuForOtherMachines) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = changed_fmu(scratch, "Oscillator", "Other");
  std::filesystem::rename(p.file / "binaries" / STRAKE_FMU_PLATFORM, p.file / "binaries" / "x86_64-windows");
  const std::string said = error_of([&] { FmuAttachment(p, setup_of()); }, ExitCode::case_file);
  EXPECT_NE(said.find("its binaries are for: x86_64-windows"), std::string::npos) << said;
  EXPECT_NE(said.find("export it for " STRAKE_FMU_PLATFORM), std::string::npos) << said;
}

TEST(FmuRefusals, NameTheFunctionsThatALibraryLacks) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = changed_fmu(scratch, "\"oscillator\"", "\"stub\"");
  const std::filesystem::path binaries = std::filesystem::path("binaries") / STRAKE_FMU_PLATFORM;
  std::filesystem::copy(test_fmus / "stub" / binaries / "stub.so", p.file / binaries / "stub.so");
  const std::string said = error_of([&] { FmuAttachment(p, setup_of()); }, ExitCode::case_file);
  EXPECT_NE(said.find("lacks functions that FMI 3.0 demands: fmi3InstantiateCoSimulation"), std::string::npos)
      << said;
  std::ofstream(p.file / binaries / "stub.so", std::ios::trunc) << "no library";
  EXPECT_NE(error_of([&] { FmuAttachment(p, setup_of()); }, ExitCode::case_file).find("cannot be loaded"),
            std::string::npos);
}

/// What one window of an FMU that misbehaves ends with.
std::string said_in_a_window(int fault) {
  return error_of(
      [&] {
        FmuAttachment fmu(oscillator_of({"fault = " + std::to_string(fault)}), setup_of());
        fmu.advance({0.5, 1e-3}, motion_to(fmu, 0.501, 0.01, 0));
      },
      ExitCode::solver_fault);
}

TEST(FmuRefusals, GiveTheFmusOwnWordsWhereItFails) {
  for (const auto& [fault, message] :
       std::vector<std::pair<int, std::string>>{{1, "fmi3DoStep returns Error\n"},
                                                {2, "fmi3DoStep returns Fatal\n"},
                                                {4, "ends the simulation"},
                                                {5, "returned early, at t = 0.50025 s of 0.5005 s"},
                                                {7, "gives force = nan"},
                                                {8, "fmi3EnterInitializationMode returns Error\n"}}) {
    const std::string said =
        fault == 8
            ? said_in_a_window(8)
            : error_of(
                  [&, fault = fault] {
                    FmuAttachment fmu(oscillator_of({"fault = " + std::to_string(fault)}), setup_of(), 0.5);
                    fmu.advance({0.5, 1e-3}, motion_to(fmu, 0.501, 0.01, 0));
                  },
                  ExitCode::solver_fault);
    EXPECT_NE(said.find(message), std::string::npos) << message << "\n" << said;
    EXPECT_EQ(said.rfind("damper, t = 0", 0), 0u) << said;
    if (fault == 1) {
      EXPECT_NE(said.find("the spring broke\\x0aat its end"), std::string::npos) << said;
    }
  }
  EXPECT_NE(said_in_a_window(0).find("a step from another time"), std::string::npos);
}

TEST(FmuRefusals, ARewindWithoutTheAbility) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = changed_fmu(scratch, "canGetAndSetFMUState=\"true\"", "canGetAndSetFMUState=\"false\"");
  FmuAttachment fmu(p, setup_of());
  EXPECT_FALSE(fmu.can_rewind());
  EXPECT_TRUE(fmu.description().cannot_resume);
  EXPECT_NE(fmu.description().lines.at(1).find("cannot take back its state"), std::string::npos);
  fmu.rewind();  // to where it is
  fmu.advance({0, 1e-3}, motion_to(fmu, 1e-3, 0.01, 0));
  fmu.commit(false);
  fmu.advance({1e-3, 1e-3}, motion_to(fmu, 2e-3, 0.02, 0));
  const std::string said = error_of([&] { fmu.rewind(); }, ExitCode::case_file);
  EXPECT_NE(said.find("cannot take back its state"), std::string::npos) << said;
  EXPECT_NE(said.find("coupling.surface.converged.max_iterations = 1"), std::string::npos) << said;
  EXPECT_NE(error_of([&] { fmu.checkpoint(scratch.path()); }, ExitCode::cannot_write), "");

  p.parameters = {"fault = 3"};
  FmuAttachment discards(p, setup_of());
  EXPECT_NE(error_of(
                [&] {
                  discards.advance({0, 2e-3}, motion_to(discards, 2e-3, 0, 0));
                },
                ExitCode::solver_fault)
                .find("a step longer than 0.6 ms"),
            std::string::npos);
}

TEST(FmuRefusals, WindowsThatAFixedStepCannotTake) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of();
  p.file = changed_fmu(scratch, "canHandleVariableCommunicationStepSize=\"true\"",
                       "canHandleVariableCommunicationStepSize=\"false\" fixedInternalStepSize=\"0.001\"");
  FmuAttachment fmu(p, setup_of());
  for (const double dt : {1e-3, 3e-3, 1e-5}) {
    const std::string said = error_of(
        [&] {
          fmu.advance({0, dt}, motion_to(fmu, dt, 0, 0));
        },
        ExitCode::case_file);
    EXPECT_NE(said.find("has fixed steps of 0.001 s"), std::string::npos) << said;
    EXPECT_NE(said.find("coupling.surface.window = 0.002"), std::string::npos) << said;
  }
  fmu.advance({0, 4e-3}, motion_to(fmu, 4e-3, 0, 0));
  fmu.commit(false);
  EXPECT_NE(error_of(
                [&] {
                  fmu.advance({4e-3, 2e-3}, motion_to(fmu, 6e-3, 0, 0));
                },
                ExitCode::case_file)
                .find("cannot vary its step"),
            std::string::npos);
}

}  // namespace fmu_refusals_test
}  // namespace strake
