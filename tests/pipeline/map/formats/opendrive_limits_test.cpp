// OpenDRIVE files that are too large.
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/map_format.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

/// What refuses a straight road of 50 km with these lane sections.
std::string refusal_of_sections(std::string_view sections) {
  const auto map = parse_imported(fmt::format(R"(<OpenDRIVE><header revMajor="1"/>
<road id="7" length="50000" junction="-1"><planView>
<geometry s="0" x="0" y="0" hdg="0" length="50000"><line/></geometry></planView>
<lanes>{}</lanes></road></OpenDRIVE>)",
                                              sections),
                                  "large.xodr", {});
  return map ? "" : map.error().message;
}

/// A centre lane and lanes on its right.
std::string right_lanes(int count) {
  std::string lanes = R"(<center><lane id="0"/></center><right>)";
  for (int i = 1; i <= count; ++i) lanes += fmt::format(R"(<lane id="{}" type="driving"/>)", -i);
  return lanes + "</right>";
}

TEST(OpendriveLimits, SayWhatToDoAboutTooManyPoints) {
  // 2 points for each metre of 101 lanes
  EXPECT_THAT(refusal_of_sections("<laneSection s=\"0\">" + right_lanes(100) + "</laneSection>"),
              HasSubstr("large.xodr:2: road 7: found 10100000 points of lanes up to this road, "
                        "wanted at most 10000000; cut the map into several files"));
}

TEST(OpendriveLimits, SayWhatToDoAboutTooManyLanesOfTheOtherSide) {
  std::string sections = "<laneSection s=\"0\">" + right_lanes(1000) + "</laneSection>";
  for (int i = 1; i <= 1000; ++i) {
    sections += fmt::format(R"(<laneSection s="{}" singleSide="true"><left><lane id="1"/></left>
<center><lane id="0"/></center></laneSection>)",
                            i);
  }
  EXPECT_THAT(refusal_of_sections(sections),
              HasSubstr("found 1001000 lanes beside sections with singleSide, wanted at most "
                        "1000000 in the file; write both sides into one section"));
}

}  // namespace
}  // namespace bevloc
