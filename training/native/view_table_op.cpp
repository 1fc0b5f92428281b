#include "training/native/view_table_op.h"

#include <algorithm>

#include "pipeline/network/view/view_table.h"
#include "sim/samples/sample_maker.h"

void bevloc_view_table(uint8_t camera_mask, int32_t* index, float* weight) {
  const bevloc::ViewTable table = bevloc::make_view_table(
      bevloc::sim::nominal_network_rig(), bevloc::CameraMask(camera_mask), bevloc::kFeatureGrid);
  std::copy(table.index.begin(), table.index.end(), index);
  std::copy(table.weight.begin(), table.weight.end(), weight);
}
