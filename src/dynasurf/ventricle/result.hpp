#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/heart/detail/estimate.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/heart/lv_volumes.hpp"
#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/psf_fit/gaussian_profile.hpp"
#include "dynasurf/ventricle/detail/surface.hpp"
#include "dynasurf/ventricle/detail/verdict.hpp"
#include "dynasurf/ventricle/labels.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf::ventricle {

/// How the ventricle's borders were read. `psf_corrected`: surfaces of all gates fitted through the point spread.
/// `edge`: where the blurred image is steepest. `gaussian_profile`: as programs of the QGS family read them.
enum class ReadingKind { psf_corrected, edge, gaussian_profile };
std::span<const std::string_view> names_of(ReadingKind);

/// What one way of reading says of the beat. Numbers are absent where the study is not gated or a surface is missing.
struct Reading {
  ReadingKind kind = ReadingKind::edge;
  std::optional<heart::Estimate> edv_ml, esv_ml, sv_ml, ef_percent;
  std::optional<heart::Estimate> wall_ml;  // mean of the gates
  std::optional<int> ed_gate, es_gate;     // 0-based
};

/// All readings of a study. The edge's is always there, its numbers may be absent.
struct Readings {
  std::optional<psf_fit::FittedBeat> psf_corrected;
  Reading edge;
  std::optional<psf_fit::GaussianProfile> gaussian_profile;
};
/// A fitted beat, or a profile, as one of the readings.
Reading reading_of(const psf_fit::FittedBeat& beat);
Reading reading_of(const psf_fit::GaussianProfile& profile);

/// A surface of the reading that leads. World frame, mm.
struct LeadingSurface {
  TriMesh mesh;
  heart::Estimate volume_ml;
};

/// The surfaces of a gate in the reading that leads; absent where the border was not found.
struct LeadingSurfaces {
  std::optional<LeadingSurface> endo, epi;
  std::optional<heart::BasePlane> base_plane;  // world frame: the surfaces end there
  const std::optional<LeadingSurface>& of(Border wall) const { return wall == Border::endo ? endo : epi; }
};

/// The surfaces that were deformed onto the edges of a gate.
struct EdgeSurfaces {
  std::optional<Surface> endo, epi;
  std::optional<heart::BasePlane> base_plane;  // world frame; absent when it was not found
  std::optional<double> wall_ml;               // epi - endo
  const std::optional<Surface>& of(Border wall) const { return wall == Border::endo ? endo : epi; }
};

/// What was found in one gate.
struct Gate {
  int gate = 0;  // 0-based
  std::optional<double> time_ms;
  LeadingSurfaces surfaces;
  EdgeSurfaces edge_surfaces;
  Labels labels;        // on the canonical grid, apex first
  int base_slice = -1;  // highest slice of the ventricle, -1: unknown
  Mask edges;           // all edges as in EdgeMap, for drawing: they show why a border was not found
};

/// What `reconstruct` made of a study.
struct Result {
  Study study;                           // canonical: slices apex first, values normalised
  std::optional<heart::Location> heart;  // where the ventricle was found in the volume, world frame
  std::vector<Gate> gates;
  Reading leading;  // the answer: the PSF-corrected reading where there is one, else the edge's
  Readings readings;
  std::optional<heart::CurvePhases> phases;  // of the leading curve of the cavity's volume
  std::optional<double> wall_variation;      // coefficient of variation of the edges' wall over the cycle
  std::optional<Measures> measures;          // of the leading surfaces; absent when no gate has one
  Verdict verdict = Verdict::fail;
  std::vector<QualityFlag> flags;
  Notes notes;
  std::vector<std::pair<std::string, double>> seconds;  // per stage, in order, summed over gates
};

}  // namespace dynasurf::ventricle
