#include "fluid/ranks/boomer_amg.hpp"

#include "proto/ranks/mpi_communicator.hpp"

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace strake::fluid {

namespace {

void refuse_fault(int code) {
  if (code == 0) return;
  char text[256] = {};
  HYPRE_DescribeError(code, text);
  HYPRE_ClearAllErrors();
  throw std::runtime_error("hypre: " + std::string(text));
}

/// hypre works from its first use to the end of MPI.
void begin_hypre() {
  static const int code = HYPRE_Init();
  refuse_fault(code);
}

class BoomerAmg final : public SharedGrid {
 public:
  explicit BoomerAmg(MPI_Comm all) : all_(all) { begin_hypre(); }
  ~BoomerAmg() override { clear(); }

  void build(const SharedRows& rows) override {
    clear();
    const HYPRE_BigInt first = number_of(rows.first), last = number_of(rows.first + rows.own - 1);
    HYPRE_IJMatrixCreate(all_, first, last, first, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    add(rows);
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* vector : {&right_, &solution_}) {
      HYPRE_IJVectorCreate(all_, first, last, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
      HYPRE_IJVectorAssemble(*vector);
    }
    own_.resize(static_cast<std::size_t>(rows.own));
    for (std::size_t k = 0; k < own_.size(); ++k)
      own_[k] = number_of(rows.first + static_cast<std::int64_t>(k));
    values_.resize(own_.size());
    HYPRE_BoomerAMGCreate(&amg_);
    HYPRE_BoomerAMGSetPrintLevel(amg_, 0);
    HYPRE_BoomerAMGSetTol(amg_, 0);
    HYPRE_BoomerAMGSetMaxIter(amg_, 1);
    // Of twenty settings this takes the least time of those without more iterations, in two and in three
    // dimensions. Sweeps forward on the way down and backward on the way up make the cycle symmetric.
    constexpr int hmis = 10, extended = 17, forward = 3, backward = 4, elimination = 9;
    HYPRE_BoomerAMGSetCoarsenType(amg_, hmis);
    HYPRE_BoomerAMGSetInterpType(amg_, extended);
    HYPRE_BoomerAMGSetPMaxElmts(amg_, 4);
    HYPRE_BoomerAMGSetStrongThreshold(amg_, 0.25);
    HYPRE_BoomerAMGSetCycleRelaxType(amg_, forward, 1);
    HYPRE_BoomerAMGSetCycleRelaxType(amg_, backward, 2);
    HYPRE_BoomerAMGSetCycleRelaxType(amg_, elimination, 3);
    HYPRE_BoomerAMGSetRelaxOrder(amg_, 0);
    HYPRE_BoomerAMGSetMaxRowSum(amg_, 1.0);
    refuse_fault(HYPRE_BoomerAMGSetup(amg_, stored<HYPRE_ParCSRMatrix>(matrix_),
                                      stored<HYPRE_ParVector>(right_), stored<HYPRE_ParVector>(solution_)));
  }

  void solve(std::span<const float> right, std::span<float> solution) override {
    std::ranges::copy(right, values_.begin());
    const auto rows = static_cast<HYPRE_Int>(own_.size());
    HYPRE_IJVectorSetValues(right_, rows, own_.data(), values_.data());
    std::ranges::fill(values_, 0.0);
    HYPRE_IJVectorSetValues(solution_, rows, own_.data(), values_.data());
    HYPRE_BoomerAMGSolve(amg_, stored<HYPRE_ParCSRMatrix>(matrix_), stored<HYPRE_ParVector>(right_),
                         stored<HYPRE_ParVector>(solution_));
    HYPRE_ClearAllErrors();  // one cycle does not reach the tolerance
    HYPRE_IJVectorGetValues(solution_, rows, own_.data(), values_.data());
    std::ranges::transform(values_, solution.begin(), [](double value) { return static_cast<float>(value); });
  }

 private:
  static HYPRE_BigInt number_of(std::int64_t row) {
    if (row > std::numeric_limits<HYPRE_BigInt>::max())
      throw std::length_error(
          "the pressure's first grid has more vertices than this build of hypre can number");
    return static_cast<HYPRE_BigInt>(row);
  }
  template <class Object, class Interface>
  static Object stored(Interface interface) {
    void* object = nullptr;
    if constexpr (std::is_same_v<Object, HYPRE_ParCSRMatrix>)
      HYPRE_IJMatrixGetObject(interface, &object);
    else
      HYPRE_IJVectorGetObject(interface, &object);
    return static_cast<Object>(object);
  }

  void add(const SharedRows& rows) {
    const auto count = static_cast<HYPRE_Int>(rows.diagonal.size());
    std::vector<HYPRE_Int> entries;
    std::vector<HYPRE_BigInt> row, column;
    std::vector<double> value;
    for (HYPRE_Int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const HYPRE_BigInt own = number_of(rows.number[k]);
      row.push_back(own);
      entries.push_back(rows.start[k + 1] - rows.start[k] + 1);
      column.push_back(own);
      value.push_back(rows.diagonal[k]);
      for (auto e = static_cast<std::size_t>(rows.start[k]); e < static_cast<std::size_t>(rows.start[k + 1]);
           ++e) {
        column.push_back(number_of(rows.number[static_cast<std::size_t>(rows.column[e])]));
        value.push_back(rows.value[e]);
      }
    }
    HYPRE_IJMatrixAddToValues(matrix_, count, entries.data(), row.data(), column.data(), value.data());
  }

  void clear() {
    if (amg_) HYPRE_BoomerAMGDestroy(amg_);
    if (matrix_) HYPRE_IJMatrixDestroy(matrix_);
    if (right_) HYPRE_IJVectorDestroy(right_);
    if (solution_) HYPRE_IJVectorDestroy(solution_);
    amg_ = nullptr;
    matrix_ = nullptr;
    right_ = solution_ = nullptr;
  }

  MPI_Comm all_;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector right_ = nullptr, solution_ = nullptr;
  HYPRE_Solver amg_ = nullptr;
  std::vector<HYPRE_BigInt> own_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<SharedGrid> boomer_amg(Communicator& ranks) {
  auto* const processes = dynamic_cast<MpiCommunicator*>(&ranks);
  if (processes == nullptr) throw std::logic_error("hypre solves on processes of MPI");
  return std::make_unique<BoomerAmg>(processes->all_ranks());
}

}  // namespace strake::fluid
