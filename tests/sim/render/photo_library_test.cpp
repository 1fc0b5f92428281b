#include "sim/render/photo_library.h"

#include <fstream>
#include <numeric>

#include <gmock/gmock.h>

#include "common/image_file.h"
#include "sim/render/ground_painter.h"
#include "tests/sim/render/small_world.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::sim {
namespace {

using ::testing::HasSubstr;

/// A picture whose left half is four times as bright in red, in linear light, as its right half.
RgbImage half_red(int side_px) {
  RgbImage image(side_px, side_px);
  for (int y = 0; y < side_px; ++y) {
    for (int x = 0; x < side_px; ++x) {
      const bool left = x < side_px / 2;
      uint8_t* pixel = &image.pixels[3 * (static_cast<size_t>(y) * side_px + x)];
      pixel[0] = left ? 188 : 100;
      pixel[1] = pixel[2] = 120;
    }
  }
  return image;
}

class PhotoLibraryTest : public ::testing::Test {
 protected:
  void add_photo(const std::string& use, int side_px, double side_m, const RgbImage& image) {
    const std::string name = use + ".png";
    ASSERT_TRUE(write_png(image.view(), (folder_ / name).string()));
    index_ +=
        use + " " + name + " " + std::to_string(side_px) + " " + std::to_string(side_m) + "\n";
  }

  Result<PhotoLibrary> load() {
    std::ofstream(folder_ / "photos.txt") << index_;
    return PhotoLibrary::load(folder_.path());
  }

  test::TemporaryFolder folder_;
  std::string index_;
};

TEST_F(PhotoLibraryTest, GroundKeepsItsMeanAlbedoAtEveryLevel) {
  const GroundPhoto photo(64, [] {
    std::vector<Rgb> colours;
    for (int i = 0; i < 64 * 64; ++i) colours.push_back({i % 64 < 32 ? 1.6F : 0.4F, 1.0F, 1.0F});
    return colours;
  }());
  for (int level = 0; level < kGroundLevels; ++level) {
    std::array<float, 128> red{};
    std::array<float, 128> green{};
    std::array<float, 128> blue{};
    photo.copy_row(level, -5, -7, 128, red.data(), green.data(), blue.data());
    EXPECT_NEAR(std::accumulate(red.begin(), red.end(), 0.0F) / 128.0F, 1.0F, 1e-5F) << level;
    EXPECT_NEAR(std::accumulate(blue.begin(), blue.end(), 0.0F) / 128.0F, 1.0F, 1e-5F) << level;
  }
}

TEST_F(PhotoLibraryTest, CoversTheGroundOfSomeWorlds) {
  add_photo("asphalt", 64, 3.2, half_red(64));
  const auto library = load();
  ASSERT_TRUE(library) << library.error().message;
  EXPECT_EQ(library->size(), 1U);
  int covered = 0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    covered += library->ground(GroundMaterial::kAsphalt, seed) != nullptr;
    EXPECT_EQ(library->ground(GroundMaterial::kGrass, seed), nullptr);
  }
  EXPECT_GT(covered, 40);
  EXPECT_LT(covered, 80);
}

TEST_F(PhotoLibraryTest, APaintedTileShowsThePhotograph) {
  add_photo("asphalt", 64, 3.2, half_red(64));
  const auto library = load();
  ASSERT_TRUE(library) << library.error().message;
  World world = asphalt_plain();
  while (library->ground(GroundMaterial::kAsphalt, world.seed) == nullptr) ++world.seed;
  world.photos = &*library;
  std::vector<GroundTexel> tile(kTileArea);
  GroundPainter(world).paint({0, 0, 0}, tile.data());
  const auto mean_red = [&tile](int from) {
    double sum = 0.0;
    for (int j = 0; j < kTileTexels; ++j) {
      for (int i = from; i < from + 32; ++i) {
        const double root =
            static_cast<double>(tile[static_cast<size_t>(j * kTileNodes + i)] & 255U);
        sum += root * root;
      }
    }
    return sum;
  };
  EXPECT_NEAR(mean_red(0) / mean_red(32), 4.0, 0.4);
  EXPECT_NEAR(mean_red(64) / mean_red(0), 1.0, 0.1) << "does not repeat after 3.2 m";
}

TEST_F(PhotoLibraryTest, ABlackPixelOfACrownIsAHole) {
  RgbImage image = half_red(kTextureSide);
  std::fill_n(image.pixels.begin(), 3 * kTextureSide, uint8_t{0});  // the highest row
  add_photo("crown", kTextureSide, 1.0, image);
  const auto library = load();
  ASSERT_TRUE(library) << library.error().message;
  uint64_t seed = 0;
  while (library->crown(seed) == nullptr) ++seed;
  const Texture& texture = *library->crown(seed);
  EXPECT_EQ(texture.period_u_m, 0.0F);
  EXPECT_EQ(texture.texels[static_cast<size_t>(kTextureSide) * (kTextureSide - 1)] >> 24U, 0U);
  EXPECT_EQ(texture.texels[0] >> 24U, 128U);
}

TEST_F(PhotoLibraryTest, RefusesWhatItCannotUse) {
  const auto message_of = [this](const std::string& index) {
    index_ = index;
    const auto library = load();
    return library ? "accepted" : library.error().message;
  };
  ASSERT_TRUE(write_png(half_red(64).view(), (folder_ / "a.png").string()));
  EXPECT_THAT(message_of("asphalt a.png 64\n"), HasSubstr("line 1: found 'asphalt a.png 64'"));
  EXPECT_THAT(message_of("asphalt a.png 64 6.4\n"), HasSubstr("found 64 pixels for 6.4 m"));
  EXPECT_THAT(message_of("snow a.png 64 3.2\n"), HasSubstr("found the use 'snow'"));
  EXPECT_THAT(message_of("facade a.png 64 3.2\n"), HasSubstr("wanted 256"));
  EXPECT_THAT(message_of("asphalt b.png 64 3.2\n"), HasSubstr("b.png"));
  EXPECT_THAT(PhotoLibrary::load(folder_ / "none").error().message, HasSubstr("script/photos"));
}

}  // namespace
}  // namespace bevloc::sim
