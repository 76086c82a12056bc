#include "proto/mesh_files/mesh_text.hpp"

#include "proto/error.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace strake {

MeshText read_mesh_text(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".msh") return read_gmsh(path);
  if (ending == ".inp") return read_abaqus(path);
  throw Error(ExitCode::case_file, path.string(), "a mesh file ends in .msh (Gmsh) or .inp (Abaqus)",
              "gmsh -2 -format msh41 FILE.geo");
}

}  // namespace strake
