#include "dynasurf/ventricle/reconstruct.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <mutex>

#include "dynasurf/core/detail/fill_gates.hpp"
#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/ventricle/detail/border_planes.hpp"
#include "dynasurf/ventricle/detail/canonical.hpp"
#include "dynasurf/ventricle/detail/cycle.hpp"
#include "dynasurf/ventricle/detail/even_counts.hpp"
#include "dynasurf/ventricle/detail/hot_objects.hpp"
#include "dynasurf/ventricle/detail/quality.hpp"
#include "dynasurf/ventricle/detail/readings.hpp"
#include "dynasurf/ventricle/detail/region.hpp"
#include "dynasurf/ventricle/detail/relabel.hpp"
#include "dynasurf/ventricle/detail/study_run.hpp"
#include "dynasurf/ventricle/label_borders.hpp"
#include "dynasurf/ventricle/labels/detail/circle.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double near_border = 0.9;  // of the way to it
constexpr int room_voxels = 3;       // around a border, for its field

/// The edges of the caller's function, which may have left the image's grid.
image::EdgeMap own_edges(const Image& image, const OwnStages& own) {
  image::EdgeMap edges = own.edges(image);
  if (edges.edges.grid.dims != image.grid.dims || edges.gradient.grid.dims != image.grid.dims)
    throw InputError("stage edges, " + own.edges_name + ": the edges lie on another grid than the image");
  return edges;
}

Labels own_labels(const Image& image, const image::EdgeMap& edges, const OwnStages& own) {
  Labels labels = own.labels(image, edges);
  if (labels.borders.grid.dims != image.grid.dims)
    throw InputError("stage labels, " + own.labels_name + ": the borders lie on another grid than the image");
  labels.borders.grid = image.grid;
  labels.local.resize(image.grid.dims[2]);
  return labels;
}

void find_labels(GateRun& run, const Image& image, const SliceRange& useful, const std::optional<Mask>& region,
                 const StudyContext& context, const Options& options, const OwnStages& own, StageClock& clock) {
  run.edges =
      clock("edges", [&] { return own.edges ? own_edges(image, own) : image::detect_edges(image, options.edges); });
  clear_outside(run.edges.edges, useful);
  if (region) clear_outside(run.edges.edges, *region);
  run.labels = clock("labels", [&] {
    return own.labels ? own_labels(image, run.edges, own)
                      : label_borders(image, run.edges, options.labels, context.labels);
  });
  run.base_slice = run.base_plane
                       ? slice_above(image.grid, *run.base_plane, run.labels.circle.radius_px * image.grid.spacing[0])
                       : find_base_slice(image, run.labels, options.closure.base_level, run.notes);
}

/// Gates whose borders do not fit into the beat are labelled with the help of others, and say so.
void help_strays(std::vector<GateRun>& gates) {
  constexpr double reach_mm = 8;
  std::vector<GateLabels> all;
  all.reserve(gates.size());
  for (const GateRun& gate : gates) all.push_back({&gate.labels, gate.base_slice});
  for (const Helpers& help : gates_to_help(strays_mm(all))) {
    GateRun& gate = gates[help.gate];
    Labels labels = relabel(gate.edges.edges, gates[help.before].labels, gates[help.after].labels, reach_mm);
    if (!labels.has(Border::endo) || !labels.has(Border::epi)) continue;
    labels.notes = gate.labels.notes;
    const std::string why = help.stray_mm
                                ? format("its borders lay %.1f mm from their course over the beat", *help.stray_mm)
                                : std::string("a border was missing");
    labels.notes.push_back(
        {Severity::warning, "labels.gate_follows",
         why + format("; they were told apart with the help of gates %zu and %zu", help.before + 1, help.after + 1)});
    gate.labels = std::move(labels);
  }
}

/// What gates have from each other.
void join_gates(std::vector<GateRun>& gates, const Options& options) {
  if (const Mlc* mlc = std::get_if<Mlc>(&options.labels.method); mlc == nullptr || !mlc->strict_thesis) {
    std::vector<Labels*> labels;
    labels.reserve(gates.size());
    for (GateRun& gate : gates) labels.push_back(&gate.labels);
    share_division_slice(labels);
  }
  help_strays(gates);
}

bool is_empty(const Image& border) {
  return std::all_of(border.values.begin(), border.values.end(), [](float v) { return v == 0; });
}

/// The covers of a border are edges too, as strong as the border itself is in the mean: the thesis put its cover into
/// the data before it made a field of them (VOL-COVER, 6.1.2.1). Without, nothing leads to the open end of a wall.
void put_covers(const Image& border, const Image& closed, Image& edge_map) {
  const Index3 shift = voxel_of(edge_map.grid, to_grid(edge_map.grid, border.grid.origin));
  const Index3& dims = border.grid.dims;
  double sum = 0, count = 0;
  std::vector<std::size_t> covers;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const std::size_t voxel = edge_map.grid.index(i + shift[0], j + shift[1], k + shift[2]);
        if (border(i, j, k) > 0) sum += edge_map.values[voxel], count += 1;
        if (closed(i, j, k) > 0 && !(border(i, j, k) > 0)) covers.push_back(voxel);
      }
  const float strength = count > 0 ? sum / count : 0;
  for (const std::size_t voxel : covers) edge_map.values[voxel] = std::max(edge_map.values[voxel], strength);
}

void make_borders(GateRun& run, const Image& image, const Options& options) {
  for (const Border wall : walls) {
    if (!run.labels.has(wall)) continue;
    const Image found = border_volume(run.labels, wall);
    const Image border = options.closure.cover ? close_border(found, run.base_slice) : found;
    if (is_empty(border)) continue;  // all of it lay above the base
    run.wall(wall).border = with_room(border, room_voxels);
    run.wall(wall).planes = border_planes(run.wall(wall).border, wall, run.labels, run.edges, run.base_slice);
    run.wall(wall).placement = options.placement;
    if (options.pipeline != Pipeline::direct) continue;
    // One field for both walls: who comes from outside would be held by the outer one. In a cavity longer than wide all
    // vectors lead to the nearest wall, so a surface that grows starts near the border in every direction, unless the
    // options name a shape.
    if (wall == Border::endo) {
      mesh::Placement& placement = run.wall(wall).placement;
      placement.direction = mesh::Direction::in_to_out;
      if (placement.shape == mesh::StartShape::ellipsoid)
        placement.shape = mesh::StartShape::radial, placement.inside_scale = near_border;
    }
    run.wall(wall).edge_map = field::edge_map_of(spread_to(image, run.wall(wall).border.grid), options.edge_map);
    put_covers(found, border, run.wall(wall).edge_map);
  }
}

void add_notes(Notes& all, const Notes& some, int gate) {
  for (Note note : some) {
    if (gate >= 0) note.gate = gate;
    all.push_back(std::move(note));
  }
}

Gate finish_gate(GateRun& run, int g, const Result& result) {
  Gate gate;
  gate.gate = g;
  if (!result.study.time_ms.empty()) gate.time_ms = result.study.time_ms[g];
  if (run.endo.surface) run.endo.surface->stack = run.endo.stack;
  if (run.epi.surface) run.epi.surface->stack = run.epi.stack;
  EdgeSurfaces& edge = gate.edge_surfaces;
  edge.endo = std::move(run.endo.surface);
  edge.epi = std::move(run.epi.surface);
  if (edge.endo && edge.epi) edge.wall_ml = edge.epi->volume_ml - edge.endo->volume_ml;
  edge.base_plane = run.base_plane;
  gate.base_slice = run.base_slice;
  gate.labels = std::move(run.labels);
  gate.edges = std::move(run.edges.edges);
  return gate;
}

/// Surfaces that started from the data themselves have triangles of their own in every gate.
void note_correspondence(Result& result) {
  for (const Border wall : walls)
    for (const Gate& gate : result.gates) {
      const auto &first = result.gates[0].surfaces.of(wall), &here = gate.surfaces.of(wall);
      if (first && here && here->mesh.triangles != first->mesh.triangles) {
        result.notes.push_back(
            {Severity::info, "surface.no_correspondence",
             "the surfaces of the gates have different triangles, so nothing is shown between them"});
        return;
      }
    }
}

WallStages stages_of(const WallRun& run, const Image* drag) {
  WallStages stages;
  if (!run.exists()) return stages;
  stages.border = &run.border;
  if (!run.edge_map.values.empty()) stages.edge_map = &run.edge_map;
  stages.drag = drag;
  if (!run.flow.field.x.empty()) stages.field = &run.flow.field;
  if (!run.start.vertices.empty()) stages.start = &run.start;
  if (!run.evolved.mesh.vertices.empty()) stages.evolved = &run.evolved;
  if (run.settled) stages.settled = &*run.settled;
  if (run.contours) stages.contours = &*run.contours;
  return stages;
}

void hand_over_stages(const IntermediateSink& keep, std::vector<GateRun>& runs, const Study& study,
                      const dynamics::Evolution& evolution) {
  for (int g = 0; g < std::ssize(runs); ++g) {
    GateRun& run = runs[g];
    Intermediates stages{g, &study.gates[g], &run.edges, &run.labels, {}, {}};
    std::optional<Image> drags[2];
    for (std::size_t w = 0; w < 2; ++w) {
      const WallRun& wall = run.wall(walls[w]);
      if (wall.exists() && !wall.flow.field.x.empty()) drags[w] = drag_of(wall, study.gates[g], evolution);
      (w == 0 ? stages.endo : stages.epi) = stages_of(wall, drags[w] ? &*drags[w] : nullptr);
    }
    keep(stages);
  }
}

void check_options(Options options) { dynasurf::check_options(options, ""); }

Options without_label(Options options) {
  options.label = 0;
  return options;
}

constexpr std::array<std::string_view, 2> useful_slices_names{"heart", "score"};
constexpr std::array<std::string_view, 3> pipeline_names{"surface", "contour", "direct"};

/// What is bright in a study: a wall, where one was clearly seen, else what the labels of the mean say. One answer for
/// all gates: the cavity of a small heart at end-systole may look filled.
ImageContrast detect_contrast(const Study& study, const std::optional<heart::Location>& heart, const Options& options) {
  if (options.labels.bright != ImageContrast::automatic) return options.labels.bright;
  if (heart && heart->is_believed()) return ImageContrast::wall;
  Notes notes;
  const Image mean = image::normalise(heart::mean_image(study.gates), notes);
  return label_borders(mean, image::detect_edges(mean, options.edges), options.labels).bright;
}

void note_own_stages(const OwnStages& own, Notes& notes) {
  if (own.edges) notes.push_back({Severity::info, "stage.replaced", "the edges were found by " + own.edges_name});
  if (own.labels)
    notes.push_back({Severity::info, "stage.replaced", "the borders were told apart by " + own.labels_name});
}

/// The study with the means of their neighbours in the place of the gates that a person excludes.
Study without_gates(Study study, const std::vector<int>& gates) {
  const int count = study.gates.size();
  std::vector<bool> excluded(study.gates.size());
  for (const int gate : gates) {
    if (gate < 1 || gate > count)
      throw OptionError(format("option manual.exclude_gates names gate %d; expected gates 1 to %d", gate, count));
    excluded[gate - 1] = true;
  }
  if (2 * std::count(excluded.begin(), excluded.end(), true) > count)
    throw OptionError(format("option manual.exclude_gates names more than half of the %d gates", count));
  for (const auto& filled : fill_gates(study.gates, excluded)) {
    const int gate = filled.gate, before = filled.before, after = filled.after;
    study.notes.push_back({Severity::info, "gate.excluded",
                           format("gate %d was excluded by hand: the mean of gates %d and %d stands in its place",
                                  gate + 1, before + 1, after + 1),
                           gate});
  }
  return study;
}

StudyRun run_borders(const Study& whole, const Options& options, const Progress& progress, const Additions& own,
                     const StageKeeper& keep, StageClock& clock) {
  StudyRun run;
  require_workable(whole);
  if (!options.manual.exclude_gates.empty()) run.changed = without_gates(whole, options.manual.exclude_gates);
  if (own.mask != nullptr) {
    run.looked_at = region_on(*own.mask, whole.grid());
    run.changed = confine(run.changed ? *run.changed : whole, *run.looked_at);
  }
  const auto original = [&]() -> const Study& { return run.changed ? *run.changed : whole; };
  const heart::LocateHints hints = hints_of(options.manual);
  std::optional<heart::Location>& heart = run.context.heart;
  LabelContext& labels = run.context.labels;
  const auto find_heart = [&] { return clock("locate", [&] { return locate_upright(original(), hints); }); };
  heart = own.located ? own.located : keep.location(find_heart);
  if (std::optional<Study> even = heart ? with_even_counts(original(), *heart) : std::nullopt)
    run.changed = std::move(*even);
  labels.bright = clock("locate", [&] { return detect_contrast(original(), heart, options); });
  if (labels.bright == ImageContrast::cavity) heart.reset();  // it is looked for by its wall
  const std::optional<Study> cut = heart ? cut_hot_objects(original(), *heart) : std::nullopt;
  Orientation orientation = options.orientation;
  if (hints.axis) orientation.method = OrientationMethod::data;  // slices square to what a person says
  run.study = canonical_study(orient(cut ? *cut : original(), heart, orientation));
  if (heart && !hints.axis) note_ends(original(), *heart, run.study.notes);
  require_inside(options.manual, original(), run.study);
  if (options.prepare.from_least) image::stretch_to_range(run.study.gates, run.study.notes);
  for (Image& image : run.study.gates) {
    if (options.noise_fraction > 0) image = image::suppress_noise(std::move(image), options.noise_fraction);
    image = image::prepare(std::move(image), options.prepare);
  }

  note_own_stages(own.stages, run.study.notes);
  run.gates.resize(run.study.gates.size());
  const CoarseCircle around = circle_around(run.study, heart, options.manual, options.labels.coarse);
  labels.roi = coarse_circle(run.study.grid(), around);
  labels.expected_slice = expected_cavity_end(run.study, heart);
  std::vector<std::optional<heart::BasePlane>> planes(run.gates.size());
  if (options.closure.valve_plane)
    planes = clock("valve plane", [&] { return valve_planes(run.study, heart, options.manual, run.study.notes); });
  const SliceRange useful = options.useful_slices == UsefulSlices::score
                                ? scored_slices(run.study, options.edges, around, options.manual)
                                : useful_slices(run.study, heart, planes, options.manual);
  std::optional<Mask> region;
  if (own.mask != nullptr) region = region_on(*own.mask, run.study.grid());

  const auto is_left_out = [&](int g) { return own.only_gate && g != *own.only_gate; };
  StageCounter borders_found(progress, "borders", run.gates.size());
  parallel_for(run.gates.size(), 1, [&](std::size_t g, std::size_t) {
    if (is_left_out(g)) return;
    progress.check();
    run.gates[g].base_plane = planes[g];
    find_labels(run.gates[g], run.study.gates[g], useful, region, run.context, options, own.stages, clock);
    borders_found.advance();
  });
  if (!own.only_gate) join_gates(run.gates, options);
  parallel_for(run.gates.size(), 1,
               [&](std::size_t g, std::size_t) { make_borders(run.gates[g], run.study.gates[g], options); });
  return run;
}

/// Keeps stages for the caller where he asks for it and their options tell all: functions and a place of his own could
/// be others each time, and who looks at the stages wants more of them than is kept.
StageKeeper keeper_of(const Study& study, const Options& options, const Additions& own) {
  if (own.cache == nullptr || own.keep || own.stages.edges || own.stages.labels || own.located)
    return StageKeeper(options);
  own.cache->kept().begin(study, own.mask, own.start);
  return StageKeeper(options, &own.cache->kept());
}

void add_readings(OtherReadings readings, Result& result) {
  result.readings.psf_corrected = std::move(readings.psf_corrected);
  result.readings.gaussian_profile = std::move(readings.gaussian_profile);
  result.notes.insert(result.notes.end(), readings.notes.begin(), readings.notes.end());
}

std::optional<BorderField> field_of(WallRun& run) {
  if (run.flow.field.x.empty()) return std::nullopt;
  return BorderField{std::move(run.border), std::move(run.flow.field)};
}

/// Gates and notes of the result, from what was found of each gate.
void finish_gates(std::vector<GateRun>& runs, Result& result) {
  result.notes = result.study.notes;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    GateRun& run = runs[n];
    for (const Notes* notes : {&run.edges.notes, &run.labels.notes, &run.notes, &run.endo.flow.notes,
                               &run.endo.evolved.notes, &run.epi.flow.notes, &run.epi.evolved.notes})
      add_notes(result.notes, *notes, n);
    for (const Border wall : walls)
      if (run.wall(wall).surface) add_notes(result.notes, run.wall(wall).surface->notes, n);
    result.gates.push_back(finish_gate(run, n, result));
  }
}

}  // namespace

std::span<const std::string_view> names_of(Pipeline) { return pipeline_names; }
std::span<const std::string_view> names_of(UsefulSlices) { return useful_slices_names; }

BorderResult find_borders(const Study& study, const Options& options, const Progress& progress, const Additions& own) {
  if (options.label > 0) return find_borders(only_label(study, options.label), without_label(options), progress, own);
  check_options(options);
  BorderResult result;
  StageClock clock(result.seconds);
  StudyRun run = run_borders(study, options, progress, own, StageKeeper(options), clock);
  result.notes = run.study.notes;
  result.study = std::move(run.study);
  result.heart = std::move(run.context.heart);
  result.coarse = *run.context.labels.roi;
  if (own.only_gate) {
    GateRun& gate = run.gates.at(*own.only_gate);
    parallel_for(walls.size(), 1,
                 [&](std::size_t w, std::size_t) { make_field(gate.wall(walls[w]), options, progress, clock); });
  }
  for (std::size_t g = 0; g < run.gates.size(); ++g) {
    GateRun& gate = run.gates[g];
    for (const Notes* notes : {&gate.edges.notes, &gate.labels.notes, &gate.notes}) add_notes(result.notes, *notes, g);
    result.gates.push_back(
        {std::move(gate.edges), std::move(gate.labels), gate.base_slice, field_of(gate.endo), field_of(gate.epi)});
  }
  return result;
}

Result reconstruct(const Study& original, const Options& requested, const Progress& progress, const Additions& own) {
  if (requested.label > 0)
    return reconstruct(only_label(original, requested.label), without_label(requested), progress, own);
  if (requested.placement.shape == mesh::StartShape::file && own.start == nullptr)
    throw OptionError("option placement.shape is file; expected a mesh to start from, none was given");
  check_options(requested);
  Result result;
  StageClock clock(result.seconds);
  Options options = requested;
  options.evolution.histories = options.evolution.histories || own.keep;
  const StageKeeper keep = keeper_of(original, options, own);
  StudyRun run = keep.surfaces([&] {
    StudyRun found = keep.borders([&] { return run_borders(original, options, progress, own, keep, clock); });
    find_surfaces(found.gates, found.study, options, own.start, progress, clock);
    measure_surfaces(found.gates, found.study, options, clock);
    return found;
  });
  result.study = std::move(run.study);
  result.heart = std::move(run.context.heart);
  if (own.keep) hand_over_stages(own.keep, run.gates, result.study, options.evolution);
  finish_gates(run.gates, result);
  run.gates.clear();
  measure_cycle(result);
  const Study& looked_at = run.changed ? *run.changed : original;
  add_readings(
      keep.readings([&] { return read_otherwise(looked_at, run.looked_at, options, progress, clock, result); }),
      result);
  choose_leading(result);
  note_correspondence(result);
  result.measures = clock("measures", [&] { return measure_study(result, options.measures); });
  result.flags = assess(result);
  result.verdict = verdict_of(result.flags);
  return result;
}

}  // namespace dynasurf::ventricle
