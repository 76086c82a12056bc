/* A library with the C functions of preCICE 3 that couples with nobody: three windows of two iterations each. Read values
   are RECORDER_VALUE, else zero. It prints every call that changes something. Its finalize never returns in a window, as preCICE's may. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const double window = 5e-4;
static double left = 5e-4;
static int windows = 0, iteration = 1, write_checkpoint = 1, read_checkpoint = 0, complete = 0, vertices = 0;

const char* precicec_getVersionInformation(void) { return "3.1.2;revision=none;MPI:OFF"; }
void precicec_createParticipant(const char* name, const char* config, int rank, int size) {
  setvbuf(stdout, 0, _IOLBF, 0);
  printf("create %s %s %d %d\n", name, config, rank, size);
}
int precicec_requiresMeshConnectivityFor(const char* mesh) {
  (void)mesh;
  return 1;
}
void precicec_setMeshVertices(const char* mesh, int size, const double* positions, int* ids) {
  (void)positions;
  for (int i = 0; i < size; ++i) ids[i] = size - 1 - i; /* any numbers, as preCICE may give */
  vertices = size;
  printf("%s: %d vertices\n", mesh, size);
}
void precicec_setMeshEdges(const char* mesh, int size, const int* ids) { printf("%s: %d edges from %d\n", mesh, size, ids[0]); }
void precicec_setMeshTriangles(const char* mesh, int size, const int* ids) {
  printf("%s: %d triangles from %d\n", mesh, size, ids[0]);
}
int precicec_requiresInitialData(void) { return 1; }
void precicec_initialize(void) { printf("initialize\n"); }
int precicec_isCouplingOngoing(void) { return windows < 3; }
int precicec_isTimeWindowComplete(void) { return complete; }
double precicec_getMaxTimeStepSize(void) { return left; }
int precicec_requiresWritingCheckpoint(void) {
  if (write_checkpoint) printf("checkpoint\n");
  return write_checkpoint;
}
int precicec_requiresReadingCheckpoint(void) {
  if (read_checkpoint) printf("rewind\n");
  return read_checkpoint;
}
void precicec_readData(const char* mesh, const char* data, int size, const int* ids, double time, double* values) {
  (void)mesh, (void)ids;
  const char* given = getenv("RECORDER_VALUE");
  for (int i = 0; i < 2 * size; ++i) values[i] = given ? atof(given) : 0;
  printf("read %s at %g%s\n", data, time, size == vertices ? "" : ", not at all points");
}
void precicec_writeData(const char* mesh, const char* data, int size, const int* ids, const double* values) {
  (void)mesh, (void)ids;
  double sum = 0;
  for (int i = 0; i < 2 * size; ++i) sum += values[i];
  printf("write %s %.17g\n", data, sum);
}
void precicec_advance(double dt) {
  printf("advance %g\n", dt);
  left -= dt;
  write_checkpoint = read_checkpoint = complete = 0;
  if (left > 1e-12) return;
  left = window;
  if (iteration == 1) {
    iteration = 2;
    read_checkpoint = 1;
    return;
  }
  iteration = complete = write_checkpoint = 1;
  ++windows;
}
void precicec_finalize(void) {
  printf("finalize\n");
  if (windows < 3) sleep(1000);
}
