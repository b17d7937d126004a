#pragma once
#include <span>
#include <string>
#include <string_view>

#include "dynasurf/core/error.hpp"

namespace dynasurf::fuzz {

/// A reader under test: takes any bytes; true when it read them, false when it refused them. It must not crash, hang,
/// leak, or throw anything but the three errors of this project.
struct Target {
  std::string_view name;
  bool (*run)(std::string_view bytes);
};

/// All of them, in the order in which `./dev fuzz` lists them.
std::span<const Target> all_targets();

bool run_dicom(std::string_view bytes);
bool run_dicom_folder(std::string_view bytes);
bool run_nifti(std::string_view bytes);
bool run_nifti_gz(std::string_view bytes);
bool run_nifti_pair(std::string_view bytes);
bool run_nrrd(std::string_view bytes);
bool run_nhdr(std::string_view bytes);
bool run_ply(std::string_view bytes);
bool run_stl(std::string_view bytes);
bool run_obj(std::string_view bytes);
bool run_off(std::string_view bytes);
bool run_las(std::string_view bytes);
bool run_pcd(std::string_view bytes);
bool run_ptx(std::string_view bytes);
bool run_e57(std::string_view bytes);
bool run_rows(std::string_view bytes);
bool run_tracks(std::string_view bytes);
bool run_glb(std::string_view bytes);
bool run_json(std::string_view bytes);
bool run_options(std::string_view bytes);
bool run_settings(std::string_view bytes);
bool run_normals(std::string_view bytes);
bool run_manifest(std::string_view bytes);

/// Stops the process when a promise is broken: that is what the fuzzer looks for.
void require(bool promise, std::string_view what);

/// Runs a reader that may refuse: InputError and IoError in one line that begins with `name`, where one is given;
/// OptionError in one line. Anything else that is thrown is a finding.
template <class Read>
bool reads(std::string_view name, Read&& read) {
  const auto check = [](std::string_view text, std::string_view begin) {
    require(!text.empty() && text.find('\n') == std::string_view::npos, "an error is one line");
    require(text.starts_with(begin), "an error begins with the name of the file");
  };
  try {
    read();
    return true;
  } catch (const InputError& error) {
    check(error.what(), name);
  } catch (const IoError& error) {
    check(error.what(), name);
  } catch (const OptionError& error) {
    check(error.what(), "");
  }
  return false;
}

}  // namespace dynasurf::fuzz
