#include "pipeline/calibration/refine/refine_rig.h"

#include <array>

namespace bevloc {
namespace {

constexpr double kPaintReach_m = 25.0;
/// A frameset is used if the vehicle has moved or turned this much since the one used before.
constexpr double kApart_m = 1.5;
constexpr double kApart_deg = 2.0;

struct Round {
  double search_rad;  ///< how far from the expected place paint and ties are searched, as an angle
  /// Factor on the sigma of where they are found (RefinementProblem::solve). Each solution halves
  /// it, from the first value to the last.
  double first_sigma_scale;
  double last_sigma_scale;
  bool uses_paint = true;
  /// Whether paint is searched where the expected tilt of the body puts it.
  bool expects_tilt = false;
};
/// A wide search also finds the paint of wrong lines. So the first round uses the ties only, which
/// need no map. With a large sigma, wrong lines change the estimate less. The body tilts by more
/// than a narrow search reaches, so the last rounds expect its tilt. They also reset the estimate
/// of each frameset and begin with a large sigma. Otherwise a frameset whose estimate was fitted to
/// a kerb would keep it. The earlier rounds do neither, because they cannot yet tell the tilt from
/// errors of the cameras.
constexpr Round kTiesOnly{
    .search_rad = 0.04, .first_sigma_scale = 8.0, .last_sigma_scale = 1.0, .uses_paint = false};
constexpr Round kLast{
    .search_rad = 0.014, .first_sigma_scale = 4.0, .last_sigma_scale = 1.0, .expects_tilt = true};
constexpr std::array<Round, 7> kRounds{
    {kTiesOnly, {0.04, 8.0, 8.0}, {0.02, 4.0, 4.0}, {0.014, 2.0, 2.0}, kLast, kLast, kLast}};

class RigRefiner {
 public:
  RigRefiner(const Rig& rig, const MapIndex& map, PictureRecording& recording,
             const RefinementOptions& options, const RefinementProgress& progress)
      : rig_(rig),
        map_(map),
        recording_(recording),
        progress_(progress),
        problem_(rig, recording.reference(), options) {}

  Result<RigRefinement> run() {
    for (const Round& round : kRounds) {
      if (Status read = look(round); !read) return tl::unexpected(read.error());
      if (framesets_ < kLeastFramesets) {
        return fail(
            "pictures: found {} framesets with a reference pose that are {:g} m or {:g} degrees "
            "apart, wanted {} or more; drive longer, or check the times of the reference poses",
            framesets_, kApart_m, kApart_deg, kLeastFramesets);
      }
      solve(round);
    }
    problem_.finish(kRounds.back().search_rad);
    return problem_.result(kRounds.back().search_rad);
  }

 private:
  /// Reads all framesets once and replaces the problem's sightings.
  Status look(const Round& round) {
    problem_.clear_sightings();
    recording_.rewind();
    framesets_ = 0;
    before_.clear();
    std::optional<Se2> last;
    for (std::vector<RecordedPicture> pictures;;) {
      if (Status read = recording_.next(pictures); !read) return read;
      if (pictures.empty()) return {};
      if (progress_) {
        progress_(++read_, recording_.framesets() * static_cast<int>(kRounds.size()));
      }
      const auto pose = recording_.reference().at(pictures.front().time);
      if (!pose || (last && is_near(*last, *pose))) continue;
      last = pose;
      look_at(pictures, *pose, round);
      tie(pictures, round);
      before_.swap(pictures);
      ++framesets_;
    }
  }

  /// Ties the pictures of a frameset to each other and to those of the frameset before.
  void tie(const std::vector<RecordedPicture>& pictures, const Round& round) {
    for (const RecordedPicture& first : pictures) {
      for (const RecordedPicture& second : pictures) {
        if (first.camera < second.camera) tie_two(first, framesets_, second, round);
      }
    }
    for (const RecordedPicture& first : before_) {
      for (const RecordedPicture& second : pictures) {
        tie_two(first, framesets_ - 1, second, round);
      }
    }
  }

  /// The second picture belongs to the present frameset.
  void tie_two(const RecordedPicture& first, int frame, const RecordedPicture& second,
               const Round& round) {
    const RefinementProblem::Picture a{frame, first.camera, first.time};
    const RefinementProblem::Picture b{framesets_, second.camera, second.time};
    const auto first_view = problem_.expected_view(a);
    const auto second_view = problem_.expected_view(b);
    if (!first_view || !second_view) return;
    TieSearch search;
    search.reach_px = round.search_rad * first_view->camera().intrinsics.fx_px;
    auto ties = find_ties(first.image, *first_view, second.image, *second_view, search);
    if (!ties.empty()) problem_.add_ties(a, b, std::move(ties));
  }

  void solve(const Round& round) {
    if (round.expects_tilt) problem_.restart_frames();
    for (double scale = round.first_sigma_scale; scale >= round.last_sigma_scale; scale *= 0.5) {
      problem_.solve(round.search_rad, scale);
    }
  }

  static bool is_near(const Se2& a, const Se2& b) {
    const Se2 between = correction_between(a, b);
    return between.translation().norm() < kApart_m &&
           std::abs(between.yaw_rad) < radians(kApart_deg);
  }

  void look_at(const std::vector<RecordedPicture>& pictures, const Se2& pose, const Round& round) {
    find_paint_points(map_, pose, kPaintReach_m, points_);
    const Se3 vehicle_from_body =
        round.expects_tilt ? problem_.expected_body_from_vehicle(framesets_).inverse() : Se3{};
    for (const RecordedPicture& picture : pictures) {
      const CameraAdjustment& change = problem_.change(picture.camera);
      const auto exposed =
          recording_.reference().at(picture.time + from_seconds(change[kTimeOffset]));
      if (!exposed) continue;
      CameraModel camera = adjusted(rig_.cameras[picture.camera], change);
      camera.vehicle_from_camera = vehicle_from_body * camera.vehicle_from_camera;
      const double reach_px = round.search_rad * camera.intrinsics.fx_px;
      problem_.add(framesets_, picture.camera, picture.time,
                   round.uses_paint
                       ? find_paint(picture.image, camera, exposed->inverse(), points_, reach_px)
                       : std::vector<PaintSighting>{});
    }
  }

  const Rig& rig_;
  const MapIndex& map_;
  PictureRecording& recording_;
  const RefinementProgress& progress_;
  RefinementProblem problem_;
  std::vector<PaintPoint> points_;
  std::vector<RecordedPicture> before_;  ///< the frameset before
  int framesets_ = 0;
  int read_ = 0;
};

}  // namespace

Result<RigRefinement> refine_rig(const Rig& rig, const MapIndex& map, PictureRecording& recording,
                                 const RefinementOptions& options,
                                 const RefinementProgress& progress) {
  return RigRefiner(rig, map, recording, options, progress).run();
}

Rig refined(const Rig& rig, const RigRefinement& refinement) {
  Rig result = rig;
  for (int c = 0; c < kCameraCount; ++c) {
    result.cameras[c] = adjusted(rig.cameras[c], refinement.cameras[c].change);
  }
  return result;
}

}  // namespace bevloc
