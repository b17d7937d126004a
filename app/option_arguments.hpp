#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "command_line.hpp"

namespace dynasurf::app {

/// The arguments by which the user sets options: defaults < preset < file < --pipeline < --set < by hand.
struct OptionArguments {
  std::string preset = "psf_corrected", file, pipeline, mask;
  std::vector<std::string> settings;
  // What a person says in place of what would be found.
  std::vector<double> center, axis;
  std::optional<double> radius_mm, base_plane_mm;
  std::optional<double> fwhm_mm;  // of the camera
  std::optional<int> label;       // of the muscle in a label map
  std::optional<int> first_slice, last_slice;
};

/// The volume of --mask, with which the file is named in messages. Throws InputError, IoError.
Image read_mask(const std::filesystem::path& file);

/// --series, for `read_study`.
void add_series_argument(CommandLine& command, std::string& series);

void add_option_arguments(CommandLine& command, OptionArguments& arguments);

/// All settings in order; the pipeline and what is said by hand stand as settings of options, so that they are checked,
/// recorded and repeated like every other option.
std::vector<std::string> settings_of(const OptionArguments& arguments);

/// A word as a shell takes it: in quotes where it holds more than letters, digits and _.=,:+/-.
std::string shell_word(const std::string& word);

/// Assigns what a JSON file names. Throws OptionError "FILE: ...", IoError.
void read_options(const std::filesystem::path& file, const OptionNodes& nodes);

/// Throws OptionError, IoError.
ventricle::Options options_of(const OptionArguments& arguments);

}  // namespace dynasurf::app
