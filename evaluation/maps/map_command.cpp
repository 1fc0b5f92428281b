#include "evaluation/maps/map_command.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/files.h"
#include "common/json_dump.h"
#include "common/number_text.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/replace_file.h"
#include "evaluation/check_outputs.h"
#include "evaluation/maps/map_diff.h"
#include "evaluation/maps/map_facts.h"
#include "evaluation/maps/map_picture.h"
#include "pipeline/map/formats/geojson.h"
#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"

namespace bevloc::evaluation {
namespace {

std::optional<double> degrees_from(std::string_view text, double limit_deg) {
  const auto value_deg = parse_number<double>(trimmed_number(text));
  return value_deg && std::abs(*value_deg) <= limit_deg ? value_deg : std::nullopt;
}

Result<GeoOrigin> origin_from(const std::string& text) {
  const size_t comma = std::min(text.find(','), text.size());
  const auto latitude_deg = degrees_from(std::string_view(text).substr(0, comma), 90.0);
  const auto longitude_deg =
      degrees_from(std::string_view(text).substr(std::min(comma + 1, text.size())), 180.0);
  if (!latitude_deg || !longitude_deg) {
    return fail("--origin: found \"{}\", wanted LATITUDE,LONGITUDE in degrees", text);
  }
  const GeoOrigin origin{*latitude_deg, *longitude_deg};
  if (is_known(origin)) return origin;
  return fail("--origin: found \"{}\", wanted a place: (0, 0) stands for an unknown one", text);
}

Status check_map_extension(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".bvm" || extension == ".geojson") return {};
  return fail("{}: found the extension \"{}\", wanted .bvm or .geojson", path.string(), extension);
}

Status write_map(const ImportedMap& imported, const std::filesystem::path& path, bool version_1) {
  const std::string extension = path.extension().string();
  if (extension == ".bvm") {
    return version_1 ? write_map_binary(imported.map, path) : write_tiled_map(imported.map, path);
  }
  const Result<std::string> text = to_geojson(imported);
  return text ? replace_file(path, *text) : Status(tl::unexpected(text.error()));
}

void print_map(const ImportedMap& imported, const std::string& file) {
  fmt::print("{}: {}\n", file, contents_of(imported.map));
  for (const std::string& warning : warnings_of(imported.map)) {
    fmt::print(stderr, "{}: {}\n", file, warning);
  }
}

}  // namespace

void MapCommand::declare(CLI::App& app) {
  auto* map = app.add_subcommand("map", "Import, describe, check, draw and compare maps");
  map->require_subcommand(1);
  map->footer(
      "Formats: Lanelet2, OpenDRIVE, Argoverse 2, nuScenes, GeoJSON and bevloc's own .bvm. "
      "docs/maps.md");
  const auto add = [&](const char* name, const char* what, Status (MapCommand::*action)() const) {
    auto* command = map->add_subcommand(name, what);
    command->add_option("map", in_, "Map file of any format")->required();
    command->callback([this, action] { action_ = action; });
    return command;
  };
  auto* imports =
      add("import", "Convert a map, and say what was taken, dropped and why", &MapCommand::import);
  imports->add_option("out", out_, "Map to write: .bvm or .geojson")
      ->required()
      ->check(replaced_file());
  imports->add_option("--classes", classes_,
                      "YAML file that gives kinds of lines a class (docs/maps.md)");
  imports->add_option("--origin", origin_,
                      "LATITUDE,LONGITUDE of the file's point (0, 0), where x points to true east");
  imports->add_flag("--bvm-1", version_1_,
                    "Write a .bvm of version 1, for releases that cannot read tiles");
  imports->add_option("--report", json_, "Write the report to this JSON file")
      ->check(output_file());
  imports->add_option("--picture", picture_, "Draw the map to this PNG file")->check(output_file());
  auto* infos = add("info", "Say what a map contains", &MapCommand::info);
  infos->add_option("--json", json_, "Write the figures to this JSON file, too")
      ->check(output_file());
  auto* checks = add("check", "Look for what is wrong with a map", &MapCommand::check);
  checks->add_option("--json", json_, "Write the faults to this JSON file, too")
      ->check(output_file());
  auto* renders = add("render", "Draw a map with legend and scale", &MapCommand::render);
  renders->add_option("out", out_, "PNG file to write")->required()->check(output_file());
  renders->add_option("--pixels", size_px_, "Width and height")
      ->capture_default_str()
      ->check(CLI::Range(800, 8000));
  auto* diffs = add("diff", "Compare the lines of two maps by class", &MapCommand::diff);
  diffs->add_option("other", other_, "Map to compare with")->required();
  diffs->add_option("--json", json_, "Write the result to this JSON file, too")
      ->check(output_file());
  diffs->add_option("--picture", picture_, "Draw the differences to this PNG file")
      ->check(output_file());
  imports->footer("Examples:\n  bevloc map import town.xodr town.bvm --picture town.png");
  infos->footer("Examples:\n  bevloc map info town.osm");
  checks->footer("Examples:\n  bevloc map check town.osm --json check.json");
  renders->footer("Examples:\n  bevloc map render town.osm town.png --pixels 2000");
  diffs->footer("Examples:\n  bevloc map diff old.osm new.osm --picture changes.png");
}

Status MapCommand::run() const {
  const Status others = check_outputs({out_, json_, picture_}, {in_, other_, classes_});
  return others ? (this->*action_)() : others;
}

Status MapCommand::check_picture() const {
  return picture_.empty() ? Status() : check_extension(picture_, ".png");
}

Status MapCommand::import() const {
  Status status = check_map_extension(out_);
  if (status) status = check_picture();
  if (!status) return status;
  if (version_1_ && std::filesystem::path(out_).extension() != ".bvm") {
    return fail("--bvm-1: found {} as the map to write, wanted a .bvm", out_);
  }
  ImportOptions options;
  ClassTable classes;
  if (!classes_.empty()) {
    auto read = ClassTable::read_file(classes_);
    if (!read) return tl::unexpected(read.error());
    classes = std::move(*read);
    options.classes = &classes;
  }
  if (!origin_.empty()) {
    const auto origin = origin_from(origin_);
    if (!origin) return tl::unexpected(origin.error());
    options.origin = *origin;
  }
  const auto imported = import_map(in_, options);
  if (!imported) return tl::unexpected(imported.error());
  fmt::print("{}", text_of(imported->report));
  status = write_option_file(json_, json_document(json_of(*imported)));
  if (status) status = write_map(*imported, out_, version_1_);
  if (!status) return status;
  print_map(*imported, out_);
  return picture_.empty() ? Status() : write_map_picture(imported->map, size_px_, picture_);
}

Status MapCommand::info() const {
  const auto imported = import_map(in_, {});
  if (!imported) return tl::unexpected(imported.error());
  print_map(*imported, in_);
  const MapFacts facts = facts_of(imported->map);
  fmt::print("{}", text_of(facts));
  return write_option_file(json_, json_document(json_of(facts)));
}

Status MapCommand::check() const {
  const auto imported = import_map(in_, {});
  if (!imported) return tl::unexpected(imported.error());
  const std::vector<std::string> found = faults_of(imported->map);
  for (const std::string& fault : found) fmt::print("{}: {}\n", in_, fault);
  const nlohmann::json json{{"faults", found}, {"left_out", imported->map.left_out}};
  if (Status status = write_option_file(json_, json_document(json)); !status) return status;
  if (!found.empty()) {
    return fail("{}: found {} fault{}, wanted none", in_, found.size(),
                found.size() == 1 ? "" : "s");
  }
  fmt::print("good: {}\n", contents_of(imported->map));
  return {};
}

Status MapCommand::render() const {
  if (Status status = check_extension(out_, ".png"); !status) return status;
  const auto map = load_map(in_);
  if (!map) return tl::unexpected(map.error());
  return write_map_picture(*map, size_px_, out_);
}

Status MapCommand::diff() const {
  if (Status status = check_picture(); !status) return status;
  const auto first = load_map(in_);
  if (!first) return tl::unexpected(first.error());
  auto second = load_map(other_);
  if (!second) return tl::unexpected(second.error());
  if (is_known(first->origin) != is_known(second->origin)) {
    fmt::print(
        stderr,
        "{}: this map does not say where on earth it is, so its coordinates are compared as if "
        "both maps had the same origin; `bevloc map import --origin` gives a map its place\n",
        is_known(first->origin) ? other_ : in_);
  }
  if (Status near = check_near(*first, *second); !near) {
    return fail("{}, {}: {}", in_, other_, near.error().message);
  }
  const MapDiff difference = compare(*first, *second);
  fmt::print("{}", text_of(difference));
  if (Status status = write_option_file(json_, json_document(json_of(difference))); !status)
    return status;
  return picture_.empty() ? Status() : write_diff_picture(difference, size_px_, picture_);
}

}  // namespace bevloc::evaluation
