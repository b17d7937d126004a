#pragma once
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/report/detail/label_volumes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

#include "command.hpp"
#include "out_argument.hpp"

// The kinds of `dynasurf phantom` that are made in ways of their own.
namespace dynasurf::app {

struct PhantomArguments {
  std::string kind;
  OutFolder out;
  std::vector<std::string> settings;
  std::string seed;
  int threads = 0, count = 0, repeats = 1;
  bool nrrd = false, quiet = false, small = false;
  report::LabelOutput labels;
};

/// The options of a kind that is made by itself, with --set and --seed.
template <Described O>
O options_from(const PhantomArguments& arguments) {
  O options;
  set_options(options, arguments.settings);
  if (!arguments.seed.empty()) set_option(options, "seed=" + arguments.seed);
  return options;
}

/// A scan with its truth: the points, and the surface they were taken from.
ExitCode make_scan(const PhantomArguments& arguments, std::stop_token stop);

/// A height field with spikes, and without them as its truth.
ExitCode make_terrain(const PhantomArguments& arguments, std::stop_token stop);

/// A patient before the camera: projections, slices, truth.
ExitCode make_acquisition(const PhantomArguments& arguments, std::stop_token stop);

/// The true surfaces as truth/endo_g01.ply and so on.
void write_surfaces(const synthetic::Phantom& phantom, const std::filesystem::path& folder);

/// The true volumes as a table, with the notes.
std::string summary_of(const synthetic::Phantom& phantom);

}  // namespace dynasurf::app
