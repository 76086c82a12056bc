#include "proto/files/result_file.hpp"

#include "proto/files/hdf5_file.hpp"
#include "proto/files/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace strake {
namespace {

const std::string archive_format = "strake archive 1";

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

std::string topology(int nodes_per_cell, int dimension) {
  static const std::map<int, std::string> cells = {{1, "Polyvertex\" NodesPerElement=\"1"},
                                                   {2, "Polyline\" NodesPerElement=\"2"},
                                                   {3, "Triangle"},
                                                   {8, "Hexahedron"}};
  if (nodes_per_cell == 4) return dimension == 2 ? "Quadrilateral" : "Tetrahedron";
  return cells.at(nodes_per_cell);
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

void write_archive(const std::filesystem::path& path, const ArchiveSource& archive, const ArchiveUnits& unit,
                   bool lasting) {
  hdf5::Writer file;
  file.attribute("/", "format", archive_format);
  file.group("/real");
  for (const auto& [name, make] : archive.real) {
    const hdf5::RowMajor rows = make();
    const std::string place = "/real/" + hdf5::link_name(name);
    file.dataset(place, rows.data(), rows.rows(), rows.cols());
    if (const auto own = unit.find(name); own != unit.end()) file.attribute(place, "unit", own->second);
  }
  file.group("/integer");
  for (const auto& [name, make] : archive.integer) file.dataset("/integer/" + hdf5::link_name(name), make());
  file.save(path, lasting);
}

void write_archive(const std::filesystem::path& path, const Archive& archive, const ArchiveUnits& unit,
                   bool lasting) {
  write_archive(path, source_of(archive), unit, lasting);
}

ArchiveSource source_of(const Archive& archive) {
  ArchiveSource source;
  for (const auto& [name, value] : archive.real) source.real[name] = [&value] { return value; };
  for (const auto& [name, value] : archive.integer) source.integer[name] = [&value] { return value; };
  return source;
}

Archive read_archive(const std::filesystem::path& path) {
  const hdf5::Reader file(path, archive_format);
  Archive archive;
  for (const std::string& link : file.names("/real"))
    archive.real[hdf5::from_link_name(link)] = file.real("/real/" + link);
  for (const std::string& link : file.names("/integer"))
    archive.integer[hdf5::from_link_name(link)] = file.integer("/integer/" + link);
  return archive;
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

void FrameSeries::write(const Frame& frame) {
  const bool vertices = frame.cells.size() == 0;
  Entry entry;
  entry.time = frame.time;
  entry.file = fmt::format("frames/{}-{:06}.h5", name_, next_);
  entry.n_points = frame.position.cols();
  entry.n_cells = vertices ? entry.n_points : frame.cells.cols();
  entry.nodes_per_cell = vertices ? 1 : static_cast<int>(frame.cells.rows());

  hdf5::Writer file;
  file.attribute("/", "format", hdf5::frame_format);
  file.attribute("/", "time", frame.time);
  file.dataset("/position", frame.position.data(), frame.position.cols(), 3);
  file.attribute("/position", "unit", std::string("m"));
  file.dataset("/cells", cells_of(frame, entry.n_cells * entry.nodes_per_cell), entry.nodes_per_cell);
  put_arrays(file, "/point", frame.point_data, frame.position.cols(), entry.point_data);
  put_arrays(file, "/cell", frame.cell_data, entry.n_cells, entry.cell_data);
  file.save(run_folder_ / entry.file);
  entries_.push_back(entry);
  ++next_;
  write_xdmf();
}

void FrameSeries::truncate(double time) {
  entries_.clear();
  next_ = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& item : std::filesystem::directory_iterator(run_folder_ / "frames"))
    if (item.path().filename().string().starts_with(name_ + "-")) files.push_back(item.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& path : files) {
    const std::string number = path.stem().string().substr(name_.size() + 1);
    const bool is_frame = path.extension() == ".h5" && number.size() == 6 &&
                          number.find_first_not_of("0123456789") == std::string::npos;
    if (!is_frame) continue;
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
  write_xdmf();
}

std::optional<FrameSeries::Entry> FrameSeries::entry_of(const std::filesystem::path& path) try {
  const hdf5::Reader file(path, hdf5::frame_format);
  Entry entry;
  entry.time = file.number("time");
  entry.file = "frames/" + path.filename().string();
  entry.n_points = file.shape("/position")[0];
  const auto cells = file.shape("/cells");
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
