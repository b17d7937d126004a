#include "batch_reason.hpp"

#include <algorithm>

#include "utf8.hpp"

namespace dynasurf::app {

std::string without_names(std::string message, const std::filesystem::path& input) {
  constexpr std::string_view colon = ": ";
  const std::string name = printable(input.string());
  if (name.empty()) return message;
  for (std::size_t at = message.find(name); at != std::string::npos; at = message.find(name, at)) {
    const std::size_t end = at + name.size();
    const bool is_folder = end < message.size() && message[end] == '/';
    const std::size_t until = is_folder ? std::min(message.find(colon, end), message.size()) : end;
    const bool leads = at == 0 && message.compare(until, colon.size(), colon) == 0 && !is_folder;
    const std::string instead = leads ? "" : is_folder ? "one of its files" : "the input";
    message.replace(at, until - at + (leads ? colon.size() : 0), instead);
    at += instead.size();
  }
  return message;
}

std::string reason_in(const std::string& words, const std::filesystem::path& input) {
  constexpr std::string_view sign = "dynasurf: error: ";
  const std::size_t at = words.rfind(sign);
  if (at == std::string::npos) return {};
  const std::string rest = words.substr(at + sign.size());
  return without_names(rest.substr(0, rest.find('\n')), input);
}

}  // namespace dynasurf::app
