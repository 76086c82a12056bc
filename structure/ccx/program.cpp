#include "structure/solver/program.hpp"

#include "structure/ccx/stepwise.hpp"
#include "structure/ccx/whole_history.hpp"
#include "structure/fem/fem.hpp"

namespace strake::structure {
namespace {

std::unique_ptr<Solver> build(const Parameters& p) {
  ccx::installed_program();  // before the mesh, which takes longer
  deck::Model model = fem::model(p, p.probes);
  if (p.ccx.calls != CalculixCalls::once || p.analysis != Analysis::dynamic)
    return std::make_unique<ccx::Stepwise>(p, std::move(model));
  const InterfaceRecord record = p.load_run.empty() ? ccx::no_load(p) : read_interface_record(p.load_run);
  return std::make_unique<ccx::WholeHistory>(p, std::move(model), record);
}

}  // namespace

SolverProgram this_program() {
  return {.kind = "ccx", .build = &build, .sizes = &fem::sizes};
}

}  // namespace strake::structure
