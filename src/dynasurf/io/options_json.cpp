#include "dynasurf/io/options_json.hpp"

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::io {
namespace {

using Json = nlohmann::ordered_json;

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

std::string short_text(const Json& json) {
  std::string text = json_text(json, -1);
  text.pop_back();  // the line break
  if (text.size() > 40) text = text.substr(0, 37) + "...";
  return text;
}

Json value_of(const OptionNode& node) {
  return std::visit(Overload{[](const auto* value) { return Json(*value); },
                             [](const std::optional<double>* v) { return *v ? Json(**v) : Json(); },
                             [](const std::optional<int>* v) { return *v ? Json(**v) : Json(); },
                             [](const std::optional<std::array<double, 3>>* v) { return *v ? Json(**v) : Json(); },
                             [](const WordRef& word) { return Json(word.words[word.get()]); },
                             [](const ChoiceRef& choice) {
                               const std::size_t current = choice.current();
                               Json object = {{"method", choice.methods[current]}};
                               object.update(options_to_json(choice.choose(current)));
                               return object;
                             },
                             [](const GroupRef& group) { return options_to_json(group.members); }},
                    node.ref);
}

void require_object(const Json& json, const std::string& path) {
  if (json.is_object()) return;
  throw OptionError((path.empty() ? "the options are " : "option " + path + " is ") + short_text(json) +
                    "; expected an object {...}");
}

void assign_members(const Json& json, const OptionNodes& nodes, const std::string& path, bool in_family);

void assign_method(const Json& json, const ChoiceRef& choice, const OptionNode& node, const std::string& path) {
  if (json.is_string()) {
    choice.choose(position_of(choice.methods, json.get_ref<const std::string&>(), path));
    return;
  }
  require_object(json, path);
  // The method is chosen before any member is assigned, wherever its key stands: which members there are depends on it.
  std::size_t wanted = choice.current();
  if (const auto method = json.find("method"); method != json.end()) {
    if (!method->is_string()) throw_wrong_value(node, path + ".method", short_text(*method));
    wanted = position_of(choice.methods, method->get_ref<const std::string&>(), path + ".method");
  }
  assign_members(json, choice.choose(wanted), path, true);
}

void assign(const Json& json, const OptionNode& node, const std::string& path) {
  const auto wrong = [&] { throw_wrong_value(node, path, short_text(json)); };
  const auto number = [&]<class Number>(Number& target, const Json& value) {
    // Whole numbers must be written as such: 2.0 for a count is more often a slip than meant.
    const bool right_type = std::is_floating_point_v<Number> ? value.is_number() : value.is_number_integer();
    if (!right_type || !in_range(node.field, value.get<double>())) wrong();
    if constexpr (std::is_integral_v<Number>) {
      // The limits of an option may be wider than its type; the JSON keeps positive numbers unsigned, others signed.
      const bool fits = value.is_number_unsigned() ? std::in_range<Number>(value.get<std::uint64_t>())
                                                   : std::in_range<Number>(value.get<std::int64_t>());
      if (!fits) wrong();
    }
    target = value.get<Number>();
  };
  const auto optional = [&]<class Number>(std::optional<Number>& target) {
    if (json.is_null()) {
      target.reset();
      return;
    }
    Number value{};
    number(value, json);
    target = value;
  };
  const auto list = [&]<class Number>(std::vector<Number>& target) {
    if (!json.is_array()) wrong();
    std::vector<Number> numbers(json.size());
    for (std::size_t n = 0; n < numbers.size(); ++n) number(numbers[n], json[n]);
    target = numbers;
  };
  std::visit(Overload{[&](bool* v) {
                        if (!json.is_boolean()) wrong();
                        *v = json.get<bool>();
                      },
                      [&](std::string* v) {
                        if (!json.is_string()) wrong();
                        *v = json.get<std::string>();
                      },
                      [&](double* v) { number(*v, json); }, [&](int* v) { number(*v, json); },
                      [&](std::uint64_t* v) { number(*v, json); }, [&](std::optional<double>* v) { optional(*v); },
                      [&](std::optional<int>* v) { optional(*v); },
                      [&]<class Number>(std::vector<Number>* v) {
                        // Options of earlier versions hold a text.
                        if (json.is_string()) return assign_text(node, path, json.get_ref<const std::string&>());
                        list(*v);
                      },
                      [&](std::optional<std::array<double, 3>>* v) {
                        if (json.is_null()) return v->reset();
                        std::vector<double> three;
                        list(three);
                        if (three.size() != 3) wrong();
                        *v = {three[0], three[1], three[2]};
                      },
                      [&](const WordRef& word) {
                        if (!json.is_string()) wrong();
                        word.set(position_of(word.words, json.get_ref<const std::string&>(), path));
                      },
                      [&](const ChoiceRef& choice) { assign_method(json, choice, node, path); },
                      [&](const GroupRef& group) { assign_members(json, group.members, path, false); }},
             node.ref);
}

void assign_members(const Json& json, const OptionNodes& nodes, const std::string& path, bool in_family) {
  require_object(json, path);
  for (const auto& [key, value] : json.items()) {
    if (in_family && key == "method") continue;
    const OptionNode* found = nullptr;
    for (const OptionNode& node : nodes)
      if (node.name == key) found = &node;
    // A misspelt option must not leave a default in force unnoticed.
    if (found == nullptr) throw_unknown_option(nodes, path, key, in_family);
    assign(value, *found, join_path(path, key));
  }
}

}  // namespace

Json options_to_json(const OptionNodes& nodes) {
  Json object = Json::object();
  for (const OptionNode& node : nodes) object[std::string(node.name)] = value_of(node);
  return object;
}

std::string options_to_text(const OptionNodes& nodes) { return json_text(options_to_json(nodes)); }

void options_from_json(const Json& json, const OptionNodes& nodes, const std::string& path) {
  assign_members(json, nodes, path, false);
}

void options_from_text(std::string_view text, const OptionNodes& nodes, const std::string& path) {
  Json json;
  try {
    json = parse_json(text, path.empty() ? "the options" : path);
  } catch (const InputError& error) {
    throw OptionError(error.what());
  }
  options_from_json(json, nodes, path);
}

}  // namespace dynasurf::io
