#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace strake {

struct RunOptions;
struct PictureOptions;

/// Declares options that several commands have: --set, those of a run, those of a picture. out: help of its
/// -o.
void add_sets(CLI::App& command, std::vector<std::string>& sets);
CLI::App* add_run_options(CLI::App* command, RunOptions&);
void add_picture_options(CLI::App* command, PictureOptions&, const std::string& out);

}  // namespace strake
