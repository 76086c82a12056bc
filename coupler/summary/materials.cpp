#include "coupler/summary/materials.hpp"

#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

namespace strake {
namespace {

/// Values between which a material is taken for this one.
struct MetalRange {
  double least, most;
  bool has(double value) const { return value >= least && value <= most; }
};

struct Metal {
  const char* name;
  MetalRange young, density;  // [Pa], [kg/m³]
  double softest;             // [Pa] what has this density and is softer than this is none of its materials
  const char* its_young;      // how it is often written, and in Pa
  const char* its_density;
};

// Densities from cast iron to bronze are 7000 to 9000 kg/m³, of which no material has less than 4e10 Pa (tin,
// 7300 kg/m³). Aluminium, glass and granite have 2600 to 2800 kg/m³ and 2e10 Pa and more. Rubber with fillers
// has at most 2000 kg/m³, lead 11 300. Test cases with soft walls have 1000, 2500 or 10 000 kg/m³.
constexpr Metal steel = {"steel", {1.9e11, 2.2e11}, {7000, 9000}, 1e10, "210 GPa are 2.1e11", "7800"};
constexpr Metal aluminium = {"aluminium", {6.5e10, 7.5e10}, {2600, 2800}, 1e9, "70 GPa are 7e10", "2700"};

/// A material of a body: where it stands in the case, E and ρ.
struct Material {
  std::string table;
  double young, density;
};

std::string too_soft(const Material& m) {
  constexpr double gel = 1e4, rubber = 1e6, heavy = 2000;  // [Pa], [Pa], [kg/m³]: heavier is a metal
  if (m.young < gel)
    return fmt::format("{}.young = {:.3g} Pa is softer than a gel; 210 GPa are 2.1e11", m.table, m.young);
  for (const Metal& metal : {steel, aluminium})
    if (metal.density.has(m.density) && m.young < metal.softest)
      return fmt::format(
          "{}.young = {:.3g} Pa is softer than any metal, and {:.4g} kg/m^3 are those of {}; {}", m.table,
          m.young, m.density, metal.name, metal.its_young);
  if (m.young < rubber && m.density > heavy)
    return fmt::format(
        "{}.young = {:.3g} Pa is softer than rubber, and {:.4g} kg/m^3 are those of a metal; 210 000 MPa are "
        "2.1e11",
        m.table, m.young, m.density);
  return {};
}

/// One key of steel, the other of aluminium: where one of them is left out, it is that of steel.
std::string of_two_metals(const Material& m) {
  for (const auto& [stiff, heavy] : {std::pair(steel, aluminium), std::pair(aluminium, steel)})
    if (stiff.young.has(m.young) && heavy.density.has(m.density))
      return fmt::format(
          "{0}.young = {1:.3g} Pa is that of {2}, density = {3:.4g} kg/m^3 that of {4}: {2} has {5} kg/m^3, "
          "and of {4} {6}",
          m.table, m.young, stiff.name, m.density, heavy.name, stiff.its_density, heavy.its_young);
  return {};
}

std::vector<std::string> faults_of(const Material& m) {
  constexpr double diamond = 1.3e12, foam = 20, osmium = 2.3e4;  // [Pa], [kg/m³], [kg/m³]
  std::vector<std::string> lines = {too_soft(m), of_two_metals(m)};
  if (m.young > diamond)
    lines.push_back(
        fmt::format("{}.young = {:.3g} Pa is stiffer than diamond; 210 GPa are 2.1e11", m.table, m.young));
  if (m.density < foam)
    lines.push_back(fmt::format("{}.density = {:.3g} kg/m^3 is lighter than foam; 7.8 g/cm^3 are 7800",
                                m.table, m.density));
  if (m.density > osmium)
    lines.push_back(fmt::format("{}.density = {:.3g} kg/m^3 is heavier than any metal; steel has 7800",
                                m.table, m.density));
  std::erase(lines, "");
  return lines;
}

std::optional<Material> material_of(const CaseView& view, const std::string& table) {
  const auto young = view.number(table + ".young"), density = view.number(table + ".density");
  if (!young && !density) return std::nullopt;
  constexpr double no_fault_young = 1e11, no_fault_density = 1e4;  // [Pa], [kg/m³] where one is not told
  return Material{table, young.value_or(no_fault_young), density.value_or(no_fault_density)};
}

/// The materials of a body that differ: its own unless each box or part has one, then those of the others.
std::vector<Material> materials_of(const CaseView& view, const std::string& body) {
  std::vector<Material> found;
  const auto add = [&](const std::string& table) {
    const auto m = material_of(view, table);
    if (!m) return false;
    for (const Material& other : found)
      if (other.young == m->young && other.density == m->density) return true;
    found.push_back(*m);
    return true;
  };
  add(body + ".material");
  for (const char* list : {".box", ".part"})
    for (std::size_t k = 0; add(fmt::format("{}{}[{}].material", body, list, k)); ++k) {
    }
  return found;
}

}  // namespace

void look_at_materials(const CaseView& view, std::vector<std::string>& lines) {
  for (const SideView& side : view.structures) {
    const std::string body = side.is_body ? "structures." + side.side : "structure";
    const double length =
                     view.number(body + ".plate.length").value_or(std::numeric_limits<double>::infinity()),
                 thickness = view.number(body + ".plate.thickness").value_or(0);
    if (thickness > length)
      lines.push_back(fmt::format(
          "{}.plate.thickness = {:.4g} m is more than its length, {:.4g} m: lengths are in m, 10 mm are 0.01",
          body, thickness, length));
    if (!side.deforms() || side.is_users()) continue;
    for (const Material& m : materials_of(view, body))
      for (std::string& line : faults_of(m)) lines.push_back(std::move(line));
  }
}

}  // namespace strake
