#include "proto/files/result_file.hpp"

#include "proto/files/hdf5_file.hpp"
#include "proto/files/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace strake {
namespace {

const std::string archive_format = "strake archive 1", part_format = "strake part of a frame 1";

/// Adds a third component of zeros to two.
Eigen::MatrixXd padded(const Eigen::MatrixXd& two) {
  Eigen::MatrixXd three = Eigen::MatrixXd::Zero(3, two.cols());
  three.topRows(2) = two;
  return three;
}

void put_arrays(hdf5::Writer& file, const std::string& group, const std::vector<Frame::Array>& arrays,
                Eigen::Index n, std::vector<std::pair<std::string, int>>& listed) {
  file.group(group);
  for (const Frame::Array& array : arrays) {
    assert(array.value.cols() == n);
    static_cast<void>(n);
    const std::string path = group + "/" + hdf5::link_name(array.name);
    // components×n, columns one after the other: n×components
    const auto put = [&](const Eigen::MatrixXd& value) {
      file.dataset(path, value.data(), value.cols(), value.rows());
      listed.emplace_back(array.name, static_cast<int>(value.rows()));
    };
    array.value.rows() == 2 ? put(padded(array.value)) : put(array.value);  // ParaView draws no arrows of two
    file.attribute(path, "unit", array.unit);
  }
  std::sort(listed.begin(), listed.end());  // as a folder of frames lists them again on resume
}

/// The nodes of a frame's cells one after the other; without cells, each point.
std::vector<std::int64_t> cells_of(const Frame& frame, long long count) {
  std::vector<std::int64_t> cells(static_cast<std::size_t>(count));
  if (frame.cells.size() == 0)
    std::iota(cells.begin(), cells.end(), 0);
  else
    std::copy_n(frame.cells.data(), cells.size(), cells.begin());
  return cells;
}

/// Lists the arrays in `point_data` and `cell_data`.
void put_frame(hdf5::Writer& file, const Frame& frame, const std::string& format,
               const std::vector<std::int64_t>& cells, int nodes_per_cell,
               std::vector<std::pair<std::string, int>>& point_data,
               std::vector<std::pair<std::string, int>>& cell_data) {
  file.attribute("/", "format", format);
  file.attribute("/", "time", frame.time);
  file.dataset("/position", frame.position.data(), frame.position.cols(), 3);
  file.attribute("/position", "unit", std::string("m"));
  file.dataset("/cells", cells, nodes_per_cell);
  put_arrays(file, "/point", frame.point_data, frame.position.cols(), point_data);
  put_arrays(file, "/cell", frame.cell_data, std::ssize(cells) / nodes_per_cell, cell_data);
}

std::string xml_text(const std::string& text) {
  static const std::map<char, const char*> escapes = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string escaped;
  for (const char c : text) escaped += escapes.contains(c) ? escapes.at(c) : std::string(1, c);
  return escaped;
}

std::string attribute_type(int components) {
  static const std::map<int, std::string> types = {
      {1, "Scalar"}, {3, "Vector"}, {6, "Tensor6"}, {9, "Tensor"}};
  return types.contains(components) ? types.at(components) : "Matrix";
}

/// Kinds of cells by the number of their nodes; those of four depend on the dimension.
const std::map<std::int64_t, std::string> topologies = {{1, "Polyvertex\" NodesPerElement=\"1"},
                                                        {2, "Polyline\" NodesPerElement=\"2"},
                                                        {3, "Triangle"},
                                                        {4, "Tetrahedron"},
                                                        {8, "Hexahedron"}};

std::string topology(int nodes_per_cell, int dimension) {
  return nodes_per_cell == 4 && dimension == 2 ? "Quadrilateral" : topologies.at(nodes_per_cell);
}

std::string attributes(const std::vector<std::pair<std::string, int>>& arrays, const std::string& center,
                       long long n, const std::string& file) {
  std::string text;
  for (const auto& [name, components] : arrays)
    text += fmt::format(
        "        <Attribute Name=\"{0}\" Center=\"{1}\" AttributeType=\"{2}\">\n"
        "          <DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{3} {4}\">"
        "{5}:/{6}/{7}</DataItem>\n"
        "        </Attribute>\n",
        xml_text(name), center, attribute_type(components), n, components, xml_text(file),
        center == "Node" ? "point" : "cell", xml_text(hdf5::link_name(name)));
  return text;
}

}  // namespace

FilePart part_of(const std::filesystem::path& path, std::int64_t length,
                 const std::filesystem::path& folder) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) throw cannot_write(path, error.value());
  return {path.lexically_relative(folder).string(), length, static_cast<std::int64_t>(bytes)};
}

namespace {

void put_real(hdf5::Writer& file, const ArchiveSource& archive, const ArchiveUnits& unit = {}) {
  for (const auto& [name, make] : archive.real) {
    const hdf5::RowMajor rows = make();
    const std::string place = "/real/" + hdf5::link_name(name);
    file.dataset(place, rows.data(), rows.rows(), rows.cols());
    if (const auto own = unit.find(name); own != unit.end()) file.attribute(place, "unit", own->second);
  }
}

void put_integer(hdf5::Writer& file, const ArchiveSource& archive) {
  for (const auto& [name, make] : archive.integer) file.dataset("/integer/" + hdf5::link_name(name), make());
}

}  // namespace

void write_archive(const std::filesystem::path& path, const ArchiveSource& archive, const ArchiveUnits& unit,
                   bool lasting) {
  hdf5::Writer file;
  file.attribute("/", "format", archive_format);
  file.group("/real");
  put_real(file, archive, unit);
  file.group("/integer");
  put_integer(file, archive);
  file.save(path, lasting);
}

void write_archive(const std::filesystem::path& path, const Archive& archive, const ArchiveUnits& unit,
                   bool lasting) {
  write_archive(path, source_of(archive), unit, lasting);
}

ArchiveSource source_of(const Archive& archive) {
  ArchiveSource source;
  for (const auto& [name, value] : archive.real) source.real[name] = [&value = value] { return value; };
  for (const auto& [name, value] : archive.integer) source.integer[name] = [&value = value] { return value; };
  return source;
}

void join_archive(const std::filesystem::path& path, const ArchiveSource& own,
                  const std::vector<FilePart>& parts) {
  hdf5::Writer file(true);
  file.attribute("/", "format", archive_format);
  file.parts(parts);
  const hdf5::Reader first(path.parent_path() / parts.front().file, archive_format);
  const auto join = [&](const std::string& group, H5T_class_t type) {
    file.group(group);
    for (const std::string& link : first.names(group)) {
      const std::string place = std::string(group).append("/").append(link);
      const auto shape = first.shape(place);
      shape[1] == 1 ? file.joined_rows(place, type, 1) : file.joined_columns(place, type, shape[0]);
    }
  };
  join("/real", H5T_FLOAT);
  put_real(file, own);
  join("/integer", H5T_INTEGER);
  put_integer(file, own);
  file.save(path);
}

namespace {

Archive read_values(const hdf5::Reader& file, const ArchiveSlice& slice) {
  const hdf5::Slice entries{slice.length, {slice.ranges.begin(), slice.ranges.end()}};
  const auto of = [&](const std::string& name) {
    return std::ranges::find(slice.names, name) == slice.names.end() ? nullptr : &entries;
  };
  Archive archive;
  for (const std::string& link : file.names("/real")) {
    const std::string name = hdf5::from_link_name(link);
    archive.real[name] = file.real("/real/" + link, of(name));
  }
  for (const std::string& link : file.names("/integer")) {
    const std::string name = hdf5::from_link_name(link);
    archive.integer[name] = file.integer("/integer/" + link, of(name));
  }
  return archive;
}

}  // namespace

Archive read_archive(const std::filesystem::path& path) {
  return read_archive(path, ArchiveSlice{});
}

Archive read_archive(const std::filesystem::path& path, const ArchiveSlice& slice) {
  return read_values(hdf5::Reader(path, archive_format), slice);
}

std::array<std::int64_t, 2> shape_in_archive(const std::filesystem::path& path, const std::string& name) {
  const auto shape = hdf5::Reader(path, archive_format).shape("/real/" + hdf5::link_name(name));
  return {shape[0], shape[1]};
}

ArchiveUnits read_archive_units(const std::filesystem::path& path) {
  const hdf5::Reader file(path, archive_format);
  ArchiveUnits unit;
  for (const std::string& link : file.names("/real"))
    if (const auto text = file.text_of("/real/" + link, "unit")) unit[hdf5::from_link_name(link)] = *text;
  return unit;
}

FrameSeries::FrameSeries(std::filesystem::path run_folder, std::string name, int dimension)
    : run_folder_(std::move(run_folder)), name_(std::move(name)), dimension_(dimension) {
  std::error_code error;
  std::filesystem::create_directories(run_folder_ / "frames", error);
  if (error) throw cannot_write(run_folder_ / "frames", error.value());
}

std::string FrameSeries::file_of(int number) const {
  return fmt::format("frames/{}-{:06}", name_, number);
}

void FrameSeries::write(const Frame& frame) {
  const bool vertices = frame.cells.size() == 0;
  Entry entry;
  entry.time = frame.time;
  entry.file = file_of(next_) + ".h5";
  entry.n_points = frame.position.cols();
  entry.n_cells = vertices ? entry.n_points : frame.cells.cols();
  entry.nodes_per_cell = vertices ? 1 : static_cast<int>(frame.cells.rows());

  hdf5::Writer file;
  put_frame(file, frame, hdf5::frame_format, cells_of(frame, entry.n_cells * entry.nodes_per_cell),
            entry.nodes_per_cell, entry.point_data, entry.cell_data);
  file.save(run_folder_ / entry.file);
  entries_.push_back(entry);
  ++next_;
  write_xdmf();
}

FilePart FrameSeries::write_part(const Frame& own, int number, int part, std::int64_t before) const {
  assert(own.cells.size() == 0);
  const std::string folder = file_of(number), file_name = fmt::format("{:04}.h5", part);
  std::error_code error;
  std::filesystem::create_directories(run_folder_ / folder, error);
  if (error) throw cannot_write(run_folder_ / folder, error.value());
  std::vector<std::int64_t> points(static_cast<std::size_t>(own.position.cols()));
  std::iota(points.begin(), points.end(), before);
  std::vector<std::pair<std::string, int>> listed, none;
  hdf5::Writer file;
  put_frame(file, own, part_format, points, 1, listed, none);
  const std::filesystem::path path = run_folder_ / folder / file_name;
  file.save(path);
  return part_of(path, own.position.cols(), run_folder_ / "frames");
}

void FrameSeries::forget_parts(int number) const {
  std::error_code ignored;
  if (std::filesystem::exists(run_folder_ / (file_of(number) + ".h5"), ignored)) return;
  std::filesystem::remove_all(run_folder_ / file_of(number), ignored);
}

/// The first part tells the names, the units and the numbers of components, which all parts share.
void FrameSeries::join(double time, const std::vector<FilePart>& parts) {
  const std::string name = file_of(next_) + ".h5";
  const hdf5::Reader first(run_folder_ / "frames" / parts.front().file, part_format);
  hdf5::Writer file(true);
  file.attribute("/", "format", hdf5::frame_format);
  file.attribute("/", "time", time);
  file.parts(parts);
  const auto join = [&](const std::string& path, H5T_class_t type) {
    file.joined_rows(path, type, first.shape(path)[1]);
    if (const auto unit = first.text_of(path, "unit")) file.attribute(path, "unit", *unit);
  };
  join("/position", H5T_FLOAT);
  join("/cells", H5T_INTEGER);
  file.group("/point");
  for (const std::string& link : first.names("/point")) join("/point/" + link, H5T_FLOAT);
  file.group("/cell");
  file.save(run_folder_ / name);
  if (auto entry = entry_of(run_folder_ / name)) entries_.push_back(std::move(*entry));
  ++next_;
  write_xdmf();
}

void FrameSeries::truncate(double time) {
  entries_.clear();
  next_ = 0;
  std::vector<std::filesystem::path> files, parts;
  for (const auto& item : std::filesystem::directory_iterator(run_folder_ / "frames"))
    if (item.path().filename().string().starts_with(name_ + "-")) files.push_back(item.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& path : files) {
    const std::string number = path.stem().string().substr(name_.size() + 1);
    const bool is_numbered =
        number.size() == 6 && number.find_first_not_of("0123456789") == std::string::npos;
    if (is_numbered && path.extension().empty()) parts.push_back(path);
    if (!is_numbered || path.extension() != ".h5") continue;
    // A frame that a power cut damaged is not listed; a resumed run does not need it.
    const std::optional<Entry> entry = entry_of(path);
    if (!entry) continue;
    if (entry->time > time) {
      std::filesystem::remove(path);
      continue;
    }
    entries_.push_back(*entry);
    next_ = std::stoi(number) + 1;
  }
  for (const std::filesystem::path& folder : parts)
    if (!std::filesystem::exists(folder.string() + ".h5")) std::filesystem::remove_all(folder);
  write_xdmf();
}

std::optional<FrameSeries::Entry> FrameSeries::entry_of(const std::filesystem::path& path) try {
  const hdf5::Reader file(path, hdf5::frame_format);
  Entry entry;
  entry.time = file.number("time");
  entry.file = "frames/" + path.filename().string();
  entry.n_points = file.shape("/position")[0];
  const auto cells = file.shape("/cells");
  if (!std::isfinite(entry.time) || !topologies.contains(cells[1])) return std::nullopt;
  entry.n_cells = cells[0];
  entry.nodes_per_cell = static_cast<int>(cells[1]);
  for (const std::string& link : file.names("/point"))
    entry.point_data.emplace_back(hdf5::from_link_name(link),
                                  static_cast<int>(file.shape("/point/" + link)[1]));
  for (const std::string& link : file.names("/cell"))
    entry.cell_data.emplace_back(hdf5::from_link_name(link),
                                 static_cast<int>(file.shape("/cell/" + link)[1]));
  return entry;
} catch (const Error&) {
  return std::nullopt;
}

void FrameSeries::write_xdmf() const {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
      xml_text(name_));
  for (const Entry& entry : entries_) {
    text += fmt::format(
        "      <Grid Name=\"{0}\" GridType=\"Uniform\">\n"
        "        <Time Value=\"{1}\"/>\n"
        "        <Topology TopologyType=\"{2}\" NumberOfElements=\"{3}\">\n"
        "          <DataItem Format=\"HDF\" NumberType=\"Int\" Precision=\"8\" Dimensions=\"{3} {4}\">"
        "{5}:/cells</DataItem>\n"
        "        </Topology>\n"
        "        <Geometry GeometryType=\"XYZ\">\n"
        "          <DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{6} 3\">"
        "{5}:/position</DataItem>\n"
        "        </Geometry>\n",
        xml_text(name_), entry.time, topology(entry.nodes_per_cell, dimension_), entry.n_cells,
        entry.nodes_per_cell, xml_text(entry.file), entry.n_points);
    text += attributes(entry.point_data, "Node", entry.n_points, entry.file);
    text += attributes(entry.cell_data, "Cell", entry.n_cells, entry.file);
    text += "      </Grid>\n";
  }
  text += "    </Grid>\n  </Domain>\n</Xdmf>\n";
  write_whole(run_folder_ / (name_ + ".xdmf"), text);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_lasting(path, text);
}

}  // namespace strake
