#include "option_arguments.hpp"

#include <iomanip>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/ventricle/options.hpp"

namespace dynasurf::app {

Image read_mask(const std::filesystem::path& file) {
  Study study = io::read_study(file);
  if (study.gates.size() != 1)
    throw InputError(file.string() + ": holds " + std::to_string(study.gates.size()) +
                     " volumes; expected a mask of one");
  return std::move(study.gates.front());
}

std::string shell_word(const std::string& word) {
  constexpr const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.=,:+/-";
  if (word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  // A single quote ends the quotes, stands escaped by itself, and begins them again.
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> settings_of(const OptionArguments& a) {
  std::vector<std::string> settings;
  if (!a.pipeline.empty()) settings.push_back("pipeline=" + a.pipeline);
  settings.insert(settings.end(), a.settings.begin(), a.settings.end());
  // Streams write six digits, which would cut a place that a person gave.
  const auto set = [&](const std::string& name, double value) {
    TextOutput text;
    text << "manual." << name << '=' << std::setprecision(12) << value;
    settings.push_back(text.str());
  };
  const auto set_place = [&](const std::string& name, const std::vector<double>& numbers) {
    if (numbers.empty()) return;
    TextOutput text;
    text << "manual." << name << '=' << std::setprecision(12) << numbers[0] << ',' << numbers[1] << ',' << numbers[2];
    settings.push_back(text.str());
  };
  set_place("center_mm", a.center);
  set_place("axis", a.axis);
  if (a.radius_mm) set("radius_mm", *a.radius_mm);
  if (a.first_slice) set("first_slice", *a.first_slice);
  if (a.last_slice) set("last_slice", *a.last_slice);
  if (a.base_plane_mm) set("base_plane_mm", *a.base_plane_mm);
  if (a.label) settings.push_back("label=" + std::to_string(*a.label));
  if (a.fwhm_mm) {
    TextOutput text;
    text << "fit.fwhm_mm=" << std::setprecision(12) << *a.fwhm_mm;
    settings.push_back(text.str());
  }
  return settings;
}

void add_series_argument(CommandLine& command, std::string& series) {
  command.option("--series", series,
                 "which image series of a DICOM folder: its number, UID, or a part of its description");
}

void add_option_arguments(CommandLine& command, OptionArguments& a) {
  command.option(
      "--preset", a.preset,
      "psf_corrected, the default: volumes corrected for the point spread; pet, mr, ct: the same at their resolution; "
      "edges: surfaces on the largest gradient alone; thesis: as published");
  command.option("--options", a.file, "JSON file of options, such as the options.json of a result");
  command.option("--pipeline", a.pipeline,
                 "surface; contour: a contour in every slice; direct: one field straight from the image");
  command.option("--set", a.settings, "set one option: path=value; may be repeated (see: dynasurf options)").repeated();
  command.option("--fwhm", a.fwhm_mm,
                 "width of the camera's point spread in the image, mm; 0: sharp; not told: the data decide");
  command.option("--label", a.label, "value of the muscle in a label map; all else is nothing").within(1, 1000000);
  command.option("--center", a.center, "by hand: middle of the heart x,y,z in the world (LPS), mm, to within 25 mm")
      .list_of(3);
  command.option("--axis", a.axis, "by hand: long axis x,y,z from apex to base in the world (LPS)").list_of(3);
  command.option("--radius", a.radius_mm, "by hand: circle around the ventricle, mm");
  command.option("--first-slice", a.first_slice, "by hand: first slice of the ventricle, from 1 at the apex");
  command.option("--last-slice", a.last_slice, "by hand: its last slice");
  command.option("--base-plane", a.base_plane_mm, "by hand: height of the valve plane over slice 1, mm");
  command.option("--mask", a.mask,
                 "by hand: a volume (DICOM, NIfTI, NRRD) in the place of the study; only where it is above 0 the "
                 "study is looked at");
}

void read_options(const std::filesystem::path& file, const OptionNodes& nodes) {
  const std::string text = io::text_of_file(file);
  try {
    io::options_from_text(text, nodes, "");
  } catch (const OptionError& error) {
    throw OptionError(file.string() + ": " + error.what());
  }
}

ventricle::Options options_of(const OptionArguments& arguments) {
  ventricle::Options options = ventricle::preset(arguments.preset);
  if (!arguments.file.empty()) read_options(arguments.file, nodes_of(options));
  set_options(options, settings_of(arguments));
  return options;
}

}  // namespace dynasurf::app
