#pragma once

#include "coupler/attachments/catenary.hpp"
#include "coupler/attachments/local_attachment.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

class CaseFile;
struct CommonKeys;

/// [attachments.fmu]: a co-simulation unit of FMI 3.0.
struct FmuKeys {
  std::filesystem::path file;
  std::vector<std::string> inputs, outputs, parameters;
};

/// One of [[attachments]]: what is coupled to a few points of a structure.
struct AttachmentKeys {
  std::string name;
  std::string body;                 // of several; empty: the case has one structure
  std::string solver;               // "spring" | "catenary" | "fmu" | the path of a user's program
  std::vector<Eigen::Vector3d> at;  // [m] reference configuration
  SpringParameters spring;
  CatenaryParameters catenary;  // `down` is not set: it follows from fluid.gravity
  FmuKeys fmu;
  bool is_users() const { return solver.find('/') != std::string::npos; }
  /// Whether a process of its own computes it.
  bool is_program() const { return is_users() || solver == "fmu"; }
};

/// Declares and reads [[attachments]]. The common keys name the bodies.
std::vector<AttachmentKeys> read_attachments(CaseFile&, const CommonKeys&);

}  // namespace strake
