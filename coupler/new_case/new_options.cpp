#include "coupler/new_case/new_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace strake {

void add_new_options(CLI::App& command, NewOptions& options) {
  command.require_subcommand(0, 1);
  command.add_option("-o", options.out, "the case file, default KIND.toml")->type_name("FILE");
  for (const NewKind& kind : new_kinds()) {
    CLI::App* one = command.add_subcommand(kind.name, kind.help);
    one->add_option("-o", options.out, "the case file, default " + kind.name + ".toml")->type_name("FILE");
    if (kind.mesh)
      one->add_option("MESH,--mesh", options.answers.mesh, "mesh file")->type_name("FILE")->required();
    if (kind.mesh)
      one->add_option("--up", options.answers.up,
                      "axis of the file that points up, default y; it is turned so")
          ->check(CLI::IsMember(std::vector<std::string>{"y", "z"}))
          ->type_name("y|z");
    if (kind.solvers.size() > 1)
      one->add_option("--solver", options.answers.solver, "of the body, default " + kind.solvers.front())
          ->check(CLI::IsMember(kind.solvers))
          ->type_name(fmt::format("{}", fmt::join(kind.solvers, "|")));
    for (const NewNumber& number : kind.numbers)
      one->add_option_function<double>(
             "--" + number.name,
             [&options, name = number.name](double x) { options.answers.number[name] = x; },
             fmt::format("{}; {:g} to {:g}, default {}", number.help, number.min, number.max,
                         number.follows.empty() ? fmt::format("{:g}", number.value) : number.follows))
          ->type_name(number.unit);
    one->callback([&options, &kind] { options.kind = kind.name; });
  }
}

}  // namespace strake
