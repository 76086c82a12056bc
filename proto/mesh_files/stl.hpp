#pragma once

#include "proto/interface.hpp"

#include <filesystem>

namespace strake {

/// Largest number of triangles that an STL file may have: 100 MB in binary, about 500 MB as text.
inline constexpr long most_stl_triangles = 2'000'000;

/// Whether the name of a file ends in .stl, in small or large letters.
bool is_stl(const std::filesystem::path&);

/// Corners of the triangles of an STL file, binary or text, as the file has them. They are 3×3n, three
/// columns per triangle, in the file's unit. The file's own normals are not used: the order of the corners
/// says which side is outside (right-hand rule). A file of n triangles that has not 84 + 50 n bytes is read
/// as text if it begins with "solid". Several solids in a text are joined.
///
/// Throws Error(case_file) that names the file and the line, or the triangle, counted from 1.
Points read_stl(const std::filesystem::path&);

}  // namespace strake
