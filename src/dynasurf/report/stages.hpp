#pragma once
#include <filesystem>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {

/// Saves what a run passed through, gate by gate, as files that ParaView and 3D Slicer open: the image, the edges, the
/// labels and the closed borders as NRRD, the fields as VTK images, the meshes that the surfaces start from as PLY.
class StageWriter {
 public:
  explicit StageWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}
  void operator()(const Intermediates& stages) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dynasurf
