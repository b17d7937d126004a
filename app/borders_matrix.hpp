#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "option_arguments.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {

struct BordersArguments {
  std::string study, series;
  OutFolder out;
  OptionArguments options;
  std::vector<std::string> vary;  // path=value,value,...
  int gate = 1, slice = 0;        // from 1; slice 0: the middle of the heart
  int threads = 0;
  bool edges_only = false, quiet = false;
};

enum class Drawing { edges, borders };

/// One gate under every pair of choices, as matrix.png: columns by the first --vary, rows by the second.
void write_matrix(const BordersArguments& arguments, Drawing what, const Image* mask,
                  const std::filesystem::path& folder, const Progress& progress);

}  // namespace dynasurf::app
