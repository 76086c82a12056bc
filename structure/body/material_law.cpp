#include "structure/body/material_law.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace strake::structure {

std::string material_law(const std::vector<Part>& parts) {
  constexpr std::array<std::pair<MaterialModel, const char*>, 3> known = {
      {{MaterialModel::linear, "linear elasticity"},
       {MaterialModel::saint_venant_kirchhoff, "Saint Venant-Kirchhoff"},
       {MaterialModel::neo_hookean, "neo-Hookean"}}};
  std::vector<std::pair<std::string, std::string>> laws;  // law, names of its parts
  for (const auto& [model, law] : known)
    for (const Part& part : parts) {
      if (part.material.model != model) continue;
      if (laws.empty() || laws.back().first != law) laws.emplace_back(law, "");
      std::string& names = laws.back().second;
      names += (names.empty() ? "" : ", ") + part.name;
    }
  std::string text;
  for (const auto& [law, names] : laws)
    text += (text.empty() ? "" : " and ") + law + (laws.size() > 1 ? " (" + names + ")" : "");
  return text;
}

bool all_linear(const std::vector<Part>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [](const Part& part) { return part.material.model == MaterialModel::linear; });
}

}  // namespace strake::structure
