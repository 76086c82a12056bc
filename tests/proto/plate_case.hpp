#pragma once

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace strake {

/// A few keys of a plate case with every kind of declaration, for tests of the case file.
struct PlateCase {
  CommonKeys common;
  double spacing = 0, sound_speed = 1500, cfl = 0.2, young = 2.1e11;
  int degree = 2;
  bool negative_pressure = true;
  Eigen::Vector3d gravity{0, -9.81, 0};
  Box tank;
  enum class Material { linear, saint_venant_kirchhoff } material = Material::saint_venant_kirchhoff;
  std::filesystem::path reference, run;
  std::vector<std::string> parts{"bottom"};
  struct Compare {
    std::string probe;
    std::vector<std::pair<std::string, std::vector<std::string>>> when;
    std::vector<std::pair<std::string, double>> value;
  };
  std::vector<Compare> compare;
};

inline PlateCase read_plate(CaseFile& file) {
  PlateCase c;
  c.common = read_common(file);
  CaseTable fluid = file.root().table("fluid");
  fluid.number("spacing", c.spacing,
               {.unit = "m", .min = 0, .exclusive = true, .required = true, .help = "l0"});
  fluid.number(
      "sound_speed", c.sound_speed,
      {.unit = "m/s", .min = 0, .exclusive = true, .paper = std::numeric_limits<double>::infinity()});
  fluid.vector("gravity", c.gravity, {.unit = "m/s^2"});
  fluid.box("tank", c.tank, {.unit = "m"});
  CaseTable scheme = fluid.table("scheme", "the MPS scheme");
  scheme.number("cfl", c.cfl, {.min = 0, .max = 1, .exclusive = true, .paper = 0.1});
  scheme.flag("negative_pressure", c.negative_pressure, {.paper = false});
  CaseTable structure = file.root().table("structure");
  CaseTable material = structure.table("material");
  material.number("young", c.young, {.unit = "Pa", .min = 0, .exclusive = true});
  material.choice("model", c.material,
                  {{"linear", PlateCase::Material::linear},
                   {"saint_venant_kirchhoff", PlateCase::Material::saint_venant_kirchhoff}},
                  {.paper = "linear", .not_built = {"neo_hookean"}});
  structure.table("fem").integer("degree", c.degree, {.min = 1, .max = 2, .paper = 1});
  structure.texts("parts", c.parts, {.help = "driven parts"});
  structure.not_built("mesh", "meshes of Gmsh come with the hull");
  structure.table("replay").folder("run", c.run, {});
  for (CaseTable table : file.root().tables("compare", "what the case expects")) {
    PlateCase::Compare compare;
    table.text("probe", compare.probe, {.required = true});
    CaseTable when = table.table("when"), value = table.table("value");
    for (const std::string& key : when.keys()) compare.when.emplace_back(key, when.scalars_as_text(key));
    for (const std::string& key : value.keys())
      value.number(key, compare.value.emplace_back(key, 0).second, {});
    table.file("reference", c.reference, {.help = "curve"});
    c.compare.push_back(compare);
  }
  return c;
}

/// The top of its case file, up to the keys of [fluid].
inline const std::string head =
    "title = \"plate\"\n"
    "end_time = 0.03\n"
    "[fluid]\n"
    "spacing = 0.01\n";

inline PlateCase read(const std::string& text, const std::vector<std::string>& sets = {}) {
  CaseFile file = CaseFile::parse(text, "case.toml", sets);
  PlateCase c = read_plate(file);
  file.refuse_unknown();
  return c;
}

inline const KeyInfo& info(const CaseFile& file, const std::string& path) {
  const auto& keys = file.declared();
  const auto key = std::find_if(keys.begin(), keys.end(), [&](const KeyInfo& k) { return k.path == path; });
  if (key == keys.end()) throw std::runtime_error("not declared: " + path);
  return *key;
}

}  // namespace strake
