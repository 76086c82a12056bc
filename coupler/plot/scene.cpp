#include "coupler/plot/scene.hpp"

#include "coupler/case/case_view.hpp"
#include "proto/error.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/files/json_file.hpp"
#include "proto/interface.hpp"
#include "proto/lookup.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::picture {
namespace {

using Eigen::Index;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::map<std::string, std::string> keys_of(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "case.toml";
  try {
    return flatten_toml(read_text(path).value_or(""), path.string());
  } catch (const Error&) {  // a picture needs title and spacing only
    return {};
  }
}

double number(const std::map<std::string, std::string>& keys, const std::string& key, double otherwise) {
  return keys.contains(key) ? std::strtod(keys.at(key).c_str(), nullptr) : otherwise;
}

/// "[0, -6.26, 0]"
Eigen::Vector3d vector(const std::map<std::string, std::string>& keys, const std::string& key) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  const std::vector<double> numbers = numbers_in(at_or(keys, key));
  for (std::size_t k = 0; k < std::min<std::size_t>(3, numbers.size()); ++k)
    v(static_cast<Index>(k)) = numbers[k];
  return v;
}

/// Of three dimensions: the plane z = `at`, and how far from it a particle is still shown.
struct Cut {
  bool solid = false;
  double at = 0, half = 0;
  bool shows(double z, double reach) const { return !solid || std::abs(z - at) <= reach; }
};

std::string names(const Frame& frame) {
  std::string text;
  for (const Frame::Array& array : frame.point_data)
    if (array.name != "id" && array.name != "kind") text += (text.empty() ? "" : ", ") + array.name;
  return text;
}

/// A column of air below the face whose first layer particle is `behind`, l0/2 inside the body.
void add_air(Scene& scene, const Mark& behind, double gap) {
  const double half = 0.5 * scene.spacing, top = behind.at.y - half;
  const double left = behind.at.x - half, right = behind.at.x + half;
  scene.air.push_back({{{left, top}, {right, top}, {right, top - gap}, {left, top - gap}}, behind.value});
}

void take_water(const Frame& frame, const std::string& field, const Cut& cut, Scene& scene) {
  const auto value = scalar(frame, field, scene.water_field);
  const Frame::Array *kind = find(frame.point_data, "kind"), *gap = find(frame.point_data, "gap");
  std::vector<double> values;
  for (Index i = 0; i < frame.position.cols(); ++i) {
    const auto x = frame.position.col(i);
    if (!x.allFinite() || !cut.shows(x.z(), 0.5 * scene.spacing)) continue;
    const double what = kind == nullptr ? 0 : kind->value(0, i);
    const bool has = value && (what != 0 || field != "gap");  // the water has no gap
    const Mark mark = {{x.x(), x.y()}, has ? (*value)(i) : none};
    if (what == 1) scene.wall.push_back(mark);
    if (what == 3 && gap != nullptr && gap->value(0, i) > 0) {
      add_air(scene, mark, gap->value(0, i));
      if (std::isfinite(mark.value)) values.push_back(mark.value);
    }
    if (what != 0) continue;  // interface and structure particles are drawn from the structure's frames
    scene.water.push_back(mark);
    scene.x.add(x.x());
    scene.y.add(x.y());
    if (std::isfinite(mark.value)) values.push_back(mark.value);
  }
  if (value) {
    for (const double v : values) scene.water_field.all.add(v);
    scene.water_field.shown = shown_range(std::move(values));
  }
}

/// Positions with the deformation drawn larger, x + (s − 1) d.
Points enlarged(const Frame& frame, const std::map<std::string, std::string>& keys, double scale,
                const std::string& body) {
  if (scale == 1) return frame.position;
  const auto bend = deformation(keys, frame, body);
  return bend ? Points(frame.position + (scale - 1) * *bend) : frame.position;
}

/// Whether the whole body turns or goes where no support at a constant speed takes it.
bool moves_freely(const std::map<std::string, std::string>& keys, const std::string& table) {
  return std::any_of(keys.begin(), keys.end(), [&](const auto& key) {
    return (key.first.starts_with(table + ".free.") && key.second == "true") ||
           key.first.starts_with(table + ".motion.");
  });
}

/// The table of a body's keys.
std::string table_of(const std::string& body) {
  return body.empty() ? "structure" : "structures." + body;
}

/// The bodies of a case with several, from "structures.left.name".
std::vector<std::string> bodies_of(const std::map<std::string, std::string>& keys) {
  std::vector<std::string> names;
  for (const auto& [key, value] : keys)
    if (key == "structures." + value + ".name") names.push_back(value);
  return names;
}

/// Displacements of the rigid motion that fits best: the least Σ |R (X_i − X̄) + x̄ − x_i|², X = x − u. R comes
/// from the singular vectors of Σ (X_i − X̄)(x_i − x̄)ᵀ (Kabsch 1976).
Points rigid_part(const Points& at, const Points& u) {
  const Points before = at - u;
  const Eigen::Vector3d mean = at.rowwise().mean(), mean_before = before.rowwise().mean();
  const Points arm = before.colwise() - mean_before;
  const Eigen::Matrix3d moment = arm * (at.colwise() - mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d turn = svd.matrixV() * mirror * svd.matrixU().transpose();
  return ((turn * arm).colwise() + mean) - before;
}

void take_structure(const Frame& frame, const Points& at, const std::string& field, const Cut& cut,
                    Scene& scene, std::vector<double>& values) {
  const auto value = scalar(frame, field, scene.solid_field);
  const auto keep = [&](double v) {
    if (std::isfinite(v)) values.push_back(v);
  };
  const auto span = [&](const Place& p) {
    scene.x.add(p.x);
    scene.y.add(p.y);
  };
  if (frame.cells.cols() == 0) {
    for (Index i = 0; i < at.cols(); ++i) {
      if (!at.col(i).allFinite() || !cut.shows(frame.position(2, i), 0.5 * scene.solid_spacing)) continue;
      scene.solid.push_back({{at(0, i), at(1, i)}, value ? (*value)(i) : none});
      span(scene.solid.back().at);
      keep(scene.solid.back().value);
    }
  }
  for (Index c = 0; c < frame.cells.cols(); ++c) {
    const Eigen::VectorXi cell = frame.cells.col(c);
    Patch patch;
    if (cut.solid) {
      patch.corner = section(at, cell, cut.at);
    } else {
      for (const int k : cell) patch.corner.push_back({at(0, k), at(1, k)});
    }
    if (patch.corner.empty()) continue;
    patch.value = none;
    if (value) {
      patch.value = 0;
      for (const int k : cell) patch.value += (*value)(k) / static_cast<double>(cell.size());
    }
    for (const Place& p : patch.corner) span(p);
    keep(patch.value);
    for (const int k : cell)  // a cell has the colour of its mean; the extremes are those of its points
      if (value && std::isfinite((*value)(k))) scene.solid_field.all.add((*value)(k));
    scene.cells.push_back(std::move(patch));
  }
  if (value) {
    for (const double v : values) scene.solid_field.all.add(v);
    scene.solid_field.shown = shown_range(values);
  }
}

Cut middle_cut(const std::map<std::string, std::string>& keys, const Frame& frame, double spacing) {
  Cut cut;
  const bool flat = (frame.position.row(2).array() == 0).all();
  cut.solid = number(keys, "fluid.dimension", flat ? 2 : 3) == 3 && !flat;
  if (!cut.solid) return cut;
  // Half way between two layers of a lattice there is no particle: the plane stands on the layer nearest.
  const double middle = 0.5 * (frame.position.row(2).minCoeff() + frame.position.row(2).maxCoeff());
  cut.at = middle + (spacing > 0 ? 0.25 * spacing : 0);
  return cut;
}

/// Pairs of corners that an edge joins. Of four corners (a tetrahedron) these are all pairs. Of eight they
/// are those of a hexahedron whose two faces are numbered alike.
std::vector<std::pair<int, int>> edges(Eigen::Index corners) {
  if (corners != 8) {
    std::vector<std::pair<int, int>> all;
    for (int a = 0; a < corners; ++a)
      for (int b = a + 1; b < corners; ++b) all.emplace_back(a, b);
    return all;
  }
  return {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
}

}  // namespace

std::vector<bool> surrounded(const std::vector<Mark>& marks, double spacing) {
  constexpr double reach = 1.6;  // [spacing] beyond the diagonal of a cell
  constexpr int enough = 7 + 1;  // and the mark itself
  using Cell = std::pair<long, long>;
  const auto cell_of = [&](const Place& p) -> Cell {
    return {std::lround(p.x / (reach * spacing)), std::lround(p.y / (reach * spacing))};
  };
  std::vector<bool> inner;
  std::map<Cell, std::vector<Place>> cells;
  for (const Mark& mark : marks) cells[cell_of(mark.at)].push_back(mark.at);
  for (const Mark& mark : marks) {
    const Cell here = cell_of(mark.at);
    int near = 0;
    for (long x = here.first - 1; x <= here.first + 1; ++x)
      for (long y = here.second - 1; y <= here.second + 1; ++y)
        if (const auto found = cells.find({x, y}); found != cells.end())
          near += static_cast<int>(std::ranges::count_if(found->second, [&](const Place& p) {
            return std::hypot(p.x - mark.at.x, p.y - mark.at.y) < reach * spacing;
          }));
    inner.push_back(near >= enough);
  }
  return inner;
}

std::vector<Place> section(const Points& point, const Eigen::VectorXi& cell, double at) {
  std::vector<Place> cut;
  for (const auto& [a, b] : edges(cell.size())) {
    const auto p = point.col(cell(a)), q = point.col(cell(b));
    if ((p.z() < at) == (q.z() < at)) continue;
    const double s = (at - p.z()) / (q.z() - p.z());
    cut.push_back({p.x() + s * (q.x() - p.x()), p.y() + s * (q.y() - p.y())});
  }
  if (cut.size() < 3) return cut.size() == 2 ? cut : std::vector<Place>{};
  Place middle;
  for (const Place& c : cut) {
    middle.x += c.x / static_cast<double>(cut.size());
    middle.y += c.y / static_cast<double>(cut.size());
  }
  // The section of a convex cell is convex: its corners stand in the order of their angle.
  std::sort(cut.begin(), cut.end(), [&](const Place& p, const Place& q) {
    return std::atan2(p.y - middle.y, p.x - middle.x) < std::atan2(q.y - middle.y, q.x - middle.x);
  });
  return cut;
}

std::optional<Eigen::VectorXd> scalar(const Frame& frame, const std::string& name, Quantity& quantity) {
  const Frame::Array* array = find(frame.point_data, name == "speed" ? "velocity" : name);
  if (array == nullptr) return std::nullopt;
  quantity.name = name;
  quantity.unit = array->unit;
  if (array->value.rows() == 1) return array->value.row(0).transpose();
  return array->value.colwise().norm().transpose();
}

std::optional<Points> deformation(const std::map<std::string, std::string>& keys, const Frame& frame,
                                  const std::string& body) {
  const Frame::Array* u = find(frame.point_data, "displacement");
  if (u == nullptr || u->value.rows() != 3 || u->value.cols() == 0) return std::nullopt;
  if (body.empty() && !bodies_of(keys).empty()) return std::nullopt;  // each moves in its own way
  if (moves_freely(keys, table_of(body))) return Points(u->value - rigid_part(frame.position, u->value));
  return Points(u->value.colwise() - frame.time * vector(keys, table_of(body) + ".velocity"));
}

std::optional<Points> deformation(const std::map<std::string, std::string>& keys, const Frame& frame,
                                  const std::vector<MeshPart>& parts) {
  if (parts.empty()) return deformation(keys, frame);
  const Frame::Array* u = find(frame.point_data, "displacement");
  if (u == nullptr || u->value.rows() != 3) return std::nullopt;
  Points all(3, frame.position.cols());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Index first = parts[k].first_point,
                count = (k + 1 < parts.size() ? parts[k + 1].first_point : all.cols()) - first;
    Frame own;
    own.time = frame.time;
    own.position = frame.position.middleCols(first, count);
    own.point_data = {{u->name, u->unit, u->value.middleCols(first, count)}};
    const auto bend = deformation(keys, own, parts[k].name);
    if (!bend) return std::nullopt;
    all.middleCols(first, count) = *bend;
  }
  return all;
}

Range shown_range(std::vector<double> values) {
  if (values.empty()) return {};
  const auto at = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<std::size_t>(k)];
  };
  Range range = {at(0.005), at(0.995)};
  if (range.lo > 0 && range.lo < 0.5 * range.hi) range.lo = 0;
  if (range.lo < 0 && range.hi > 0 && -range.lo < 0.05 * range.hi) range.lo = 0;
  if (range.lo < range.hi) return range;
  const double width = range.lo == 0 ? 1 : 0.5 * std::abs(range.lo);
  return {range.lo - (range.lo == 0 ? 0 : width), range.hi + width};
}

RunFrames find_frames(const std::filesystem::path& folder) {
  RunFrames run = {.folder = folder,
                   .keys = keys_of(folder),
                   .fluid = list_frames(folder, "fluid"),
                   .structure = list_frames(folder, "structure"),
                   .bodies = {},
                   .interface = nullptr};
  for (const std::string& body : bodies_of(run.keys))
    run.bodies.emplace_back(body, list_frames(folder, body));
  if (run.bodies.empty()) run.bodies.emplace_back("", run.structure);
  run.structure = run.bodies.front().second;
  if (run.fluid.empty() && run.structure.empty())
    throw Error(ExitCode::case_file, (folder / "frames").string(), "there is no frame to draw",
                "name the folder of a run that has written frames (output.every), e.g. runs/plate_entry");
  if (std::ranges::any_of(run.bodies, [](const auto& body) { return body.second.empty(); }))
    run.interface = record_of(folder);
  return run;
}

double lattice_spacing(const Frame& frame) {
  std::vector<double> way;
  for (Index i = 1; i < frame.position.cols(); ++i)
    way.push_back((frame.position.col(i) - frame.position.col(i - 1)).norm());
  if (way.empty()) return 0;
  const auto middle = way.begin() + static_cast<std::ptrdiff_t>(way.size() / 2);
  std::nth_element(way.begin(), middle, way.end());
  return *middle;
}

Scene read_scene(const RunFrames& run, const SceneOptions& options) {
  const auto& [folder, keys, fluid, structure, bodies, interface] = run;
  Scene scene;
  scene.title = at_or(keys, "title");
  if (scene.title.empty()) scene.title = folder.filename().string();
  scene.spacing = number(keys, "fluid.spacing", 0);
  scene.scale = options.scale;

  std::string known;
  Cut cut;
  if (const FrameFile* file = nearest(fluid, options.time)) {
    const Frame frame = read_frame(file->path);
    scene.time = frame.time;
    cut = middle_cut(keys, frame, scene.spacing);
    const bool has = options.field == "speed" || find(frame.point_data, options.field) != nullptr;
    take_water(frame, has ? options.field : "pressure", cut, scene);
    known = "speed, " + names(frame);
  }
  // The structure's frame of the fluid's time: both are written at the same windows.
  std::vector<double> shown;
  for (const auto& [body, frames] : bodies) {
    const FrameFile* file = nearest(frames, fluid.empty() ? options.time : scene.time);
    if (file == nullptr) {
      draw_interface(run, body, cut.solid ? std::optional(cut.at) : std::nullopt, scene);
      continue;
    }
    const Frame frame = read_frame(file->path);
    if (fluid.empty()) {
      scene.time = frame.time;
      cut = middle_cut(keys, frame, 0);
    }
    scene.solid_spacing = number(keys, table_of(body) + ".particle.spacing", scene.spacing);
    if (scene.solid_spacing == 0) scene.solid_spacing = lattice_spacing(frame);  // it followed the body
    if (at_or(keys, "coupling.interface") == "volume" && scene.spacing > 0)
      scene.solid_spacing = scene.spacing;
    const bool has = find(frame.point_data, options.field) != nullptr && options.field != "velocity";
    take_structure(frame, enlarged(frame, keys, options.scale, body), has ? options.field : "von_mises", cut,
                   scene, shown);
    for (const Points& line : attached_lines(keys, frame, body)) {
      scene.lines.emplace_back();
      for (Index k = 0; k < line.cols(); ++k) scene.lines.back().push_back({line(0, k), line(1, k)});
    }
    if (body == bodies.front().first) known += (known.empty() ? "" : "; of the structure: ") + names(frame);
  }
  if (scene.water_field.name != options.field && scene.solid_field.name != options.field &&
      !(scene.water_field.name.empty() && options.field == "pressure"))
    throw Error(ExitCode::command_line, "--field " + options.field, "no frame of this run has it",
                "one of: " + known);
  if (cut.solid) scene.cut = fmt::format("section z = {:.4g} m", cut.at);
  return scene;
}

}  // namespace strake::picture
