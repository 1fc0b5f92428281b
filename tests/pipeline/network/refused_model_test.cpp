// Tests each reason for which loading refuses a model file or an option, and that damaged files are
// refused or run.
// engine/under_test/ has a file for each form of the engine that these test cases run on.
#include <array>
#include <fstream>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "pipeline/network/network.h"
#include "tests/pipeline/network/engine/engine_under_test.h"
#include "tests/pipeline/network/model_inputs.h"
#include "tests/pipeline/network/network_under_test.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using ::testing::HasSubstr;

/// How the tests damage a byte: one bit, the highest bit, all bits.
constexpr std::array kFlips{0x01, 0x80, 0xFF};

std::string with_flipped(std::string bytes, size_t place, int bits) {
  bytes[place] = static_cast<char>(bytes[place] ^ bits);
  return bytes;
}

class RefusedModel : public ::testing::Test {
 protected:
  std::string message_for(const std::string& path) {
    const auto network = Network::load(path, test::network_options());
    return network ? "loaded" : network.error().message;
  }

  std::string message_for_bytes(const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
    const std::string message = message_for(path_);
    EXPECT_THAT(message, ::testing::StartsWith(path_ + ": "));
    return message;
  }

  /// Whether loading accepts a network of these bytes. If so, it has run.
  bool runs(const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
    const auto network = Network::load(path_, test::network_options());
    if (!network) {
      EXPECT_THAT(network.error().message, ::testing::StartsWith(path_ + ": "));
      return false;
    }
    (*network)->set_view_table(test::network_view_table());
    test::fill_input((*network)->image_input(), 1);
    test::run_all(**network);
    return true;
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

  /// The message for the tiny network with one more entry of metadata (ModelProto.metadata_props,
  /// field 14), which must be short.
  std::string message_after_adding(const std::string& key, const std::string& value) {
    const auto field = [](char tag, const std::string& content) {
      return std::string{tag, static_cast<char>(content.size())} + content;
    };
    const std::string entry = field('\x0A', key) + field('\x12', value);
    return message_for_bytes(test::read_bytes(test::fixture("tiny_network_int8.onnx")) +
                             field('\x72', entry));
  }

 private:
  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "model.onnx";
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

TEST_F(RefusedModel, CorrectionsOfSigmaAndScoreThatAreNotNearOne) {
  for (const std::string key : {"bevloc.solver.score_scale", "bevloc.solver.sigma_scale"}) {
    for (const char* const text : {"1118", "0.01"}) {
      EXPECT_THAT(
          message_after_adding(key, text),
          HasSubstr(fmt::format("metadata '{}' is '{}', wanted a number of 0.1 to 10", key, text)));
    }
  }
}

TEST_F(RefusedModel, NoThreads) {
  const auto network =
      Network::load(test::fixture("tiny_network_int8.onnx"), test::network_options(0));
  ASSERT_FALSE(network);
  EXPECT_EQ(network.error().message, "network: 0 threads, wanted at least 1");
}

TEST_F(RefusedModel, AnotherInstructionSetThanThisProcessUses) {
  ASSERT_NE(test::load_network("tiny_network_int8"), nullptr);
  NetworkOptions capped = test::network_options();
  capped.isa = IsaCap::kAvx512;
  const auto network = Network::load(test::fixture("tiny_network_int8.onnx"), capped);
  ASSERT_FALSE(network);
  EXPECT_THAT(network.error().message, HasSubstr("instruction set of oneDNN is already fixed"));
}

/// Reading and lowering report an error for a damaged byte, or accept it. They never crash.
TEST_F(RefusedModel, RefusesOrLowersAModelWithAnyDamagedByte) {
  const std::string whole = test::read_bytes(test::fixture("conv_unrounded_int8.onnx"));
  ASSERT_NO_THROW(nn::lower(nn::parse_onnx(whole)));
  size_t accepted = 0;
  size_t refused = 0;
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const int flip : kFlips) {
      try {
        nn::lower(nn::parse_onnx(with_flipped(whole, i, flip)));
        ++accepted;
      } catch (const nn::LoadError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(accepted, whole.size() / 10) << "the weights may have any value";
  EXPECT_GT(refused, whole.size() / 2) << "the names of values and operators must fit";
}

/// A damaged network is refused, or it runs within its memory.
TEST_F(RefusedModel, RefusesOrRunsANetworkWithADamagedByte) {
  constexpr size_t kStep = 997;  // each accepted network takes a while to compile
  const std::string whole = test::read_bytes(test::fixture("tiny_network_int8.onnx"));
  ASSERT_TRUE(runs(whole));
  size_t tried = 0;
  size_t accepted = 0;
  for (size_t i = 0; i < whole.size(); i += kStep, ++tried) {
    accepted += runs(with_flipped(whole, i, kFlips[tried % kFlips.size()])) ? 1 : 0;
  }
  EXPECT_GE(accepted, tried / 4) << "the weights may have any value";
  EXPECT_LE(accepted, tried - tried / 8) << "the names of values and operators must fit";
}

/// The same with small changes of the nodes. Lengths are varints, so larger changes break the file
/// itself.
TEST_F(RefusedModel, RunsDamagedNetworksThatItAccepts) {
  constexpr int kDamaged = 60;
  const std::string whole = test::read_bytes(test::fixture("tiny_network_int8.onnx"));
  const size_t nodes = whole.find("bev_features");  // the nodes come before the constants
  ASSERT_NE(nodes, std::string::npos);
  std::minstd_rand random(1);
  int accepted = 0;
  for (int i = 0; i < kDamaged; ++i) {
    const size_t place = random() % nodes;
    accepted += runs(with_flipped(whole, place, 1 << random() % 3)) ? 1 : 0;
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, kDamaged);
}

}  // namespace
}  // namespace bevloc
