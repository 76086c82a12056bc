#pragma once

#include "coupler/attachments/case/attachment_keys.hpp"
#include "coupler/case/case_view.hpp"
#include "proto/case/foreign_keys.hpp"
#include "proto/files/json_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// The program of an attachment that is computed by one. Throws Error where it is not there.
std::filesystem::path program_of(const AttachmentKeys&, const CaseView&);

/// Refuses an attachment whose program is not there. by_hand: sides that the user starts.
void check_attached_programs(const CaseView&, const std::vector<std::string>& by_hand);

/// Adds solver and program of each attachment that is a program, under its name, as run.json has them.
/// Returns those that the coupler computes itself.
Json record_attachments(const CaseView&, Json& programs);

/// Our solvers that may take the body of a case, in the order of the table of `strake check`. A form that
/// rigid bodies alone have (a wedge, an outline) needs no start of the others, which load deal.II.
std::vector<std::string> discretisations(const CaseView&, const SideView& body);

/// Whether the user starts this side (--attach): it is named, or it is a body and "structure" is.
bool starts_by_hand(const std::vector<std::string>& by_hand, const SideView&);

/// Error(command_line) for a name that the case has not, or that has no solver.
void check_by_hand(const std::vector<std::string>& by_hand, const CaseView&);

/// Says that a preCICE configuration has other windows than the run; empty where it has the same.
/// configured: its time-window-size [s], 0: none. window: the case's [s].
std::string other_window_line(const std::string& side, double configured, double window);

/// The same of each side whose configuration is in the case.
std::vector<std::string> other_window_lines(const CaseView&);

/// Looks up the names of data that [SIDE.precice] gives in its preCICE configuration. Error(case_file) for
/// one that is not there, and for a configuration that cannot be read. Does nothing without a configuration.
void check_precice_names(const std::string& side, const ForeignKeys&);

}  // namespace strake
