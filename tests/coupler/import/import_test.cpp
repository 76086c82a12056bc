#include "coupler/import/imported_run.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace strake {
namespace {

namespace fs = std::filesystem;

const std::string whole = R"(<?xml version="1.0"?>
<precice-configuration>
  <log enabled="true"><sink filter="none" /></log>
  <data:vector name="Force" />
  <data:vector name="Displacement" />
  <mesh name="Water-Mesh" dimensions="3"><use-data name="Force" /><use-data name="Displacement" /></mesh>
  <mesh name="Hull-Mesh" dimensions="3"><use-data name="Force" /><use-data name="Displacement" /></mesh>
  <participant name="Hull">
    <provide-mesh name="Hull-Mesh" />
    <write-data name="Displacement" mesh="Hull-Mesh" />
    <read-data name="Force" mesh="Hull-Mesh" />
    <watch-point mesh="Hull-Mesh" name="Tip" coordinate="0;0;0" />
  </participant>
  <participant name="Water">
    <provide-mesh name="Water-Mesh" />
    <receive-mesh name="Hull-Mesh" from="Hull" safety-factor="0.5" />
    <write-data name="Force" mesh="Water-Mesh" />
    <read-data name="Displacement" mesh="Water-Mesh" />
    <mapping:nearest-projection direction="write" from="Water-Mesh" to="Hull-Mesh" constraint="conservative" />
    <mapping:nearest-projection direction="read" from="Hull-Mesh" to="Water-Mesh" constraint="consistent" />
  </participant>
  <m2n:sockets acceptor="Water" connector="Hull" exchange-directory=".." />
  <coupling-scheme:parallel-implicit>
    <participants first="Water" second="Hull" />
    <max-time value="0.5" />
    <time-window-size value="1.25e-3" />
    <min-iterations value="2" />
    <max-iterations value="30" />
    <exchange data="Force" mesh="Hull-Mesh" from="Water" to="Hull" />
    <exchange data="Displacement" mesh="Hull-Mesh" from="Hull" to="Water" />
    <relative-convergence-measure data="Displacement" mesh="Hull-Mesh" limit="1e-4" strict="true" />
    <residual-relative-convergence-measure data="Force" mesh="Hull-Mesh" limit="1e-3" />
    <acceleration:IQN-IMVJ>
      <data name="Displacement" mesh="Hull-Mesh" />
      <data name="Force" mesh="Hull-Mesh" />
      <filter type="QR1" limit="1e-6" />
      <initial-relaxation value="0.3" />
      <max-used-iterations value="60" />
    </acceleration:IQN-IMVJ>
  </coupling-scheme:parallel-implicit>
</precice-configuration>
)";

/// `whole` with the first appearance of a text replaced.
std::string changed(const std::string& from, const std::string& to, std::string text = whole) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class PreciceImport : public testing::Test {
 protected:
  ~PreciceImport() override { fs::remove(path_); }

  ImportedRun read(const std::string& text) {
    std::ofstream(path_) << text;
    return import_precice(path_);
  }
  std::string case_of(const std::string& text) { return case_text(read(text), "."); }

  /// The error from its line on: "17:5: <mapping:…>: …".
  std::string refused(const std::string& text) {
    try {
      read(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::case_file);
      std::string said = to_text(e);
      const std::string file = path_.string() + ":";
      for (std::size_t at; (at = said.find(file)) != std::string::npos;) said.erase(at, file.size());
      return said;
    }
    return "nothing was refused";
  }
  void expect_refused(const std::string& from, const std::string& to, const std::string& begin) {
    const std::string said = refused(changed(from, to));
    EXPECT_TRUE(said.starts_with(begin)) << said;
  }

  fs::path path_ = fs::temp_directory_path() / ("strake-import-" + std::to_string(getpid()) + ".xml");
};

/// True if a line of the case begins so.
void expect_line(const std::string& text, const std::string& line) {
  EXPECT_NE(text.find("\n" + line), std::string::npos) << line << "\nis not in\n" << text;
}

TEST_F(PreciceImport, WritesEverySettingWithItsLine) {
  const std::string text = case_of(whole);
  for (const char* line :
       {"end_time = 0.5 ",           "solver = \"./Water\" ",
        "solver = \"./Hull\" ",      "arguments = [] ",
        "folder = \".\" ",           "precice_names = [\"Force=force\", \"Displacement=displacement\"]",
        "scheme = \"parallel\" ",    "window = 0.00125 ",
        "predictor = \"constant\" ", "kind = \"nearest-projection\" ",
        "kind = \"iqn-imvj\" ",      "initial_relaxation = 0.3 ",
        "filter_kind = \"QR1\" ",    "filter = 1e-06 ",
        "max_columns = 60 ",         "min_iterations = 2 ",
        "max_iterations = 30 ",      "unconverged = \"stop\" ",
        "measure = \"value\" ",      "relative = 0.0001 ",
        "absolute = 1e-300 ",        "residual_relative = 0.001 "})
    expect_line(text, line);
  // A limit of 0 would be that of the displacement.
  expect_line(text.substr(text.find("[coupling.surface.converged.load]")), "relative = 1e-300 ");
  EXPECT_NE(text.find("# s; line 26"), std::string::npos) << text;
  EXPECT_LT(text.find("./Water"), text.find("./Hull"));  // the first participant is the fluid's side
}

TEST_F(PreciceImport, SaysOnceWhatIsLeftOut) {
  const ImportedRun run = read(whole);
  ASSERT_EQ(run.notes.size(), 4u);
  EXPECT_TRUE(run.notes[0].starts_with("line 3: <log> is left out: "));
  EXPECT_TRUE(run.notes[1].starts_with("line 12: <watch-point> is left out: "));
  EXPECT_TRUE(run.notes[2].starts_with("line 22: <m2n:sockets> is left out: "));
  EXPECT_TRUE(run.notes[3].starts_with("line 16: safety-factor is left out: "));
  for (const std::string& note : run.notes)
    EXPECT_NE(case_text(run, ".").find("# " + note + "\n"), std::string::npos) << note;
}

TEST_F(PreciceImport, TakesTheEarlierEnd) {
  expect_line(case_of(changed("<max-time value=\"0.5\" />", "<max-time-windows value=\"80\" />")),
              "end_time = 0.1 ");
  expect_line(case_of(changed("<max-time ", "<max-time-windows value=\"4\" /><max-time ")),
              "end_time = 0.005 ");
}

TEST_F(PreciceImport, ExplicitSchemesHaveOneIteration) {
  std::string text = whole;
  for (std::size_t at; (at = text.find("parallel-implicit")) != std::string::npos;)
    text.replace(at, 17, "serial-explicit");
  for (const char* kind : {"acceleration:IQN-IMVJ>"}) text.erase(text.find(std::string("<") + kind));
  text += "</coupling-scheme:serial-explicit></precice-configuration>";
  const std::string made = case_of(text);
  for (const char* line : {"scheme = \"serial\" ", "max_iterations = 1 ", "min_iterations = 1 ",
                           "kind = \"constant\" ", "initial_relaxation = 1 "})
    expect_line(made, line);
}

TEST_F(PreciceImport, DefaultsAreThoseOfPrecice) {
  const auto cut = [](const std::string& begin, std::string text) {
    const std::size_t at = text.find("      <" + begin);
    return text.erase(at, text.find('\n', at) + 1 - at);
  };
  std::string text = whole;
  for (const char* name : {"filter", "initial-relaxation", "max-used"}) text = cut(name, text);
  const ImportedRun run = read(text);
  EXPECT_EQ(run.acceleration.initial_relaxation.value, 0.1);
  EXPECT_EQ(run.acceleration.max_columns.value, 100);
  EXPECT_EQ(run.acceleration.reused_windows.value, 20);
  EXPECT_EQ(run.acceleration.filter.value, 1e-2);
  EXPECT_NE(run.notes.back().find("QR3"), std::string::npos);
  const ImportedRun aitken = read(
      changed("</acceleration:IQN-IMVJ>", "</acceleration:aitken>", changed("IQN-IMVJ", "aitken", text)));
  EXPECT_EQ(aitken.acceleration.kind.value, "aitken");
  EXPECT_EQ(aitken.acceleration.initial_relaxation.value, 0.5);
}

TEST_F(PreciceImport, RadialMappingsKeepTheirNumbers) {
  const std::string empty =
      "<mapping:nearest-projection direction=\"write\" from=\"Water-Mesh\" to=\"Hull-Mesh\" "
      "constraint=\"conservative\" />";
  const std::string radial =
      "<mapping:rbf-pum-direct from=\"F\" to=\"T\" constraint=\"C\" vertices-per-cluster=\"80\" "
      "relative-overlap=\"0.3\"><basis-function:compact-polynomial-c4 support-radius=\"0.7\" />"
      "</mapping:rbf-pum-direct>";
  const auto between = [&](const char* from, const char* to, const char* constraint) {
    return changed("\"F\"", from, changed("\"T\"", to, changed("\"C\"", constraint, radial)));
  };
  const std::string there = between("\"Water-Mesh\"", "\"Hull-Mesh\"", "\"conservative\"");
  const std::string back = between("\"Hull-Mesh\"", "\"Water-Mesh\"", "\"consistent\"");
  const std::string second =
      "<mapping:nearest-projection direction=\"read\" from=\"Hull-Mesh\" to=\"Water-Mesh\" "
      "constraint=\"consistent\" />";
  const std::string text = case_of(changed(second, back, changed(empty, there)));
  for (const char* line : {"kind = \"radial-basis\" ", "function = \"wendland-c4\" ", "support = 0.7 ",
                           "solve = \"partition\" ", "patch_points = 80 ", "overlap = 0.3 "})
    expect_line(text, line);
  EXPECT_TRUE(refused(changed(second, back, changed(empty, changed("0.7", "0.8", there))))
                  .starts_with("20:5: <mapping:rbf-pum-direct>: is not the mapping of line 19"));
  EXPECT_TRUE(
      refused(changed(second, back, changed(empty, changed("polynomial-c4", "polynomial-c8", there))))
          .starts_with("19:137: <basis-function:compact-polynomial-c8>: is no basis-function of Strake"));
}

TEST_F(PreciceImport, NamesAreQuantitiesWhereTheMappingAgrees) {
  const auto names = [&](const std::string& text) { return read(text).fluid.names; };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(changed("constraint=\"conservative\"", "constraint=\"consistent\"")),
            (Names{"Force=Force", "Displacement=displacement"}));
  std::string text = changed("<data:vector name=\"Displacement\"", "<data:scalar name=\"Displacement\"");
  EXPECT_EQ(names(text), (Names{"Force=force", "Displacement=Displacement"}));
}

TEST_F(PreciceImport, RefusesWhatStrakeDoesNotHave) {
  using Change = std::vector<std::string>;
  for (const Change& c : std::vector<Change>{
           {"<provide-mesh name=\"Hull-Mesh\" />",
            "<provide-mesh name=\"Hull-Mesh\" /><provide-mesh name=\"Water-Mesh\" />",
            "15:5: <provide-mesh>: Water-Mesh is provided by Hull as well"},
           {"<m2n", "<participant name=\"Air\" /><m2n", "22:3: <participant>: Air is a third participant"},
           {"</precice", "<coupling-scheme:serial-explicit /></precice",
            "41:1: <coupling-scheme:serial-explicit>: is a second scheme"},
           {"<m2n", "<action:multiply-by-area mesh=\"Hull-Mesh\" timing=\"write-mapping-prior\" /><m2n",
            "22:3: <action:multiply-by-area>: changes data between the solvers"},
           {"value=\"1.25e-3\"", "method=\"first-participant\"",
            "26:5: <time-window-size>: method = \"first-participant\""},
           {"value=\"1.25e-3\"", "value=\"0\"", "26:5: <time-window-size>: value = \"0\""},
           {"value=\"1.25e-3\"", "value=\"1 ms\"", "26:5: <time-window-size>: value = \"1 ms\""},
           {"<max-time value=\"0.5\" />", "", "23:3: <coupling-scheme:parallel-implicit>: has no end"},
           {"<watch-point", "<watch-integral", "12:5: <watch-integral>: is an integral over the interface"},
           {"<precice-configuration>", "<precice-configuration allow-remeshing=\"yes\">",
            "2:1: <precice-configuration>: allow-remeshing"},
           {"safety-factor=\"0.5\"", "api-access=\"true\"", "16:5: <receive-mesh>: api-access"},
           {"limit=\"1e-4\"", "limit=\"1e-4\" suffices=\"1\"",
            "31:5: <relative-convergence-measure>: suffices"},
           {"type=\"QR1\"", "type=\"QR3\"", "36:7: <filter>: type = \"QR3\" is not in Strake"},
           {"constraint=\"consistent\"", "constraint=\"scaled-consistent-surface\"",
            "20:5: <mapping:nearest-projection>: constraint"},
           {"nearest-projection direction=\"read\"", "nearest-neighbor direction=\"read\"",
            "20:5: <mapping:nearest-neighbor>: is not the mapping of line 19"},
           {"nearest-projection direction=\"write\"", "axial-geometric-multiscale direction=\"write\"",
            "19:5: <mapping:axial-geometric-multiscale>: is no mapping of Strake"},
           {" to=\"Hull-Mesh\" constraint", " constraint", "19:5: <mapping:nearest-projection>: has no to"},
           {"<min-iterations", "<min-iteration",
            "27:5: <min-iteration>: is no element that strake import knows\n  fix: did you mean "
            "<min-iterations>?"},
           {"value=\"2\"", "value=\"31\"", "27:5: <min-iterations>: is more than max-iterations"},
           {"value=\"0.3\"", "value=\"0\"", "37:7: <initial-relaxation>: value = \"0\""},
           {"data=\"Force\" mesh=\"Hull-Mesh\" limit", "data=\"Displacement\" mesh=\"Hull-Mesh\" limit",
            "32:5: <residual-relative-convergence-measure>: is a second measure of Displacement after line "
            "31"},
           {"from=\"Hull\" to=\"Water\" />", "from=\"Hull\" to=\"Hull\" />",
            "30:5: <exchange>: goes from Hull to Hull"},
           {"first=\"Water\"", "first=\"Hull\"", "24:5: <participants>: couples a participant with itself"},
       })
    expect_refused(c[0], c[1], c[2]);
}

/// `whole`, where Water reads on Water-Mesh and writes on Water-Faces.
std::string with_two_meshes() {
  std::string text =
      changed("  <participant name=\"Hull\">",
              "  <mesh name=\"Water-Faces\" dimensions=\"3\"><use-data name=\"Force\" /></mesh>\n"
              "  <participant name=\"Hull\">");
  text =
      changed("    <provide-mesh name=\"Water-Mesh\" />\n",
              "    <provide-mesh name=\"Water-Mesh\" />\n    <provide-mesh name=\"Water-Faces\" />\n", text);
  text = changed("\"Force\" mesh=\"Water-Mesh\" />", "\"Force\" mesh=\"Water-Faces\" />", text);
  return changed("from=\"Water-Mesh\" to=\"Hull-Mesh\"", "from=\"Water-Faces\" to=\"Hull-Mesh\"", text);
}

TEST_F(PreciceImport, TakesAParticipantWithTwoMeshes) {
  const ImportedRun run = read(with_two_meshes());
  EXPECT_EQ(run.fluid.meshes, (std::vector<std::string>{"Water-Mesh", "Water-Faces"}));
  EXPECT_EQ(run.fluid.names, (std::vector<std::string>{"Force=force", "Displacement=displacement"}));
  expect_line(case_of(with_two_meshes()), "kind = \"nearest-projection\" ");
}

TEST_F(PreciceImport, RefusesTwoMeshesThatDoNotFitTogether) {
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& begin) {
    const std::string said = refused(changed(from, to, with_two_meshes()));
    EXPECT_TRUE(said.starts_with(begin)) << said;
  };
  expect("Water-Faces\" dimensions=\"3\"", "Water-Faces\" dimensions=\"2\"",
         "17:5: <provide-mesh>: Water-Faces has 2 dimensions, and Water-Mesh of Water has not");
  expect("    <write-data name=\"Force\" mesh=\"Water-Faces\" />",
         "    <write-data name=\"Force\" mesh=\"Water-Faces\" /><write-data name=\"Force\" "
         "mesh=\"Water-Mesh\" />",
         "19:51: <write-data>: has Force on Water-Mesh after Water-Faces");
  expect("from=\"Water-Faces\" to=\"Hull-Mesh\"", "from=\"Water-Mesh\" to=\"Hull-Mesh\"",
         "2:1: <precice-configuration>: has no mapping from Water-Faces to Hull-Mesh, for Force");
  expect(
      "from=\"Water-Faces\" to=\"Hull-Mesh\"", "from=\"Water-Faces\" to=\"Water-Mesh\"",
      "21:5: <mapping:nearest-projection>: goes from Water-Faces to Water-Mesh\n  fix: between Water-Mesh, "
      "Water-Faces and Hull-Mesh");
  expect("<provide-mesh name=\"Water-Faces\" />",
         "<provide-mesh name=\"Water-Faces\" /><provide-mesh name=\"Water-Mesh\" />",
         "17:40: <provide-mesh>: is the mesh Water-Mesh of Water once more");
}

TEST_F(PreciceImport, RefusesSchemesAndAccelerationsByName) {
  const auto renamed = [](const std::string& from, const std::string& to) {
    return changed("</" + from, "</" + to, changed("<" + from, "<" + to));
  };
  EXPECT_TRUE(refused(renamed("coupling-scheme:parallel-implicit", "coupling-scheme:multi"))
                  .starts_with("23:3: <coupling-scheme:multi>: couples more than two participants"));
  EXPECT_TRUE(refused(renamed("acceleration:IQN-IMVJ", "acceleration:broyden"))
                  .starts_with("33:5: <acceleration:broyden>: is no acceleration of Strake"));
  EXPECT_TRUE(refused(renamed("coupling-scheme:parallel-implicit", "coupling-scheme:serial-implicit"))
                  .starts_with("35:7: <data>: Force does not go from Hull to Water"));
}

TEST_F(PreciceImport, RefusesNamesThatACaseCannotHold) {
  EXPECT_TRUE(refused(changed("first=\"Water\"", "first=\"Wa&#10;ter\"",
                              changed("participant name=\"Water\"", "participant name=\"Wa&#10;ter\"")))
                  .starts_with("24:5: <participants>: has the name \"Wa\\x0ater\""));
  std::string text = whole;
  for (std::size_t at; (at = text.find("\"Force\"")) != std::string::npos;) text.replace(at, 7, "'F=\"'");
  EXPECT_TRUE(refused(text).starts_with("29:5: <exchange>: has the name \"F=\"\"")) << refused(text);
}

TEST_F(PreciceImport, SaysOnceThatAFileIsOfVersion2) {
  EXPECT_EQ(
      refused("<precice-configuration><solver-interface dimensions=\"2\"><use-mesh name=\"A\" /><use-mesh />"
              "</solver-interface></precice-configuration>"),
      "1:24: <solver-interface>: is of preCICE 2\n  fix: bring the configuration to preCICE 3 first\n");
}

TEST_F(PreciceImport, RefusesElementsWithoutEnd) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<data>";
  EXPECT_TRUE(refused("<precice-configuration>" + deep).starts_with("1:144: <data>: is inside 21 elements"))
      << refused("<precice-configuration>" + deep);
}

TEST_F(PreciceImport, NamesAllForeignElementsAtOnce) {
  const std::string said = refused(changed("<m2n", "<action:summation /><colour /><m2n"));
  EXPECT_NE(said.find("22:3: <action:summation>"), std::string::npos) << said;
  EXPECT_NE(said.find("22:23: <colour>"), std::string::npos) << said;
}

TEST_F(PreciceImport, NeedsATestOfConvergenceOrAFixedNumber) {
  std::string text = changed(
      "<relative-convergence-measure data=\"Displacement\" mesh=\"Hull-Mesh\" limit=\"1e-4\" strict=\"true\" "
      "/>",
      "");
  text = changed("<residual-relative-convergence-measure data=\"Force\" mesh=\"Hull-Mesh\" limit=\"1e-3\" />",
                 "", text);
  EXPECT_TRUE(
      refused(text).starts_with("23:3: <coupling-scheme:parallel-implicit>: has no convergence measure"));
  EXPECT_EQ(read(changed("value=\"30\"", "value=\"2\"", text)).scheme.max_iterations.value, 2);
}

}  // namespace
}  // namespace strake
