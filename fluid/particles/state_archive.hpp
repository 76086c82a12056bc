#pragma once

#include "fluid/particles/state.hpp"
#include "proto/archive_source.hpp"
#include "proto/interface.hpp"

#include <string>
#include <vector>

namespace strake::fluid {

/// Notes each member of the state under its own name; the state must outlive what is noted.
template <int dim>
void save(const State<dim>&, ArchiveSource&);
/// Notes the members of a share of a state in two archives: those with one entry per particle, which every
/// rank writes, and the values that the first rank writes.
template <int dim>
void save_share(const State<dim>&, ArchiveSource& entries, ArchiveSource& values);
/// Names of those that may have one entry per particle.
template <int dim>
std::vector<std::string> entry_names();
/// Reads it back, to the last bit. Throws Error(case_file) naming what is missing or of another size.
template <int dim>
State<dim> load(const Archive&);

/// Gives the values of a checkpoint of version 0.1.0 their names. That version stored them by position, in
/// the arrays `scalars` and `counts`. Other checkpoints stay as they are. Throws Error(case_file) where those
/// arrays are not of 0.1.0.
Archive with_names(Archive);

}  // namespace strake::fluid
