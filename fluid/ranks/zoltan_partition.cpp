#include "fluid/ranks/zoltan_partition.hpp"

#include "proto/ranks/mpi_communicator.hpp"

#include <mpi.h>
#include <zoltan_cpp.h>

#include <string>

namespace strake::fluid {

namespace {

/// What Zoltan asks of.
struct Buckets {
  std::span<const double> centres, weights;
};

int number_of(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(static_cast<const Buckets*>(data)->weights.size());
}

void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights, int* error) {
  const auto& buckets = *static_cast<const Buckets*>(data);
  for (std::size_t b = 0; b < buckets.weights.size(); ++b) {
    global[b] = local[b] = static_cast<ZOLTAN_ID_TYPE>(b);
    weights[b] = static_cast<float>(buckets.weights[b]);
  }
  *error = ZOLTAN_OK;
}

int dimensions(void*, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void places(void* data, int, int, int count, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, int, double* place,
            int* error) {
  const auto& buckets = *static_cast<const Buckets*>(data);
  for (int k = 0; k < count; ++k)
    for (std::size_t d = 0; d < 3; ++d)
      place[3 * k + static_cast<int>(d)] = buckets.centres[3 * global[k] + d];
  *error = ZOLTAN_OK;
}

void refuse_fault(int code) {
  if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
    throw std::runtime_error("Zoltan could not divide the particles, code " + std::to_string(code));
}

}  // namespace

std::vector<double> zoltan_partition(Communicator& ranks, std::span<const double> centres,
                                     std::span<const double> weights) {
  auto* const processes = dynamic_cast<MpiCommunicator*>(&ranks);
  if (processes == nullptr) throw std::logic_error("Zoltan divides among processes of MPI");
  float version = 0;
  refuse_fault(Zoltan_Initialize(0, nullptr, &version));
  Zoltan zoltan(processes->all_ranks());
  Buckets buckets{centres, weights};
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"DEBUG_LEVEL", "0"},
                                   {"LB_METHOD", "RCB"},
                                   {"KEEP_CUTS", "1"},
                                   {"NUM_GID_ENTRIES", "1"},
                                   {"NUM_LID_ENTRIES", "1"},
                                   {"OBJ_WEIGHT_DIM", "1"},
                                   {"RETURN_LISTS", "NONE"}})
    refuse_fault(zoltan.Set_Param(key, value));
  zoltan.Set_Num_Obj_Fn(number_of, &buckets);
  zoltan.Set_Obj_List_Fn(list, &buckets);
  zoltan.Set_Num_Geom_Fn(dimensions, &buckets);
  zoltan.Set_Geom_Multi_Fn(places, &buckets);
  int changes = 0, id_entries = 0, local_entries = 0, imported = 0, exported = 0;
  ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr,
                export_local = nullptr;
  int *import_rank = nullptr, *import_part = nullptr, *export_rank = nullptr, *export_part = nullptr;
  refuse_fault(zoltan.LB_Partition(changes, id_entries, local_entries, imported, import_global, import_local,
                                   import_rank, import_part, exported, export_global, export_local,
                                   export_rank, export_part));
  std::vector<double> boxes(6 * static_cast<std::size_t>(ranks.size()));
  for (int part = 0; part < ranks.size(); ++part) {
    double* const box = boxes.data() + 6 * part;
    int axes = 0;
    refuse_fault(zoltan.RCB_Box(part, axes, box[0], box[1], box[2], box[3], box[4], box[5]));
  }
  return boxes;
}

}  // namespace strake::fluid
