#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/cloud/detail/indicator_field.hpp"
#include "dynasurf/cloud/options.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {

/// The surface of a field at `level`, in the cloud's frame, without components supported by less than `smallest_share`
/// of the points: those nearest to fewer.
TriMesh body_surface(const IndicatorField& field, double level, std::span<const Vec3> points, double smallest_share);

/// The mesh without components that fewer than `smallest_share` of the points are nearest to; the largest stays.
TriMesh without_small_parts(TriMesh mesh, std::span<const Vec3> points, double smallest_share);

/// The field changed so that the inside is one ball without handles or cavities: it grows from its innermost node, the
/// most inward node first, and leaves out every node that would close a handle (simple points, Bertrand and Malandain
/// 1994). Values become 0.3 inside and -0.5 outside.
IndicatorField without_handles(const IndicatorField& field);

/// What a closed surface is: separate pieces, and handles of all of them together.
struct BodyTopology {
  int parts = 0, genus = 0;
  bool operator==(const BodyTopology&) const = default;
};

/// The surface to start from, and what it is.
struct Body {
  TriMesh mesh;  // closed, manifold, oriented, in the cloud's frame
  int parts = 0, genus = 0;
  bool handles_cut = false;
  IndicatorField field;  // that it comes from
};

/// Turns the surface, with its field, to the other side.
void turn(Body& body);

/// Nothing tells which side of a terrain is out: what is flat as a whole, and no upright front, faces up.
void turn_upwards(Body& body);

/// Chooses among the fields, coarsest first. `automatic`: the finest whose surface keeps its parts and handles when the
/// level is raised or lowered a little, which accidents of the sampling do not; `zero`: the finest without handles;
/// `keep`: the finest. Where that is a coarse field, a finer one is taken whose surface has the same parts and handles
/// at a level a little higher or lower. `expected` is what the surface should be after holes were filled; fields that
/// show it come first. Where no field does, "cloud.handles" tells which was taken instead. A body of negative volume is
/// turned, with its field. Throws InputError when there is no surface at all.
Body choose_body(const std::vector<IndicatorField>& fields, std::span<const Vec3> points, const Options& options,
                 Notes& notes, const std::optional<BodyTopology>& expected = {});

/// How sure parts and handles are. Surfaces at five levels, up to 0.2 off, of the two finest fields are looked at; the
/// share of those that have this kind, among them and those of another kind that the points do not contradict.
/// Surfaces that leave over 2 % of the points farther than `reach` away are contradicted. 1 where none is left.
double firmness_of(std::span<const IndicatorField> fields, std::span<const Vec3> points, double smallest_share,
                   const BodyTopology& kind, double reach);

/// The share of the points that the field's surface at `level` passes at more than `reach`, by probes in 14 directions.
double share_passed_by(const IndicatorField& field, double level, std::span<const Vec3> points, double reach);

}  // namespace dynasurf::cloud
