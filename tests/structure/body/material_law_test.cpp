#include "structure/body/solid.hpp"

#include <gtest/gtest.h>

namespace strake::structure {
namespace material_law_test {

Part part(const std::string& name, MaterialModel model) {
  Part part;
  part.name = name;
  part.material.model = model;
  return part;
}

TEST(MaterialLaw, IsThatOfTheMaterialAndOfEachPartWhereTheyDiffer) {
  const Part plate = part("plate", MaterialModel::saint_venant_kirchhoff),
             deck = part("deck", MaterialModel::saint_venant_kirchhoff),
             pad = part("pad", MaterialModel::neo_hookean), rib = part("rib", MaterialModel::linear);
  EXPECT_EQ(material_law({plate}), "Saint Venant-Kirchhoff");
  EXPECT_EQ(material_law({pad}), "neo-Hookean");
  EXPECT_EQ(material_law({rib}), "linear elasticity");
  EXPECT_EQ(material_law({plate, deck}), "Saint Venant-Kirchhoff");
  EXPECT_EQ(material_law({plate, pad, deck, rib}),
            "linear elasticity (rib) and Saint Venant-Kirchhoff (plate, deck) and neo-Hookean (pad)");
  EXPECT_TRUE(all_linear({rib}));
  EXPECT_FALSE(all_linear({rib, pad}));
}

}  // namespace material_law_test
}  // namespace strake::structure
