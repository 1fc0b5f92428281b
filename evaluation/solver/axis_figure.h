// The data of the paper's Fig. 4: axis features, and the scores that axis matching gives them.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {

/// Three channels of hand-made features: of the map at the true pose, of the perceived mask, and of
/// the perceived mask moved by `shift_m` along x and y.
///
///     channels      names
///     shift_m
///     x_m, y_m      the positions of the profiles
///     hypotheses_m
///     map           {features: [channel][row][column], x_profile: [channel][position], y_profile}
///     perceived     two times the same with {x_score, y_score: [hypothesis]}: in place, moved
///
/// Features are those before standardisation. A profile is the axis features less their mean.
nlohmann::json axis_figure(const sim::MatchingScene& scene);

}  // namespace bevloc::evaluation
