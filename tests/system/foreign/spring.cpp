// A rigid floor on a spring, m y'' + k y = F, against the installed package; cases/python_spring/ has it in
// Python.
#include "coupler/participant/participant_main.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/files/vector_participant.hpp"

using namespace strake;

int main(int argc, char** argv) {
  double m = 1, k = 1, width = 1, thickness = 1;
  int n = 2;
  Program program{"spring", "spring", "1", "structure", {}, {}, {}};
  program.declare = [&](CaseFile& file) {
    read_common(file);
    CaseTable keys = file.root().table("structure").table("spring", "a rigid floor on a spring");
    keys.number("mass", m, {.unit = "kg/m", .min = 0, .exclusive = true, .help = "of the floor"});
    keys.number("stiffness", k, {.unit = "Pa", .min = 0, .help = "of the spring, per metre of depth"});
    keys.number("width", width, {.unit = "m", .min = 0, .exclusive = true, .help = "of the floor"});
    keys.number("thickness", thickness, {.unit = "m", .min = 0, .exclusive = true, .help = "of the floor"});
    keys.integer("points", n, {.min = 2, .max = 100000, .help = "on its upper face"});
  };
  program.build = [&](CaseFile&, const ParticipantOptions&, const Setup&) {
    InterfaceMesh floor{
        .name = "spring", .dimension = 2, .position = Points::Zero(3, 2 * n), .faces = {}, .mass = {}};
    floor.position.row(0) << Eigen::RowVectorXd::LinSpaced(n, -width / 2, width / 2),
        Eigen::RowVectorXd::LinSpaced(n, width / 2, -width / 2);
    floor.position.row(1).head(n).setConstant(-thickness);
    floor.faces.resize(2, 2 * n);  // the outline, counter-clockwise
    for (int i = 0; i < 2 * n; ++i) floor.faces.col(i) << i, (i + 1) % (2 * n);
    const auto displacement = [n](double y) -> Field {
      return {"displacement", "m", false, Eigen::Vector3d(0, y, 0).replicate(1, 2 * n)};
    };
    // The trapezoidal rule with the mean force over the window; the state is y [m] and v [m/s].
    const auto step = [=](const Window& w, const Input& in, const Eigen::VectorXd& was,
                          Eigen::VectorXd& now) {
      const double force = find(in.samples.back().fields, "force")->value.row(1).sum();
      const double a = k * w.dt * w.dt / (4 * m);
      now[1] = ((1 - a) * was[1] + w.dt * (force - k * was[0]) / m) / (1 + a);
      now[0] = was[0] + w.dt * (was[1] + now[1]) / 2;
      return Advanced{.output = {displacement(now[0])}, .monitor = {{"floor.y", now[0]}}};
    };
    const Description told{
        .initial = {displacement(0)}, .columns = {{"floor.y", "m"}}, .lines = {"spring in C++"}};
    return std::make_unique<VectorParticipant>(floor, told, Eigen::VectorXd::Zero(2), step);
  };
  return participant_main(argc, argv, program);
}
