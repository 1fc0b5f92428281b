// C interface to the daemon's network (pipeline/network) and solvers (pipeline/solver), with which
// training measures exported models. Used by training/runtime.py. Handles are not thread-safe.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bevloc_network bevloc_network;
typedef struct bevloc_solver bevloc_solver;

/// Loads a model file; bevloc_network_destroy() frees the result. On failure returns null and
/// writes the reason to `error` (at most `error_size` bytes, zero-terminated).
bevloc_network* bevloc_network_create(const char* model, int threads, char* error, int error_size);
void bevloc_network_destroy(bevloc_network* network);

/// Runs the network on one sample (images, index, weight and raster as in sample_record.h). Writes
/// bev and map, float [16, 100, 50] each, and mask, float logits [3, 400, 200].
void bevloc_network_run(bevloc_network* network, const uint8_t* images, const int32_t* index,
                        const float* weight, const uint8_t* raster, float* bev, float* map,
                        float* mask);

/// Makes the solver named `kind` (pipeline/solver/solver_factory.h) with the parameters of the
/// network's model, for the paper's hypotheses; bevloc_solver_destroy() frees it. It does not refer
/// to the network afterwards. On failure it returns null and the reason, as
/// bevloc_network_create() does.
bevloc_solver* bevloc_solver_create(const bevloc_network* network, const char* kind, char* error,
                                    int error_size);
void bevloc_solver_destroy(bevloc_solver* solver);

/// Solves for bev and map, float [16, 100, 50] each. Writes the correction [3] (x m, y m, yaw rad),
/// its standard deviations [3], the distributions of x, y and yaw, concatenated [21 + 11 + 21], and
/// the score [1].
void bevloc_solver_solve(bevloc_solver* solver, const float* bev, const float* map,
                         float* correction, float* deviation, float* probabilities, float* score);

#ifdef __cplusplus
}
#endif
