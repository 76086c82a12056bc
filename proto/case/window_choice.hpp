#pragma once

#include <string>

namespace strake {

class CaseFile;
struct CommonKeys;

/// coupling.surface.window of a case that gives none, and why.
struct WindowChoice {
  double window = 1e-5;  // [s]
  bool level = true;     // a level face may meet the water: its first pressure needs steps that resolve sound
  bool known = true;     // the flow is: otherwise the window is the usual one, and no measure of another
  double speed = 0;      // [m/s] of the body's fastest point, or of waves in the water
  double by_table = 0;   // [m/s] the largest that structure.motion.file gives a point of the body
  bool from_rest = false;  // the body starts at rest out of the water, and moves: free, or by a table
  std::string why;         // the bound that decided, in words
};

/// Chooses the exchange window of surface coupling from what the case gives of fluid and structure.
/// keys: title, preset, end_time, solvers and interface have been read. Declares no key.
///
/// A level face that may meet the water, and what Strake does not know (a program's body out of the water, a
/// lost record, preset paper, no fluid) keep 1e-5 s, a level face at most 2 l0/c. Elsewhere the shortest of
///
///   0.05 l0 / U                 the body, or water with waves of its depth, moves a twentieth of a spacing
///   0.2 √(l0/g)                 four of the steps that gravity allows
///   20 l0 / √(E/ρ_s)            elastic bodies: bending as short as the water can load
///   2 l0 / c                    elastic or free bodies whose steps resolve sound, c Δt < l0: thin layers of
///                               water ring in longer windows (coupler/THEORY.md, section on windows)
///   end_time / 100              rows of the history
///   output.every, and of a replay the window of its record
///
/// rounded down to 1, 2, 2.5, 4 or 5 times a power of ten. U is the largest of the body's speed at t = 0, of
/// that of a free body or of structure.motion.file later, and, for elastic or driven bodies, of √(g H). The
/// speed of a body that turns is that of its fastest point, |v| + |ω| r, r being its reach_of_body. A
/// free body above the water gains g end_time, at most as much as a fall from the tank's top to its floor
/// gives. One that stands in the water at the start (fluid.submerged) moves with the waves, U = √(g H) at
/// most, or the speed that it was given. Water alone has no exchange; it takes end_time / 400. A given
/// fluid.scheme.time_step is never longer than the window.
WindowChoice choose_window(const CaseFile&, const CommonKeys& keys);

/// Distance of the body's farthest point from the axis along z that it turns about [m]: through
/// structure.pivot, else its centre of gravity, else the middle of its extent. A cylinder or sphere turns
/// within its own surface, so that of its centre. 0 where the case does not tell, as of a program's own body.
/// Reads the file of a mesh or of offsets.
double reach_of_body(const CaseFile&);

/// Rounds down to 1, 2, 2.5, 4 or 5 times a power of ten that divides `whole`. Where none of the next few
/// divides it, the largest is taken. whole = 0: every one divides it.
double round_window(double value, double whole = 0);

}  // namespace strake
