/* An FMU for the tests: a mass m on a spring k and a damper c, whose other end is the attachment point.
 *
 *   m x'' = -F,   F = k (x - u) + c (x' - w)     F acts on the point, which has moved by u with the velocity w
 *
 * Runge-Kutta steps of the fourth order, no longer than `longest`. It keeps to the rules of FMI 3.0: outputs are
 * not read after inputs were set, until fmi3DoStep. `fault` makes it misbehave on purpose (enum fault below). */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum status { OK, WARNING, DISCARD, ERROR, FATAL };
enum fault { NO_FAULT, STEP_ERROR, STEP_FATAL, DISCARDS_LONG, TERMINATES, RETURNS_EARLY, WARNS, GIVES_NAN, REFUSES_INIT };
enum variable { U = 1, W, F, X, V, M, K, C, LONGEST, FAULT, RESOURCES };
enum { ENTRIES = 16 };
enum mode { INSTANTIATED, INITIALIZATION, STEP };

typedef void (*log_message)(void*, int, const char*, const char*);
typedef struct {
  double value[ENTRIES]; /* by variable; RESOURCES: 1 if a path was given that ends with '/' */
  int32_t fault;
  double time;
} state;
typedef struct {
  state now;
  enum mode mode;
  bool dirty; /* inputs were set since the last step */
  void* environment;
  log_message log;
  void* kept; /* the state given out last */
} instance;

static instance* volatile lost; /* nobody frees it; a leak checker finds it here */
static const char token[] = "{oscillator-1}";

static int say(instance* self, int status, const char* message) {
  if (self->log) self->log(self->environment, status, "logStatusError", message);
  return status;
}

static void derivative(const double* p, const double* y, double* dy) {
  dy[0] = y[1];
  dy[1] = -(p[K] * (y[0] - p[U]) + p[C] * (y[1] - p[W])) / p[M];
}

static void advance(double* p, double h) {
  double y[2] = {p[X], p[V]}, k[4][2], at[2];
  const double node[4] = {0, 0.5, 0.5, 1};
  for (int stage = 0; stage < 4; ++stage) {
    for (int i = 0; i < 2; ++i) at[i] = y[i] + (stage ? node[stage] * h * k[stage - 1][i] : 0);
    derivative(p, at, k[stage]);
  }
  for (int i = 0; i < 2; ++i) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  p[X] = y[0];
  p[V] = y[1];
}

void* fmi3InstantiateCoSimulation(const char* name, const char* given, const char* resources, bool visible, bool logging,
                                  bool event_mode, bool early_return, const uint32_t* intermediate, size_t n,
                                  void* environment, log_message log, void* update) {
  (void)name, (void)visible, (void)logging, (void)early_return, (void)intermediate, (void)n, (void)update;
  if (strcmp(given, token) != 0 || event_mode) {
    if (log) log(environment, ERROR, "logStatusError", "the token of modelDescription.xml is not mine");
    return NULL;
  }
  instance* self = calloc(1, sizeof *self);
  if (!self) return NULL;
  self->environment = environment;
  self->log = log;
  self->now.value[M] = self->now.value[K] = 1;
  self->now.value[LONGEST] = 1e-3;
  self->now.value[RESOURCES] = resources && resources[0] == '/' && resources[strlen(resources) - 1] == '/';
  return self;
}
void fmi3FreeInstance(void* it) { free(it); }

int fmi3EnterInitializationMode(void* it, bool tolerance, double size, double start, bool stop, double end) {
  (void)tolerance, (void)size, (void)stop, (void)end;
  instance* self = it;
  if (self->now.fault == REFUSES_INIT) return say(self, ERROR, "no state of rest");
  self->now.time = start;
  self->mode = INITIALIZATION;
  return OK;
}
int fmi3ExitInitializationMode(void* it) {
  ((instance*)it)->mode = STEP;
  return OK;
}
int fmi3Terminate(void* it) {
  return ((instance*)it)->mode == STEP ? OK : ERROR;
}

int fmi3DoStep(void* it, double t, double h, bool no_state, bool* event, bool* ends, bool* early, double* reached) {
  (void)no_state;
  instance* self = it;
  *event = *ends = *early = false;
  if (self->mode != STEP || !(h > 0) || fabs(t - self->now.time) > 1e-6 * h) return say(self, ERROR, "a step from another time");
  switch (self->now.fault) {
    case STEP_ERROR: return say(self, ERROR, "the spring broke\nat its end");
    case STEP_FATAL: lost = self; return say(self, FATAL, "out of order");
    case DISCARDS_LONG:
      if (h > 0.6e-3) return say(self, DISCARD, "a step longer than 0.6 ms");
      break;
    case TERMINATES: *ends = true; break;
    case RETURNS_EARLY:
      *early = true;
      *reached = t + 0.5 * h;
      return OK;
    default: break;
  }
  double* p = self->now.value;
  const int n = (int)ceil(h / p[LONGEST] * (1 - 1e-9));
  for (int i = 0; i < n; ++i) advance(p, h / n);
  self->now.time = *reached = t + h;
  self->dirty = false;
  return self->now.fault == WARNS ? say(self, WARNING, "the spring is stretched") : OK;
}

int fmi3SetFloat64(void* it, const uint32_t* reference, size_t n, const double* value, size_t m) {
  instance* self = it;
  if (n != m) return say(self, ERROR, "as many values as references");
  for (size_t i = 0; i < n; ++i) {
    const bool input = reference[i] == U || reference[i] == W;
    if (!input && self->mode != INSTANTIATED) return say(self, ERROR, "this variable is fixed now");
    if (reference[i] >= ENTRIES) return say(self, ERROR, "no such variable");
    self->now.value[reference[i]] = value[i];
    if (self->mode == STEP) self->dirty = true;
  }
  return OK;
}
int fmi3GetFloat64(void* it, const uint32_t* reference, size_t n, double* value, size_t m) {
  instance* self = it;
  const double* p = self->now.value;
  if (n != m) return say(self, ERROR, "as many values as references");
  if (self->dirty) return say(self, ERROR, "outputs are read before the step");
  for (size_t i = 0; i < n; ++i) {
    if (reference[i] >= ENTRIES) return say(self, ERROR, "no such variable");
    value[i] = p[reference[i]];
    if (reference[i] == F) value[i] = p[K] * (p[X] - p[U]) + p[C] * (p[V] - p[W]);
    if (reference[i] == F && self->now.fault == GIVES_NAN) value[i] = NAN;
  }
  return OK;
}
int fmi3SetInt32(void* it, const uint32_t* reference, size_t n, const int32_t* value, size_t m) {
  if (n != 1 || m != 1 || reference[0] != FAULT) return say(it, ERROR, "no such variable");
  ((instance*)it)->now.fault = value[0];
  return OK;
}

int fmi3GetFMUState(void* it, void** kept) {
  if (!*kept) *kept = malloc(sizeof(state));
  if (!*kept) return ERROR;
  memcpy(*kept, &((instance*)it)->now, sizeof(state));
  ((instance*)it)->kept = *kept;
  return OK;
}
int fmi3SetFMUState(void* it, void* kept) {
  memcpy(&((instance*)it)->now, kept, sizeof(state));
  ((instance*)it)->dirty = false;
  return OK;
}
int fmi3FreeFMUState(void* it, void** kept) {
  (void)it;
  free(*kept);
  *kept = NULL;
  return OK;
}
int fmi3SerializedFMUStateSize(void* it, void* kept, size_t* size) {
  (void)it, (void)kept;
  *size = sizeof(state);
  return OK;
}
int fmi3SerializeFMUState(void* it, void* kept, uint8_t* bytes, size_t size) {
  if (size != sizeof(state)) return say(it, ERROR, "another size");
  memcpy(bytes, kept, size);
  return OK;
}
int fmi3DeserializeFMUState(void* it, const uint8_t* bytes, size_t size, void** kept) {
  if (size != sizeof(state)) return say(it, ERROR, "another size");
  *kept = malloc(sizeof(state));
  if (!*kept) return ERROR;
  memcpy(*kept, bytes, size);
  return OK;
}
