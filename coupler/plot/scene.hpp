#pragma once

#include "coupler/participant/interface_record.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace strake::picture {

struct Place {
  double x = 0, y = 0;  // [m]
};

/// From `lo` to `hi`; empty while lo > hi.
struct Range {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  bool empty() const { return !(lo <= hi); }
  /// -0 counts as 0.
  void add(double value) {
    if (value < lo) lo = value + 0.0;
    if (value > hi) hi = value + 0.0;
  }
  void add(const Range& other) {
    if (other.empty()) return;
    add(other.lo);
    add(other.hi);
  }
};

/// A quantity on marks, by the name that the frame gives it.
struct Quantity {
  std::string name, unit;  // empty name: there is none
  Range shown;             // without the outermost half per cent of either end
  Range all;               // with it
};

/// A particle: `value` is NaN where it has none.
struct Mark {
  Place at;
  double value = 0;
};
/// Whether each mark of a lattice has others all around: seven of eight neighbours. spacing: [m] of the
/// lattice.
std::vector<bool> surrounded(const std::vector<Mark>& marks, double spacing);

/// A cell of a mesh, its section by the plane of the picture, or a line of two points.
struct Patch {
  std::vector<Place> corner;
  double value = 0;
};

/// What a picture shows of one instant of a run.
struct Scene {
  std::string title;
  double time = 0;           // [s] of the frame that was nearest
  double spacing = 0;        // [m] of the fluid's particles
  double solid_spacing = 0;  // [m] of the structure's, where it consists of particles
  std::vector<Mark> water, wall, solid;
  std::vector<Patch> cells;
  std::vector<std::vector<Place>> lines;  // springs and mooring lines
  std::vector<Patch> air;                 // between a face and the water, where a run computes it
  Quantity water_field, solid_field;
  std::string cut;                 // of three dimensions: which section this is; empty in two
  std::vector<std::string> notes;  // of bodies without frames
  double scale = 1;                // of the deformation
  Range x, y;                      // what water and structure span [m]
};

struct SceneOptions {
  double time = std::numeric_limits<double>::infinity();  // [s] the frame next to it
  /// A scalar of the fluid's frames, "speed" (|velocity|), or one of the structure's ("von_mises", "damage").
  /// The other side shows its pressure, or its von Mises stress.
  std::string field = "pressure";
  double scale = 1;  // of the structure's deformation: its displacement without rigid motion
};

/// The frames of a run and the settings of its case, read once for many scenes.
struct RunFrames {
  std::filesystem::path folder;
  std::map<std::string, std::string> keys;  // of case.toml
  std::vector<FrameFile> fluid, structure;  // of several bodies those of the first
  /// Of each body; one without a name for one structure.
  std::vector<std::pair<std::string, std::vector<FrameFile>>> bodies;
  std::shared_ptr<const InterfaceRecord> interface;  // where a body has no frames
};
/// Throws Error(case_file) where there is no frame.
RunFrames find_frames(const std::filesystem::path& run_folder);
/// Throws Error(command_line) for a field that no frame has, Error(case_file) for a damaged one.
Scene read_scene(const RunFrames&, const SceneOptions&);
/// One number per point of a field of the frame. It is the field itself, or the length of a vector ("speed":
/// velocity). Name and unit go to `quantity`. Nothing if the frame has no such field.
std::optional<Eigen::VectorXd> scalar(const Frame&, const std::string& name, Quantity& quantity);
/// Displacement of each point less the rigid motion of the whole [m], 3 x n; nothing without displacements.
/// The rigid motion is that of driven supports, V t; of a body that is free or follows a table the one that
/// fits its points best. body: of several, its name.
std::optional<Points> deformation(const std::map<std::string, std::string>& keys, const Frame&,
                                  const std::string& body = {});
/// Of several bodies in one frame: each less its own rigid motion. parts: where each begins.
std::optional<Points> deformation(const std::map<std::string, std::string>& keys, const Frame&,
                                  const std::vector<MeshPart>& parts);
/// Distance of the particles of a lattice [m]: the median of those of points that follow one another.
double lattice_spacing(const Frame&);
/// The shown range of values: from zero where the least is but a small part of the largest.
Range shown_range(std::vector<double> values);

/// The section of one cell by the plane z = `at`: corners in order, two for a facet, none without
/// intersection.
std::vector<Place> section(const Points& point, const Eigen::VectorXi& cell, double at);

/// The interface record of a run; none where it has none that can be read.
std::shared_ptr<const InterfaceRecord> record_of(const std::filesystem::path& run_folder);
/// Adds the wet interface of a body without frames to the scene, at its time, and a note. body: of several,
/// its name. at: [m] the plane of the section; none in two dimensions.
void draw_interface(const RunFrames&, const std::string& body, std::optional<double> at, Scene&);

/// Springs and mooring lines of a body at one instant: places along each, 3×n [m], the anchor first. keys: of
/// case.toml, by full names. body: of several, its name.
std::vector<Points> attached_lines(const std::map<std::string, std::string>& keys, const Frame& structure,
                                   const std::string& body);

}  // namespace strake::picture
