// Measures the processor time of MPI's calls inside hypre, which a rank counts as its own (rank_scaling.py).
// Loaded before the program (LD_PRELOAD), it takes those calls of MPI that can wait and passes them on by
// MPI's profiling interface. Where $STRAKE_MESSAGE_TIME is set, each rank writes its seconds into the file
// $STRAKE_MESSAGE_TIME.RANK.
#include "proto/ranks/communicator.hpp"

#include <mpi.h>

#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <string>

namespace {

double seconds = 0;

bool is_hypre(const void* caller) {
  Dl_info info{};
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr &&
         std::string(info.dli_fname).find("libHYPRE") != std::string::npos;
}

template <class Call>
int timed(const void* caller, const Call& call) {
  if (!is_hypre(caller)) return call();
  const double start = strake::processor_time(CLOCK_THREAD_CPUTIME_ID);
  const int result = call();
  seconds += strake::processor_time(CLOCK_THREAD_CPUTIME_ID) - start;
  return result;
}

}  // namespace

#define STRAKE_TIMED(name, parameters, arguments)                                 \
  int name parameters {                                                           \
    return timed(__builtin_return_address(0), [&] { return P##name arguments; }); \
  }

extern "C" {

STRAKE_TIMED(MPI_Wait, (MPI_Request * request, MPI_Status* status), (request, status))
STRAKE_TIMED(MPI_Waitall, (int n, MPI_Request* requests, MPI_Status* status), (n, requests, status))
STRAKE_TIMED(MPI_Waitany, (int n, MPI_Request* requests, int* which, MPI_Status* status),
             (n, requests, which, status))
STRAKE_TIMED(MPI_Test, (MPI_Request * request, int* done, MPI_Status* status), (request, done, status))
STRAKE_TIMED(MPI_Testall, (int n, MPI_Request* requests, int* done, MPI_Status* status),
             (n, requests, done, status))
STRAKE_TIMED(MPI_Iprobe, (int rank, int tag, MPI_Comm all, int* there, MPI_Status* status),
             (rank, tag, all, there, status))
STRAKE_TIMED(MPI_Probe, (int rank, int tag, MPI_Comm all, MPI_Status* status), (rank, tag, all, status))
STRAKE_TIMED(MPI_Recv,
             (void* to, int n, MPI_Datatype type, int rank, int tag, MPI_Comm all, MPI_Status* status),
             (to, n, type, rank, tag, all, status))
STRAKE_TIMED(MPI_Send, (const void* from, int n, MPI_Datatype type, int rank, int tag, MPI_Comm all),
             (from, n, type, rank, tag, all))
STRAKE_TIMED(MPI_Isend,
             (const void* from, int n, MPI_Datatype type, int rank, int tag, MPI_Comm all,
              MPI_Request* request),
             (from, n, type, rank, tag, all, request))
STRAKE_TIMED(MPI_Irsend,
             (const void* from, int n, MPI_Datatype type, int rank, int tag, MPI_Comm all,
              MPI_Request* request),
             (from, n, type, rank, tag, all, request))
STRAKE_TIMED(MPI_Irecv,
             (void* to, int n, MPI_Datatype type, int rank, int tag, MPI_Comm all, MPI_Request* request),
             (to, n, type, rank, tag, all, request))
STRAKE_TIMED(MPI_Barrier, (MPI_Comm all), (all))
STRAKE_TIMED(MPI_Bcast, (void* data, int n, MPI_Datatype type, int root, MPI_Comm all),
             (data, n, type, root, all))
STRAKE_TIMED(MPI_Reduce,
             (const void* from, void* to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm all),
             (from, to, n, type, op, root, all))
STRAKE_TIMED(MPI_Allreduce, (const void* from, void* to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm all),
             (from, to, n, type, op, all))
STRAKE_TIMED(MPI_Scan, (const void* from, void* to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm all),
             (from, to, n, type, op, all))
STRAKE_TIMED(MPI_Allgather,
             (const void* from, int n, MPI_Datatype type, void* to, int m, MPI_Datatype other, MPI_Comm all),
             (from, n, type, to, m, other, all))
STRAKE_TIMED(MPI_Allgatherv,
             (const void* from, int n, MPI_Datatype type, void* to, const int* counts, const int* at,
              MPI_Datatype other, MPI_Comm all),
             (from, n, type, to, counts, at, other, all))
STRAKE_TIMED(MPI_Alltoall,
             (const void* from, int n, MPI_Datatype type, void* to, int m, MPI_Datatype other, MPI_Comm all),
             (from, n, type, to, m, other, all))
STRAKE_TIMED(MPI_Comm_create, (MPI_Comm all, MPI_Group group, MPI_Comm* made), (all, group, made))
STRAKE_TIMED(MPI_Comm_split, (MPI_Comm all, int colour, int key, MPI_Comm* made), (all, colour, key, made))

int MPI_Finalize() {
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (const char* file = std::getenv("STRAKE_MESSAGE_TIME"))
    std::ofstream(file + ("." + std::to_string(rank))) << seconds << "\n";
  return PMPI_Finalize();
}

}  // extern "C"
