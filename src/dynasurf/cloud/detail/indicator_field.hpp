#pragma once
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::cloud {

/// A function that is positive inside the body and negative outside: 0.5 and -0.5 far from the surface. Its grid frame
/// is in steps of `side`: cloud = origin + side * grid frame.
struct IndicatorField {
  Image value;
  double side = 1;
  Vec3 origin{0, 0, 0};
};

/// The value at a place of the cloud's frame, between the nodes; -0.5 beyond the lattice.
double value_at(const IndicatorField& field, const Vec3& place);

/// Direction outwards at a place of the cloud's frame: down the field's slope. Zero where there is none.
Vec3 outwards(const IndicatorField& field, const Vec3& place);

/// The share of the points whose direction is against the field's own.
double share_turned(const OrientedPoints& points, const IndicatorField& field);

struct InsideOptions {
  int cells = 128;       // along the longest side of the cloud
  double closeness = 4;  // how strongly the level 0 is held to the points
  double margin = 0.12;  // free space around the cloud, of its longest side
};

/// The function whose slope is nearest to the normals at the points and zero elsewhere, and whose value is nearest to 0
/// at the points, coarsest lattice first; each has half the steps of the one before (Kazhdan and Hoppe, Screened
/// Poisson surface reconstruction, 2013; here on a lattice by finite differences, solved from coarse to fine by
/// conjugate gradients). Holes between the points close smoothly. The same for any number of threads.
std::vector<IndicatorField> solve_indicator(const OrientedPoints& points, const InsideOptions& options,
                                            const Progress& progress = {});

}  // namespace dynasurf::cloud
