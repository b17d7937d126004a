#pragma once
#include <optional>

#include "dynasurf/image/edges.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// What is known of a study before the edges of its gates are labelled.
struct LabelContext {
  ImageContrast bright = ImageContrast::automatic;
  std::optional<Circle> roi;             // in place of the coarse circle; absent: that of the options
  std::optional<double> expected_slice;  // of the cavity's end, where the options tell none
};

/// Tells endocardial from epicardial edges. `image` is normalised, its slices run from apex to base, and
/// `edges.edges` lies on the same grid. Never throws for hard data: what could not be found is absent, with notes.
/// Throws OptionError for parameters out of range.
/// `context` fills in what the options leave open.
Labels label_borders(const Image& image, const image::EdgeMap& edges, const Labelling& options,
                     const LabelContext& context = {});

/// The voxels of one border as a binary volume: the edge map of its field and the stop mask of its surface
/// (VOL-BORDERS, thesis 3.3.4).
Image border_volume(const Labels& labels, Border wall);

}  // namespace dynasurf::ventricle
