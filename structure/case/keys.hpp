#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace strake::structure {

/// Reads [structure.plate]: length, thickness, place, angle, hollow [SI, deg] and supports.
void read_plate(CaseTable, Plate&);

/// Makes the polygon of a plate whose lower face is a parabola. Its 40 chords miss that by 0.0006 of its
/// depth. `structure` is the table [structure]. Throws Error(case_file) where the solver is not rigid, or the
/// plate is thinner than it is hollow.
void read_hollow_plate(CaseTable structure, Parameters&);

/// Reads the one shape of [structure]: plate, outline, wedge, cylinder or sphere. In three dimensions it
/// reads the extent along z too. Throws Error(case_file) for a shape that no body can have.
void read_shape(const CaseFile&, CaseTable structure, Parameters&);

/// Reads the motion of a rigid body, or of the frame of an elastic body's supports. It reads mass and
/// inertia, motion by a table, turning and freedom, and checks them against one another.
void read_body(const CaseFile&, CaseTable structure, const CommonKeys&, Parameters&);

/// Reads [structure.initial_velocity] of an elastic body.
void read_initial_velocity(const CaseFile&, CaseTable structure, Parameters&);

/// Reads structure.loaded_faces, or structure.wet, its name before version 0.2. Throws Error(case_file) for a
/// face that the body has not got.
void read_loaded_faces(CaseTable structure, bool only_declares, Parameters&);

/// Reads [[structure.box]], the parts of an elastic body, and builds the solid of the given shape. Called
/// after read_shape and after [structure.material], which is the material of parts without one. Throws
/// Error(case_file) for a body in separate pieces, a support that constrains nothing, and so on.
void read_solid(const CaseFile&, CaseTable structure, Parameters&);

/// Reads a table of material keys over the values that stand in the material.
void read_material(CaseTable, Material&);

/// A body of structure.mesh that is an STL file, x ↦ map x + move with both of [structure.placed]. Fills
/// Parameters::closed_surface and sets the shape's kind. Throws Error(case_file) if the file or the solver
/// does not allow such a body.
void read_surface_body(CaseTable structure, Parameters&, const std::filesystem::path& stl,
                       const Eigen::Matrix3d& map, const Eigen::Vector3d& move);

/// Reads structure.offsets and structure.station: one section of a table of offsets, mirrored at the middle
/// plane. Returns its corners (half breadth, height) [m], counter-clockwise from the keel, the top closed by
/// a deck. Empty: the keys are not given. Throws Error(case_file) with the table's file and row.
std::vector<Eigen::Vector2d> read_offsets(const CaseFile&, CaseTable structure);

/// x ↦ R (s x) + move: R turns about the axis through the origin.
struct Placing {
  double scale = 1, angle = 0;  // angle in degrees
  Eigen::Vector3d axis = {0, 0, 1}, move = {0, 0, 0};
  Eigen::Matrix3d turn() const;                           // R
  Eigen::Matrix3d map() const { return scale * turn(); }  // s R
};

/// A key for a turn of at most `most` degrees to either side.
NumberKey turn_key(double most, const std::string& help);

/// Reads [structure.placed]. Throws Error(case_file) where the body's shape is not placed, or where the axis
/// would turn a body out of its plane.
Placing read_placing(CaseTable structure, const Parameters&, bool only_declares);

/// The turn of a plate by structure.plate.angle, about the middle of its lower face.
Placing tilt_of(const Plate&);

void place(Solid&, const Placing&);

/// Places the corners of structure.offsets, structure.outline or structure.wedge; nothing else. Throws
/// Error(case_file) where they are no outline of a body then.
void place_section(CaseTable structure, Parameters&, const Placing&);

/// Reads [structure.fem]. In space the default is two cells through the thickness, in the plane eight. A
/// solid shell has other defaults: degree 1, one cell through the thickness.
void read_fem(CaseTable, int dimension, FemKeys&);

/// Throws Error(case_file) where a solid shell is asked for and cannot be: in the plane, or of degree 2.
void check_fem(CaseTable, const Parameters&);

/// Reads structure.ranks and structure.launcher.
void read_ranks(CaseTable structure, Parameters&);

/// Refuses what is computed on one rank alone.
void check_ranks(const CaseTable& structure, const Parameters&);

/// Refuses a body whose smallest box leaves the box around fluid.tank by more than half a spacing. The fluid
/// refuses what leaves its walls by less, when it is built; this answers before anything is built. A mesh
/// that is far larger than the tank is told to be in mm.
void refuse_outside_tank(const CaseFile&, const CaseTable& structure, const CommonKeys&, const Parameters&);

}  // namespace strake::structure
