#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/show/detail/canvas.hpp"
#include "dynasurf/ventricle/options.hpp"

namespace dynasurf::show {

/// What is to be drawn, and from what.
struct ShowRequest {
  std::filesystem::path input;  // a study, a folder of dynasurf ventricle, or a mesh
  std::string what;             // a name of `pictures`
  std::string series;           // of a DICOM folder
  int gate = 1;                 // from 1
  ventricle::Border wall = ventricle::Border::epi;
  int slice = 0, row = 0;       // from 1; 0: through the middle of the wall
  std::vector<int> steps;       // of the evolution; empty: eight, or 32 in its film
  ventricle::Options options;   // for a study
  std::vector<TriMesh> levels;  // of detail, finest first, for `instances`
};

/// A picture that can be asked for by name.
struct PictureKind {
  std::string_view name, says;
};
/// All pictures and films.
std::span<const PictureKind> picture_kinds();

/// Throws OptionError for a name that is none, InputError where the input does not hold what the picture needs.
Canvas draw_picture(const ShowRequest& request, const Progress& progress = {});

/// Whether the name is that of drawings that follow each other.
bool is_film(std::string_view what);
/// Draws them; throws as `draw_picture`.
Film draw_film(const ShowRequest& request, const Progress& progress = {});

}  // namespace dynasurf::show
