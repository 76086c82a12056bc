#pragma once

namespace strake::fluid {

/// The tuned numbers of the least-squares scheme. Lengths are in spacings l0. "Chosen" means that no
/// measurement stands behind the value.
struct LeastSquaresConstants {
  // A lattice, for comparison.
  double first_row = 0.5;  // [l0] height of the first layer over a face; its depth under the free surface

  // Moment matrices (fluid/THEORY.md (F33)).
  double least_ratio = 0.1;  // [-] smallest ratio of eigenvalues; at twice that a direction counts. Chosen
  double even_2d = 0.56;     // [-] det/(tr/d)^d above which no eigenvalue is below 2 least_ratio. Derived
  double even_3d = 0.52;     // [-] the same in space
  double singular = 1e-6;    // [-] of the lattice's determinant or of the trace. Chosen
  double smallest = 1e-3;    // [-] part of n0, or of a distance, below which nothing is divided by it. Chosen

  // Free surface (F37)–(F39).
  double surface_begins = 0.5;  // [M2] |m| at which σ leaves 0. Chosen
  double surface_counts = 0.9;  // [M2] |m| at which σ reaches 1. Chosen
  double least_depth = 0.4;     // [l0] smallest depth D. Chosen
  double largest_depth = 2.0;   // [l0] largest depth D. Chosen
  double edge = 0.25;           // [W_1] missing weight that makes an edge, where D ≥ first_row. Chosen
  double shown_depth = 1.0;     // [l0] a particle less deep than this is shown as surface. Chosen
  double inner_depth = 2;       // [l0] depth from which packed water has no surface at the start. Derived
  double gap = 0.01;            // [-] of a full tank's volume, that a packed lattice may leave. Chosen

  // Faces (F34)–(F36).
  double face_reach = 1.6;  // [l0] water this near to a face's middle gives the mean velocity there. Chosen
  double own_height = 1;  // [l0] about this height its own velocity gives way to that mean, if curved. Chosen
  double own_side = 0.75;  // [l0] the same for its distance beside the face's middle. Chosen
  double own_fades = 0.5;  // [l0] over this distance. Chosen
  double at_end = 0.25;  // [l0] water this near to a face's sharp end lies at its corner. Chosen; 0.5: blows
  double at_keel = 0.6;  // [l0] the same of a keel in space. Chosen; 0.25: blows
  double past_end = 1;   // [l0] and water that is less far past the end. Chosen
  double stopped = 0.3;  // [l0] height below which no residual velocity past a face is left. Chosen

  // Faces newly met (F71).
  double under_face = 0.75;      // [l0] beside a wet face's middle, within which water is met already. Chosen
  double goes_on = 0.9;          // [-] cosine between faces that lie along one another. Chosen
  double one_sided = 0.5;        // [-] |Σ w r|/Σ w |r| above which a surface lies on one side. Chosen
  double steepest = 3;           // [-] largest tangent of the angle between a face and the surface. Chosen
  double stopped_height = 0.25;  // [l0] height at which water must have lost its approach to a face. Chosen
  double least_stopping = 0.1;   // [l0] shortest way on which it loses it. Chosen; 0 stops it at once

  // Own pressure beside bodies (F47).
  double body_counts = 0.06;  // [n0] tr a of bodies where b ≥ f D N·C holds in full. Chosen; 0.25: noise

  // Images in faces (F72).
  double alike = 0.8;      // [-] cosine of two normals above which both are one face. Chosen
  double one_plane = 0.3;  // [l0] two heights over one face fit the places so far. Chosen

  // Limits on the pressure (F46).
  double no_tension_to = 1.6;       // [l0] distance to the surface up to which p ≥ 0. Chosen
  double no_tension_beside = 0.8;   // [l0] where a body stood in the water. Chosen; 0.16: the same rolls
  double tension_from = 3.1;        // [l0] from here on tension counts in full: the Laplacian's radius
  double largest_tension = 0.99e5;  // [Pa] atmosphere less the pressure of vapour

  // Films and spray (F69).
  double film_begins = 0.58;  // [-] ratio of B's eigenvalues below which φ > 0; a first row has 0.59. Chosen
  double film_counts = 0.5;   // [-] the same for φ = 1. Chosen

  // Lack of water beside a body that stood in it (F88).
  double lack = 0.03;  // [-] δ_m, the lack that counts most. Chosen; 0.02 and 0.05: the same hull at rest

  // Residual, filter and shifting (F45), (F48), (F49).
  double memory_rate = 0.2;    // [-] how fast τ_r falls, against Δt/τ_r. Chosen
  double filter_bound = 0.25;  // [-] part of δ that a step removes at most. Chosen
  double filter_floor = 0.02;  // [√(g l0)] least |δ| of the filter; 0: trapezoid at 10 mm/s, 0.05: as 0.02
  double longest_shift = 0.1;  // [l0] Chosen
  double soft_stiffness = 0.02;  // [-] αS below which S is left out. Chosen
};

/// The values in use. A benchmark may change them before a simulation is made; no run does.
inline LeastSquaresConstants& least_squares_constants() {
  static constinit LeastSquaresConstants values;
  return values;
}

}  // namespace strake::fluid
