#include "coupler/participant/precice/c_library.hpp"

#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <dlfcn.h>

namespace strake {
namespace {

constexpr const char* library_name = "libprecice.so.3";
constexpr int major_version = 3;

/// What a user may do about a library that is not found.
std::string how_to_find() {
  const char* path = std::getenv("LD_LIBRARY_PATH");
  std::string fix = fmt::format("--precice-library FILE, or its folder in LD_LIBRARY_PATH, which is {}",
                                path && *path ? fmt::format("\"{}\"", path) : std::string("not set"));
  if (const std::string own = library_path(); !own.empty())
    fix += fmt::format("\nfor a run of Strake its own library: {}/{}", own.substr(0, own.find(':')),
                       library_name);
  return fix;
}

void* open(const std::filesystem::path& file) {
  const std::string wanted = file.empty() ? library_name : file.string();
  // A word without '/' is looked up by the loader; a file of the user's is that file alone.
  const std::string path = file.empty() ? wanted : std::filesystem::absolute(file).string();
  if (void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return handle;
  const char* reason = dlerror();
  throw Error(ExitCode::command_line, file.empty() ? "--precice" : "--precice-library " + wanted,
              fmt::format("preCICE's library cannot be loaded\n{}", reason ? reason : path), how_to_find());
}

template <class Function>
void find(void* handle, const std::string& file, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(handle, name));
  if (!function)
    throw Error(ExitCode::command_line, file,
                fmt::format("is no library of preCICE {}: it has no function {}", major_version, name),
                how_to_find());
}

std::filesystem::path file_of(void* function, const std::filesystem::path& otherwise) {
  Dl_info info{};
  return dladdr(function, &info) != 0 && info.dli_fname ? info.dli_fname : otherwise;
}

}  // namespace

PreciceLibrary PreciceLibrary::load(const std::filesystem::path& wanted) {
  void* handle = open(wanted);
  PreciceLibrary library;
  const std::string name = wanted.empty() ? library_name : wanted.string();
  const char* (*version)() = nullptr;
  find(handle, name, "precicec_getVersionInformation", version);
  library.file = file_of(reinterpret_cast<void*>(version), name);
  library.version = version();
  library.version = library.version.substr(0, library.version.find(';'));
  if (std::atoi(library.version.c_str()) != major_version)
    throw Error(ExitCode::command_line, library.file.string(),
                fmt::format("is version {} of preCICE, expected {}", library.version, major_version),
                how_to_find());
  library.is_strakes = library.version.find("strake") != std::string::npos;
  const auto take = [&](const char* function, auto*& to) {
    find(handle, library.file.string(), function, to);
  };
  take("precicec_createParticipant", library.create);
  take("precicec_initialize", library.initialize);
  take("precicec_advance", library.advance);
  take("precicec_finalize", library.finalize);
  take("precicec_isCouplingOngoing", library.is_ongoing);
  take("precicec_getMaxTimeStepSize", library.longest_step);
  take("precicec_requiresInitialData", library.needs_initial_data);
  take("precicec_requiresWritingCheckpoint", library.needs_checkpoint);
  take("precicec_requiresReadingCheckpoint", library.needs_rewind);
  take("precicec_requiresMeshConnectivityFor", library.needs_faces);
  take("precicec_setMeshVertices", library.set_vertices);
  take("precicec_setMeshEdges", library.set_edges);
  take("precicec_setMeshTriangles", library.set_triangles);
  take("precicec_writeData", library.write);
  take("precicec_readData", library.read);
  return library;
}

}  // namespace strake
