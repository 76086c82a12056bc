#include "coupler/study/plan.hpp"
#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace strake::study {
namespace {

bool fits_a_folder(const std::string& label) {
  return !label.empty() &&
         label.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
             "._+") == std::string::npos &&
         label.front() != '.';
}

std::vector<std::string> labels_of(const Axis& axis) {
  std::vector<std::string> labels;
  for (const AxisValue& value : axis.values) labels.push_back(value.label);
  return labels;
}

const Axis* find_axis(const std::vector<Axis>& axes, const std::string& name) {
  const auto found = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == name; });
  return found == axes.end() ? nullptr : &*found;
}

void read_sets(CaseTable table, const std::string& name, std::vector<std::string>& sets) {
  table.texts(name, sets, {.help = "keys of the case, each \"KEY=VALUE\" as --set takes it"});
  for (const std::string& set : sets)
    if (set.find('=') == std::string::npos || set.front() == '=')
      throw table.error(name, fmt::format("\"KEY=VALUE\", not \"{}\"", set),
                        name + " = [\"structure.solver=fem\"]");
}

AxisValue read_value(CaseTable table) {
  AxisValue value;
  table.text("label", value.label, {.required = true, .help = "its part of the run's name"});
  if (!fits_a_folder(value.label))
    throw table.error("label", "letters, digits, points, plus and underscores: it names a folder");
  read_sets(table, "set", value.sets);
  double at = 0;
  table.number("at", at, {.unit = "SI", .help = "its number, where results are followed along the axis"});
  if (table.has("at")) value.at = at;
  table.text("replay", value.replay,
             {.help = "label on the same axis: the loads that its run recorded drive this one"});
  return value;
}

Axis read_axis(CaseTable table) {
  Axis axis;
  table.text("name", axis.name, {.required = true, .help = "what is varied"});
  for (CaseTable value : table.tables("value", "one choice")) {
    axis.values.push_back(read_value(value));
    const AxisValue& now = axis.values.back();
    if (std::any_of(axis.values.begin(), axis.values.end() - 1,
                    [&](const AxisValue& v) { return v.label == now.label; }))
      throw value.error("label", "a label that no other value of the axis has");
    const bool earlier = std::any_of(axis.values.begin(), axis.values.end() - 1,
                                     [&](const AxisValue& v) { return v.label == now.replay; });
    if (!now.replay.empty() && !earlier)
      throw value.error("replay", "the label of a value that stands before it on this axis");
  }
  if (axis.values.empty())
    throw table.error("name", "an axis with values",
                      "value = [{ label = \"fem\", set = [\"structure.solver=fem\"] }]");
  return axis;
}

void refuse_label(CaseTable& table, const std::string& key, const std::string& name, const Axis& axis) {
  const auto labels = labels_of(axis);
  if (std::find(labels.begin(), labels.end(), name) == labels.end())
    throw table.error(key, fmt::format("a label of axis {}: {}", axis.name, joined(labels)));
}

const Axis& axis_of(CaseTable& table, const std::vector<Axis>& axes, const std::string& key,
                    const std::string& name) {
  if (const Axis* axis = find_axis(axes, name)) return *axis;
  std::vector<std::string> names;
  for (const Axis& axis : axes) names.push_back(axis.name);
  throw table.error(key, fmt::format("the name of an axis: {}", joined(names)));
}

/// One condition on a run's labels: "solver=fem" or "solver!=fem".
struct Condition {
  std::string axis, label;
  bool equal = true;
  bool holds(const PlannedRun& run) const { return (run.label.at(axis) == label) == equal; }
};

std::vector<Condition> read_conditions(CaseTable& table, const std::vector<Axis>& axes,
                                       const std::string& help) {
  const std::string key = "where";
  std::vector<std::string> texts;
  table.texts(key, texts, {.help = help});
  std::vector<Condition> all;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    Condition one = {text.substr(0, equals), equals == std::string::npos ? "" : text.substr(equals + 1),
                     true};
    if (one.axis.ends_with('!')) {
      one.axis.pop_back();
      one.equal = false;
    }
    refuse_label(table, key, one.label, axis_of(table, axes, key, one.axis));
    all.push_back(std::move(one));
  }
  return all;
}

/// where = ["solver=fem", "speed=6.26"]
Filter read_filter(CaseTable& table, const std::vector<Axis>& axes) {
  Filter filter;
  for (const Condition& c :
       read_conditions(table, axes, "only runs with these labels, each \"AXIS=LABEL\"")) {
    if (!c.equal) throw table.error("where", "AXIS=LABEL", "name the label that is wanted");
    filter[c.axis] = c.label;
  }
  return filter;
}

/// Refuses a metric that no summary.json has, beside the one that was probably meant.
void refuse_metric(CaseTable& table, const Quantity& q) {
  static const std::vector<std::string> of_probes = {
      "first_peak", "time_of_first_peak", "peak", "time_of_peak", "impulse", "mean_peak_50us", "final", "l2",
      "dtw"};
  static const std::vector<std::string> of_runs = {"work_gap",
                                                   "momentum_gap",
                                                   "structure_energy_drift",
                                                   "inner_fraction_min",
                                                   "voids",
                                                   "openings",
                                                   "penetrations",
                                                   "lost",
                                                   "volume_drift",
                                                   "air_mass",
                                                   "air_energy",
                                                   "wall",
                                                   "windows",
                                                   "iterations",
                                                   "iterations.mean",
                                                   "iterations.max",
                                                   "iterations.unconverged",
                                                   "iterations.taken_back"};
  const auto& known = q.probe.empty() ? of_runs : of_probes;
  if (std::find(known.begin(), known.end(), q.metric) != known.end()) return;
  if (q.probe.empty() && q.metric.starts_with("failure.")) return;
  const std::string near = did_you_mean(q.metric, known);
  throw table.error("metric", fmt::format("one of {}", joined(known)),
                    near.empty() ? "" : fmt::format("did you mean \"{}\"?", near));
}

Quantity read_quantity(CaseTable& table) {
  Quantity q;
  table.text("probe", q.probe,
             {.help = "probe and component, e.g. mid.y, force.y; none: a number of the run itself"});
  table.text(
      "metric", q.metric,
      {.required = true, .help = "first_peak, impulse, … of the probe; momentum_gap, wall, … of the run"});
  refuse_metric(table, q);
  return q;
}

Check read_check(CaseTable table, const std::vector<Axis>& axes) {
  Check check;
  table.text("title", check.title, {.help = "what is held to be equal"});
  table.text("axis", check.axis, {.required = true, .help = "axis on which the two stand"});
  const Axis& axis = axis_of(table, axes, "axis", check.axis);
  table.text("of", check.of, {.required = true, .help = "label of what is judged"});
  refuse_label(table, "of", check.of, axis);
  table.text("against", check.against, {.required = true, .help = "label of what it is held against"});
  refuse_label(table, "against", check.against, axis);
  check.quantity = read_quantity(table);
  table.number("tolerance", check.tolerance,
               {.min = 0, .required = true, .help = "allowed deviation, relative to the other's value"});
  check.where = read_filter(table, axes);
  if (check.title.empty())
    check.title = fmt::format("{} against {}: {}", check.of, check.against, check.quantity.name());
  return check;
}

Reference read_reference(CaseTable table, const std::vector<Axis>& axes) {
  Reference r;
  table.text("title", r.title, {.required = true, .help = "what the numbers are, as a table's head"});
  table.text("axis", r.axis, {.required = true, .help = "axis whose labels the numbers belong to"});
  const Axis& axis = axis_of(table, axes, "axis", r.axis);
  r.quantity = read_quantity(table);
  table.choice("kind", r.kind, {"experiment", "theory", "code", "calibration"},
               {.required = true, .help = "where the numbers come from"});
  table.text("source", r.source, {.required = true, .help = "who gives them, and how sure they are"});
  CaseTable value = table.table("value", "label = number, SI");
  for (const std::string& label : value.keys()) {
    refuse_label(value, label, label, axis);
    value.number(label, r.value[label], {.unit = "SI", .required = true, .help = "expected at " + label});
  }
  if (r.value.empty())
    throw table.error("title", "numbers beside it",
                      "value = { \"" + axis.values.front().label + "\" = 1.0 }");
  table.texts("fitted", r.fitted, {.help = "labels whose number chose the study's settings: not judged"});
  for (const std::string& label : r.fitted) refuse_label(table, "fitted", label, axis);
  double tolerance = 0;
  table.number("tolerance", tolerance,
               {.min = 0, .help = "allowed deviation, relative; not given: stated only"});
  if (table.has("tolerance")) r.tolerance = tolerance;
  r.where = read_filter(table, axes);
  return r;
}

Convergence read_convergence(CaseTable table, const std::vector<Axis>& axes) {
  Convergence c;
  table.text("title", c.title, {.help = "what should converge"});
  table.text("axis", c.axis,
             {.required = true, .help = "axis of spacings or steps, each with its number `at`"});
  for (const AxisValue& value : axis_of(table, axes, "axis", c.axis).values)
    if (!value.at || !(*value.at > 0))
      throw table.error("axis",
                        fmt::format("an axis with a number above 0 at each value; {} has none", value.label),
                        "at = 0.01");
  c.quantity = read_quantity(table);
  c.where = read_filter(table, axes);
  if (c.title.empty()) c.title = fmt::format("{} along {}", c.quantity.name(), c.axis);
  return c;
}

Claim read_claim(CaseTable table, const std::vector<Axis>& axes) {
  Claim claim;
  table.text("claim", claim.claim, {.required = true, .help = "the sentence that is judged"});
  table.text("source", claim.source, {.required = true, .help = "who says it, and where"});
  table.text("why", claim.why, {.help = "what the verdict rests on, and what limits it"});
  table.choice(
      "rule", claim.rule,
      {{"increases", Claim::Rule::increases},
       {"decreases", Claim::Rule::decreases},
       {"same", Claim::Rule::same},
       {"agree", Claim::Rule::agree},
       {"differ", Claim::Rule::differ},
       {"same_time", Claim::Rule::same_time},
       {"decays", Claim::Rule::decays},
       {"at_most", Claim::Rule::at_most},
       {"none", Claim::Rule::none}},
      {.required = true,
       .help =
           "increases, decreases, same: along the axis; agree: `of` with `against` on it; differ: not so; "
           "same_time: peaks "
           "of two probes; decays: the last fifth against the peak; at_most: each run's number; none: cannot "
           "be judged here"});
  if (claim.rule == Claim::Rule::none) {
    if (claim.why.empty()) throw table.error("rule", "a reason why it cannot be judged", "why = \"…\"");
    return claim;
  }
  claim.quantity = read_quantity(table);
  const bool along = claim.rule != Claim::Rule::same_time && claim.rule != Claim::Rule::decays &&
                     claim.rule != Claim::Rule::at_most;
  table.text("axis", claim.axis, {.required = along, .help = "axis that the rule follows"});
  if (!claim.axis.empty()) axis_of(table, axes, "axis", claim.axis);
  const bool agree = claim.rule == Claim::Rule::agree || claim.rule == Claim::Rule::differ;
  table.text("of", claim.of, {.required = agree, .help = "label of what is judged"});
  table.text("against", claim.against, {.required = agree, .help = "label of what it is held against"});
  if (agree) {
    refuse_label(table, "of", claim.of, axis_of(table, axes, "axis", claim.axis));
    refuse_label(table, "against", claim.against, axis_of(table, axes, "axis", claim.axis));
  }
  table.text(
      "other_probe", claim.other_probe,
      {.required = claim.rule == Claim::Rule::same_time, .help = "probe whose peak comes at the same time"});
  const bool limited = claim.rule != Claim::Rule::increases && claim.rule != Claim::Rule::decreases;
  table.number(
      "tolerance", claim.tolerance,
      {.min = 0,
       .required = limited,
       .help = "same, agree, differ: relative; same_time: in s; decays: share of the peak that may be left; "
               "at_most: the limit"});
  claim.where = read_filter(table, axes);
  return claim;
}

/// The product of the axes, the last one running fastest.
std::vector<PlannedRun> product(const std::vector<Axis>& axes, const std::vector<std::string>& sets) {
  std::vector<PlannedRun> runs = {{.name = {}, .label = {}, .sets = sets, .source = {}}};
  for (const Axis& axis : axes) {
    std::vector<PlannedRun> longer;
    for (const PlannedRun& run : runs)
      for (const AxisValue& value : axis.values) {
        PlannedRun next = run;
        next.name += (next.name.empty() ? "" : "-") + value.label;
        next.label[axis.name] = value.label;
        next.sets.insert(next.sets.end(), value.sets.begin(), value.sets.end());
        longer.push_back(std::move(next));
      }
    runs = std::move(longer);
  }
  return runs;
}

/// Which run's loads each replaying one takes: the same labels but for the axis that says so.
void connect(std::vector<PlannedRun>& runs, const std::vector<Axis>& axes) {
  for (PlannedRun& run : runs)
    for (const Axis& axis : axes)
      for (const AxisValue& value : axis.values) {
        if (value.replay.empty() || run.label.at(axis.name) != value.label) continue;
        auto wanted = run.label;
        wanted[axis.name] = value.replay;
        for (const PlannedRun& other : runs)
          if (other.label == wanted) run.source = other.name;
      }
}

/// Refuses the file of a case, which names no case and varies nothing.
void refuse_a_case(const CaseFile& file) {
  const auto given = [&](const char* key) { return file.has(key); };
  if (given("case") || given("axis")) return;
  if (!given("fluid") && !given("structure") && !given("structures") && !given("end_time")) return;
  throw Error(ExitCode::case_file, file.path().string(), "is a case, not a study",
              fmt::format("a study is a file of its own, which names this case and what varies:\n"
                          "  title = \"…\"\n"
                          "  case = \"{}\"\n"
                          "  [[axis]]\n"
                          "  name = \"spacing\"\n"
                          "  value = [{{ label = \"10mm\", at = 0.01, set = [\"fluid.spacing=0.01\"] }}, …]\n"
                          "every key of it: proto/STUDY_FILE.md. One run of the case: strake run {}",
                          file.path().filename().string(), file.path().string()));
}

}  // namespace

const Axis& Plan::axis(const std::string& name) const {
  return *find_axis(axes, name);
}

Plan read_plan(const std::filesystem::path& path) {
  CaseFile file = CaseFile::load(path);
  file.not_a_case();
  refuse_a_case(file);
  CaseTable root = file.root();
  Plan plan;
  plan.file = path;
  root.text("title", plan.title, {.required = true, .help = "what the study asks"});
  root.file("case", plan.case_file, {.required = true, .help = "case file of every run"});
  if (const CaseFile named = CaseFile::load(plan.case_file); named.has("case") && named.has("axis"))
    throw root.error("case", fmt::format("a case: {} is a study", plan.case_file.filename().string()),
                     "name the case that it varies");
  plan.case_file = std::filesystem::proximate(plan.case_file);  // as a user would type it
  root.integer("jobs", plan.jobs, {.min = 0, .help = "runs at once; 0: as many as there are cores"});
  std::vector<std::string> sets;
  read_sets(root, "set", sets);
  for (CaseTable table : root.tables("axis", "what is varied")) {
    plan.axes.push_back(read_axis(table));
    if (find_axis(plan.axes, plan.axes.back().name) != &plan.axes.back())
      throw table.error("name", "a name that no other axis has");
  }
  if (plan.axes.empty())
    throw Error(ExitCode::case_file, path.string(), "varies nothing",
                "give it an axis: [[axis]] with name and value = [{ label, set }, …]");
  plan.runs = product(plan.axes, sets);
  for (CaseTable table : root.tables("exclude", "choices that are left out together")) {
    const auto out = read_conditions(
        table, plan.axes, "runs for which all of these hold, each \"AXIS=LABEL\" or \"AXIS!=LABEL\"");
    if (out.empty())
      throw table.error("where", "labels to leave out", "where = [\"solver=ccx\", \"speed!=6.26\"]");
    std::erase_if(plan.runs, [&](const PlannedRun& run) {
      return std::all_of(out.begin(), out.end(), [&](const Condition& c) { return c.holds(run); });
    });
  }
  connect(plan.runs, plan.axes);
  for (CaseTable table : root.tables("column", "a number of each run in the summary"))
    plan.columns.push_back(read_quantity(table));
  for (CaseTable table : root.tables("check", "two choices held against each other"))
    plan.checks.push_back(read_check(table, plan.axes));
  for (CaseTable table : root.tables("reference", "published or derived numbers along an axis"))
    plan.references.push_back(read_reference(table, plan.axes));
  for (CaseTable table : root.tables("convergence", "order and uncertainty along an axis"))
    plan.convergences.push_back(read_convergence(table, plan.axes));
  for (CaseTable table : root.tables("claim", "a published sentence and the rule that judges it"))
    plan.claims.push_back(read_claim(table, plan.axes));
  file.refuse_unknown();

  std::set<std::string> names;
  for (const PlannedRun& run : plan.runs)
    if (!names.insert(run.name).second)
      throw Error(ExitCode::case_file, path.string(), fmt::format("two runs would be called {}", run.name),
                  "choose labels that differ");
  if (plan.runs.empty())
    throw Error(ExitCode::case_file, path.string(), "leaves out every run", "remove an [[exclude]]");
  return plan;
}

}  // namespace strake::study
