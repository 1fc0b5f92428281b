#include "can/e2e/e2e_state.h"

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

constexpr E2eStateParameters kParameters{.window = 5,
                                         .min_ok_init = 2,
                                         .max_error_init = 1,
                                         .min_ok_valid = 1,
                                         .max_error_valid = 2,
                                         .min_ok_invalid = 3,
                                         .max_error_invalid = 0};

class E2eStateMachineTest : public testing::Test {
 protected:
  E2eState add(E2eCheck check, int times = 1) {
    for (int i = 0; i < times; ++i) machine_.add(check);
    return machine_.state();
  }

  E2eStateMachine machine_{kParameters};
};

TEST_F(E2eStateMachineTest, NeedsEnoughGoodFramesToBecomeValid) {
  EXPECT_EQ(machine_.state(), E2eState::kNoData);
  EXPECT_EQ(add(E2eCheck::kNoNewData), E2eState::kNoData);
  EXPECT_EQ(add(E2eCheck::kError), E2eState::kNoData);
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kInit);
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kValid);
}

TEST_F(E2eStateMachineTest, StaysInInitWhileThereAreErrors) {
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kInit);
  EXPECT_EQ(add(E2eCheck::kError, 2), E2eState::kInit);
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kInit) << "two errors are too many";
  EXPECT_EQ(add(E2eCheck::kOk, 2), E2eState::kInit) << "both are still in the window";
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kValid) << "one has left it";
}

TEST_F(E2eStateMachineTest, BecomesInvalidByErrorsAndByRepetitions) {
  for (const E2eCheck bad : {E2eCheck::kError, E2eCheck::kRepeated}) {
    machine_ = E2eStateMachine(kParameters);
    EXPECT_EQ(add(E2eCheck::kOk, 5), E2eState::kValid);
    EXPECT_EQ(add(bad, 2), E2eState::kValid);
    EXPECT_EQ(add(bad), E2eState::kInvalid);
    EXPECT_EQ(add(E2eCheck::kOk, 4), E2eState::kInvalid) << "an error is still in the window";
    EXPECT_EQ(add(E2eCheck::kOk), E2eState::kValid);
  }
}

TEST_F(E2eStateMachineTest, BecomesInvalidWithoutNewFramesAndNeedsMoreToReturn) {
  EXPECT_EQ(add(E2eCheck::kOk, 2), E2eState::kValid);
  EXPECT_EQ(add(E2eCheck::kNoNewData, 4), E2eState::kValid);
  EXPECT_EQ(add(E2eCheck::kNoNewData), E2eState::kInvalid);
  EXPECT_EQ(add(E2eCheck::kOk, 2), E2eState::kInvalid);
  EXPECT_EQ(add(E2eCheck::kOk), E2eState::kValid);
}

TEST_F(E2eStateMachineTest, CountsContradictionsInItsWindow) {
  add(E2eCheck::kWrongSequence, 2);
  add(E2eCheck::kRepeated);
  EXPECT_EQ(machine_.contradictions(), 3);
  add(E2eCheck::kOk, 4);
  EXPECT_EQ(machine_.contradictions(), 1);
  machine_.clear_window();
  EXPECT_EQ(machine_.contradictions(), 0);
}

}  // namespace
}  // namespace bevloc::can
