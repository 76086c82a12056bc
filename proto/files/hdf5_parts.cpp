#include "proto/error.hpp"
#include "proto/files/hdf5_calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

// Datasets that lie in several files: HDF5's virtual datasets.

namespace strake::hdf5 {

void Writer::parts(std::vector<FilePart> all) {
  std::erase_if(all, [](const FilePart& part) { return part.length == 0; });
  parts_ = std::move(all);
  std::vector<std::int64_t> bytes;
  for (const FilePart& part : parts_) bytes.push_back(part.bytes);
  dataset(parts_path, bytes);
}

void Writer::joined_rows(const std::string& path, H5T_class_t type, Eigen::Index width) {
  join(path, type, 0, width);
}

void Writer::joined_columns(const std::string& path, H5T_class_t type, Eigen::Index width) {
  join(path, type, 1, width);
}

void Writer::join(const std::string& path, H5T_class_t numbers, std::size_t axis, Eigen::Index width) {
  const bool real = numbers == H5T_FLOAT;
  const hid_t type = real ? H5T_IEEE_F64LE : H5T_STD_I64LE;
  std::array<hsize_t, 2> size{}, at{}, part_size{};
  size[1 - axis] = part_size[1 - axis] = static_cast<hsize_t>(width);
  for (const FilePart& part : parts_) size[axis] += static_cast<hsize_t>(part.length);
  const Handle list = without_times([] { return H5Pcreate(H5P_DATASET_CREATE); }),
               space(made(H5Screate_simple(2, size.data(), nullptr)), H5Sclose);
  const double no_number = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t no_integer = -1;
  done(real ? H5Pset_fill_value(list.get(), H5T_NATIVE_DOUBLE, &no_number)
            : H5Pset_fill_value(list.get(), H5T_NATIVE_INT64, &no_integer));
  for (const FilePart& part : parts_) {
    part_size[axis] = static_cast<hsize_t>(part.length);
    const Handle own(made(H5Screate_simple(2, part_size.data(), nullptr)), H5Sclose);
    done(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, at.data(), nullptr, part_size.data(), nullptr));
    done(H5Pset_virtual(list.get(), space.get(), part.file.c_str(), path.c_str(), own.get()));
    at[axis] += part_size[axis];
  }
  done(H5Sselect_all(space.get()));
  const Handle set(
      made(H5Dcreate2(file_.get(), path.c_str(), type, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT)),
      H5Dclose);
}

/// Returns the bytes of all parts of a dataset. HDF5 itself would say nothing where a part is not there.
std::uintmax_t Reader::bytes_of_parts(hid_t list) const {
  std::size_t count = 0;
  if (H5Pget_virtual_count(list, &count) < 0) refuse("does not name its parts");
  const std::vector<std::int64_t> bytes = integer(parts_path);
  if (bytes.size() != count) refuse("does not name all its parts");
  std::uintmax_t sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const ssize_t length = H5Pget_virtual_filename(list, k, nullptr, 0);
    std::string name(static_cast<std::size_t>(std::max<ssize_t>(length, 0)) + 1, '\0');
    if (H5Pget_virtual_filename(list, k, name.data(), name.size()) < 0) refuse("does not name its parts");
    name.pop_back();
    const auto size = static_cast<std::uintmax_t>(std::max<std::int64_t>(bytes[k], 0));
    if (checked_.insert(name).second) check_part(path_.parent_path() / name, size);
    sum += size;
  }
  return sum;
}

void Reader::check_part(const std::filesystem::path& part, std::uintmax_t bytes) const {
  const auto refuse_part = [&](const std::string& problem) {
    throw Error(ExitCode::case_file, path_.string(), fmt::format("its part {} {}", part.string(), problem),
                "a run on several ranks writes parts beside the file: copy them with it, or make it again");
  };
  std::error_code error;
  const std::uintmax_t found = std::filesystem::file_size(part, error);
  if (error) refuse_part(std::filesystem::exists(part, error) ? "cannot be read" : "is missing");
  if (found != bytes) refuse_part(fmt::format("has {} bytes, not {}", found, bytes));
  const Handle opened(H5Fopen(part.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (opened.get() < 0) refuse_part("is damaged, or cannot be read");
}

}  // namespace strake::hdf5
