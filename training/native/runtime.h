// C interface through which training measures what it ships on the daemon's own run time: the
// network of pipeline/network and the solvers of pipeline/solver.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bevloc_network bevloc_network;
typedef struct bevloc_solver bevloc_solver;

/// Loads a model file. On failure: null, and the reason in `error` (`error_size` bytes at most).
bevloc_network* bevloc_network_create(const char* model, int threads, char* error, int error_size);
void bevloc_network_destroy(bevloc_network* network);

/// One sample as sampler.h describes it -> bev and map float [16, 100, 50], mask float (logits)
/// [3, 400, 200].
void bevloc_network_run(bevloc_network* network, const uint8_t* images, uint8_t camera_mask,
                        const uint8_t* raster, float* bev, float* map, float* mask);

/// The solver named `kind` (pipeline/solver/solver_factory.h) with the parameters of the network's
/// model, on the paper's hypotheses. On failure as above.
bevloc_solver* bevloc_solver_create(const bevloc_network* network, const char* kind, char* error,
                                    int error_size);
void bevloc_solver_destroy(bevloc_solver* solver);

/// bev, map: float [16, 100, 50] -> correction [3] (x m, y m, yaw rad), its standard deviations [3]
/// and the probabilities of x, y and yaw side by side [21 + 11 + 21].
void bevloc_solver_solve(bevloc_solver* solver, const float* bev, const float* map,
                         float* correction, float* deviation, float* probabilities);

#ifdef __cplusplus
}
#endif
