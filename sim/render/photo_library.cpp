#include "sim/render/photo_library.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <sstream>

#include "common/image_file.h"
#include "sim/random.h"

namespace bevloc::sim {
namespace {

/// Share of the worlds' materials, walls and trees that a photograph covers.
constexpr double kPhotographed = 0.6;

constexpr int kLeastGroundSide = 64;
constexpr int kMostGroundSide = 256;

struct GroundUse {
  std::string_view name;
  GroundMaterial material;
};
constexpr GroundUse kGroundUses[] = {
    {"asphalt", GroundMaterial::kAsphalt}, {"concrete", GroundMaterial::kConcrete},
    {"paving", GroundMaterial::kPaving},   {"grass", GroundMaterial::kGrass},
    {"dirt", GroundMaterial::kDirt},       {"gravel", GroundMaterial::kGravel},
};

struct PanelUse {
  std::string_view name;
  Pattern pattern;
};
constexpr PanelUse kPanelUses[] = {
    {"facade", Pattern::kFacade},
    {"stone_wall", Pattern::kStoneWall},
    {"concrete_barrier", Pattern::kConcreteBarrier},
    {"crown", Pattern::kCrown},
};

float linear(uint8_t value) {
  return std::pow(static_cast<float>(value) / 255.0F, 2.2F);
}

/// The pixels as linear colours, the lowest row first, divided by their mean in each channel.
/// Black pixels are holes and do not count.
std::vector<Rgb> relative_colours(const RgbImage& image) {
  std::vector<Rgb> colours;
  Rgb sum;
  int count = 0;
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* pixel = &image.pixels[3 * (static_cast<size_t>(y) * image.width + x)];
      const Rgb colour{linear(pixel[0]), linear(pixel[1]), linear(pixel[2])};
      colours.push_back(colour);
      sum.r += colour.r;
      sum.g += colour.g;
      sum.b += colour.b;
      if (colour.r + colour.g + colour.b > 0.0F) ++count;
    }
  }
  static constexpr float kDarkest = 1e-3F;
  const auto factor = [count](float of_channel) {
    return 1.0F / std::max(of_channel / static_cast<float>(std::max(count, 1)), kDarkest);
  };
  for (Rgb& colour : colours) {
    colour = {colour.r * factor(sum.r), colour.g * factor(sum.g), colour.b * factor(sum.b)};
  }
  return colours;
}

std::vector<Rgb> halved(const std::vector<Rgb>& finer, int finer_side) {
  const int side = finer_side / 2;
  std::vector<Rgb> result;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      Rgb sum;
      for (const int at : {0, 1, finer_side, finer_side + 1}) {
        const Rgb& colour = finer[static_cast<size_t>(2 * y * finer_side + 2 * x + at)];
        sum = {sum.r + 0.25F * colour.r, sum.g + 0.25F * colour.g, sum.b + 0.25F * colour.b};
      }
      result.push_back(sum);
    }
  }
  return result;
}

template <typename Photo>
const Photo* choose(const std::vector<Photo>& photos, uint64_t seed) {
  Random random(seed);
  if (photos.empty() || !random.chance(kPhotographed)) return nullptr;
  return &photos[static_cast<size_t>(random.integer(0, static_cast<int>(photos.size()) - 1))];
}

Result<RgbImage> read_square(const std::filesystem::path& file, int side_px) {
  RgbImage image(side_px, side_px);
  if (const Status status = read_image(file, image); !status) {
    return tl::unexpected(status.error());
  }
  return image;
}

}  // namespace

GroundPhoto::GroundPhoto(int side_px, std::vector<Rgb> finest) : side_px_(side_px) {
  levels_[0] = std::move(finest);
  for (int level = 1; level < kGroundLevels; ++level) {
    levels_[static_cast<size_t>(level)] =
        halved(levels_[static_cast<size_t>(level) - 1], side_px >> (level - 1));
  }
}

void GroundPhoto::copy_row(int level, int64_t ix, int64_t iy, int count, float* red, float* green,
                           float* blue) const {
  const int64_t side = side_px_ >> level;
  // The side is a power of two, so this is the right remainder for negative indices, too.
  const Rgb* row =
      &levels_[static_cast<size_t>(level)][static_cast<size_t>((iy & (side - 1)) * side)];
  for (int i = 0; i < count; ++i) {
    const Rgb& colour = row[(ix + i) & (side - 1)];
    red[i] = colour.r;
    green[i] = colour.g;
    blue[i] = colour.b;
  }
}

Result<PhotoLibrary> PhotoLibrary::load(const std::filesystem::path& folder) {
  const std::filesystem::path index = folder / "photos.txt";
  std::ifstream lines(index);
  if (!lines) {
    return fail("{}: found no file that can be read, wanted the index that script/photos writes",
                index.string());
  }
  PhotoLibrary library;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    std::string use;
    std::string name;
    int side_px = 0;
    double side_m = 0.0;
    if (!(words >> use >> name >> side_px >> side_m) || side_m <= 0.0) {
      return fail("{}: line {}: found '{}', wanted USE FILE PIXELS METRES", index.string(), number,
                  line);
    }
    if (const Status added = library.add(use, folder / name, side_px, side_m); !added) {
      return fail("{}: line {}: {}", index.string(), number, added.error().message);
    }
  }
  return library;
}

Status PhotoLibrary::add(std::string_view use, const std::filesystem::path& file, int side_px,
                         double side_m) {
  if (const auto* ground = std::ranges::find(kGroundUses, use, &GroundUse::name);
      ground != std::end(kGroundUses)) {
    const bool fits = side_px >= kLeastGroundSide && side_px <= kMostGroundSide &&
                      std::has_single_bit(static_cast<unsigned>(side_px)) &&
                      std::abs(side_px * kFinestTexelM - side_m) < 0.01;
    if (!fits) {
      return fail("found {} pixels for {} m, wanted 64, 128 or 256 pixels of {} m", side_px, side_m,
                  kFinestTexelM);
    }
    const auto image = read_square(file, side_px);
    if (!image) return tl::unexpected(image.error());
    ground_[static_cast<size_t>(ground->material)].emplace_back(side_px, relative_colours(*image));
    return {};
  }
  const auto* panel = std::ranges::find(kPanelUses, use, &PanelUse::name);
  if (panel == std::end(kPanelUses)) return fail("found the use '{}', wanted a known one", use);
  if (side_px != kTextureSide) return fail("found {} pixels, wanted {}", side_px, kTextureSide);
  const auto image = read_square(file, side_px);
  if (!image) return tl::unexpected(image.error());
  panels_[static_cast<size_t>(panel->pattern)].push_back(
      texture_from(relative_colours(*image), panel->pattern, static_cast<float>(side_m)));
  return {};
}

const GroundPhoto* PhotoLibrary::ground(GroundMaterial material, uint64_t world_seed) const {
  const auto number = static_cast<size_t>(material);
  return choose(ground_[number], mix_seed(seed_for(world_seed, "ground photo") + number));
}

const Texture* PhotoLibrary::wall(WallTexture kind, uint64_t wall_seed) const {
  return choose(panels_[static_cast<size_t>(pattern_of(kind))], seed_for(wall_seed, "wall photo"));
}

const Texture* PhotoLibrary::crown(uint64_t tree_seed) const {
  return choose(panels_[static_cast<size_t>(Pattern::kCrown)], seed_for(tree_seed, "tree photo"));
}

size_t PhotoLibrary::size() const {
  size_t count = 0;
  for (const auto& photos : ground_) count += photos.size();
  for (const auto& photos : panels_) count += photos.size();
  return count;
}

}  // namespace bevloc::sim
