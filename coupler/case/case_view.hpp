#pragma once

#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/case/coupling_keys.hpp"
#include "coupler/compare/compare_block.hpp"
#include "proto/case/case_keys.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

class StopRequest;

/// One side of a case: the program that solves it and what that program understood.
struct SideView {
  std::string side;    // "fluid" | "structure" | the name of one of several bodies
  std::string solver;  // "mps", "fem", …, or the path of a user's program
  std::filesystem::path program;
  std::vector<std::string> lines;              // of its --check: derived numbers
  std::string echo;                            // its resolved tables, TOML; empty for a user's program
  std::optional<std::string> properties = {};  // of a structure, where `read_case` asked: its --properties
  bool is_body = false;                        // one of several

  /// Whether its solver computes how it deforms.
  bool deforms() const { return solver != "rigid" && solver != "replay"; }
  bool is_users() const { return solver.find('/') != std::string::npos; }
};

/// Lines of a side's own check that begin so, without those words.
std::vector<std::string> lines_with(const std::string& words, const SideView&);
/// Whether its own check says that it takes long to build.
bool is_large(const SideView&);

/// A case as all programs of the run read it.
struct CaseView {
  std::filesystem::path path, folder;   // of the case file; relative paths in it are relative to its folder
  std::array<std::uint8_t, 32> hash{};  // CaseFile::hash()
  CommonKeys common;
  CouplingKeys coupling;
  std::vector<CompareBlock> blocks;
  std::optional<SideView> fluid;     // none: solver = "none"
  std::vector<SideView> structures;  // one, the bodies of [[structures]], or none: solver = "none"
  std::vector<AttachmentKeys> attachments;
  std::vector<std::string> sets;
  std::string resolved;                      // case.toml of the run folder: every key, defaults marked
  std::map<std::string, std::string> value;  // key → resolved value as text

  /// Whether a whole body is free in some direction.
  bool moves_freely() const;
  /// The resolved value as a number, or nothing.
  std::optional<double> number(const std::string& key) const;
  bool coupled() const { return fluid && !structures.empty(); }
  bool any_deforms() const;
  std::vector<const SideView*> sides() const;  // fluid, then the structures
  std::vector<std::string> bodies() const;     // names of several; empty for one structure
};

/// Reads the case with the coupler's keys, and lets each side's program check its own. So everything that
/// `run` would refuse is refused here, before a run folder exists. Throws Error. by_hand: sides that the user
/// starts; a program of the user's need not be on this machine then. properties: ask structures for theirs.
CaseView read_case(const std::filesystem::path& case_file, const std::vector<std::string>& sets,
                   const StopRequest* stop = nullptr, const std::vector<std::string>& by_hand = {},
                   bool properties = false);

/// Runs one mode of a program ("--check", or "--export" and what goes with it) on a case; what it prints.
/// What it refuses is thrown with its own words and exit code. body: of several; empty: it needs none.
std::string ask(const std::filesystem::path& program, std::vector<std::string> arguments,
                const std::filesystem::path& case_file, const std::vector<std::string>& sets,
                const StopRequest* stop = nullptr, const std::string& body = {});

/// Returns the output of a program's mode ("--properties") for the case with another solver of that structure
/// ("particle"). Nothing if the program is not installed. A refusal is thrown with the program's own words.
std::optional<std::string> ask_solver(const CaseView&, const SideView& structure, const std::string& solver,
                                      const std::string& mode, const StopRequest* stop);

/// "mps" → "strake-fluid", "fem" → "strake-structure-fem"; a path stays as it is.
std::string program_name(const std::string& side, const std::string& solver);

/// The numbers of a resolved value in their order: "[[-1, 0], [1, 0.5]]" → −1, 0, 1, 0.5.
std::vector<double> numbers_in(const std::string& value);

CaseLookup lookup_in(std::map<std::string, std::string> values);

/// Every value of a TOML text by its full key: numbers in shortest form, arrays as "[0, -6.26, 0]". Tables of
/// a list are counted, "structure.box[0].min", and those of structures and attachments have their names.
std::map<std::string, std::string> flatten_toml(const std::string& text, const std::string& name);

}  // namespace strake
