#include "evaluation/localize/localize_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/shipped_file.h"
#include "evaluation/check_outputs.h"
#include "evaluation/choice_option.h"
#include "evaluation/drive/sheet.h"
#include "evaluation/localize/localize_report.h"
#include "evaluation/localize/picture_set.h"
#include "evaluation/progress_bar.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"
#include "pipeline/preprocessing/view_check.h"
#include "sim/random.h"

namespace bevloc::evaluation {
namespace {

constexpr int kMostPriors = 100'000;

/// Why a camera's picture was not used in the latest localize().
std::string reason_of(const Localizer& localizer, const PictureSet& pictures, size_t camera) {
  if (!pictures.present[camera]) return "it has no picture";
  if (localizer.with(ViewFault::kDark)[camera]) return "its picture is dark";
  if (localizer.with(ViewFault::kBlinded)[camera]) return "its picture is blinded by light";
  // Dirt cannot be judged from one picture.
  return "its picture cannot be used";
}

/// A localizer with the pictures that it localizes.
class PictureLocalizer {
 public:
  PictureLocalizer(Localizer& localizer, const MapIndex& map, const PictureSet& pictures,
                   SearchRange range)
      : localizer_(localizer), rasterizer_(map), pictures_(pictures), range_(range) {}

  /// The distributions are valid until the next call.
  Localization localize(const Se2& prior) {
    Localization localization;
    localization.prior = prior;
    localization.cameras = localizer_.localize(pictures_.images(), prior, range_, solution_);
    localization.is_wide = range_ == SearchRange::kAcquiring;
    // The solver does not know that nothing was seen or mapped.
    const bool shows_nothing = localization.cameras.none() || !localizer_.map_nearby();
    if (shows_nothing) solution_.evidence = Evidence::kNone;
    localization.seen = judge_single(solution_);
    localization.match = solution_;
    for (size_t i = 0; i < kCameraCount; ++i) {
      if (localization.cameras[i]) continue;
      localization.left_out.emplace(kCameraNames[i], reason_of(localizer_, pictures_, i));
    }
    return localization;
  }

  /// Compares what the latest call perceived with the map at a pose.
  PerceptionScore perception_at(const Se2& pose) {
    std::vector<uint8_t> raster(kRasterSize);
    rasterizer_.draw(pose, raster);
    return score_perception(localizer_.perceived_mask(), raster);
  }

  const SolverResult& solution() const { return solution_; }
  const HypothesisGrid& hypotheses() const { return localizer_.hypotheses(range_); }
  std::span<const float> perceived_mask() { return localizer_.perceived_mask(); }

 private:
  Localizer& localizer_;
  MapRasterizer rasterizer_;
  const PictureSet& pictures_;
  SearchRange range_;
  SolverResult solution_;
};

/// Draws priors uniformly within the range of the search around the truth.
PriorScores score_priors(PictureLocalizer& localizer, const Se2& truth, int priors, uint64_t seed) {
  const HypothesisGrid& range = localizer.hypotheses();
  sim::Random random(sim::seed_for(seed, "priors"));
  const auto within = [&random](double limit) { return random.uniform(-limit, limit); };
  PriorScores scores;
  for (int i = 0; i < priors; ++i) {
    const Se2 correction{within(range.x_m.range), within(range.y_m.range),
                         within(range.yaw_rad.range)};
    const Localization localization = localizer.localize(truth * correction.inverse());
    scores.priors.push_back(judge(Se2{}, correction));
    scores.matches.push_back(judge(localizer.solution(), range, correction));
    scores.matches.back().sigma = sigma_of(localization);
    scores.without_evidence += localization.match.evidence == Evidence::kNone;
    show_progress(i + 1, priors, "priors");
  }
  scores.perception = localizer.perception_at(truth);
  return scores;
}

void print_strays(const PictureSet& pictures) {
  for (const std::filesystem::path& file : pictures.strays) {
    fmt::print(stderr, "{}: found a picture of no camera, wanted one of: {}\n", file.string(),
               fmt::join(kCameraNames, ", "));
  }
}

void print_left_out(const Localization& localization) {
  for (const auto& [camera, reason] : localization.left_out) {
    fmt::print(stderr, "{}: this camera is not used, because {}\n", camera, reason);
  }
}

SheetContent sheet_of(const PictureSet& pictures, const Localization& localization,
                      PictureLocalizer& localizer) {
  SheetContent sheet;
  sheet.images = pictures.pictures;
  sheet.present = pictures.present;
  sheet.reference_from_exposure = pictures.reference_from_exposure;
  sheet.prior = localization.prior;
  sheet.corrected = localization.pose();
  const std::span<const float> mask = localizer.perceived_mask();
  sheet.mask_logits.assign(mask.begin(), mask.end());
  sheet.matched_at = localization.prior;
  sheet.solution = localizer.solution();
  sheet.hypotheses = localizer.hypotheses();
  return sheet;
}

}  // namespace

void LocalizeCommand::declare(CLI::App& app) {
  auto* localize =
      app.add_subcommand("localize", "Localize six picture files: where were they taken?");
  localize->add_option("--rig", rig_file_, "Calibration of the cameras")->required();
  localize->add_option("--map", map_file_, "HD map of any format (docs/maps.md)")->required();
  localize
      ->add_option("--images", image_folder_,
                   "Folder with a picture of each camera, such as front_left.jpg or back.png")
      ->required();
  localize
      ->add_option(
          "--prior", prior_,
          "Approximate pose of the vehicle: X,Y,YAW (metres and degrees in the map frame) or "
          "LATITUDE,LONGITUDE,HEADING (degrees)")
      ->required();
  add_choice(
      *localize, "--frame", frame_,
      {{"guess", PoseFrame::kGuess}, {"map", PoseFrame::kMap}, {"geodetic", PoseFrame::kGeodetic}},
      "How to read the three numbers of --prior. guess: as latitude, longitude and heading if that "
      "place lies on the map, otherwise as metres and degrees");
  localize
      ->add_option("--motion", motion_file_,
                   "YAML file: how the vehicle moved between the pictures (docs/localize.md)")
      ->check(is_name_of("a file"));
  localize->add_option("--model", model_, "Network")->capture_default_str();
  add_choice(*localize, "--solver", solver_,
             {{"banded+refine", SolverKind::kBandedRefined},
              {"block", SolverKind::kBlock},
              {"decoupled", SolverKind::kDecoupled}},
             "Solver");
  localize->add_flag("--wide", wide_, "Search in the wider range of a start: 4 m, 3 m, 4 degrees");
  auto* truth = localize->add_flag("--truth", truth_, "The prior is the true pose: score --priors");
  auto* priors = localize->add_option("--priors", priors_,
                                      "Number of random priors around the true pose, all of which "
                                      "are localized");
  priors->check(CLI::Range(1, kMostPriors))->needs(truth);
  truth->needs(priors);
  localize->add_option("--seed", seed_, "Seed of the random priors")
      ->check(whole_number())
      ->needs(truth)
      ->capture_default_str();
  localize->add_option("--json", json_file_, "Write the answer to this file")->check(output_file());
  localize
      ->add_option("--sheet", sheet_file_, "Draw pictures, map and distributions to this PNG file")
      ->check(output_file());
  localize->footer(
      "Examples:\n"
      "  bevloc localize --rig rig.yaml --map town.osm --images pictures --prior 49.012,8.423,90 "
      "--sheet sheet.png\n"
      "  bevloc localize --rig rig.yaml --map town.osm --images pictures --prior 10,20,90 --truth "
      "--priors 300");
}

Status LocalizeCommand::run() const {
  const auto rig = read_rig(rig_file_);
  if (!rig) return tl::unexpected(rig.error());
  const auto narrow_views = check_views(*rig, rig_file_);
  if (!narrow_views) return tl::unexpected(narrow_views.error());
  if (!narrow_views->empty()) fmt::print(stderr, "{}\n", *narrow_views);
  const auto map = load_map(map_file_);
  if (!map) return tl::unexpected(map.error());
  for (const std::string& warning : warnings_of(*map)) {
    fmt::print(stderr, "{}: {}\n", map_file_, warning);
  }
  const auto prior = pose_from(prior_, frame_, *map);
  if (!prior) return tl::unexpected(prior.error());
  auto pictures = read_pictures(image_folder_, *rig);
  if (!pictures) return tl::unexpected(pictures.error());
  const std::string model = given_or_shipped(model_);
  std::vector<std::filesystem::path> inputs = pictures->files;
  inputs.insert(inputs.end(), {rig_file_, map_file_, motion_file_, model});
  if (Status others = check_outputs({json_file_, sheet_file_}, inputs); !others) return others;
  print_strays(*pictures);
  if (!motion_file_.empty()) {
    const auto motions = read_motions(motion_file_);
    if (!motions) return tl::unexpected(motions.error());
    pictures->reference_from_exposure = *motions;
  }
  const MapIndex index(*map);
  LocalizerOptions options;
  options.solver = solver_;
  options.online_calibration.enabled = false;
  auto localizer = Localizer::create(*rig, index, model, options);
  if (!localizer) return tl::unexpected(localizer.error());

  const SearchRange range = wide_ ? SearchRange::kAcquiring : SearchRange::kTracking;
  PictureLocalizer pictured(**localizer, index, *pictures, range);
  fmt::print("{}", text_of(*prior));
  Localization localization = pictured.localize(prior->pose);
  print_left_out(localization);
  localization.perception = pictured.perception_at(localization.pose());
  nlohmann::json json = json_of(localization);
  fmt::print("{}", text_of(localization));
  if (!sheet_file_.empty()) {
    const SheetContent sheet = sheet_of(*pictures, localization, pictured);
    if (Status drawn = write_sheet(sheet, *rig, index, sheet_file_); !drawn) return drawn;
  }
  if (truth_) {
    const PriorScores scores = score_priors(pictured, prior->pose, priors_, seed_);
    json["priors"] = json_of(scores);
    fmt::print("\n{}", text_of(scores));
  }
  return write_option_file(json_file_, json_document(json));
}

}  // namespace bevloc::evaluation
