#pragma once
#include <filesystem>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::report {

/// Saves what a run passed through, gate by gate, as files that ParaView and 3D Slicer open: the image, the edges, the
/// labels, the closed borders, the edge maps of pipeline direct and the maps of a drag as NRRD, the fields as NRRD and
/// VTK images, the meshes that surfaces start from, come to rest as and settle to as PLY. Beside them as CSV: the
/// contours of pipeline contour, how many particles are near their border after every step, and where each one ended.
class StageWriter {
 public:
  explicit StageWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}
  void operator()(const ventricle::Intermediates& stages) const;
  /// What the fit saw, made of it and left: data, model and their difference of every gate, and the pixels' weights.
  void write_fit(const psf_fit::FitImages& images) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dynasurf::report
