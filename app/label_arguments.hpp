#pragma once
#include "dynasurf/report/detail/label_volumes.hpp"

#include "command_line.hpp"

namespace dynasurf::app {

/// `--labels` and `--partial-volumes`, of studies and of phantoms.
inline void add_label_arguments(CommandLine& command, report::LabelOutput& labels) {
  command.option("--labels", labels.ending, "write walls and borders as voxels too, in this format: nii.gz, nii");
  command.flag("--partial-volumes", labels.partial_volumes,
               "with --labels: the part of each voxel that is cavity and wall too");
}

}  // namespace dynasurf::app
