#include "pipeline/online_calibration/extrinsic_filter.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/pipeline/online_calibration/demo_cells.h"

namespace bevloc {
namespace {

struct Learned {
  ExtrinsicErrors errors;
  ExtrinsicErrors sigmas;
};

/// Shows the road with `errors` many times, and applies what was learned each time.
Learned learn(const ExtrinsicErrors& errors, int matches = 25) {
  DemoCells cells;
  ExtrinsicSums sums(kFeatureGrid);
  ExtrinsicFilter filter(cells.rig());
  ExtrinsicInformation information;
  for (int i = 0; i < matches; ++i) {
    const ExtrinsicErrors used = filter.errors();
    cells.show(errors - used);
    sums.compute(cells.match(), information);
    filter.update(information, used, 0.4);
  }
  return {filter.errors(), filter.covariance().diagonal().cwiseSqrt()};
}

TEST(ExtrinsicFilter, FindsTheTurnOfOneCamera) {
  for (const int camera : {1, 4}) {
    for (const int axis : {0, 2}) {
      const ExtrinsicErrors errors = error_of(camera, axis, radians(0.4));
      const Learned learned = learn(errors, 40);
      const int wrong = camera * kErrorsPerCamera + axis;
      // Roll shows less than pitch, so the initial covariance holds it back longer.
      EXPECT_NEAR(degrees(learned.errors(wrong)), 0.4, axis == 0 ? 0.1 : 0.16)
          << kCameraNames[camera] << ", axis " << axis;
    }
  }
}

TEST(ExtrinsicFilter, FindsNothingWhereNothingIsWrong) {
  const Learned learned = learn(ExtrinsicErrors::Zero());
  for (int error = 0; error < kExtrinsicErrors; ++error) {
    EXPECT_LT(std::abs(learned.errors(error)), 0.7 * learned.sigmas(error)) << error;
  }
}

TEST(ExtrinsicFilter, SigmasFallWithEachMatchAndGrowWithTime) {
  EXPECT_LT(learn(ExtrinsicErrors::Zero(), 20).sigmas(0),
            learn(ExtrinsicErrors::Zero(), 5).sigmas(0));
  ExtrinsicFilter filter(demo_network_rig());
  const double before = filter.covariance()(0, 0);
  filter.update({}, ExtrinsicErrors::Zero(), 3600.0);
  EXPECT_GT(filter.covariance()(0, 0), before);
}

TEST(ExtrinsicFilter, RestoresWhatIsPossibleOnly) {
  const Learned learned = learn(error_of(1, 0, radians(0.4)));
  ExtrinsicFilter filter(demo_network_rig());
  const ExtrinsicCovariance covariance = ExtrinsicCovariance::Identity() * 1e-6;
  ExtrinsicErrors broken = learned.errors;
  broken(3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(filter.restore(broken, covariance));
  EXPECT_FALSE(filter.restore(learned.errors, -covariance));
  EXPECT_EQ(filter.errors(), ExtrinsicErrors::Zero());
  EXPECT_TRUE(filter.restore(learned.errors, covariance));
  EXPECT_EQ(filter.errors(), learned.errors);
}

}  // namespace
}  // namespace bevloc
