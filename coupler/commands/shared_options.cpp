#include "coupler/commands/commands.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdlib>

namespace strake {

void add_sets(CLI::App& command, std::vector<std::string>& sets) {
  command.add_option("--set", sets, "change one key of the case: --set structure.solver=rigid")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

CLI::App* add_run_options(CLI::App* command, RunOptions& options) {
  add_sets(*command, options.sets);
  command->add_option("--tag", options.folder.tag, "the run folder is <case>-TAG")->type_name("TAG");
  command->add_option("--runs", options.folder.runs, "folder of the run folders, default runs")
      ->type_name("DIR");
  auto* force = command->add_flag("--force", options.folder.force, "replace an earlier run of that name");
  auto* resume =
      command->add_flag("--resume", options.folder.resume, "go on from the latest checkpoint of the run");
  resume->excludes(force);
  auto* free = command->add_flag("--first-free-tag", options.folder.first_free_tag,
                                 "number the run if its name is taken");
  force->excludes(free);
  resume->excludes(free);
  command
      ->add_option_function<std::string>(
          "--attach",
          [&options](const std::string& sides) {
            options.by_hand = sides == "both" ? std::vector<std::string>{"fluid", "structure"}
                                              : std::vector<std::string>{sides};
          },
          "start this side, one of several bodies, or an attachment, by hand, here or elsewhere: its command "
          "line is "
          "printed")
      ->type_name("fluid|structure|both");
  command->add_flag("--patient", options.patient,
                    "wait without limit for a program that lives, for debuggers");
  command->add_flag("--strict", options.strict, "exit 1 when a compare block fails, or an alarm was raised");
  command->add_flag("--profile", options.profile, "say at the end where the time went");
  command->add_flag("!--no-trace", options.trace, "write no trace.json");
  auto* quiet = command->add_flag("--quiet", options.quiet, "print only warnings and verdicts");
  command->add_flag("--json", options.json, "one JSON object per line instead of the table")->excludes(quiet);
  return command;
}

void add_picture_options(CLI::App* command, PictureOptions& options, const std::string& out) {
  command->add_option("RUN", options.run, "run folder")->required();
  command
      ->add_option("--field", options.field,
                   "pressure, speed, or another field of the frames, e.g. von_mises or damage")
      ->capture_default_str();
  command
      ->add_option("--size", options.size,
                   "pixels, WIDTH or WIDTHxHEIGHT; default 1120 wide and as high as it takes")
      ->type_name("W[xH]");
  command->add_option("--view", options.view, "corners of what is drawn [m]; default all")
      ->type_name("x0,y0,x1,y1");
  command->add_option("--range", options.range, "of the field's colours, SI units")->type_name("LO,HI");
  command
      ->add_option("--scale", options.scale,
                   "factor on the structure's deformation, without its rigid motion")
      ->capture_default_str()
      ->check(no_number);
  command->add_option("-o", options.out, out)->type_name("FILE");
}

std::string no_number(const std::string& text) {
  const double value = std::strtod(text.c_str(), nullptr);
  return std::isfinite(value) ? "" : "expected a number, not " + text;
}

}  // namespace strake
