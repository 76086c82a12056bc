#include "proto/files/hdf5_file.hpp"

#include "proto/error.hpp"
#include "proto/files/hdf5_calls.hpp"
#include "proto/files/whole_file.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cstdlib>
#include <fstream>
#include <string_view>

namespace strake::hdf5 {
namespace {

Handle fixed_text(std::size_t length) {
  Handle type(made(H5Tcopy(H5T_C_S1)), H5Tclose);
  done(H5Tset_size(type.get(), std::max<std::size_t>(1, length)));
  done(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  done(H5Tset_cset(type.get(), H5T_CSET_UTF8));
  return type;
}

void put_attribute(hid_t file, const std::string& object, const std::string& name, hid_t file_type,
                   hid_t memory_type, const void* value) {
  const Handle owner(made(H5Oopen(file, object.c_str(), H5P_DEFAULT)), H5Oclose);
  const Handle space(made(H5Screate(H5S_SCALAR)), H5Sclose);
  const Handle attribute(
      made(H5Acreate2(owner.get(), name.c_str(), file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT)),
      H5Aclose);
  done(H5Awrite(attribute.get(), memory_type, value));
}

herr_t collect_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// Gives HDF5 the memory of a file. `image` follows it, and keeps it when HDF5 closes the file.
void* resize_image(void* bytes, std::size_t size, H5FD_file_image_op_t, void* image) {
  void* const moved = std::realloc(bytes, size);
  if (moved != nullptr) static_cast<Image*>(image)->bytes = moved;
  return moved;
}
herr_t keep_image(void*, H5FD_file_image_op_t, void*) {
  return 0;
}
void* same_image(void* image) {
  return image;
}
herr_t release_nothing(void*) {
  return 0;
}

std::recursive_mutex& session_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

}  // namespace

Session::Session() : alone_(session_mutex()) {
  // Suppresses HDF5's clean-up at exit, which would report objects that a damaged file left open. No data of
  // ours is lost: we never leave a write pending in HDF5.
  static const bool no_complaint_at_exit = H5dont_atexit() >= 0;
  static_cast<void>(no_complaint_at_exit);
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Session::~Session() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

Image::~Image() {
  std::free(bytes);
}

Writer::Writer(bool joins) : image_(std::make_unique<Image>()) {
  const Handle access(made(H5Pcreate(H5P_FILE_ACCESS)), H5Pclose);
  constexpr std::size_t growth = 1 << 18;  // bytes
  done(H5Pset_fapl_core(access.get(), growth, false));
  H5FD_file_image_callbacks_t memory{};
  memory.image_realloc = resize_image;
  memory.image_free = keep_image;
  memory.udata_copy = same_image;
  memory.udata_free = release_nothing;
  memory.udata = image_.get();
  done(H5Pset_file_image_callbacks(access.get(), &memory));
  if (joins) done(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110));
  // Else the file keeps the library's default (oldest) format, for readers of any age. It was also needed
  // once: with a newer format H5Fget_file_image (1.10.8) clears the superblock's "open" flag without renewing
  // the checksum, and the result cannot be opened. `save` asks it for the size alone.
  const Handle creation = without_times([] { return H5Pcreate(H5P_FILE_CREATE); });
  file_ =
      Handle(made(H5Fcreate("composed in memory", H5F_ACC_TRUNC, creation.get(), access.get())), H5Fclose);
}

void Writer::group(const std::string& path) {
  const Handle list = without_times([] { return H5Pcreate(H5P_GROUP_CREATE); });
  const Handle made_group(made(H5Gcreate2(file_.get(), path.c_str(), H5P_DEFAULT, list.get(), H5P_DEFAULT)),
                          H5Gclose);
}

void Writer::put(const std::string& path, hid_t file_type, hid_t memory_type, const void* data,
                 Eigen::Index rows, Eigen::Index columns) {
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(rows), static_cast<hsize_t>(columns)};
  const Handle space(made(H5Screate_simple(2, size.data(), nullptr)), H5Sclose);
  const Handle list = without_times([] { return H5Pcreate(H5P_DATASET_CREATE); });
  const Handle set(made(H5Dcreate2(file_.get(), path.c_str(), file_type, space.get(), H5P_DEFAULT, list.get(),
                                   H5P_DEFAULT)),
                   H5Dclose);
  if (rows * columns > 0) done(H5Dwrite(set.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
}

void Writer::dataset(const std::string& path, const double* data, Eigen::Index rows, Eigen::Index columns) {
  put(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, data, rows, columns);
}

void Writer::dataset(const std::string& path, const std::vector<std::int64_t>& data, Eigen::Index columns) {
  const Eigen::Index rows = columns > 0 ? static_cast<Eigen::Index>(data.size()) / columns : 0;
  assert(rows * columns == static_cast<Eigen::Index>(data.size()));
  put(path, H5T_STD_I64LE, H5T_NATIVE_INT64, data.data(), rows, columns);
}

void Writer::attribute(const std::string& object, const std::string& name, double value) {
  put_attribute(file_.get(), object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
  const Handle type = fixed_text(value.size());
  put_attribute(file_.get(), object, name, type.get(), type.get(), value.c_str());
}

void Writer::save(const std::filesystem::path& path, bool lasting) {
  done(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file_.get(), nullptr, 0);  // the memory has some room behind
  if (size < 0) done(-1);
  done(H5Fclose(file_.release()));  // it clears the flag "open for writing" in the bytes
  const std::string_view bytes(static_cast<const char*>(image_->bytes), static_cast<std::size_t>(size));
  if (lasting)
    write_lasting(path, bytes);
  else
    write_whole(path, bytes);
}

Reader::Reader(const std::filesystem::path& path, const std::string& format) : path_(path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse("no such file");
  if (!std::filesystem::is_regular_file(path, error)) refuse("is no file");
  if (!std::ifstream(path)) refuse("cannot be read");
  size_ = std::filesystem::file_size(path, error);
  if (error) refuse("cannot be read: " + error.message());
  file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file_.get() < 0) refuse("is no HDF5 file, or only part of one");
  if (H5Aexists_by_name(file_.get(), "/", "format", H5P_DEFAULT) <= 0 || text("format") != format)
    refuse(fmt::format("is HDF5, but no {}", format));
}

void Reader::refuse(const std::string& problem) const {
  throw Error(ExitCode::case_file, path_.string(), problem, "check the path, or make the file again");
}

std::vector<std::string> Reader::names(const std::string& group) const {
  std::vector<std::string> names;
  if (H5Lexists(file_.get(), group.c_str(), H5P_DEFAULT) <= 0) refuse("has no group " + group);
  const Handle opened(H5Gopen2(file_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
  if (opened.get() < 0 ||
      H5Literate(opened.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_name, &names) < 0)
    refuse("group " + group + " cannot be read");
  return names;
}

Handle Reader::dataset(const std::string& path, H5T_class_t wanted,
                       std::array<Eigen::Index, 2>& shape) const {
  Handle set(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (set.get() < 0) refuse("has no dataset " + path);
  const Handle type(H5Dget_type(set.get()), H5Tclose), space(H5Dget_space(set.get()), H5Sclose);
  if (type.get() < 0 || space.get() < 0) refuse("dataset " + path + " cannot be read");
  if (wanted != H5T_NO_CLASS && (H5Tget_class(type.get()) != wanted || H5Tget_size(type.get()) != 8))
    refuse(fmt::format("dataset {} does not hold {}", path, wanted == H5T_FLOAT ? "float64" : "int64"));
  if (H5Sget_simple_extent_ndims(space.get()) != 2)
    refuse("dataset " + path + " is not a table of rows and columns");
  std::array<hsize_t, 2> size{};
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  shape = {static_cast<Eigen::Index>(size[0]), static_cast<Eigen::Index>(size[1])};
  const Handle list(H5Dget_create_plist(set.get()), H5Pclose);
  const bool in_parts = H5Pget_layout(list.get()) == H5D_VIRTUAL;
  if (in_parts && path == parts_path) refuse("does not name its parts");
  if (in_parts && wanted == H5T_NO_CLASS) return set;
  // A file cannot have more numbers than bytes: a damaged count must not become an allocation.
  const std::uintmax_t most = (in_parts ? bytes_of_parts(list.get()) : size_) / 8;
  if (size[0] > most || size[1] > most || (size[1] > 0 && size[0] > most / size[1]))
    refuse("dataset " + path + " claims to be larger than the file");
  return set;
}

std::array<Eigen::Index, 2> Reader::shape(const std::string& path) const {
  std::array<Eigen::Index, 2> shape{};
  dataset(path, H5T_NO_CLASS, shape);
  return shape;
}

/// Reads a dataset, or ranges of it, into memory of that many rows and columns.
void Reader::read(const std::string& path, hid_t set, hid_t type, std::array<Eigen::Index, 2>& shape,
                  const Slice* slice,
                  const std::function<void*(Eigen::Index rows, Eigen::Index columns)>& allocate) const {
  const std::size_t axis = shape[1] == 1 ? 0 : 1;
  Slice whole{shape[axis], {{0, shape[axis]}}};
  if (slice == nullptr || slice->length != shape[axis]) slice = &whole;
  std::array<hsize_t, 2> size{static_cast<hsize_t>(shape[0]), static_cast<hsize_t>(shape[1])};
  size[axis] = 0;
  for (const auto& [first, last] : slice->ranges) {
    if (first < 0 || first > last || last > shape[axis]) refuse("dataset " + path + " has no such entries");
    size[axis] += static_cast<hsize_t>(last - first);
  }
  shape = {static_cast<Eigen::Index>(size[0]), static_cast<Eigen::Index>(size[1])};
  void* const values = allocate(shape[0], shape[1]);
  if (size[0] == 0 || size[1] == 0) return;
  const Handle in_file(H5Dget_space(set), H5Sclose),
      in_memory(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  std::array<hsize_t, 2> from{}, to{}, count = size;
  for (const auto& [first, last] : slice->ranges) {
    from[axis] = static_cast<hsize_t>(first);
    count[axis] = static_cast<hsize_t>(last - first);
    if (first == last) continue;
    if (H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr) < 0 ||
        H5Sselect_hyperslab(in_memory.get(), H5S_SELECT_SET, to.data(), nullptr, count.data(), nullptr) < 0 ||
        H5Dread(set, type, in_memory.get(), in_file.get(), H5P_DEFAULT, values) < 0)
      refuse("dataset " + path + " cannot be read");
    to[axis] += count[axis];
  }
}

RowMajor Reader::real(const std::string& path, const Slice* slice) const {
  std::array<Eigen::Index, 2> shape{};
  const Handle set = dataset(path, H5T_FLOAT, shape);
  RowMajor value;
  read(path, set.get(), H5T_NATIVE_DOUBLE, shape, slice, [&](Eigen::Index rows, Eigen::Index columns) {
    value.resize(rows, columns);
    return value.data();
  });
  return value;
}

std::vector<std::int64_t> Reader::integer(const std::string& path, const Slice* slice) const {
  std::array<Eigen::Index, 2> shape{};
  const Handle set = dataset(path, H5T_INTEGER, shape);
  std::vector<std::int64_t> value;
  read(path, set.get(), H5T_NATIVE_INT64, shape, slice, [&](Eigen::Index rows, Eigen::Index columns) {
    value.resize(static_cast<std::size_t>(rows * columns));
    return value.data();
  });
  return value;
}

double Reader::number(const std::string& name) const {
  const Handle attribute(H5Aopen(file_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle space(attribute.get() < 0 ? -1 : H5Aget_space(attribute.get()), H5Sclose);
  double value = 0;
  // HDF5 writes a double for each value of the attribute, however few bytes it has in the file.
  if (space.get() < 0 || H5Sget_simple_extent_npoints(space.get()) != 1 ||
      H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0)
    refuse("has no number " + name);
  return value;
}

std::string Reader::text(const std::string& name) const {
  return text(file_.get(), name);
}

std::optional<std::string> Reader::text_of(const std::string& object, const std::string& name) const {
  if (H5Aexists_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return {};
  const Handle owner(H5Oopen(file_.get(), object.c_str(), H5P_DEFAULT), H5Oclose);
  return text(owner.get(), name);
}

std::string Reader::text(hid_t object, const std::string& name) const {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.get() < 0 ? -1 : H5Aget_type(attribute.get()), H5Tclose);
  if (type.get() < 0 || H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0)
    refuse("has no text " + name);
  std::string value(H5Aget_storage_size(attribute.get()), '\0');
  if (value.empty() || value.size() > size_ || H5Aread(attribute.get(), type.get(), value.data()) < 0)
    refuse("has no text " + name);
  value.erase(value.find_last_not_of('\0') + 1);
  return value;
}

std::string link_name(const std::string& name) {
  std::string link;
  for (const char c : name) {
    if (c == '/' || c == '%' || c == '\0' || (c == '.' && link.empty()))
      link += fmt::format("%{:02X}", static_cast<unsigned>(c));
    else
      link += c;
  }
  return link;
}

std::string from_link_name(const std::string& link) {
  std::string name;
  for (std::size_t i = 0; i < link.size(); ++i) {
    if (link[i] == '%' && i + 2 < link.size() && std::isxdigit(static_cast<unsigned char>(link[i + 1])) &&
        std::isxdigit(static_cast<unsigned char>(link[i + 2]))) {
      name += static_cast<char>(std::stoi(link.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      name += link[i];
    }
  }
  return name;
}

}  // namespace strake::hdf5
