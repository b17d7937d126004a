#include "dynasurf/ventricle/detail/study_run.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr FirstTouched<Stage> first_touched[]{
    {"pipeline", Stage::borders},
    {"orientation.", Stage::borders},
    {"manual.first_slice", Stage::borders},
    {"manual.last_slice", Stage::borders},
    {"manual.base_", Stage::borders},
    {"useful_slices", Stage::borders},
    {"noise_fraction", Stage::borders},
    {"prepare.", Stage::borders},
    {"edges", Stage::borders},
    {"labels.", Stage::borders},
    {"closure.", Stage::borders},
    {"edge_map.", Stage::borders},
    {"placement.", Stage::borders},
    {"field", Stage::surfaces},
    {"mesh_level", Stage::surfaces},
    {"evolution.", Stage::surfaces},
    {"contour.", Stage::surfaces},
    {"warm_", Stage::surfaces},
    {"settle.", Stage::surfaces},
    {"tidy.", Stage::surfaces},
    {"manual.endo_points", Stage::readings},
    {"manual.epi_points", Stage::readings},
    {"fit.", Stage::readings},
    {"manual.decision", Stage::measures},
    {"manual.reader", Stage::measures},
    {"manual.comment", Stage::measures},
    {"keyframes.", Stage::measures},
    {"measures.", Stage::measures},
};

/// Whether two things that may be absent are the same.
template <class T>
bool is_same(const std::optional<T>& kept, const T* given) {
  return given == nullptr ? !kept : kept == *given;
}

template <class T>
std::optional<T> copied(const T* given) {
  return given == nullptr ? std::nullopt : std::optional<T>(*given);
}

}  // namespace

std::string options_up_to(Stage stage, const Options& options) {
  std::string text = dynasurf::options_up_to<Stage>(stage, first_touched, options);
  if (stage >= Stage::surfaces && options.evolution.histories) text += "evolution.histories";  // not described
  return text;
}

void KeptStages::begin(const Study& of, const Image* mask_of, const TriMesh* start_of) {
  if (study == of && is_same(mask, mask_of) && is_same(start, start_of)) return;
  *this = {};
  study = of;
  mask = copied(mask_of);
  start = copied(start_of);
}

}  // namespace dynasurf::ventricle
