#include "evaluation/network/answer_command.h"

#include <string_view>

#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include "common/files.h"
#include "common/replace_file.h"
#include "pipeline/network/test_frame.h"

namespace bevloc::evaluation {
namespace {

void set_metadata(onnx::ModelProto& model, std::string_view key, const std::string& value) {
  onnx::StringStringEntryProto* entry = nullptr;
  for (auto& known : *model.mutable_metadata_props()) {
    if (known.key() == key) entry = &known;
  }
  if (entry == nullptr) entry = model.add_metadata_props();
  entry->set_key(std::string(key));
  entry->set_value(value);
}

/// Runs the model on the test frame (pipeline/network/test_frame.h) and writes the answer into the
/// metadata of its ONNX file. The appliance compares its own answer with it. Fails if the file
/// cannot be read, run or written; the file is then unchanged.
Status store_answer(const std::string& model) {
  const auto network = Network::load(model, {});
  if (!network) return tl::unexpected(network.error());
  const auto bytes = read_file(model);
  if (!bytes) return tl::unexpected(bytes.error());
  onnx::ModelProto proto;
  if (!proto.ParseFromString(*bytes)) return fail("{}: is not a complete ONNX file", model);
  const std::string answer = to_text(answer_to_test_frame(**network));
  if (!answer_from(answer)) {
    return fail(
        "{}: found features that are all zero or not finite for the test frame, wanted "
        "those of a trained network; the file is not changed",
        model);
  }
  set_metadata(proto, kAnswerKey, answer);
  return replace_file(model, proto.SerializeAsString());
}

}  // namespace

void AnswerCommand::declare(CLI::App& app) {
  auto* answer = app.add_subcommand(
      "store-answer",
      "Store a model's answer to the test frame, which bevlocd checks, in its file");
  answer->add_option("model", model_, "ONNX file")->capture_default_str();
  answer->footer(
      "Examples:\n"
      "  bevloc store-answer models/nano.onnx");
}

Status AnswerCommand::run() const {
  Status status = store_answer(model_);
  if (status) fmt::print("{}: stored the answer to the test frame\n", model_);
  return status;
}

}  // namespace bevloc::evaluation
