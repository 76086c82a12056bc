#include "tests/benchmark/fluid/library_solvers.hpp"

#ifdef STRAKE_HAS_HYPRE
#include <HYPRE.h>
#include <HYPRE_krylov.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>
#endif

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace strake::fluid {

#ifdef STRAKE_HAS_HYPRE

namespace {

/// MPI and hypre from the first use to the end of the process.
struct Session {
  bool own = false;
  Session() {
    int started = 0;
    MPI_Initialized(&started);
    own = started == 0;
    if (own) MPI_Init(nullptr, nullptr);
    HYPRE_Init();
  }
  ~Session() {
    HYPRE_Finalize();
    int ended = 0;
    MPI_Finalized(&ended);
    if (own && ended == 0) MPI_Finalize();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

HYPRE_IJVector to_hypre(const Eigen::VectorXd& x, const std::vector<HYPRE_Int>& index) {
  const auto n = static_cast<HYPRE_Int>(x.size());
  HYPRE_IJVector vector = nullptr;
  HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, n - 1, &vector);
  HYPRE_IJVectorSetObjectType(vector, HYPRE_PARCSR);
  HYPRE_IJVectorInitialize(vector);
  HYPRE_IJVectorSetValues(vector, n, index.data(), x.data());
  HYPRE_IJVectorAssemble(vector);
  return vector;
}

HYPRE_IJMatrix to_hypre(const PressureSystem& system) {
  const auto n = static_cast<HYPRE_Int>(system.size());
  HYPRE_IJMatrix matrix = nullptr;
  HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, n - 1, 0, n - 1, &matrix);
  HYPRE_IJMatrixSetObjectType(matrix, HYPRE_PARCSR);
  std::vector<HYPRE_Int> sizes(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < sizes.size(); ++k)
    sizes[k] = static_cast<HYPRE_Int>(system.stop[k] - system.start[k]) + 1;
  HYPRE_IJMatrixSetRowSizes(matrix, sizes.data());
  HYPRE_IJMatrixInitialize(matrix);
  std::vector<HYPRE_Int> column;
  std::vector<double> value;
  for (HYPRE_Int k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    column.assign(1, k);
    value.assign(1, system.diagonal[k]);
    column.insert(column.end(), system.column.begin() + system.start[row],
                  system.column.begin() + system.stop[row]);
    value.insert(value.end(), system.value.begin() + system.start[row],
                 system.value.begin() + system.stop[row]);
    auto entries = static_cast<HYPRE_Int>(column.size());
    HYPRE_IJMatrixSetValues(matrix, 1, &entries, &k, column.data(), value.data());
  }
  HYPRE_IJMatrixAssemble(matrix);
  return matrix;
}

}  // namespace

bool has_hypre() {
  return true;
}

void solve_hypre(const PressureSystem& system, double tolerance, int max_iterations,
                 PressureSolution& solution) {
  static const Session session;
  std::vector<HYPRE_Int> index(static_cast<std::size_t>(system.size()));
  std::iota(index.begin(), index.end(), 0);
  HYPRE_IJMatrix matrix = to_hypre(system);
  HYPRE_IJVector right = to_hypre(system.right, index), unknown = to_hypre(solution.pressure, index);
  void* object = nullptr;
  HYPRE_IJMatrixGetObject(matrix, &object);
  const auto a = static_cast<HYPRE_ParCSRMatrix>(object);
  HYPRE_IJVectorGetObject(right, &object);
  const auto b = static_cast<HYPRE_ParVector>(object);
  HYPRE_IJVectorGetObject(unknown, &object);
  const auto x = static_cast<HYPRE_ParVector>(object);

  HYPRE_Solver cg = nullptr, amg = nullptr;
  HYPRE_BoomerAMGCreate(&amg);
  HYPRE_BoomerAMGSetMaxIter(amg, 1);
  HYPRE_BoomerAMGSetTol(amg, 0);
  HYPRE_BoomerAMGSetCoarsenType(amg, 8);  // PMIS
  HYPRE_BoomerAMGSetInterpType(amg, 6);   // extended+i
  HYPRE_BoomerAMGSetPMaxElmts(amg, 4);
  HYPRE_BoomerAMGSetAggNumLevels(amg, 1);
  HYPRE_BoomerAMGSetStrongThreshold(amg, 0.25);
  HYPRE_BoomerAMGSetRelaxType(amg, 6);  // symmetric Gauss-Seidel
  HYPRE_ParCSRPCGCreate(MPI_COMM_SELF, &cg);
  HYPRE_PCGSetTol(cg, tolerance);
  HYPRE_PCGSetMaxIter(cg, max_iterations);
  HYPRE_PCGSetTwoNorm(cg, 1);
  HYPRE_PCGSetPrecond(cg, reinterpret_cast<HYPRE_PtrToSolverFcn>(HYPRE_BoomerAMGSolve),
                      reinterpret_cast<HYPRE_PtrToSolverFcn>(HYPRE_BoomerAMGSetup), amg);
  HYPRE_ParCSRPCGSetup(cg, a, b, x);
  HYPRE_ParCSRPCGSolve(cg, a, b, x);
  HYPRE_Int iterations = 0;
  HYPRE_PCGGetNumIterations(cg, &iterations);
  HYPRE_IJVectorGetValues(unknown, static_cast<HYPRE_Int>(index.size()), index.data(),
                          solution.pressure.data());
  HYPRE_ParCSRPCGDestroy(cg);
  HYPRE_BoomerAMGDestroy(amg);
  HYPRE_IJVectorDestroy(unknown);
  HYPRE_IJVectorDestroy(right);
  HYPRE_IJMatrixDestroy(matrix);
  HYPRE_ClearAllErrors();  // a solve that did not converge shows in its residual
  solution.iterations = iterations;
  solution.residual = pressure_residual(system, solution.pressure);
}

#else

bool has_hypre() {
  return false;
}

void solve_hypre(const PressureSystem&, double, int, PressureSolution&) {
  throw std::runtime_error("hypre was not there when this was built");
}

#endif

}  // namespace strake::fluid
