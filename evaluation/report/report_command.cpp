#include "evaluation/report/report_command.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "common/files.h"
#include "common/jpeg.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/recording/played_devices.h"
#include "evaluation/report/report_page.h"
#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

constexpr int kPictureWidth_px = 480;
constexpr int kPictureQuality = 80;

Result<std::string> small_jpeg(const RgbImage& image, JpegEncoder& encoder) {
  const int width = std::min(kPictureWidth_px, image.width);
  const int height = std::max(1, image.height * width / image.width);
  RgbImage small(width, height);
  const cv::Mat source(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.row(0)));
  cv::Mat target(height, width, CV_8UC3, small.row(0));
  cv::resize(source, target, target.size(), 0.0, 0.0, cv::INTER_AREA);
  const auto jpeg = encoder.encode(small.view(), kPictureQuality);
  if (!jpeg) return tl::unexpected(jpeg.error());
  return std::string(*jpeg);
}

Result<std::string> small_picture(Recording& recording, int camera, const MessagePlace& place,
                                  JpegEncoder& encoder) {
  const auto image = picture_at(recording, camera, place);
  if (!image) return tl::unexpected(image.error());
  return small_jpeg(*image, encoder);
}

/// Adds the pictures that were exposed last before the moment. Says on stderr which ones cannot be
/// read.
void add_pictures(Recording& recording, const ReportData& data, ShownFrame& frame) {
  JpegEncoder encoder;
  const auto moment_ns = data.begin_ns + static_cast<uint64_t>(frame.time_s * 1e9);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto& places = recording.messages(firmware::image_topic(camera));
    const auto behind = std::ranges::upper_bound(places, moment_ns, {}, &MessagePlace::log_time_ns);
    if (behind == places.begin()) continue;
    const MessagePlace& place = *std::prev(behind);
    auto jpeg = small_picture(recording, camera, place, encoder);
    if (jpeg) {
      frame.pictures[camera] = std::move(*jpeg);
      continue;
    }
    frame.unreadable[camera] = true;
    const double time_s = 1e-9 * static_cast<double>(place.log_time_ns - data.begin_ns);
    fmt::print(stderr, "{}: left out the picture of camera {} at {} ({:.1f} s): {}\n",
               recording.file_of(place), kCameraNames[camera], time_of_day(data, time_s), time_s,
               jpeg.error().message);
  }
}

std::vector<std::pair<std::string, std::string>> facts_of(const Recording& recording) {
  std::vector<std::pair<std::string, std::string>> facts{
      {"bevloc", recording.value(firmware::kVersionKey)},
      {"configuration", recording.value(firmware::kConfigKey)},
      {"model", fmt::format("{} (SHA-256 {})", recording.value(firmware::kModelFileKey),
                            recording.value(firmware::kModelChecksumKey).substr(0, 16))},
      {"map", fmt::format("checksum {}", recording.value(firmware::kMapChecksumKey))}};
  for (const std::string& gap : recording.gaps()) facts.emplace_back("incomplete", gap);
  return facts;
}

}  // namespace

void ReportCommand::declare(CLI::App& app) {
  auto* report = app.add_subcommand("report", "Make one HTML page of a recording");
  report->add_option("files", files_, "Files of one recording (.mcap), in any order")->required();
  report->add_option("--out", out_, "The page (.html)")
      ->check(output_file())
      ->capture_default_str();
  // Takes one value, because a further one is a file.
  report
      ->add_option("--at", moments_,
                   "Explain the state at this time: 14:32, 14:32:05 (local time), or seconds; may "
                   "be repeated")
      ->allow_extra_args(false);
  report->footer(
      "Examples:\n"
      "  bevloc report recording/*.mcap --out report.html\n"
      "  bevloc report recording/*.mcap --at 14:32");
}

Status ReportCommand::run() const {
  if (Status named = check_extension(out_, ".html"); !named) return named;
  if (Status other = check_output(out_, files_); !other) return other;
  auto recording = Recording::open(files_);
  if (!recording) return tl::unexpected(recording.error());
  for (const std::string& gap : recording->gaps()) fmt::print(stderr, "{}\n", gap);
  if (recording->messages(firmware::kSolutionTopic).empty()) {
    return fail("{}: found no pose, wanted a recording that holds some", recording->name());
  }
  const auto data = read_report_data(*recording);
  if (!data) return tl::unexpected(data.error());
  std::vector<Answer> answers;
  for (const std::string& text : moments_) {
    const auto moment_s = parse_moment(*data, text);
    if (!moment_s) return tl::unexpected(moment_s.error());
    answers.push_back(
        {fmt::format("What was the state at {}, and why?", text), explain(*data, *moment_s)});
    for (const std::string& sentence : answers.back().sentences) fmt::print("{}\n", sentence);
  }
  std::vector<ShownFrame> frames = choose_frames(*data);
  for (ShownFrame& frame : frames) add_pictures(*recording, *data, frame);
  std::vector<std::string> names;
  for (const auto& file : files_) names.push_back(file.string());
  const std::string page = report_page(*data, names, facts_of(*recording), frames, answers);
  if (Status written = write_file(out_, page); !written) return written;
  for (const auto& [name, text] : key_figures(*data)) fmt::print("{:<20}{}\n", name, text);
  fmt::print("{}\n", out_.string());
  return {};
}

}  // namespace bevloc::evaluation
