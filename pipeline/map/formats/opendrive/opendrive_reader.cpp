#include "pipeline/map/formats/opendrive/opendrive_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "pipeline/map/formats/opendrive/asphalt.h"
#include "pipeline/map/formats/opendrive/document.h"
#include "pipeline/map/formats/opendrive/section_lines.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/line_neighbours.h"
#include "pipeline/map/map_check.h"

namespace bevloc {
namespace {

namespace od = opendrive;

/// Vehicles do not drive on lanes that are narrower than this everywhere.
constexpr double kNarrowLane_m = 1.5;
/// Points this close to a line are left out of it.
constexpr double kTolerance_m = 0.01;
/// Maps of a UTM zone are nearer than this to its meridian.
constexpr double kFarFromMeridian_m = 400'000.0;
/// Maps of a country that uses one zone everywhere are nearer than this to its meridian.
constexpr double kFarthestFromMeridian_m = 1'000'000.0;
/// This is more points than any map has (200 bytes each).
constexpr size_t kMostPoints = 10'000'000;
/// This is more repeated crossings than any map has.
constexpr size_t kMostCopiesInAll = 100'000;

std::optional<Meaning> meaning_of_mark_type(std::string_view type) {
  using Look = Appearance;
  struct Row {
    std::string_view type;
    ElementClass element_class;
    Look appearance;
  };
  constexpr auto kDivider = ElementClass::kLaneDivider;
  constexpr auto kBoundary = ElementClass::kRoadBoundary;
  static constexpr std::array kRows{
      Row{"solid", kDivider, Look::kSolid},
      Row{"broken", kDivider, Look::kDashed},
      Row{"solid solid", kDivider, Look::kDoubleSolid},
      Row{"solid broken", kDivider, Look::kSolid},
      Row{"broken solid", kDivider, Look::kSolid},
      Row{"broken broken", kDivider, Look::kDashed},
      Row{"botts dots", kDivider, Look::kDashed},
      Row{"custom", kDivider, Look::kUnknown},
      Row{"curb", kBoundary, Look::kKerb},
      Row{"grass", kBoundary, Look::kRoadEdge},
      Row{"edge", kBoundary, Look::kRoadEdge},
  };
  const auto row = std::ranges::find(kRows, type, &Row::type);
  if (row == kRows.end()) return std::nullopt;
  return Meaning{row->element_class, row->appearance};
}

/// Lines of one class this close, along nearly all of a line, are the same line.
constexpr double kSameBorder_m = 0.05;
constexpr double kSameBorderShare = 0.95;

/// The lines that were taken, by class.
using TakenLines = std::array<LineNeighbours, 3>;

/// Collects consecutive pieces of one border that are of the same kind, and adds them as lines.
class BorderRun {
 public:
  BorderRun(MapBuilder& builder, TakenLines& taken, std::string where)
      : builder_(builder), taken_(taken), where_(std::move(where)) {}
  ~BorderRun() { flush(); }
  BorderRun(const BorderRun&) = delete;
  BorderRun& operator=(const BorderRun&) = delete;

  void add(const std::string& kind, const std::optional<Meaning>& meaning, std::string_view why,
           const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const bool goes_on = !line_.empty() && (from - line_.back()).head<2>().norm() <= kTolerance_m;
    if (!goes_on || kind != kind_ || meaning != meaning_ || why != why_) {
      flush();
      kind_ = kind;
      meaning_ = meaning;
      why_ = why;
      line_ = {from};
    }
    line_.push_back(to);
  }

  void flush() {
    if (line_.size() > 1) add_line(simplified(line_, kTolerance_m));
    line_.clear();
    kind_.clear();
  }

 private:
  /// Adds a line unless another road has the same one. The roads of a junction repeat each other's
  /// lines.
  void add_line(const Line3& line) {
    const auto meaning = builder_.meaning_of(kind_, meaning_);
    // finish() drops longer lines.
    if (meaning && length_of(line) <= kLongestPolylineM) {
      LineNeighbours& taken = taken_[static_cast<size_t>(meaning->element_class)];
      Polyline points;
      for (const Eigen::Vector3d& point : line) points.emplace_back(point.head<2>());
      const auto any = [](int64_t) { return true; };
      if (taken.share_beside(points, kSameBorder_m, any) >= kSameBorderShare) {
        builder_.drop(kind_, where_, "another road has the same line", length_of(line));
        return;
      }
      taken.add(0, points);
    }
    builder_.add(kind_, where_, meaning_, why_, line);
  }

  MapBuilder& builder_;
  TakenLines& taken_;
  std::string where_;
  std::string kind_;
  std::optional<Meaning> meaning_;
  std::string_view why_;
  Line3 line_;
};

class OpendriveReader {
 public:
  OpendriveReader(const od::Document& document, const ImportOptions& options)
      : document_(document), builder_(document.file, options) {}

  Status read() {
    size_t points = 0;
    for (size_t r = 0; r < document_.roads.size(); ++r) {
      const od::Road& road = document_.roads[r];
      for (std::string& fault : od::faults_of(road, document_.file)) {
        builder_.leave_out(std::move(fault));
      }
      for (const od::LaneSection& section : road.sections) {
        const double length_m = section.end_m - section.start_m;
        points += static_cast<size_t>(std::max(2.0, 2.0 * length_m)) * section.lanes.size();
        if (points > kMostPoints) {
          return fail(
              "{}:{}: road {}: found {} points of lanes up to this road, wanted at most {}; cut "
              "the map into several files",
              document_.file, road.line, road.id, points, kMostPoints);
        }
        for (const od::Stretch& stretch : road.stretches) {
          const od::Stretch part = od::part_of(section, stretch);
          if (part.end_m - part.start_m < kTolerance_m) continue;
          sections_.push_back({&road, r, &section, od::lines_of(road, section, part)});
        }
      }
    }
    asphalt_.emplace(sections_);
    for (const od::CutSection& cut : sections_) {
      add_borders(cut);
      add_lanes(cut);
    }
    link_successors(builder_.lanes());
    for (const od::Road& road : document_.roads) {
      for (const od::RoadObject& object : road.objects) {
        if (Status status = add_object(road, object); !status) return status;
      }
    }
    return {};
  }

  Result<ImportedMap> finish(const std::string& name, const ImportOptions& options) {
    std::unique_ptr<Projection> projection;
    const bool has_reference =
        document_.georeference.find_first_not_of(" \t\r\n") != std::string::npos;
    if (has_reference && !options.origin) {
      auto read = read_projection();
      if (!read) {
        // bevloc refuses an origin for coordinates that are far from (0, 0).
        const bool may_have_origin = is_near_origin(builder_.middle());
        return fail(
            "{}:{}: <geoReference>: {}; {}delete the geoReference, and the map has no place on "
            "earth",
            document_.file, document_.georeference_line, read.error().message,
            may_have_origin ? "--origin LATITUDE,LONGITUDE takes its place; or " : "");
      }
      projection = std::move(*read);
    }
    return builder_.finish(name, std::move(projection));
  }

 private:
  /// The plane of the file's coordinates, or null if the geoReference names none. The error says
  /// what is wrong, without a place.
  Result<std::unique_ptr<Projection>> read_projection() {
    auto read = projection_from_proj(document_.georeference);
    if (!read) return read;
    if (!*read) {
      builder_.remark("the geoReference is longlat, which does not define a plane in metres");
      return nullptr;
    }
    const Eigen::Vector2d middle =
        Eigen::Rotation2Dd(document_.offset_heading_rad) * builder_.middle() + document_.offset;
    const double apart_m = (*read)->distance_from_meridian_m(middle);
    if (!builder_.is_empty() && apart_m > kFarFromMeridian_m) {
      const std::string found = fmt::format(
          "the middle of the map at ({:.0f}, {:.0f}) m, which is {:.0f} km from the "
          "meridian of the projection",
          middle.x(), middle.y(), apart_m / 1000.0);
      if (is_near_origin(middle) || apart_m > kFarthestFromMeridian_m) {
        return fail(
            "found {}, wanted at most {:g} km; add the missing <offset>, or correct the "
            "geoReference",
            found, kFarFromMeridian_m / 1000.0);
      }
      builder_.remark("the geoReference puts " + found + "; look whether that is right");
    }
    return moved_projection(std::move(*read), document_.offset, document_.offset_heading_rad);
  }

  void add_borders(const od::CutSection& cut) {
    const auto& lanes = cut.section->lanes;
    for (size_t border = 0; border <= lanes.size(); ++border) {
      // The centre has two borders at the same place; its left one stands for both.
      if (border < lanes.size() && lanes[border].id == 0) continue;
      const bool is_right = border < lanes.size() && lanes[border].id < 0;
      const od::LaneSpec& owner = is_right ? lanes[border] : lanes[border - 1];
      BorderRun run(builder_, taken_,
                    fmt::format("road {} lane {} (line {})", cut.road->id, owner.id, owner.line));
      for (size_t piece = 0; piece + 1 < cut.lines.along_m.size(); ++piece) {
        const size_t own = is_right ? border : border - 1;
        if (owner.id != 0 && cut.width_m(own, piece) <= od::kNoWidth_m) {
          run.flush();
          continue;
        }
        add_piece(cut, border, owner, piece, run);
      }
    }
  }

  void add_piece(const od::CutSection& cut, size_t border, const od::LaneSpec& owner, size_t piece,
                 BorderRun& run) {
    const Eigen::Vector3d& from = cut.lines.borders[border][piece];
    const Eigen::Vector3d& to = cut.lines.borders[border][piece + 1];
    const std::string left = cut.type_from(static_cast<std::ptrdiff_t>(border), 1, piece);
    const std::string right = cut.type_from(static_cast<std::ptrdiff_t>(border) - 1, -1, piece);
    const double middle_m = 0.5 * (cut.lines.along_m[piece] + cut.lines.along_m[piece + 1]);
    const od::RoadMark* mark = od::mark_at(owner, middle_m - cut.section->start_m);
    const std::string type = mark == nullptr || mark->type.empty() ? "none" : mark->type;
    const auto of_mark = meaning_of_mark_type(type);
    const bool left_paved = od::is_paved(left);
    const bool right_paved = od::is_paved(right);
    const bool is_kerb = of_mark && of_mark->element_class == ElementClass::kRoadBoundary;
    if (left_paved != right_paved && !is_kerb) {
      const std::string& inside = left_paved ? left : right;
      const std::string& beside = left_paved ? right : left;
      const std::string kind = fmt::format("edge of {} beside {}", inside, beside);
      if (!asphalt_->continues_beside(cut, from, to, left_paved)) {
        const bool has_kerb = beside == "sidewalk" || beside == "walking" || beside == "curb";
        run.add(kind,
                Meaning{ElementClass::kRoadBoundary,
                        has_kerb ? Appearance::kKerb : Appearance::kRoadEdge},
                "", from, to);
        return;
      }
      if (!of_mark) {
        run.add(kind, std::nullopt, "the asphalt of another road continues there", from, to);
        return;
      }
    }
    if (!left_paved && !right_paved && !is_kerb) {
      run.add("border of " + left + " beside " + right, std::nullopt, "not beside asphalt", from,
              to);
      return;
    }
    const auto [paint_from, paint_to] =
        mark == nullptr ? std::pair(from, to) : cut.paint(*mark, border, piece);
    run.add("road mark " + type, of_mark, "not painted", paint_from, paint_to);
  }

  void add_lanes(const od::CutSection& cut) {
    for (size_t i = 0; i < cut.section->lanes.size(); ++i) {
      const od::LaneSpec& spec = cut.section->lanes[i];
      if (spec.id == 0 || !od::is_driven(spec.type)) continue;
      double widest_m = 0.0;
      for (size_t piece = 0; piece + 1 < cut.lines.along_m.size(); ++piece) {
        widest_m = std::max(widest_m, cut.width_m(i, piece));
      }
      if (widest_m < kNarrowLane_m) continue;
      Lane lane;
      lane.right = flat_line(cut.lines.borders[i]);
      lane.left = flat_line(cut.lines.borders[i + 1]);
      if (!can_be_lane(lane.left, lane.right)) continue;
      if ((spec.id > 0) != cut.road->drives_left) {
        std::swap(lane.left, lane.right);
        std::ranges::reverse(lane.left);
        std::ranges::reverse(lane.right);
      }
      lane.centerline = centerline_between(lane.left, lane.right);
      lane.speed_limit_mps =
          spec.speed_mps.value_or(cut.road->speed_mps.value_or(lane.speed_limit_mps));
      builder_.add_lane(std::move(lane));
    }
  }

  static Polyline flat_line(const Line3& line) {
    Polyline points;
    for (const Eigen::Vector3d& point : simplified(line, kTolerance_m)) {
      if (points.empty() || points.back() != point.head<2>()) points.emplace_back(point.head<2>());
    }
    return points;
  }

  Status add_object(const od::Road& road, const od::RoadObject& object) {
    const bool is_crossing = od::is_crosswalk(object);
    const std::string kind =
        is_crossing ? "object crosswalk" : "object " + (object.type.empty() ? "-1" : object.type);
    std::optional<Meaning> meaning;
    if (is_crossing) meaning = Meaning{ElementClass::kPedestrianCrossing, Appearance::kUnknown};
    const std::string where = fmt::format("object {} (line {})", object.id, object.line);
    if (!object.fault.empty()) {
      if (builder_.meaning_of(kind, meaning)) return fail("{}", object.fault);
      builder_.leave_out(object.fault);
      builder_.drop(kind, where, "a bad number", 0.0);
      return {};
    }
    std::vector<od::RoadObject> copies = od::copies_of(object);
    if (copies.size() > 1) copies_ += copies.size();
    if (copies.empty() || (copies.size() > 1 && copies_ > kMostCopiesInAll)) {
      leave_out(road, object,
                "a <repeat> that is not read, wanted a distance, few copies and no cornerRoad");
      copies = {object};
    }
    for (const od::RoadObject& copy : copies) {
      for (const od::Outline& outline : od::outlines_of(copy)) {
        if (is_crossing && !is_on_road(road, copy, outline.corners)) continue;
        builder_.add(kind, where, meaning, "not a line of the road",
                     od::points_of(road, copy, outline));
      }
    }
    return {};
  }

  /// Reports the corners of a crossing that lie where the road has no reference line. Returns false
  /// if all corners lie there.
  bool is_on_road(const od::Road& road, const od::RoadObject& object,
                  const std::vector<od::Corner>& outline) {
    double first_m = 0.0;
    size_t lost = 0;
    for (const od::Corner& corner : outline) {
      const double s_m = corner.is_local ? object.s_m : corner.place.x();
      if (!road.has_line_at(s_m) && lost++ == 0) first_m = s_m;
    }
    if (lost == 0) return true;
    leave_out(road, object,
              fmt::format("{} of {} corners beyond the road, first by s={:g}, wanted none", lost,
                          outline.size(), first_m));
    return lost < outline.size();
  }

  void leave_out(const od::Road& road, const od::RoadObject& object, std::string_view found) {
    builder_.leave_out(fmt::format("{}:{}: road {}: object {}: found {}", document_.file,
                                   object.line, road.id, object.id, found));
  }

  const od::Document& document_;
  MapBuilder builder_;
  TakenLines taken_;
  std::vector<od::CutSection> sections_;
  std::optional<od::Asphalt> asphalt_;
  size_t copies_ = 0;
};

}  // namespace

Result<ImportedMap> parse_opendrive(std::string_view text, const std::filesystem::path& file,
                                    const ImportOptions& options) {
  const Result<od::Document> document = od::parse_document(text, file.string());
  if (!document) return tl::unexpected(document.error());
  OpendriveReader reader(*document, options);
  if (Status status = reader.read(); !status) return tl::unexpected(status.error());
  return reader.finish(file.stem().string(), options);
}

}  // namespace bevloc
