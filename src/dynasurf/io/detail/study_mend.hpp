#pragma once
#include <string>
#include <vector>

#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

// Faults of the data that a person would overlook, and so does the program: each with a note.

/// Values that are not finite become 0 where they lie outside the field of view, as after a resampling: joined to the
/// rim of the volume by others of their kind, and at most half of all voxels. The note is a warning where bright voxels
/// stand beside them. Throws InputError naming the first such voxel of other studies; `where` is the file.
void fill_outside_field(std::vector<Image>& gates, const std::string& where, Notes& notes);

/// Voxels brighter than twice all else and 20 times each of their neighbours become the median of these: no camera and
/// no heart shows a single bright voxel. Does nothing where they are more than 16.
void mend_hot_voxels(Study& study);

/// Gates that hold one value only, at most a quarter of all, become what their neighbours in the beat show in the mean,
/// so that neither the largest nor the smallest volume is theirs. The note is a warning.
void fill_empty_gates(Study& study);

}  // namespace dynasurf::io
