// Parses OpenDRIVE files.
#pragma once

#include <string>
#include <string_view>

#include "common/result.h"
#include "pipeline/map/formats/opendrive/road.h"

namespace bevloc::opendrive {

/// Parses the roads of an OpenDRIVE file of version 1.4 to 1.7. Fails with file and line on text
/// that is not OpenDRIVE XML, on missing or bad numbers, on a road without geometry or lane
/// section, on kinds of geometry that do not exist, and on lengths that no road has. Bad numbers of
/// an object that is no crosswalk are no failure: RoadObject::fault names the first one.
Result<Document> parse_document(std::string_view text, std::string file);

}  // namespace bevloc::opendrive
