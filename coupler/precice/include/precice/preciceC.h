#pragma once

#include <precice/Version.h>
#include <precice/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The functions of precice::Participant for C, with the same arrays and units; one participant a process.
   Names end with a zero. `size` is the number of points, edges, triangles and so on. A yes is 1, a no 0. A
   call that cannot be carried out ends the process, with the reason on standard error and at the coupler. */
PRECICE_API void precicec_createParticipant(const char* name, const char* config, int rank, int size);
PRECICE_API void precicec_createParticipant_withCommunicator(const char* name, const char* config, int rank,
                                                             int size, void* communicator);
PRECICE_API void precicec_initialize(void);
PRECICE_API void precicec_advance(double dt);
PRECICE_API void precicec_finalize(void);
PRECICE_API int precicec_isCouplingOngoing(void);
PRECICE_API int precicec_isTimeWindowComplete(void);
PRECICE_API double precicec_getMaxTimeStepSize(void);
PRECICE_API int precicec_requiresInitialData(void);
PRECICE_API int precicec_requiresWritingCheckpoint(void);
PRECICE_API int precicec_requiresReadingCheckpoint(void);
PRECICE_API int precicec_getMeshDimensions(const char* mesh);
PRECICE_API int precicec_getDataDimensions(const char* mesh, const char* data);
PRECICE_API int precicec_requiresMeshConnectivityFor(const char* mesh);
PRECICE_API void precicec_resetMesh(const char* mesh);
PRECICE_API int precicec_setMeshVertex(const char* mesh, const double* position);
PRECICE_API int precicec_getMeshVertexSize(const char* mesh);
PRECICE_API void precicec_setMeshVertices(const char* mesh, int size, const double* positions, int* ids);
PRECICE_API void precicec_setMeshEdge(const char* mesh, int first, int second);
PRECICE_API void precicec_setMeshEdges(const char* mesh, int size, const int* ids);
PRECICE_API void precicec_setMeshTriangle(const char* mesh, int first, int second, int third);
PRECICE_API void precicec_setMeshTriangles(const char* mesh, int size, const int* ids);
PRECICE_API void precicec_setMeshQuad(const char* mesh, int first, int second, int third, int fourth);
PRECICE_API void precicec_setMeshQuads(const char* mesh, int size, const int* ids);
PRECICE_API void precicec_setMeshTetrahedron(const char* mesh, int first, int second, int third, int fourth);
PRECICE_API void precicec_setMeshTetrahedra(const char* mesh, int size, const int* ids);
PRECICE_API void precicec_writeData(const char* mesh, const char* data, int size, const int* ids,
                                    const double* values);
PRECICE_API void precicec_readData(const char* mesh, const char* data, int size, const int* ids,
                                   double relative_time, double* values);
PRECICE_API void precicec_writeAndMapData(const char* mesh, const char* data, int size,
                                          const double* coordinates, const double* values);
PRECICE_API void precicec_mapAndReadData(const char* mesh, const char* data, int size,
                                         const double* coordinates, double relative_time, double* values);
PRECICE_API void precicec_setMeshAccessRegion(const char* mesh, const double* box);
PRECICE_API void precicec_getMeshVertexIDsAndCoordinates(const char* mesh, int size, int* ids,
                                                         double* coordinates);
PRECICE_API int precicec_requiresGradientDataFor(const char* mesh, const char* data);
PRECICE_API void precicec_writeGradientData(const char* mesh, const char* data, int size, const int* ids,
                                            const double* gradients);
PRECICE_API void precicec_startProfilingSection(const char* name);
PRECICE_API void precicec_stopLastProfilingSection(void);
PRECICE_API const char* precicec_getVersionInformation(void);

#ifdef __cplusplus
}
#endif
