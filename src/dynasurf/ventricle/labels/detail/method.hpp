#pragma once
#include "dynasurf/ventricle/labels/detail/circle.hpp"

// What every labelling method gets, and where each has its own source.

namespace dynasurf::ventricle {

struct LabelScene {
  const Image& image;
  const Labelling& options;
  Circle coarse;                         // nothing is looked at outside
  Axis axis;                             // of the ventricle
  Circle circle;                         // automatic
  SliceEdges inside;                     // the edges inside the automatic circle
  std::optional<double> expected_slice;  // of the cavity's end, by the shape of the whole heart
};

/// Labels' bits per voxel. May set the division slice and add notes.
Mask label(const LabelScene& scene, const Mlc& method, Labels& labels);
Mask label(const LabelScene& scene, const NoLabels& method, Labels& labels);
Mask label(const LabelScene& scene, const SignLabels& method, Labels& labels);
Mask label(const LabelScene& scene, const GradMagLabels& method, Labels& labels);
Mask label(const LabelScene& scene, const CaseLabels& method, Labels& labels);
Mask label(const LabelScene& scene, const RadialLabels& method, Labels& labels);

constexpr std::uint8_t either_wall = Labels::endo_bit | Labels::epi_bit;

/// Adds "labels.not_told_apart".
void note_not_told_apart(Notes& notes);

}  // namespace dynasurf::ventricle
