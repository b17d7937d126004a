#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"
#include "option_arguments.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {

struct BordersArguments {
  std::string study, series, located;
  OutFolder out;
  OptionArguments options;
  std::vector<std::string> vary;  // path=value,value,...
  int gate = 1, slice = 0;        // from 1; slice 0: the middle of the heart
  int threads = 0;
  bool edges_only = false, json = false, quiet = false;
};

enum class Drawing { edges, borders };

/// The gate of --gate, from 1. Throws OptionError where the study has fewer.
int gate_of(const BordersArguments& arguments, const Study& study);

/// Sheets of all gates, or a matrix of choices, in the folder of --out.
ExitCode draw_borders(const BordersArguments& arguments, std::stop_token stop);

/// One gate under every pair of choices, as matrix.png: columns by the first --vary, rows by the second.
void write_matrix(const BordersArguments& arguments, Drawing what, const Image* mask,
                  const std::filesystem::path& folder, const Progress& progress);

}  // namespace dynasurf::app
