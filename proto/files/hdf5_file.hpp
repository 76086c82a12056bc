#pragma once
// Private to proto/: the little of HDF5's C API that results need, with handles that close themselves.

#include "proto/files/file_part.hpp"

#include <Eigen/Core>
#include <hdf5.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace strake::hdf5 {

/// What the attribute "format" of a frame says.
inline const std::string frame_format = "strake frame 1";

using Close = herr_t (*)(hid_t);

/// Owns one HDF5 identifier.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  hid_t get() const { return id_; }
  hid_t release() { return std::exchange(id_, -1); }  // for whom closes it himself

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// While it lives, only this thread may use HDF5, as the library requires. HDF5 prints nothing meanwhile.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::lock_guard<std::recursive_mutex> alone_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Memory in which HDF5 composes a file.
struct Image {
  void* bytes = nullptr;
  Image() = default;
  ~Image();
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
};

/// Entries [first, last) of a dataset that has `length` of them, in columns or, with one column, in rows.
/// Those of several ranges are read one behind the other. A dataset of another length is read as a whole.
struct Slice {
  Eigen::Index length = 0;
  std::vector<std::array<Eigen::Index, 2>> ranges;
};

/// Composes a file in memory, which we then write in one go. So HDF5 never meets a full disk, and no
/// half-written file is ever seen. The memory is ours: it is written as it is, without a copy. Object times
/// are off, so equal content is equal bytes.
class Writer {
 public:
  /// joins: the file has datasets that lie in other files, which HDF5 before 1.10 cannot read.
  explicit Writer(bool joins = false);
  void group(const std::string& path);
  /// rows×columns of float64; row-major memory.
  void dataset(const std::string& path, const double* data, Eigen::Index rows, Eigen::Index columns);
  void dataset(const std::string& path, const std::vector<std::int64_t>& data, Eigen::Index columns = 1);
  /// Notes the parts from which `joined` makes datasets; those without entries are left out.
  void parts(std::vector<FilePart>);
  /// A dataset of that name out of those of all parts, one behind the other: rows of `width` columns, or
  /// columns of `width` rows. HDF5 reads entries of a part that is not there as NaN or −1.
  void joined_rows(const std::string& path, H5T_class_t, Eigen::Index width);
  void joined_columns(const std::string& path, H5T_class_t, Eigen::Index width);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  /// Closes the file and writes it whole, as the last call; throws Error(cannot_write).
  void save(const std::filesystem::path&, bool lasting = false);  // lasting: on the disk when it returns

 private:
  void put(const std::string& path, hid_t file_type, hid_t memory_type, const void* data, Eigen::Index rows,
           Eigen::Index columns);
  void join(const std::string& path, H5T_class_t, std::size_t axis, Eigen::Index width);
  Session session_;
  std::unique_ptr<Image> image_;  // outlives file_
  Handle file_;
  std::vector<FilePart> parts_;
};

/// A file of any origin; every fault of it throws Error(case_file) with the file. Where a dataset lies in
/// parts, each of them must be there when its values are read.
class Reader {
 public:
  /// format: the attribute "format" of the root that makes the file ours.
  Reader(const std::filesystem::path&, const std::string& format);
  std::vector<std::string> names(const std::string& group) const;  // of the links in it, sorted
  std::array<Eigen::Index, 2> shape(const std::string& path) const;
  RowMajor real(const std::string& path, const Slice* = nullptr) const;
  std::vector<std::int64_t> integer(const std::string& path, const Slice* = nullptr) const;
  double number(const std::string& attribute) const;  // of the root
  std::string text(const std::string& attribute) const;
  /// An attribute of another object, where it has it.
  std::optional<std::string> text_of(const std::string& object, const std::string& attribute) const;

 private:
  std::string text(hid_t object, const std::string& attribute) const;
  Handle dataset(const std::string& path, H5T_class_t, std::array<Eigen::Index, 2>&) const;
  std::uintmax_t bytes_of_parts(hid_t set) const;
  void check_part(const std::filesystem::path&, std::uintmax_t bytes) const;
  void read(const std::string& path, hid_t set, hid_t type, std::array<Eigen::Index, 2>& shape, const Slice*,
            const std::function<void*(Eigen::Index rows, Eigen::Index columns)>& allocate) const;
  [[noreturn]] void refuse(const std::string& problem) const;
  Session session_;
  std::filesystem::path path_;
  std::uintmax_t size_ = 0;  // [bytes]
  Handle file_;
  mutable std::set<std::string> checked_;  // parts
};

/// A name of ours as the name of one link ('/' would open a group), and back.
std::string link_name(const std::string& name);
std::string from_link_name(const std::string& link);

}  // namespace strake::hdf5
