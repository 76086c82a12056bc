#include "coupler/watch/web/field_view.hpp"

#include "coupler/plot/scene.hpp"
#include "proto/error.hpp"
#include "proto/files/frame_file.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

namespace strake::watch {
namespace {

using Eigen::Index;
using Corner = std::uint32_t;

bool is_label(const std::string& name) {
  return name == "id" || name == "kind";
}

/// Faces of a cell in space, each walked round.
std::vector<std::vector<Corner>> faces_of(const std::vector<Corner>& c) {
  if (c.size() == 8)
    return {{c[0], c[1], c[2], c[3]}, {c[4], c[5], c[6], c[7]}, {c[0], c[1], c[5], c[4]},
            {c[1], c[2], c[6], c[5]}, {c[2], c[3], c[7], c[6]}, {c[3], c[0], c[4], c[7]}};
  if (c.size() == 4) return {{c[0], c[1], c[2]}, {c[0], c[1], c[3]}, {c[1], c[2], c[3]}, {c[0], c[2], c[3]}};
  return {c};
}

class SurfaceBuilder {
 public:
  void add(const std::vector<Corner>& face) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<Corner, 3> triangle = {face[0], face[k - 1], face[k]};
      surface.triangle.insert(surface.triangle.end(), triangle.begin(), triangle.end());
    }
    const std::size_t n = face.size() == 2 ? 1 : face.size();
    for (std::size_t k = 0; k < n; ++k) {
      const Corner a = face[k], b = face[(k + 1) % face.size()];
      if (!seen_.insert({std::min(a, b), std::max(a, b)}).second) continue;
      surface.edge.push_back(a);
      surface.edge.push_back(b);
    }
  }
  Surface surface;

 private:
  std::set<std::pair<Corner, Corner>> seen_;
};

std::vector<float> flat(const Points& points, const std::vector<std::uint32_t>& index) {
  std::vector<float> all;
  all.reserve(3 * index.size());
  for (const std::uint32_t i : index)
    for (int k = 0; k < 3; ++k) all.push_back(static_cast<float>(points(k, i)));
  return all;
}

Json range_json(const picture::Range& range) {
  return range.empty() ? Json() : Json{range.lo, range.hi};
}

Json field_names(const Frame& frame) {
  Json names = Json::array();
  for (const Frame::Array& array : frame.point_data) {
    // One number, or the length of a vector; that of a tensor has no meaning.
    if (is_label(array.name) || (array.value.rows() != 1 && array.value.rows() != 3)) continue;
    // A velocity is shown by its length, which has a name of its own.
    names.push_back({{"name", array.name == "velocity" ? "speed" : array.name}, {"unit", array.unit}});
  }
  return names;
}

void add_bounds(const std::vector<float>& position, ArrayMessage& message) {
  if (position.empty()) return;
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < position.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], position[i]);
    high[i % 3] = std::max(high[i % 3], position[i]);
  }
  message.head["low"] = low;
  message.head["high"] = high;
}

/// Name, first point and box of each of several bodies. Points that are nowhere do not count.
Json bodies_json(const Frame& frame, const std::vector<MeshPart>& parts) {
  Json bodies = Json::array();
  for (std::size_t b = 0; b < parts.size(); ++b) {
    const Index first = parts[b].first_point;
    const Index end = b + 1 < parts.size() ? parts[b + 1].first_point : frame.position.cols();
    Eigen::AlignedBox3d box;
    for (Index i = first; i < end; ++i)
      if (frame.position.col(i).allFinite()) box.extend(Eigen::Vector3d(frame.position.col(i)));
    Json body = {{"name", parts[b].name}, {"first", first}};
    if (!box.isEmpty()) {
      body["low"] = std::vector<double>(box.min().begin(), box.min().end());
      body["high"] = std::vector<double>(box.max().begin(), box.max().end());
    }
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace

Surface surface_of(const Eigen::MatrixXi& cells, int dimension) {
  SurfaceBuilder builder;
  std::map<std::vector<Corner>, std::pair<int, std::vector<Corner>>>
      faces;  // sorted corners → how many cells, corners
  for (Index c = 0; c < cells.cols(); ++c) {
    std::vector<Corner> corners;
    for (Index k = 0; k < cells.rows(); ++k) corners.push_back(static_cast<Corner>(cells(k, c)));
    if (dimension == 2 || corners.size() < 4) {
      builder.add(corners);
      continue;
    }
    for (std::vector<Corner>& face : faces_of(corners)) {
      std::vector<Corner> sorted = face;
      std::sort(sorted.begin(), sorted.end());
      auto& [count, walked] = faces[std::move(sorted)];
      ++count;
      walked = std::move(face);
    }
  }
  for (const auto& [sorted, face] : faces)
    if (face.first == 1) builder.add(face.second);
  return std::move(builder.surface);
}

ArrayMessage field_message(const Frame& frame, const FieldRequest& request) {
  ArrayMessage message;
  picture::Quantity quantity;
  std::optional<Eigen::VectorXd> value;
  if (!request.field.empty()) value = picture::scalar(frame, request.field, quantity);

  const bool fluid = request.side == "fluid";
  const Frame::Array* kinds = fluid ? find(frame.point_data, "kind") : nullptr;
  const bool cells = frame.cells.cols() > 0;
  std::vector<std::uint32_t> index;
  std::vector<std::uint8_t> kind;
  std::vector<double> of_field;  // what the range is taken of
  for (Index i = 0; i < frame.position.cols(); ++i) {
    const double what = kinds == nullptr ? 0 : kinds->value(0, i);
    // Interface and structure particles are drawn from the structure's frames. The corners of cells all stay.
    if (!cells && (!frame.position.col(i).allFinite() || (what != 0 && what != 1))) continue;
    index.push_back(static_cast<std::uint32_t>(i));
    kind.push_back(static_cast<std::uint8_t>(what));
    if (value && what == 0 && std::isfinite((*value)(i))) of_field.push_back((*value)(i));
  }
  message.head["side"] = request.side;
  message.head["time"] = frame.time;
  message.head["fields"] = field_names(frame);
  const std::vector<float> position = flat(frame.position, index);
  add_bounds(position, message);
  message.add("position", position);
  message.add("index", index);
  if (fluid) message.add("kind", kind);
  if (value) {
    for (const double v : of_field) quantity.all.add(v);
    quantity.shown = picture::shown_range(std::move(of_field));
    message.head["field"] = {{"name", quantity.name},
                             {"unit", quantity.unit},
                             {"shown", range_json(quantity.shown)},
                             {"all", range_json(quantity.all)}};
    std::vector<float> shown;
    for (const std::uint32_t i : index) shown.push_back(static_cast<float>((*value)(i)));
    message.add("value", shown);
  }
  if (fluid) return message;
  message.head["bodies"] = bodies_json(frame, request.parts);
  if (const auto bend = picture::deformation(request.keys, frame, request.parts))
    message.add("bend", flat(*bend, index));
  if (!cells) return message;
  const Surface surface = surface_of(frame.cells, request.dimension);
  message.add("triangle", surface.triangle);
  message.add("edge", surface.edge);
  return message;
}

Json point_values(const Frame& frame, Index index) {
  if (index < 0 || index >= frame.position.cols())
    throw Error(ExitCode::command_line, fmt::format("point {}", index),
                "there is no such point in this frame",
                fmt::format("points are numbered from 0 to {}", frame.position.cols() - 1));
  Json values = {{"time", frame.time}, {"values", Json::array()}};
  const auto add = [&](const std::string& name, const std::string& unit, const auto& column) {
    Json numbers = Json::array();
    for (const double v : column) numbers.push_back(finite(v));
    values["values"].push_back({{"name", name}, {"unit", unit}, {"value", std::move(numbers)}});
  };
  add("position", "m", Eigen::VectorXd(frame.position.col(index)));
  for (const Frame::Array& array : frame.point_data)
    add(array.name, array.unit, Eigen::VectorXd(array.value.col(index)));
  return values;
}

Index place_of(const Frame& frame, std::int64_t id) {
  if (const Frame::Array* ids = find(frame.point_data, "id"))
    for (Index i = 0; i < ids->value.cols(); ++i)
      if (ids->value(0, i) == static_cast<double>(id)) return i;
  throw Error(ExitCode::case_file, fmt::format("point with id {}", id), "is not in this frame");
}

namespace {

static_assert(std::endian::native == std::endian::little, "arrays go out as they lie in memory");

std::size_t padded(std::size_t bytes) {
  return (bytes + 7) / 8 * 8;
}

}  // namespace

void ArrayMessage::add(const std::string& name, const char* type, const void* data, std::size_t count,
                       std::size_t size) {
  arrays_.push_back({name, type, count, data_.size()});
  data_.append(static_cast<const char*>(data), count * size);
  data_.resize(padded(data_.size()), '\0');
}

void ArrayMessage::add(const std::string& name, std::span<const float> a) {
  add(name, "f32", a.data(), a.size(), sizeof(float));
}
void ArrayMessage::add(const std::string& name, std::span<const double> a) {
  add(name, "f64", a.data(), a.size(), sizeof(double));
}
void ArrayMessage::add(const std::string& name, std::span<const std::uint32_t> a) {
  add(name, "u32", a.data(), a.size(), sizeof(std::uint32_t));
}
void ArrayMessage::add(const std::string& name, std::span<const std::uint8_t> a) {
  add(name, "u8", a.data(), a.size(), sizeof(std::uint8_t));
}

std::string ArrayMessage::bytes() const {
  constexpr std::size_t length_bytes = 4;
  // The offsets stand in the head, whose length shifts them: it is made longer until it fits.
  std::string text;
  std::size_t first = 0;
  do {
    first = padded(std::max(first + 8, text.size() + length_bytes));
    Json json = head;
    json["arrays"] = Json::object();
    for (const Array& array : arrays_)
      json["arrays"][array.name] = {{"type", array.type}, {"at", first + array.at}, {"count", array.count}};
    text = json_text(json);
  } while (text.size() + length_bytes > first);
  text.resize(first - length_bytes, ' ');
  const auto n = static_cast<std::uint32_t>(text.size());
  std::string all(reinterpret_cast<const char*>(&n), length_bytes);
  return all + text + data_;
}

}  // namespace strake::watch
