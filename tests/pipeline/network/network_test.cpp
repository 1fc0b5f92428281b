// The whole network with a tiny model, compared with numpy, and each reason to refuse a model file.
// engines/under_test/ lists the engines that these test cases run on.
#include "pipeline/network/network.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <ranges>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "pipeline/network/test_frame.h"
#include "tests/pipeline/network/engines/engine_under_test.h"
#include "tests/pipeline/network/model_inputs.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using ::testing::HasSubstr;

constexpr int kStride = 61;  // tiny_network_*.expected has every 61st value

NetworkOptions options(int threads = 1) {
  const test::EngineUnderTest& tested = test::engine_under_test();
  return {.threads = threads, .isa = tested.isa, .engine = tested.make};
}

std::unique_ptr<Network> load(const std::string& model, int threads = 1) {
  auto network = Network::load(test::fixture(model + ".onnx"), options(threads));
  if (!network) {
    ADD_FAILURE() << network.error().message;
    std::abort();
  }
  (*network)->set_view_table(
      test::view_table(kFeatureGrid.cells(), kCameraCount * kImageFeatureCells));
  test::fill_input((*network)->image_input(), 1);
  test::fill_input((*network)->raster_input(), 2);
  return std::move(*network);
}

void run_all(Network& network) {
  network.run_image_branch();
  network.run_map_branch();
  network.run_mask_head();
}

std::vector<float> all_outputs(const Network& network, size_t stride = 1) {
  std::vector<float> values;
  for (const auto& output :
       {network.bev_features().data, network.map_features().data, network.mask_logits()}) {
    for (size_t i = 0; i < output.size(); i += stride) values.push_back(output[i]);
  }
  return values;
}

double root_mean_square(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> difference(a);
  for (size_t i = 0; i < b.size(); ++i) difference[i] -= b[i];
  return root_mean_square(difference);
}

TEST(Network, Int8AgreesWithNumpy) {
  const auto network = load("tiny_network_int8");
  run_all(*network);
  const std::vector<float> found = all_outputs(*network, kStride);
  const std::vector<float> expected = test::expected_values("tiny_network_int8");
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(root_mean_square(expected), 0.1);
  // The scales are not powers of two. About one sum in 100,000 rounds differently in float32 than
  // in float64. It changes its element by one step and, through the view transform, many outputs a
  // little.
  const auto same = std::ranges::count_if(std::views::iota(size_t{0}, found.size()), [&](size_t i) {
    return std::abs(found[i] - expected[i]) < 1e-5F;
  });
  EXPECT_GT(same, 0.8 * static_cast<double>(found.size()));
  EXPECT_LT(rms_difference(found, expected), 3e-3 * root_mean_square(expected));
}

TEST(Network, FloatAgreesWithNumpy) {
  const auto network = load("tiny_network_float");
  run_all(*network);
  EXPECT_THAT(all_outputs(*network, kStride),
              ::testing::Pointwise(::testing::FloatNear(1e-4F),
                                   test::expected_values("tiny_network_float")));
}

TEST(Network, ThreadsDoNotChangeTheResult) {
  const auto one = load("tiny_network_int8");
  const auto two = load("tiny_network_int8", 2);
  run_all(*one);
  run_all(*two);
  EXPECT_EQ(all_outputs(*one), all_outputs(*two));
}

TEST(Network, PartsRunInAnyOrderAndAgain) {
  const auto network = load("tiny_network_int8");
  run_all(*network);
  const std::vector<float> expected = all_outputs(*network);
  network->run_map_branch();
  network->run_mask_head();
  network->run_image_branch();
  network->run_map_branch();
  network->run_mask_head();
  network->run_mask_head();
  EXPECT_EQ(all_outputs(*network), expected);
}

TEST(Network, OutputsStayUntilTheirOwnPartRunsAgain) {
  const auto network = load("tiny_network_int8");
  run_all(*network);
  const std::vector<float> expected = all_outputs(*network);
  network->run_mask_head();
  network->run_map_branch();
  network->run_image_branch();
  EXPECT_EQ(all_outputs(*network), expected);
}

TEST(Network, ReadsTheInputsOfThisRun) {
  const auto network = load("tiny_network_int8");
  run_all(*network);
  const std::vector<float> before = all_outputs(*network);
  test::fill_input(network->image_input(), 3);
  run_all(*network);
  const std::vector<float> after = all_outputs(*network);
  const size_t features = network->bev_features().data.size();
  EXPECT_FALSE(std::equal(before.begin(), before.begin() + features, after.begin()));
  EXPECT_TRUE(std::equal(before.begin() + features, before.begin() + 2 * features,
                         after.begin() + features))
      << "the map features changed with the images";
}

TEST(Network, WithoutCamerasTheImagesDoNotMatter) {
  const auto network = load("tiny_network_int8");
  const size_t entries = static_cast<size_t>(kViewSlots) * kFeatureGrid.cells();
  network->set_view_table({std::vector<int32_t>(entries, 0), std::vector<float>(entries, 0.0F)});
  network->run_image_branch();
  const FeatureView view = network->bev_features();
  const std::vector<float> before(view.data.begin(), view.data.end());
  test::fill_input(network->image_input(), 3);
  network->run_image_branch();
  EXPECT_TRUE(std::ranges::equal(network->bev_features().data, before));
}

TEST(Network, DescribesItsFeaturesAndParameters) {
  const auto network = load("tiny_network_int8");
  EXPECT_EQ(network->name(), "tiny_network_int8");
  EXPECT_EQ(network->image_input().size(), 6U * 3 * 96 * 320);
  EXPECT_EQ(network->raster_input().size(), 3U * 400 * 200);
  EXPECT_EQ(network->mask_logits().size(), 3U * 400 * 200);
  for (const FeatureView& view : {network->bev_features(), network->map_features()}) {
    EXPECT_EQ(view.channels, 16);
    EXPECT_EQ(view.grid, kFeatureGrid);
    EXPECT_EQ(view.data.size(), 16U * 100 * 50);
  }
  const SolverParameters& parameters = network->solver_parameters();
  EXPECT_FLOAT_EQ(parameters.joint_scale, 150.5F);
  EXPECT_FLOAT_EQ(parameters.x_scale, 90.0F);
  EXPECT_FLOAT_EQ(parameters.y_scale, 120.0F);
  EXPECT_FLOAT_EQ(parameters.yaw_scale, 2000.0F);
  EXPECT_FLOAT_EQ(parameters.gem_omega, 1.25F);
}

TEST(Network, AllocatesNothingInARun) {
  const auto network = load("tiny_network_int8");
  const ViewTable table = test::view_table(kFeatureGrid.cells(), kCameraCount * kImageFeatureCells);
  run_all(*network);
  bench::AllocationCallers callers;
  network->set_view_table(table);
  run_all(*network);
  EXPECT_EQ(callers.outside_of("libdnnl"), 0);
}

/// With our own kernels, the shipped model uses no oneDNN primitives, which would allocate.
TEST(Network, TheShippedModelAllocatesNothingAtAll) {
  auto network = Network::load(BEVLOC_SOURCE_DIR "/models/nano.onnx", options());
  ASSERT_TRUE(network) << network.error().message;
  run_all(**network);
  const uint64_t before = bench::allocation_count();
  run_all(**network);
  EXPECT_EQ(bench::allocation_count(), before);
}

TEST(Network, DoesOtherWorkOnItsThreadsWithoutAllocating) {
  for (const int threads : {1, 2, 3}) {
    const auto network = load("tiny_network_int8", threads);
    std::array<int, 7> calls{};
    std::array<std::thread::id, 7> workers;
    const auto body = [&calls, &workers](int index) {
      ++calls[index];
      workers[index] = std::this_thread::get_id();
    };
    network->parallel_for(static_cast<int>(calls.size()), body);
    const uint64_t before = bench::allocation_count();
    network->parallel_for(static_cast<int>(calls.size()), body);
    network->parallel_for(0, body);
    EXPECT_EQ(bench::allocation_count(), before);
    EXPECT_THAT(calls, ::testing::Each(2));
    if (threads > 1) continue;
    EXPECT_THAT(workers, ::testing::Each(std::this_thread::get_id()));
  }
}

TEST(Network, AllocationCounterCounts) {
  bench::AllocationCallers callers;
  const std::vector<int> numbers(1000);
  EXPECT_EQ(numbers.size(), 1000U);
  EXPECT_GE(callers.outside_of("libdnnl"), 1);
}

class RefusedModel : public ::testing::Test {
 protected:
  std::string message_for(const std::string& path) {
    const auto network = Network::load(path, options());
    return network ? "loaded" : network.error().message;
  }

  std::string message_for_bytes(const std::string& bytes) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "model.onnx";
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string message = message_for(path);
    EXPECT_THAT(message, ::testing::StartsWith(path + ": "));
    return message;
  }

  /// The message for the tiny network with all occurrences of a text replaced by another text of
  /// the same length.
  std::string message_after_replacing(const std::string& from, const std::string& to) {
    std::string bytes = test::read_bytes(test::fixture("tiny_network_int8.onnx"));
    size_t count = 0;
    for (size_t i = bytes.find(from); i != std::string::npos; i = bytes.find(from, i + 1)) {
      bytes.replace(i, from.size(), to);
      ++count;
    }
    EXPECT_EQ(from.size(), to.size());
    EXPECT_GT(count, 0U);
    return message_for_bytes(bytes);
  }
};

TEST_F(RefusedModel, MissingFile) {
  EXPECT_EQ(message_for("/no/such/model.onnx"),
            "/no/such/model.onnx: cannot be opened: No such file or directory");
}

TEST_F(RefusedModel, CutOffAtAnyPlace) {
  const std::string whole = test::read_bytes(test::fixture("tiny_network_int8.onnx"));
  for (const size_t length : {whole.size() / 2, whole.size() / 7, size_t{100}}) {
    EXPECT_THAT(message_for_bytes(whole.substr(0, length)),
                HasSubstr("is not a complete ONNX file"));
  }
  EXPECT_THAT(message_for_bytes(""), HasSubstr("contains no graph"));
}

TEST_F(RefusedModel, SomethingElse) {
  EXPECT_THAT(message_for_bytes("GIF89a, certainly not a network"),
              HasSubstr("is not a complete ONNX file"));
}

TEST_F(RefusedModel, UnknownOperatorByName) {
  EXPECT_THAT(message_after_replacing("Relu", "Tanh"),
              HasSubstr("(Tanh): operator 'Tanh' is not supported"));
}

TEST_F(RefusedModel, UnknownAttributeByName) {
  EXPECT_THAT(message_after_replacing("strides", "stridez"),
              HasSubstr("attribute 'stridez' is not supported"));
}

TEST_F(RefusedModel, MissingInput) {
  EXPECT_THAT(message_after_replacing("images", "pixels"),
              HasSubstr("there is no input 'images' (found: pixels, view_index, view_weight, "
                        "raster)"));
}

TEST_F(RefusedModel, MissingOutput) {
  EXPECT_THAT(message_after_replacing("bev_mask", "bev_task"),
              HasSubstr("there is no output 'bev_mask'"));
}

TEST_F(RefusedModel, WrongShape) {
  EXPECT_THAT(message_for(test::fixture("wrong_shape.onnx")),
              HasSubstr("input 'images' is int8 [6, 3, 4, 4], wanted int8 [6, 3, 96, 320]"));
}

/// The view table's indices would point beyond such features.
TEST_F(RefusedModel, ImageFeaturesOfAnotherSize) {
  EXPECT_THAT(message_for(test::fixture("small_features.onnx")),
              HasSubstr("the view transform reads features [6, 4, 6, 20], wanted [6, channels, 12, "
                        "40]"));
}

TEST_F(RefusedModel, MissingMetadata) {
  EXPECT_THAT(message_after_replacing("bevloc.solver.x_scale", "bevloc.solver.q_scale"),
              HasSubstr("metadata 'bevloc.solver.x_scale' is missing"));
}

TEST_F(RefusedModel, MetadataOutOfRange) {
  for (const char* const text : {"-50.5", "150.x", "    5", "nan  ", "1.e37", "1e-37"}) {
    EXPECT_THAT(message_after_replacing("150.5", text),
                HasSubstr(fmt::format("metadata 'bevloc.solver.joint_scale' is '{}', wanted a "
                                      "number of 0.01 to 1000000",
                                      text)));
  }
}

std::unique_ptr<Network> load_shipped(const std::string& path) {
  auto network = Network::load(path, options());
  if (!network) ADD_FAILURE() << network.error().message;
  return network ? std::move(*network) : nullptr;
}

const std::string kShipped = std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx";

TEST(TestFrame, TheShippedModelGivesItsStoredAnswer) {
  const auto network = load_shipped(kShipped);
  ASSERT_TRUE(network);
  const auto stored = answer_from(network->stored_answer());
  ASSERT_TRUE(stored) << stored.error().message;
  const NetworkAnswer found = answer_to_test_frame(*network);
  const Status same = check_answer(found, *stored);
  EXPECT_TRUE(same) << same.error().message;
  EXPECT_EQ(to_text(answer_to_test_frame(*network)), to_text(found));
}

TEST(TestFrame, AModelWithDamagedWeightsIsFound) {
  const auto whole = load_shipped(kShipped);
  ASSERT_TRUE(whole);
  const NetworkAnswer wanted = answer_to_test_frame(*whole);
  const std::string bytes = test::read_bytes(kShipped);
  const test::TemporaryFolder folder;
  const std::string path = folder / "damaged.onnx";
  int judged = 0;
  for (const size_t place : {bytes.size() / 5, bytes.size() / 2, bytes.size() * 4 / 5}) {
    std::string damaged = bytes;
    // One page of bits that do not hold their value.
    for (size_t i = 0; i < 4096; ++i)
      damaged[place + i] = static_cast<char>(damaged[place + i] ^ 0x20);
    std::ofstream(path, std::ios::binary) << damaged;
    const auto network = Network::load(path, options());
    if (!network) continue;  // the page held more than weights
    ++judged;
    const Status same = check_answer(answer_to_test_frame(**network), wanted);
    ASSERT_FALSE(same) << place;
    EXPECT_THAT(same.error().message, HasSubstr("replace the model file"));
  }
  EXPECT_GT(judged, 0);
}

TEST(TestFrame, AnAnswerSurvivesItsText) {
  const auto network = load_shipped(kShipped);
  ASSERT_TRUE(network);
  const NetworkAnswer answer = answer_to_test_frame(*network);
  const auto read = answer_from(to_text(answer));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(check_answer(*read, answer));
  NetworkAnswer other = answer;
  other.map.sums[3] += 0.2 * answer.map.norm;
  EXPECT_FALSE(check_answer(other, answer));
  other.map.sums[3] = std::nan("");
  EXPECT_FALSE(check_answer(other, answer));
}

TEST(TestFrame, ADamagedTextIsRefused) {
  const std::string good = "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9";
  EXPECT_TRUE(answer_from(good));
  const std::string rest = good.substr(1);
  for (const std::string& text :
       {std::string(), good + " 1", rest, std::string("0").append(rest),
        std::string("x").append(rest), std::string("nan").append(rest), good + " ",
        std::string(" ").append(good), std::string("1  2 3")}) {
    const auto answer = answer_from(text);
    ASSERT_FALSE(answer) << text;
    EXPECT_THAT(answer.error().message, HasSubstr("bevloc store-answer"));
  }
}

TEST_F(RefusedModel, NoThreads) {
  const auto network = Network::load(test::fixture("tiny_network_int8.onnx"), options(0));
  ASSERT_FALSE(network);
  EXPECT_EQ(network.error().message, "network: 0 threads, wanted at least 1");
}

TEST_F(RefusedModel, AnotherInstructionSetThanThisProcessUses) {
  ASSERT_NE(load("tiny_network_int8"), nullptr);
  NetworkOptions capped = options();
  capped.isa = IsaCap::kAvx512;
  const auto network = Network::load(test::fixture("tiny_network_int8.onnx"), capped);
  ASSERT_FALSE(network);
  EXPECT_THAT(network.error().message, HasSubstr(test::engine_under_test().cap_refusal));
}

/// With any single damaged byte, loading must report an error and never crash.
TEST_F(RefusedModel, SurvivesDamagedBytes) {
  const std::string whole = test::read_bytes(test::fixture("wrong_shape.onnx"));
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      EXPECT_NE(message_for_bytes(damaged), "loaded");
    }
  }
}

/// A damaged network is refused, or it runs within its memory.
TEST_F(RefusedModel, RunsDamagedNetworksThatItAccepts) {
  constexpr int kDamaged = 60;
  const std::string whole = test::read_bytes(test::fixture("tiny_network_int8.onnx"));
  const size_t nodes = whole.find("bev_features");  // the nodes come before the constants
  ASSERT_NE(nodes, std::string::npos);
  const test::TemporaryFolder folder;
  const std::string path = folder / "damaged.onnx";
  std::minstd_rand random(1);
  int accepted = 0;
  for (int i = 0; i < kDamaged; ++i) {
    std::string damaged = whole;
    // Small changes of bytes, because lengths are varints: larger ones break the file itself.
    char& byte = damaged[random() % nodes];
    byte = static_cast<char>(byte ^ (1 << random() % 3));
    std::ofstream(path, std::ios::binary) << damaged;
    auto network = Network::load(path, options());
    if (!network) continue;
    ++accepted;
    (*network)->set_view_table(
        test::view_table(kFeatureGrid.cells(), kCameraCount * kImageFeatureCells));
    test::fill_input((*network)->image_input(), 1);
    run_all(**network);
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, kDamaged);
}

}  // namespace
}  // namespace bevloc
