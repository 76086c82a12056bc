#include "structure/case/keys.hpp"

namespace strake::structure {

void read_fem(CaseTable t, int dimension, FemKeys& fem) {
  t.choice(
      "strain", fem.strain,
      {{"auto", StrainField::automatic},
       {"compatible", StrainField::compatible},
       {"enhanced", StrainField::enhanced},
       {"solid_shell", StrainField::solid_shell}},
      {.help =
           "compatible: of the displacement alone; enhanced: with strains beside it that keep cells "
           "from locking in bending (Q1) and at constant volume; solid_shell: of thin plates that are one "
           "cell thick, three dimensions, Q1; auto: enhanced for Q1, and for Q2 from Poisson's ratio 0.49 "
           "on, but compatible for neo_hookean and with a failure criterion"});
  // Two cells of Q2 through the thickness are within 0.5 % of four in deflection and first frequency (slab,
  // box with an elastic bottom, T beam); eight make some ten times as many unknowns.
  constexpr int in_space = 1;
  if (dimension == 3) fem.refinement = in_space;
  if (fem.strain == StrainField::solid_shell) {
    fem.degree = 1;
    fem.refinement = 0;
  }
  t.integer("degree", fem.degree,
            {.min = 1, .max = 2, .help = "of the elements: Q1 or Q2; solid_shell: Q1, also where not given"});
  t.integer("refinement", fem.refinement,
            {.min = 0,
             .max = 6,
             .help = "2^refinement cells through the thickness; not given: in space 1, of a solid_shell 0"});
  t.number(
      "cell_size", fem.cell_size,
      {.unit = "m",
       .min = 0,
       .help = "of the cells along the parts of a plate or of boxes; 0: small at supports and joints, from "
               "the thickness on; of a solid_shell 1/32 of the longest part"});
  t.number("rho_infinity", fem.rho_infinity,
           {.min = 0, .max = 1, .help = "spectral radius of generalised-alpha; 1: Newmark, no damping"});
  t.number("tolerance", fem.tolerance, positive("1", "of Newton's method, relative"));
  t.choice(
      "linear_solver", fem.linear_solver,
      {{"auto", LinearMethod::automatic}, {"direct", LinearMethod::direct}, {"cg-amg", LinearMethod::cg_amg}},
      {.help = "direct: Cholesky factors in three dimensions (CHOLMOD), LU factors else (UMFPACK); cg-amg: "
               "conjugate gradients with algebraic multigrid (Trilinos ML); auto: direct, but in three "
               "dimensions from 250000 unknowns on cg-amg first, and direct where it fails"});
}

void check_fem(CaseTable t, const Parameters& p) {
  if (p.fem.strain != StrainField::solid_shell) return;
  if (p.dimension == 2)
    throw t.error("strain", "auto, compatible or enhanced: a solid_shell has three dimensions",
                  "strain = \"enhanced\" with degree = 1 and refinement = 0, or fluid.dimension = 3");
  if (p.fem.degree == 2)
    throw t.error("degree", "1: a solid_shell has eight nodes", "leave degree out, or strain = \"auto\"");
}

}  // namespace strake::structure
