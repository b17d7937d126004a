#pragma once
#include <string>
#include <vector>

#include "command.hpp"

namespace CLI {
class Option;
}

namespace dynasurf::app {

// The few words in which commands declare their arguments. CLI11, which understands them, is included by the sources
// behind this header alone: its headers take a compiler seconds.

/// An argument that was declared, to be told more of.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}
  Argument& required();
  /// Numbers outside [low, high] are refused.
  Argument& within(int low, int high);
  Argument& within(double low, double high);
  /// Other words are refused.
  Argument& one_of(const std::vector<std::string>& words);
  /// Values are parted by commas: as many as come, or exactly `count`.
  Argument& list();
  Argument& list_of(int count);
  /// One value each time, and any number of times.
  Argument& repeated();
  /// Takes one value, however many times it may stand.
  Argument& one_value();
  /// Cannot stand beside another option.
  Argument& without(const std::string& other);

 private:
  CLI::Option* option_;
};

/// A command, as its arguments are declared.
class CommandLine {
 public:
  /// Adds the command to the program.
  CommandLine(CLI::App& program, const std::string& name, const std::string& what);

  /// An option (`--name`) or, without dashes, what stands in this place. T: std::string, int, double, an
  /// optional number, or a vector of them.
  template <class T>
  Argument option(const std::string& names, T& to, const std::string& what);
  Argument flag(const std::string& names, bool& to, const std::string& what);

  /// What the command does once the user names it.
  void run(Command& chosen, const Command& body);

 private:
  CLI::App* command_;
};

/// Adds a command that only gathers others, and returns what they are added to.
CLI::App& add_group(CLI::App& program, const std::string& name, const std::string& what);

/// Throws OptionError that tells today's name of the command where the first word is a former one.
void refuse_former_name(const std::vector<std::string>& words);

}  // namespace dynasurf::app
