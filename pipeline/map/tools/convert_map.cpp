// Converts a map of any supported format to a compact map: bevloc_convert_map town.osm town.bvm
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"

namespace {

bevloc::Status convert(const std::filesystem::path& in, const std::filesystem::path& out) {
  auto allowed = bevloc::check_extension(out, ".bvm");
  if (allowed) allowed = bevloc::check_output(out, {in});
  if (!allowed) return allowed;
  const auto map = bevloc::load_map(in);
  if (!map) return tl::unexpected(map.error());
  if (auto status = bevloc::write_tiled_map(*map, out); !status) return status;
  fmt::print("{}: {}, {} bytes\n", out.string(), bevloc::contents_of(*map),
             std::filesystem::file_size(out));
  for (const std::string& warning : bevloc::warnings_of(*map)) {
    fmt::print(stderr, "{}: {}\n", in.string(), warning);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Converts a map of any format (docs/maps.md) to a compact map (.bvm)");
  std::string in;
  std::string out;
  app.add_option("in", in, "Map to read")->required();
  app.add_option("out", out, "Compact map (.bvm) to write")->required();
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  if (const auto status = convert(in, out); !status) {
    fmt::print(stderr, "bevloc_convert_map: {}\n", status.error().message);
    return bevloc::kBadInput;
  }
  return 0;
}
