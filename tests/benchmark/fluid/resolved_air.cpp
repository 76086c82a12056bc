#include "tests/benchmark/fluid/resolved_air/plate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

// Impact of a rigid flat plate on still water with the air between them, both fluids resolved in the plane.
//   resolved_air_benchmark [--speed 6.26] [--dy 1,0.5,0.25] [--edge 0.5] [--csv FILE] [--one-velocity]
//   resolved_air_benchmark --check
// speed [m/s]; dy: heights of the rows near plate and water [mm], each a run; edge: width of the columns at
// the plate's edge [mm]; csv: writes the time series of all runs. --check: flows with known answers.
// --one-velocity: the fluids do not slip along each other inside a cell.
//
// The program uses nothing of Strake's fluid. Plate 0.4 m wide, 12 mm above water 0.5 m deep in a tank 2 m
// wide; the plate is driven at once. No gravity, viscosity, heat and surface tension; walls are smooth.
// Finite volumes for both masses, the momentum of each fluid along x and their common momentum up, with one
// pressure. Rows move with the plate. The surface lies sharp within about two rows. Once it comes near the
// plate's face, the figures hang on necks of air that are thinner than a row.

namespace {

using namespace resolved_air;

struct Arguments {
  double speed = 6.26;
  std::vector<double> rows = {1, 0.5, 0.25};  // [mm]
  double edge = 0.5;                          // [mm]
  std::string csv;
  Slip slip = Slip::free;
  bool check = false;
};

[[noreturn]] void refuse(const std::string& problem) {
  std::fprintf(stderr, "resolved_air_benchmark: %s\n", problem.c_str());
  std::exit(2);
}

double positive(const std::string& text, const std::string& of) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !(value > 0)) refuse(of + " is no positive number: " + text);
  return value;
}

std::vector<double> positive_list(const std::string& text, const std::string& of) {
  std::vector<double> values;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    values.push_back(positive(text.substr(begin, comma - begin), of));
    begin = comma + 1;
  }
  return values;
}

Arguments read_arguments(int argc, char** argv) {
  Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string name = argv[k];
    if (name == "--check") {
      arguments.check = true;
      continue;
    }
    if (name == "--one-velocity") {
      arguments.slip = Slip::none;
      continue;
    }
    if (k + 1 == argc) refuse("no value after " + name);
    const std::string value = argv[++k];
    if (name == "--speed")
      arguments.speed = positive(value, name);
    else if (name == "--dy")
      arguments.rows = positive_list(value, name);
    else if (name == "--edge")
      arguments.edge = positive(value, name);
    else if (name == "--csv")
      arguments.csv = value;
    else
      refuse("unknown argument " + name);
  }
  return arguments;
}

/// Convergence of a figure over three heights of rows of one ratio r (Richardson 1911, Roache 1994):
/// order q = ln(d_1/d_2)/ln r and limit f_3 + d_2/(r^q − 1), with the differences d of successive figures.
std::string convergence(const std::vector<double>& f, const std::vector<double>& rows) {
  const std::size_t n = f.size();
  if (n < 2) return "";
  char text[100];
  const double last = f[n - 1] - f[n - 2];
  std::snprintf(text, sizeof text, "%10.4g", last);
  std::string line = text;
  if (n < 3) return line;
  const double ratio = rows[n - 2] / rows[n - 1], before = f[n - 2] - f[n - 3];
  std::snprintf(text, sizeof text, "%10.4g", before);
  line = text + line;
  if (std::abs(rows[n - 3] / rows[n - 2] / ratio - 1) > 1e-6) return line + "  ratios of dy differ";
  if (before * last <= 0 || std::abs(last) >= std::abs(before)) return line + "  does not converge";
  const double growth = before / last;
  std::snprintf(text, sizeof text, "  order %.2f, limit %.4g", std::log(growth) / std::log(ratio),
                f[n - 1] + last / (growth - 1));
  return line + text;
}

void write_series(std::ofstream& file, double row, const PlateRun& run) {
  for (const Sample& s : run.samples)
    file << row << ',' << 1e3 * s.time << ',' << 1e-3 * s.mean_pressure << ',' << 1e-3 * s.centre_pressure
         << ',' << 1e3 * s.centre_gap << ',' << 1e3 * s.air_left << '\n';
  file.flush();
}

void print_runs(const Arguments& arguments) {
  std::ofstream series;
  if (!arguments.csv.empty()) {
    series.open(arguments.csv);
    if (!series) refuse("cannot write " + arguments.csv);
    series << "dy_mm,t_ms_after_contact,mean_kPa,centre_kPa,gap_mm,air_left_mm\n";
  }
  std::printf("plate at %g m/s, columns at the edge %g mm, %s, gauge pressures\n", arguments.speed,
              arguments.edge, arguments.slip == Slip::free ? "fluids slip" : "one velocity");
  std::vector<std::vector<double>> figures;
  for (const double row : arguments.rows) {
    PlateCase plate;
    if (const double rows = 1e3 * plate.gap / row; std::abs(rows - std::round(rows)) > 1e-6)
      refuse("the gap of 12 mm holds no whole number of rows");
    plate.speed = arguments.speed;
    plate.row = 1e-3 * row;
    plate.edge_column = 1e-3 * arguments.edge;
    plate.slip = arguments.slip;
    const PlateRun run = run_plate(plate);
    std::printf("dy %g mm: %zu cells, %zu steps, %.0f s; error of mass: air %.1e, water %.1e\n", row,
                run.cells, run.steps, run.seconds, run.air_error, run.water_error);
    std::fflush(stdout);
    figures.push_back(figures_of(run, plate));
    if (series) write_series(series, row, run);
  }
  std::printf("%-27s %-8s", "dy [mm]", "unit");
  for (const double row : arguments.rows) std::printf(" %9g", row);
  std::printf("   differences, order and limit for dy to 0\n");
  for (std::size_t k = 0; k < figure_names().size(); ++k) {
    const FigureName& figure = figure_names()[k];
    std::printf("%-27s %-8s", figure.name, figure.unit);
    std::vector<double> values;
    for (const auto& of_run : figures) {
      values.push_back(of_run[k] / figure.unit_size);
      std::printf(" %9.4g", values.back());
    }
    std::printf(" %s\n", convergence(values, arguments.rows).c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = read_arguments(argc, argv);
  if (arguments.check) return self_checks() ? 0 : 1;
  print_runs(arguments);
}
