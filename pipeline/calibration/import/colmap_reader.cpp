#include <filesystem>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "pipeline/calibration/import/readers.h"

namespace bevloc::calibration_import {
namespace {

/// The parameters of a model of COLMAP, each a letter: f, x (fx), y (fy), u (cx), v (cy), 1 to 6
/// (k1 to k6), p (p1), q (p2).
struct ColmapModel {
  Lens lens;
  std::string_view parameters;
};

const std::map<std::string_view, ColmapModel> kColmapModels = {
    {"SIMPLE_PINHOLE", {Lens::kPinhole, "fuv"}},
    {"PINHOLE", {Lens::kPinhole, "xyuv"}},
    {"SIMPLE_RADIAL", {Lens::kPinhole, "fuv1"}},
    {"RADIAL", {Lens::kPinhole, "fuv12"}},
    {"OPENCV", {Lens::kPinhole, "xyuv12pq"}},
    {"FULL_OPENCV", {Lens::kPinhole, "xyuv12pq3456"}},
    {"OPENCV_FISHEYE", {Lens::kFisheye, "xyuv1234"}},
    {"SIMPLE_RADIAL_FISHEYE", {Lens::kFisheye, "fuv1"}},
    {"RADIAL_FISHEYE", {Lens::kFisheye, "fuv12"}},
};

struct TextLine {
  std::string place;
  std::vector<std::string> words;
};

/// The lines of a file of COLMAP without comments. An empty line counts, because images.txt has
/// one for each image without points.
std::vector<TextLine> lines_of(const std::string& text, const std::string& name) {
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.starts_with('#')) continue;
    TextLine found{fmt::format("{}:{}", name, number), {}};
    std::istringstream words(line);
    for (std::string word; words >> word;) found.words.push_back(word);
    lines.push_back(std::move(found));
  }
  return lines;
}

int size_from(const std::string& word, const std::string& place) {
  const double size = number_from(word, place);
  if (!(size >= 1.0 && size <= kLargestImage_px)) {
    refuse(place, word, fmt::format("an image size of 1 to {}", kLargestImage_px));
  }
  return static_cast<int>(size);
}

Intrinsics intrinsics_from(const TextLine& line) {
  constexpr size_t kFirstParameter = 4;
  if (line.words.size() < kFirstParameter) {
    refuse(line.place, fmt::format("{} words", line.words.size()),
           "CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
  }
  const auto model = kColmapModels.find(line.words[1]);
  if (model == kColmapModels.end()) {
    refuse(line.place, line.words[1],
           "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV or a fisheye of "
           "COLMAP, because bevloc's camera model expresses no other");
  }
  const std::string_view parameters = model->second.parameters;
  if (line.words.size() != kFirstParameter + parameters.size()) {
    refuse(line.place, fmt::format("{} parameters", line.words.size() - kFirstParameter),
           fmt::format("{} of {}", parameters.size(), line.words[1]));
  }
  std::map<char, double> value;
  for (size_t i = 0; i < parameters.size(); ++i) {
    value[parameters[i]] = number_from(line.words[kFirstParameter + i], line.place);
  }
  const bool one_focal = value.contains('f');
  Intrinsics lens;
  lens.width_px = size_from(line.words[2], line.place);
  lens.height_px = size_from(line.words[3], line.place);
  lens.fx_px = one_focal ? value['f'] : value['x'];
  lens.fy_px = one_focal ? value['f'] : value['y'];
  // COLMAP's (0, 0) is the corner of the image, bevloc's the centre of the first pixel.
  lens.cx_px = value['u'] - 0.5;
  lens.cy_px = value['v'] - 0.5;
  if (model->second.lens == Lens::kFisheye) {
    set_fisheye_distortion({value['1'], value['2'], value['3'], value['4']}, line.place, lens);
  } else {
    set_pinhole_distortion({value['1'], value['2'], value['p'], value['q'], value['3'], value['4'],
                            value['5'], value['6']},
                           line.place, lens);
  }
  return lens;
}

/// The first folder of an image, or its stem if it has none.
std::string name_from_image(const std::string& file, const std::string& stem) {
  const size_t folder = file.find('/');
  return folder != std::string::npos ? file.substr(0, folder) : stem;
}

/// A camera of cameras.txt.
struct ColmapLens {
  Intrinsics intrinsics;
  std::string place;
};

ImportedCamera camera_of_image(const TextLine& line,
                               const std::map<std::string, ColmapLens>& lenses) {
  constexpr size_t kWords = 10;
  if (line.words.size() != kWords) {
    refuse(line.place, fmt::format("{} words", line.words.size()),
           "IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points after each");
  }
  std::vector<double> numbers;
  for (size_t i = 1; i < 8; ++i) numbers.push_back(number_from(line.words[i], line.place));
  const auto lens = lenses.find(line.words[8]);
  if (lens == lenses.end()) {
    refuse(line.place, fmt::format("camera {}", line.words[8]), "a camera of cameras.txt");
  }
  const Se3 camera_from_world{
      rotation_from_wxyz({numbers.begin(), numbers.begin() + 4}, line.place),
      {numbers[4], numbers[5], numbers[6]}};
  const std::string& file = line.words[9];
  const std::string stem = std::filesystem::path(file).stem().string();
  return {name_from_image(file, stem), line.place,
          lens->second.intrinsics,     Mounting{"world", camera_from_world.inverse()},
          lens->second.place,          stem};
}

/// Refuses a line that is no list of points. An image without points has an empty line, and some
/// editors remove empty lines. The line of the next image then stands in place of the points.
void check_points(const TextLine& line) {
  if (line.words.size() % 3 == 0) return;
  refuse(line.place, fmt::format("{} words", line.words.size()),
         "the points of the image in the line before: X Y POINT3D_ID of each, or an empty line");
}

}  // namespace

std::vector<ImportedCamera> read_colmap(const std::string& cameras, const std::string& cameras_name,
                                        const std::string& images, const std::string& images_name) {
  std::vector<ImportedCamera> result;
  std::map<std::string, ColmapLens> lenses;
  for (const TextLine& line : lines_of(cameras, cameras_name)) {
    if (line.words.empty()) continue;
    const Intrinsics lens = intrinsics_from(line);
    if (!lenses.emplace(line.words[0], ColmapLens{lens, line.place}).second) {
      refuse(line.place, fmt::format("camera {} again", line.words[0]), "each id once");
    }
    result.push_back({line.words[0], line.place, lens});
  }
  if (images_name.empty()) return result;
  result.clear();
  const auto lines = lines_of(images, images_name);
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].words.empty()) continue;
    result.push_back(camera_of_image(lines[i], lenses));
    // The next line has the points of this image, also if it is empty.
    if (++i < lines.size()) check_points(lines[i]);
  }
  return result;
}

}  // namespace bevloc::calibration_import
