#include <array>

#include "target.hpp"

namespace dynasurf::fuzz {

std::span<const Target> all_targets() {
  static constexpr std::array targets{
      Target{"dicom", run_dicom},
      Target{"dicom_folder", run_dicom_folder},
      Target{"nifti", run_nifti},
      Target{"nifti_gz", run_nifti_gz},
      Target{"nifti_pair", run_nifti_pair},
      Target{"nrrd", run_nrrd},
      Target{"nhdr", run_nhdr},
      Target{"ply", run_ply},
      Target{"stl", run_stl},
      Target{"obj", run_obj},
      Target{"off", run_off},
      Target{"las", run_las},
      Target{"pcd", run_pcd},
      Target{"ptx", run_ptx},
      Target{"e57", run_e57},
      Target{"rows", run_rows},
      Target{"tracks", run_tracks},
      Target{"glb", run_glb},
      Target{"json", run_json},
      Target{"options", run_options},
      Target{"settings", run_settings},
      Target{"normals", run_normals},
      Target{"manifest", run_manifest},
  };
  return targets;
}

}  // namespace dynasurf::fuzz
