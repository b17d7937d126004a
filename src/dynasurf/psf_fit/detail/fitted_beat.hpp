#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/detail/estimate.hpp"

namespace dynasurf::psf_fit {

/// One gate as fitted. World frame. The triangles are the same for all gates and both walls: `rings` rows of
/// `segments` vertices from the apex (one vertex) to the rim at the base, then the lid that closes the base.
struct FittedGate {
  TriMesh endo, epi;
  heart::Estimate endo_ml, epi_ml;
  heart::BasePlane base;
};

class WallPosterior;

/// The images that the fit compared, in parts of healthy muscle, on its own pixels around the heart: several voxels are
/// joined where they are finer than the point spread needs. World frame like the study.
struct FitImages {
  std::vector<Image> data;   // [gate] as fitted: with the Gaussian in place of an exchanged filter
  std::vector<Image> model;  // [gate] the forward projection of the fitted heart and what lies beside it
  Image weight;              // relative to the largest; 0: not looked at; outliers have lost theirs
};

/// The walls of all gates that explain the image through the point spread, with their errors.
struct FittedBeat {
  std::vector<FittedGate> gates;
  int rings = 0, segments = 0;
  std::vector<double> uptake;  // per vertex of either wall over its median; 0 on the lid
  heart::Estimate wall_ml;     // muscle, mean of the gates
  double wall_variation = 0;   // its coefficient of variation over the beat
  heart::Estimate edv_ml, esv_ml, sv_ml;
  std::optional<heart::Estimate> ef_percent;
  heart::Estimate thickness_mm;  // of the wall at end-diastole: its volume over the mean area of its two sides
  int ed_gate = 0, es_gate = 0;
  heart::Estimate fwhm_mm;
  double cavity = 0, background = 0;  // activities, the wall's median is 1
  double objective = 0;               // what is left, half a sum of squares over their variances
  int steps = 0;
  bool converged = false;
  int extracardiac_sources = 0;  // fitted with the heart
  // How much of the wall's mean thickness and of the point spread's width the data told (wall_posterior.hpp), 0 to 1.
  double thickness_from_data = 1, width_from_data = 1;
  std::shared_ptr<const WallPosterior> posterior;  // how sure anything is that is measured on the walls
  FitImages images;
  Notes notes;
};

}  // namespace dynasurf::psf_fit
