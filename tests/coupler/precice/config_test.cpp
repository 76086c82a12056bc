#include "coupler/precice/config/precice_config.hpp"
#include "coupler/precice/config/quantities.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace strake {
namespace config_test {

namespace fs = std::filesystem;

class PreciceConfigFile : public testing::Test {
 protected:
  ~PreciceConfigFile() override { fs::remove(path_); }

  PreciceConfig read(const std::string& text) {
    std::ofstream(path_) << text;
    return PreciceConfig::read(path_);
  }
  /// The error without the folder.
  std::string refused(const std::string& text) {
    try {
      read(text);
    } catch (const Error& e) {
      return to_text({e.code(), e.where().substr(e.where().rfind('/') + 1), e.problem(), e.fix()});
    }
    return "nothing was refused";
  }

  fs::path path_ = fs::temp_directory_path() / ("strake-config-" + std::to_string(getpid()) + ".xml");
};

const std::string whole = R"(<?xml version="1.0"?>
<precice-configuration>
  <log><sink filter="none" /></log>
  <data:vector name="Force" waveform-degree="3" />
  <data:scalar name="Heat" />
  <mesh name="A" dimensions="2"><use-data name="Force" /></mesh>
  <mesh name="B" dimensions="3" />
  <participant name="One">
    <provide-mesh name="A" />
    <write-data name="Force" mesh="A" />
    <mapping:nearest-projection direction="write" from="A" to="B" constraint="conservative" />
  </participant>
  <participant name="Two"><provide-mesh name="B" /><receive-mesh name="A" from="One" /></participant>
  <coupling-scheme:parallel-explicit>
    <participants first="One" second="Two" /> <time-window-size value="2.5e-3" />
    <exchange data="Force" mesh="A" from="One" to="Two" initialize="yes" substeps="on" />
    <acceleration:IQN-ILS><data name="Force" mesh="A" /></acceleration:IQN-ILS>
  </coupling-scheme:parallel-explicit>
</precice-configuration>
)";

TEST_F(PreciceConfigFile, KeepsNamesDimensionsAndExchanges) {
  const PreciceConfig config = read(whole);
  EXPECT_TRUE(config.find_data("Force")->vector);
  EXPECT_EQ(config.find_data("Force")->waveform_degree, 3);
  EXPECT_EQ(config.find_data("Heat")->waveform_degree, 1);
  EXPECT_EQ(config.data.size(), 2u);
  EXPECT_EQ(config.find_mesh("A")->dimension, 2);
  EXPECT_EQ(config.find_mesh("A")->data, std::vector<std::string>{"Force"});
  const auto* one = config.find_participant("One");
  EXPECT_EQ(one->provided, std::vector<std::string>{"A"});
  EXPECT_EQ(one->writes.front().data, "Force");
  EXPECT_EQ(one->mappings.front().kind, "nearest-projection");
  EXPECT_TRUE(config.conservative({"A", "Load"}));
  EXPECT_FALSE(config.conservative({"B", "Load"}));
  // Of two mappings from one mesh that to the mesh on which the data are read.
  std::string two = whole;
  two.replace(two.find("    <mapping"), 0,
              "    <mapping:rbf direction=\"write\" from=\"A\" to=\"C\" constraint=\"consistent\" />\n");
  two.replace(two.find("<receive-mesh"), 0, "<read-data name=\"Force\" mesh=\"B\" />");
  EXPECT_TRUE(read(two).conservative({"A", "Force"}));
  EXPECT_FALSE(read(two).conservative({"A", "Heat"}));
  EXPECT_EQ(config.find_participant("Two")->received, std::vector<std::string>{"A"});
  const auto& scheme = config.schemes.front();
  EXPECT_FALSE(scheme.implicit);
  EXPECT_EQ(scheme.participants, (std::vector<std::string>{"One", "Two"}));
  EXPECT_TRUE(scheme.exchanges.front().initialize);
  EXPECT_TRUE(scheme.exchanges.front().substeps);
  EXPECT_EQ(config.find_participant("Three"), nullptr);
  EXPECT_EQ(config.window_of("Two"), 2.5e-3);
  EXPECT_EQ(config.window_of("Three"), 0);
  std::string text = whole;
  text.replace(text.find("2.5e-3"), 6, "-1");  // the first participant chooses it
  EXPECT_EQ(read(text).window_of("Two"), 0);
}

TEST_F(PreciceConfigFile, RefusesWithLineAndColumn) {
  const std::string name = path_.filename().string();
  const auto changed = [](std::string from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(refused("<solver-interface/>"),
            name +
                ":1:1: <solver-interface>: is not the beginning of a preCICE configuration\n"
                "  fix: the outermost element is <precice-configuration>\n");
  EXPECT_EQ(refused(changed("name=\"Force\" mesh=\"A\"", "name=\"Forse\" mesh=\"A\"")),
            name + ":10:5: <write-data>: name = \"Forse\" is no data\n  fix: did you mean \"Force\"?\n");
  EXPECT_EQ(refused(changed("dimensions=\"2\"", "dimensions=\"4\"")),
            name + ":6:3: <mesh>: dimensions = \"4\"\n  fix: dimensions=\"2\" or \"3\"\n");
  EXPECT_EQ(refused(changed(" dimensions=\"2\"", "")),
            name + ":6:3: <mesh>: has no dimensions\n  fix: <mesh dimensions=\"…\" … />\n");
  EXPECT_EQ(refused(changed("substeps=\"on\"", "substeps=\"perhaps\"")),
            name + ":16:5: <exchange>: substeps = \"perhaps\"\n  fix: true or false\n");
  EXPECT_EQ(refused(changed("2.5e-3", "1 ms")),
            name + ":15:47: <time-window-size>: value = \"1 ms\"\n  fix: a number of seconds above 0\n");
  EXPECT_EQ(refused(changed("waveform-degree=\"3\"", "waveform-degree=\"-1\"")),
            name + ":4:3: <data:vector>: waveform-degree = \"-1\"\n  fix: a whole number from 0\n");
  EXPECT_EQ(refused(changed("<participant name=\"Two\">", "<participant name=\"Two\"")),
            name + ":13:26: is no XML: not well-formed (invalid token)\n");
}

TEST(QuantityNames, FollowRulesThenTheNameItself) {
  const QuantityNames names("Load=force;Dz = x;Heat=heat-flux");
  EXPECT_EQ(names.of("Load", false).unit, "N");
  EXPECT_TRUE(names.of("Load", false).conservative);
  EXPECT_EQ(names.of("Displacement", true).name, "displacement");
  EXPECT_FALSE(names.of("Displacement", true).conservative);
  EXPECT_EQ(names.of("Heat", true).name, "heat-flux");
  EXPECT_EQ(names.of("Heat", true).unit, "1");
  EXPECT_TRUE(names.of("Heat", true).conservative);
  EXPECT_EQ(names.of("CrossSection", false).name, "CrossSection");
  EXPECT_EQ(names.of("Dz", false).name, "x");
  EXPECT_THROW(QuantityNames("Force"), Error);
  EXPECT_THROW(QuantityNames("=force"), Error);
  EXPECT_NO_THROW(QuantityNames(";Force=force;"));
}

}  // namespace config_test
}  // namespace strake
