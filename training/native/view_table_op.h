// C interface to the daemon's view table (pipeline/network/view/view_table.h) for training's tests
// and tools. Used by training/data.py.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Writes the view table of the simulator's own rig for the cameras in `camera_mask`, which expose
/// at the same time: index int32 [8, 5000], weight float [8, 5000].
void bevloc_view_table(uint8_t camera_mask, int32_t* index, float* weight);

#ifdef __cplusplus
}
#endif
