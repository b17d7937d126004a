#include "dynasurf/io/detail/json_read.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::io {
namespace {

using Json = nlohmann::ordered_json;

/// Walks over the text and tells how far the parser has read, which its events do not.
struct Cursor {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at = nullptr;
  std::size_t* bytes_read = nullptr;

  const char& operator*() const { return *at; }
  Cursor& operator++() {
    ++at;
    ++*bytes_read;
    return *this;
  }
  Cursor operator++(int) {
    const Cursor before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Cursor& other) const { return at == other.at; }
};

/// "NAME: line 3, column 1: REASON" for the byte before `end`. Columns count bytes.
[[noreturn]] void refuse(std::string_view text, std::size_t end, const std::string& name, const std::string& reason) {
  const std::string_view before = text.substr(0, end > 0 ? end - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_break = before.rfind('\n');
  const std::size_t column = before.size() - (line_break == std::string_view::npos ? 0 : line_break + 1) + 1;
  throw InputError(name + ": line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + reason);
}

/// The parser's own words without its number, its place, and what it read last, which may be as long as the file.
std::string reason_of(const nlohmann::detail::exception& error) {
  constexpr int out_of_range_of_double = 406;
  if (error.id == out_of_range_of_double) return "a number too large; expected one that a double can hold";
  std::string what = error.what();
  if (const auto place = what.find(", column "); place != std::string::npos)
    what.erase(0, what.find(": ", place) + 2);
  else if (const auto number = what.find("] "); number != std::string::npos)
    what.erase(0, number + 2);
  what.erase(std::min(what.size(), what.find("; last read: ")));
  return what.find("; expected") == std::string::npos ? what + "; expected JSON" : what;
}

/// Builds the value from the parser's events, by hand: the map of ordered_json looks through all keys for every key,
/// and copies what it holds, however deep, when it grows.
class Builder {
 public:
  Builder(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::size_t bytes_read = 0;
  Json root;

  bool null() { return add_scalar(nullptr); }
  bool boolean(bool value) { return add_scalar(value); }
  bool number_integer(Json::number_integer_t value) { return add_scalar(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return add_scalar(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return add_scalar(value); }
  bool string(std::string& value) { return add_scalar(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }  // no such thing in a text
  bool start_object(std::size_t) { return open(true); }
  bool start_array(std::size_t) { return open(false); }

  bool key(std::string& value) {
    open_.back().key = std::move(value);
    return true;
  }

  bool end_object() {
    auto members = std::move(open_.back().members);
    refuse_doubles(members);
    Json::object_t object;
    object.reserve(members.size());
    for (auto& [name, value] : members) object.emplace_back(std::move(name), std::move(value));
    open_.pop_back();
    return add(std::move(object));
  }

  bool end_array() {
    Json::array_t items = std::move(open_.back().items);
    open_.pop_back();
    return add(std::move(items));
  }

  bool parse_error(std::size_t place, const std::string&, const nlohmann::detail::exception& error) {
    refuse(text_, place, name_, reason_of(error));
  }

 private:
  using Members = std::vector<std::pair<std::string, Json>>;
  /// A list or an object whose end has not come yet.
  struct Open {
    bool is_object;
    std::string key;  // of the next member
    Members members;
    Json::array_t items;
  };

  [[noreturn]] void refuse_here(const std::string& reason) const { refuse(text_, bytes_read, name_, reason); }

  bool open(bool is_object) {
    if (open_.size() == max_json_depth)
      refuse_here("nested too deep; expected at most " + std::to_string(max_json_depth) + " levels");
    count();
    open_.push_back({is_object, {}, {}, {}});
    return true;
  }

  void count() {
    if (++values_ > max_json_values)
      refuse_here("too many values; expected at most " + std::to_string(max_json_values));
  }

  template <class Value>
  bool add_scalar(Value&& value) {
    count();
    return add(Json(std::forward<Value>(value)));
  }

  bool add(Json value) {
    if (open_.empty())
      root = std::move(value);
    else if (Open& parent = open_.back(); parent.is_object)
      parent.members.emplace_back(std::move(parent.key), std::move(value));
    else
      parent.items.push_back(std::move(value));
    return true;
  }

  /// Most readers silently keep one of two members with the same key, and not all the same one.
  void refuse_doubles(const Members& members) const {
    std::vector<const std::string*> keys;
    keys.reserve(members.size());
    for (const auto& [key, value] : members) keys.push_back(&key);
    std::sort(keys.begin(), keys.end(), [](const auto* a, const auto* b) { return *a < *b; });
    const auto twice =
        std::adjacent_find(keys.begin(), keys.end(), [](const auto* a, const auto* b) { return *a == *b; });
    if (twice == keys.end()) return;
    std::string shown = json_text((*twice)->substr(0, 40), -1);
    shown.pop_back();  // the line break
    refuse_here("the object that ends here has the key " + shown + " twice; expected each key once");
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t values_ = 0;
  std::vector<Open> open_;
};

}  // namespace

nlohmann::ordered_json parse_json(std::string_view text, const std::string& name) {
  if (text.size() > max_json_bytes)
    throw InputError(name + ": holds " + std::to_string(text.size()) + " bytes; expected JSON of at most 64 MiB");
  // The parser takes a zero byte for the end of the text, whatever follows.
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
    refuse(text, zero + 1, name, "a zero byte; expected JSON");
  Builder builder(text, name);
  const Cursor begin{text.data(), &builder.bytes_read}, end{text.data() + text.size(), &builder.bytes_read};
  Json::sax_parse(begin, end, &builder);
  return std::move(builder.root);
}

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  return parse_json(text_of_file(path), path.string());
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dynasurf::io
