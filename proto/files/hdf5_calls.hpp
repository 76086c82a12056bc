#pragma once
// Private to proto/files: calls of HDF5 that compose a file in memory.

#include "proto/files/hdf5_file.hpp"

#include <stdexcept>

namespace strake::hdf5 {

/// The dataset that lists the bytes of the parts of a file.
inline constexpr const char* parts_path = "/parts";

/// Composing in memory can only fail for want of memory or through a mistake of ours.
inline hid_t made(hid_t id) {
  if (id < 0) throw std::runtime_error("HDF5 refused to compose a result file in memory");
  return id;
}
inline void done(herr_t status) {
  made(status);
}

template <class Create>
Handle without_times(Create create) {
  Handle list(made(create()), H5Pclose);
  done(H5Pset_obj_track_times(list.get(), false));
  return list;
}

}  // namespace strake::hdf5
