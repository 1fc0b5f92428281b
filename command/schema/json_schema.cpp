#include "command/schema/json_schema.h"

#include <algorithm>
#include <utility>

#include "command/schema/key_conditions.h"

namespace bevloc::command {
namespace {

using Json = nlohmann::ordered_json;

void add_number_limits(Json& schema, const YamlLimits& limits, bool whole) {
  const auto number = [whole](double value) {
    return whole ? Json(static_cast<int64_t>(value)) : Json(value);
  };
  if (limits.low) {
    schema[limits.excludes_low ? "exclusiveMinimum" : "minimum"] = number(*limits.low);
  }
  if (limits.high) schema["maximum"] = number(*limits.high);
}

Json schema_of_value(const YamlKey& key) {
  const YamlLimits& limits = key.limits;
  if (!limits.words.empty()) return {{"enum", limits.words}};
  switch (key.type) {
    case YamlType::kFlag:
      return {{"type", "boolean"}};
    case YamlType::kNumber: {
      Json schema = {{"type", "number"}};
      add_number_limits(schema, limits, false);
      return schema;
    }
    case YamlType::kWholeNumber:
    case YamlType::kCount: {
      Json schema = {{"type", "integer"}};
      if (key.type == YamlType::kCount) schema["minimum"] = 0;
      add_number_limits(schema, limits, true);
      return schema;
    }
    case YamlType::kText: {
      // Where the reader wants a text, it accepts an unquoted number as one.
      Json schema = {{"type", {"string", "number", "boolean"}}};
      if (limits.low) schema["minLength"] = static_cast<int64_t>(*limits.low);
      if (limits.high) schema["maxLength"] = static_cast<int64_t>(*limits.high);
      return schema;
    }
    case YamlType::kMap:
      break;
  }
  return {{"type", "object"}};
}

Json schema_of_form(const YamlKey& key) {
  if (!key.is_list) return schema_of_value(key);
  Json schema = {{"type", "array"}, {"items", schema_of_value(key)}};
  if (key.count != 0) {
    schema["minItems"] = key.count;
    schema["maxItems"] = key.count;
  }
  return schema;
}

std::vector<std::string> steps_of(const std::string& path) {
  std::vector<std::string> steps;
  for (std::string rest = path; !rest.empty(); rest = parent_of(rest)) {
    steps.insert(steps.begin(), name_of_key(rest));
  }
  return steps;
}

/// Returns the innermost mapping around all of these keys, which is where a condition can see them.
std::string common_parent(const std::vector<std::string>& paths) {
  std::string common = parent_of(paths.front());
  for (const std::string& path : paths) {
    while (!common.empty() && !path.starts_with(common + ".")) common = parent_of(common);
  }
  return common;
}

/// Wraps what holds for the mapping `inner` so that it holds for the mapping `outer` around it.
/// `needed` also demands that the mappings between them are there.
Json seen_from(const std::string& outer, const std::string& inner, Json content, bool needed) {
  const std::vector<std::string> all = steps_of(inner);
  const size_t skipped = steps_of(outer).size();
  for (size_t i = all.size(); i-- > skipped;) {
    std::string step = all[i];
    if (step.ends_with("[]")) {
      step.resize(step.size() - 2);
      content = {{"items", std::move(content)}};
    }
    Json wrapped = {{"properties", {{step, std::move(content)}}}};
    if (needed) wrapped["required"] = {step};
    content = std::move(wrapped);
  }
  return content;
}

/// Returns the condition that one of these options is taken. `by_default`: a missing key takes one
/// of them, too.
Json taken(const std::string& outer, const std::string& decision,
           const std::vector<std::string>& options, bool by_default) {
  const std::string key = name_of_key(decision);
  const std::string parent = parent_of(decision);
  if (options.front() == YamlRecording::kPresent) {
    return seen_from(outer, parent, {{"required", {key}}}, true);
  }
  if (options.front() == YamlRecording::kAbsent) {
    return {{"not", seen_from(outer, parent, {{"required", {key}}}, true)}};
  }
  Json word = options.size() == 1 ? Json{{"const", options.front()}} : Json{{"enum", options}};
  Json condition = Json::object();
  if (!by_default) condition["required"] = {key};
  condition["properties"] = {{key, std::move(word)}};
  return seen_from(outer, parent, std::move(condition), true);
}

class SchemaWriter {
 public:
  SchemaWriter(const KeyReader& reader, const SchemaTexts& texts)
      : reader_(explore(reader)), keys_(conditions_of(reader_)), texts_(texts) {
    for (const KeyConditions& key : keys_) add_conditions(key);
    for (const WordConditions& word : excluded_words(reader_)) add_exclusion(word);
  }

  Json mapping(const std::string& path) {
    Json schema = {{"type", "object"}, {"additionalProperties", false}};
    Json properties = Json::object();
    Json required = Json::array();
    for (const KeyConditions& key : keys_) {
      if (parent_of(key.path) != path) continue;
      const std::string name = name_of_key(key.path);
      properties[name] = property(key);
      const auto is_required = [](const auto& state) {
        return state.second && state.second->required;
      };
      if (std::ranges::all_of(key.states, is_required)) required.push_back(name);
    }
    schema["properties"] = std::move(properties);
    if (!required.empty()) schema["required"] = std::move(required);
    if (rules_.contains(path)) schema["allOf"] = rules_.at(path);
    return schema;
  }

 private:
  Json property(const KeyConditions& key) {
    const std::vector<YamlKey> forms = key.forms();
    Json schema = schema_of_form(forms.front());
    if (forms.front().type == YamlType::kMap) {
      schema = forms.front().is_list ? Json{{"type", "array"}, {"items", mapping(key.path + "[]")}}
                                     : mapping(key.path);
    } else if (forms.size() > 1) {
      // The conditional rules give the limits of each form.
      schema = Json::object();
      if (std::ranges::all_of(forms, [&](const YamlKey& f) { return f.type == forms[0].type; })) {
        schema = {{"type", schema_of_value({.path = "", .type = forms.front().type}).at("type")}};
      }
    } else {
      drop_excluded_words(key.path, schema);
      if (!forms.front().default_text.empty()) {
        schema["default"] = Json::parse(forms.front().default_text);
      }
    }
    Json described = Json::object();
    if (const std::string text = texts_.describe(key.path); !text.empty()) {
      described["description"] = text;
    }
    described.update(schema);
    return described;
  }

  void drop_excluded_words(const std::string& path, Json& schema) const {
    for (const std::string& word : always_excluded_) {
      if (!word.starts_with(path + "=")) continue;
      Json kept = Json::array();
      for (const Json& other : schema.at("enum")) {
        if (other != word.substr(path.size() + 1)) kept.push_back(other);
      }
      schema["enum"] = std::move(kept);
    }
  }

  /// Returns the condition that one of these options is taken, by a word or by default.
  Json condition_of(const std::string& outer, const std::string& decision,
                    const std::vector<std::string>& options) const {
    const auto key = std::ranges::find(keys_, decision, &KeyConditions::path);
    const std::string default_text = key == keys_.end() ? "" : key->forms().front().default_text;
    const bool by_default = std::ranges::any_of(
        options, [&](const std::string& option) { return Json(option).dump() == default_text; });
    return taken(outer, decision, options, by_default);
  }

  /// Returns what one state demands of the mapping around the key.
  static Json demand(const KeyConditions& key, const KeyState& state) {
    const std::string name = name_of_key(key.path);
    if (!state) return {{"properties", {{name, false}}}};
    Json schema = Json::object();
    if (key.forms().size() > 1) {
      Json form = schema_of_form(*state);
      if (!state->default_text.empty()) form["default"] = Json::parse(state->default_text);
      schema["properties"] = {{name, std::move(form)}};
    }
    if (state->required) schema["required"] = {name};
    return schema;
  }

  void add_conditions(const KeyConditions& key) {
    if (key.decisions.empty()) return;
    std::vector<std::string> involved = key.decisions;
    involved.push_back(key.path);
    const std::string outer = common_parent(involved);
    if (key.decisions.size() == 1) return add_simple(key, outer);
    for (const auto& [options, state] : key.states) {
      Json conditions = Json::array();
      for (size_t i = 0; i < options.size(); ++i) {
        if (!options[i].empty()) {
          conditions.push_back(condition_of(outer, key.decisions[i], {options[i]}));
        }
      }
      add_rule(outer, {{"allOf", std::move(conditions)}}, "then", key, demand(key, state));
    }
  }

  /// Adds one rule for each state, and one for all options that do not allow the key.
  void add_simple(const KeyConditions& key, const std::string& outer) {
    std::vector<std::pair<Json, std::vector<std::string>>> demands;
    std::vector<std::string> allowed;
    for (const auto& [options, state] : key.states) {
      if (!state) continue;
      allowed.push_back(options.front());
      Json wanted = demand(key, state);
      const auto same = std::ranges::find(demands, wanted, [](const auto& d) { return d.first; });
      if (same != demands.end()) {
        same->second.push_back(options.front());
      } else {
        demands.emplace_back(std::move(wanted), std::vector{options.front()});
      }
    }
    const std::string& decision = key.decisions.front();
    for (const auto& [wanted, options] : demands) {
      if (wanted.empty()) continue;
      add_rule(outer, condition_of(outer, decision, options), "then", key, wanted);
    }
    if (allowed.size() < key.states.size()) {
      add_rule(outer, condition_of(outer, decision, allowed), "else", key, demand(key, KeyState()));
    }
  }

  void add_exclusion(const WordConditions& excluded) {
    const KeyConditions& key = excluded.conditions;
    if (key.decisions.empty()) {
      always_excluded_.push_back(key.path + "=" + excluded.word);
      return;
    }
    std::vector<std::string> involved = key.decisions;
    involved.push_back(key.path);
    const std::string outer = common_parent(involved);
    for (const auto& [options, state] : key.states) {
      if (state) continue;
      Json conditions = Json::array();
      for (size_t i = 0; i < options.size(); ++i) {
        conditions.push_back(condition_of(outer, key.decisions[i], {options[i]}));
      }
      const std::string name = name_of_key(key.path);
      add_rule(outer, {{"allOf", std::move(conditions)}}, "then", key,
               {{"properties", {{name, {{"not", {{"const", excluded.word}}}}}}}});
    }
  }

  /// Adds a rule. Rules with the same condition become one.
  void add_rule(const std::string& outer, const Json& condition, const char* branch,
                const KeyConditions& key, const Json& wanted) {
    const Json content = seen_from(outer, parent_of(key.path), wanted, false);
    Json& rules = rules_[outer];
    for (Json& rule : rules) {
      if (rule.at("if") != condition) continue;
      merge(rule[branch], content);
      return;
    }
    rules.push_back({{"if", condition}, {branch, content}});
  }

  /// Adds the demands of `more`. Lists of required keys are joined.
  static void merge(Json& all, const Json& more) {
    for (const auto& [key, value] : more.items()) {
      Json& place = all[key];
      if (value.is_array()) {
        for (const Json& item : value) {
          if (std::ranges::find(place, item) == place.end()) place.push_back(item);
        }
      } else if (value.is_object()) {
        merge(place, value);
      } else {
        place = value;
      }
    }
  }

  ReaderPasses reader_;
  std::vector<KeyConditions> keys_;
  const SchemaTexts& texts_;
  std::map<std::string, Json> rules_;         ///< by the path of the mapping that they hold for
  std::vector<std::string> always_excluded_;  ///< such as "path=word"
};

}  // namespace

Json schema_of(const KeyReader& reader, const SchemaTexts& texts) {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", texts.title}};
  schema.update(SchemaWriter(reader, texts).mapping(""));
  return schema;
}

}  // namespace bevloc::command
