#include "can/publisher/solution_fd.h"

#include <algorithm>
#include <cassert>
#include <span>

namespace bevloc::can {
namespace {

constexpr size_t kClassicHeader = header_length(FrameFormat::kClassic);

/// kParts are the status, the messages of the solution in the order of SolutionFrames, and the
/// identity.
static_assert(loc_solution::kParts.front() == &loc_status::kMessage);
static_assert(std::ranges::equal(
    kSolutionMessages, std::span(loc_solution::kParts).subspan(1, kSolutionMessages.size())));
static_assert(loc_solution::kParts.back() == &loc_identity::kMessage);

}  // namespace

Frame joined_solution(const Frame& status, const SolutionFrames& frames, const Frame& identity,
                      const BaseIds& base) {
  Frame joined = blank_frame(loc_solution::kMessage, base);
  for (size_t part = 0; part < loc_solution::kParts.size(); ++part) {
    const Frame& source = part == 0 ? status : part <= frames.size() ? frames[part - 1] : identity;
    std::ranges::copy(source.payload().subspan(kClassicHeader),
                      joined.data.begin() + loc_solution::first_byte_of(part));
  }
  return joined;
}

Frame part_of_solution(const Frame& solution, size_t part, const BaseIds& base) {
  assert(solution.length == loc_solution::kMessage.length && part < loc_solution::kParts.size());
  const Message& message = *loc_solution::kParts[part];
  Frame frame = blank_frame(message, base);
  std::ranges::copy(
      solution.payload().subspan(loc_solution::first_byte_of(part), content_length(message)),
      frame.data.begin() + kClassicHeader);
  return frame;
}

}  // namespace bevloc::can
