/* dummy.cpp in C. */
#include <precice/preciceC.h>
#include <stdio.h>
#include <string.h>

/* dummy_c One|Two CONFIG */
int main(int argc, char** argv) {
  char mesh[64], own[64];
  const char* other;
  const double positions[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
  double values[9] = {0};
  int ids[3], steps = 0, i;
  if (argc < 3) return 2;
  snprintf(mesh, sizeof mesh, "%s-Mesh", argv[1]);
  snprintf(own, sizeof own, "Data-%s", argv[1]);
  other = strcmp(argv[1], "One") == 0 ? "Data-Two" : "Data-One";
  precicec_createParticipant(argv[1], argv[2], 0, 1);
  precicec_setMeshVertices(mesh, 3, positions, ids);
  precicec_initialize();
  while (precicec_isCouplingOngoing()) {
    double dt;
    if (precicec_requiresWritingCheckpoint()) puts("saves");
    dt = precicec_getMaxTimeStepSize();
    precicec_readData(mesh, other, 3, ids, dt, values);
    ++steps;
    for (i = 0; i < 9; ++i) values[i] += 1;
    if (argc > 3 && steps == 5) precicec_advance(-1.0); /* ends the process */
    precicec_writeData(mesh, own, 3, ids, values);
    precicec_advance(dt);
    puts(precicec_requiresReadingCheckpoint() ? "goes back" : "goes on");
  }
  precicec_finalize();
  printf("%d steps, last value %g\n", steps, values[8]);
  return 0;
}
