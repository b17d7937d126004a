#include "command_line.hpp"

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "dynasurf/core/error.hpp"

namespace dynasurf::app {

Argument& Argument::required() {
  option_->required();
  return *this;
}

Argument& Argument::within(int low, int high) {
  option_->check(CLI::Range(low, high));
  return *this;
}

Argument& Argument::within(double low, double high) {
  option_->check(CLI::Range(low, high));
  return *this;
}

Argument& Argument::one_of(const std::vector<std::string>& words) {
  option_->check(CLI::IsMember(words));
  return *this;
}

Argument& Argument::list() {
  option_->delimiter(',');
  return *this;
}

Argument& Argument::list_of(int count) {
  option_->delimiter(',')->expected(count);
  return *this;
}

Argument& Argument::repeated() {
  // CLI11 would let one --set take every word that follows, those of other arguments too.
  option_->take_all()->allow_extra_args(false);
  return *this;
}

Argument& Argument::one_value() {
  option_->allow_extra_args(false);
  return *this;
}

Argument& Argument::without(const std::string& other) {
  option_->excludes(other);
  return *this;
}

CommandLine::CommandLine(CLI::App& program, const std::string& name, const std::string& what)
    : command_(program.add_subcommand(name, what)) {}

template <class T>
Argument CommandLine::option(const std::string& names, T& to, const std::string& what) {
  return Argument(command_->add_option(names, to, what));
}

// All types of the arguments: the template is made here alone, where CLI11 is known.
template Argument CommandLine::option(const std::string&, std::string&, const std::string&);
template Argument CommandLine::option(const std::string&, int&, const std::string&);
template Argument CommandLine::option(const std::string&, double&, const std::string&);
template Argument CommandLine::option(const std::string&, std::vector<std::string>&, const std::string&);
template Argument CommandLine::option(const std::string&, std::optional<int>&, const std::string&);
template Argument CommandLine::option(const std::string&, std::optional<double>&, const std::string&);
template Argument CommandLine::option(const std::string&, std::vector<int>&, const std::string&);
template Argument CommandLine::option(const std::string&, std::vector<double>&, const std::string&);

Argument CommandLine::flag(const std::string& names, bool& to, const std::string& what) {
  return Argument(command_->add_flag(names, to, what));
}

CLI::App& add_group(CLI::App& program, const std::string& name, const std::string& what) {
  CLI::App* group = program.add_subcommand(name, what);
  group->require_subcommand(1);
  return *group;
}

void refuse_former_name(const std::vector<std::string>& words) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> names{{{"edges", "borders --edges-only"},
                                                                                {"normals", "perfusion build"},
                                                                                {"scores", "perfusion score"},
                                                                                {"compare", "perfusion compare"}}};
  for (const auto& [former, now] : names)
    if (!words.empty() && words.front() == former)
      throw OptionError("'" + std::string(former) + "' is '" + std::string(now) + "' now; see dynasurf --help");
}

void CommandLine::run(Command& chosen, const Command& body) {
  // Parsing only notes what was chosen: it runs once all words are understood and the limit of memory holds.
  command_->callback([&chosen, body] { chosen = body; });
}

}  // namespace dynasurf::app
