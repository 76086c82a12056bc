#include "proto/mesh_files/mesh_text.hpp"

#include "proto/error.hpp"
#include "proto/text.hpp"

#include <string>

namespace strake {

MeshText read_mesh_text(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".msh") return read_gmsh(path);
  if (ending == ".inp") return read_abaqus(path);
  throw Error(ExitCode::case_file, path.string(), "a mesh file ends in .msh (Gmsh) or .inp (Abaqus)",
              "gmsh -2 -format msh41 FILE.geo");
}

}  // namespace strake
