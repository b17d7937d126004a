#include "dynasurf/show/show.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/show/detail/inputs.hpp"
#include "dynasurf/show/detail/motion.hpp"
#include "dynasurf/show/detail/palette.hpp"
#include "dynasurf/show/detail/pictures.hpp"
#include "dynasurf/show/detail/plane.hpp"
#include "dynasurf/ventricle/detail/closure.hpp"
#include "dynasurf/ventricle/detail/contour_pipeline.hpp"

namespace dynasurf::show {
namespace {

namespace fs = std::filesystem;

constexpr ventricle::Border walls[] = {ventricle::Border::endo, ventricle::Border::epi};

io::Colour colour_of(ventricle::Border wall) { return wall == ventricle::Border::endo ? ink_of::endo : ink_of::epi; }
std::string word_for(ventricle::Border wall) { return wall == ventricle::Border::endo ? "inner wall" : "outer wall"; }

/// One request with what was read for it.
class Show {
 public:
  Show(const ShowRequest& request, const Progress& progress) : r_(request), progress_(progress) {}

  Canvas slice() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    const field::VectorField field = field_of(wall, gate.options);
    // The border's grid may have room around the image; field and image must lie on one grid to be drawn together.
    const Image image = ventricle::spread_to(gate.image, wall.border.grid);
    const Place at = place_in(gate, wall);
    SliceView view{&image, &field, at.slice, at.row, at.slice_number, &wall.border, "", {}};
    view.title = "Field and image, " + where(at) + ", " + word_for(r_.wall);
    view.parameters = parameters_of(gate.options, wall);
    if (!wall.start.vertices.empty()) view.paths = paths_in(wall, field, gate.options.evolution, at.slice, progress_);
    return draw_slice_view(view);
  }

  Canvas field() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    std::vector<NamedField> fields;
    // The values of mu are among those of table 6.2 and of the runs of the thesis; its convergence tests compare 25 to
    // 200 iterations (table 6.12).
    for (const int iterations : {50, 150})
      for (const double mu : {0.15, 0.5, 2.0}) {
        field::Gvf options{.mu = mu, .iterations = iterations};
        fields.push_back({"mu " + number_text(mu) + ", " + std::to_string(iterations) + " iterations",
                          field::flow_field(wall.map, options, progress_).field});
      }
    const Place at = place_in(gate, wall);
    return draw_field_grid(fields, 3, at.slice, at.row,
                           "Gradient vector flow by mu and iterations, " + where(at) + ", " + word_for(r_.wall),
                           &wall.border);
  }

  Canvas field3d() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    return draw_field_3d(field_of(wall, gate.options), wall.border,
                         "Field of the " + word_for(r_.wall) + ", gate " + std::to_string(r_.gate) +
                             ": vectors in the middle, and lines that follow it");
  }

  Canvas voxels() const {
    const ShownGate gate = read_gate();
    std::vector<NamedVoxels> sets;
    for (const ventricle::Border wall : walls)
      if (gate.of(wall))
        sets.push_back({"border of the " + word_for(wall), gate.of(wall)->border, colour_of(wall),
                        wall == ventricle::Border::endo ? 1.0 : 0.2});
    return draw_voxels(sets, "Borders of gate " + std::to_string(r_.gate));
  }

  Canvas labels() const {
    const ShownGate gate = read_gate();
    std::array<Image, 3> bits{Image(gate.labels.grid), Image(gate.labels.grid), Image(gate.labels.grid)};
    for (std::size_t n = 0; n < gate.labels.values.size(); ++n)
      // Two bits, inner and outer: a voxel that has both is drawn as a set of its own.
      if (const auto label = static_cast<int>(gate.labels.values[n]); label >= 1 && label <= 3)
        bits[label - 1].values[n] = 1;
    const NamedVoxels sets[] = {
        {"inner", bits[0], ink_of::endo, 1}, {"outer", bits[1], ink_of::epi, 0.45}, {"both", bits[2], ink_of::pink, 1}};
    return draw_voxels(sets, "Labelled edges of gate " + std::to_string(r_.gate));
  }

  Canvas damping() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    const dynamics::Evolution& evolution = gate.options.evolution;
    const field::VectorField field = field_of(wall, gate.options);
    std::optional<Image> map = wall.drag;
    if (!map) map = dynamics::drag_map(evolution.damping, field, wall.border, evolution.force.drag);
    const std::string which = map ? "as the run had it" : "near the border (the run's own is the same everywhere)";
    // A uniform drag has no map of its own; what BorderDrag would give is shown in its place, and the title says so.
    if (!map) map = dynamics::drag_near_border(wall.border, evolution.force.drag);
    return draw_voxel_map(*map, "Drag of each voxel, " + which, "drag, kg/s");
  }

  Canvas mesh() const {
    if (is_mesh()) {
      const NamedSurface surface{"surface", io::read_mesh(r_.input), ink_of::endo};
      return draw_mesh({&surface, 1}, {}, r_.input.filename().string());
    }
    const std::vector<NamedSurface> surfaces = surfaces_of(read_beat());
    std::vector<NamedVoxels> voxels;
    if (has_stages()) {
      const ShownGate gate = read_gate();
      if (gate.of(r_.wall))
        voxels.push_back({"border of the " + word_for(r_.wall), gate.of(r_.wall)->border, ink_of::light, 0.12});
    }
    return draw_mesh(surfaces, voxels, "Surfaces of gate " + std::to_string(r_.gate));
  }

  Canvas section() const {
    const std::vector<NamedSurface> surfaces = surfaces_of(read_beat());
    return draw_sections_of(read_gate().image, surfaces, "Surfaces cut by the slices, gate " + std::to_string(r_.gate));
  }

  Canvas cycle() const {
    const ShownBeat beat = read_beat();
    std::vector<std::vector<NamedSurface>> rows(2);
    for (std::size_t row = 0; row < 2; ++row) {
      const std::size_t w = 1 - row;  // the outer wall above
      for (std::size_t g = 0; g < beat.surfaces[w].size(); ++g)
        if (beat.surfaces[w][g])
          rows[row].push_back(
              {"gate " + std::to_string(g + 1) + ", " + number_text(std::round(10 * beat.volume_ml[w][g]) / 10) + " mL",
               *beat.surfaces[w][g], colour_of(walls[w])});
    }
    return draw_cycle(rows, "Outer and inner wall over the beat, at one scale");
  }

  Canvas curve() const {
    const ShownBeat beat = read_beat();
    std::vector<double> time = beat.time_ms;
    const bool timed = !time.empty();
    for (std::size_t g = 0; !timed && g < beat.volume_ml[0].size(); ++g) time.push_back(g + 1);
    std::vector<NamedCurve> curves;
    for (const std::size_t w : {1u, 0u}) {
      NamedCurve curve{word_for(walls[w]), beat.volume_ml[w], beat.half_width_ml[w], colour_of(walls[w])};
      if (std::any_of(curve.half_width.begin(), curve.half_width.end(), [](double v) { return !std::isfinite(v); }))
        curve.half_width.clear();
      curves.push_back(std::move(curve));
    }
    const bool banded = !curves[0].half_width.empty();
    return draw_curves(time, timed ? "ms after the R wave" : "gate", curves,
                       std::string("Volumes over the beat") + (banded ? ", with their 90 % intervals" : ""));
  }

  Canvas evolution() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    const Motion run = motion_of(wall, gate.options, 8);
    return draw_evolution(run.frames, wall.border, title_of(run.result));
  }

  Film evolution_film() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    const Motion run = motion_of(wall, gate.options, 32);
    return film_of_evolution(run.frames, wall.border, title_of(run.result));
  }

  Film beat_film() const {
    const ShownBeat beat = read_beat();
    std::array<std::vector<TriMesh>, 2> meshes;
    for (std::size_t w = 0; w < 2; ++w)
      for (const auto& surface : beat.surfaces[w])
        if (surface) meshes[w].push_back(*surface);
    for (auto& wall : meshes)
      if (wall.size() != beat.surfaces[0].size()) wall.clear();  // a gate without surface: no beat of this wall
    const std::size_t gates = beat.time_ms.size();
    // Gates begin evenly: the beat ends one step after its last gate begins.
    const double length = gates > 1 ? (beat.time_ms.back() - beat.time_ms[0]) * gates / (gates - 1) : 0;
    const io::Colour colours[] = {colour_of(walls[0]), colour_of(walls[1])};
    return film_of_beat(meshes, colours, length, "A beat, interpolated between the gates");
  }

  Canvas instances() const {
    std::vector<TriMesh> levels = r_.levels;
    if (levels.empty() && is_mesh()) levels.push_back(io::read_mesh(r_.input));
    if (levels.empty())
      throw InputError(r_.input.string() + ": has no levels of detail; expected a result of dynasurf cloud");
    return draw_instances(levels, "200 instances, each at the level of detail that its size asks for");
  }

  Canvas scatter() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    return draw_scatter(mesh::signed_distances_to_border_voxels(wall.evolved, wall.border),
                        "Particles at the end, " + word_for(r_.wall) + ", gate " + std::to_string(r_.gate));
  }

  Canvas histogram() const {
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    return draw_history(wall.histories,
                        "Particles by their distance, " + word_for(r_.wall) + ", gate " + std::to_string(r_.gate));
  }

  Canvas areas() const { return draw_areas(one_surface(), "Triangles by area and shape"); }

  Canvas smooth() const {
    const TriMesh before = unsettled_surface();
    TriMesh after = before;
    dynasurf::mesh::smooth(after, mesh::Smoothing{.sweeps = 20}, 2 * mesh::triangle_quality(before).d_mean);
    return draw_smoothing(before, after, "Smoothing, 20 sweeps: angles about a vertex against a full turn");
  }

  Canvas contour() const {
    if (is_result() || is_mesh()) throw InputError(r_.input.string() + ": contours are drawn from a study");
    const Study study = io::read_study(r_.input, r_.series);
    check_gate(study);
    const ventricle::BorderResult borders = ventricle::find_borders(study, r_.options, progress_);
    const Image& image = borders.study.gates[r_.gate - 1];
    const ventricle::GateBorders& gate = borders.gates[r_.gate - 1];
    // The inner contour is sought within the outer one, so both are needed whichever is asked for.
    const ventricle::WallContours outer =
        ventricle::propagate_contours(image, gate.labels, ventricle::Border::epi, gate.base_slice, r_.options.contour);
    const ventricle::WallContours inner = ventricle::propagate_contours(image, gate.labels, ventricle::Border::endo,
                                                                        gate.base_slice, r_.options.contour, &outer);
    const ventricle::WallContours& asked = r_.wall == ventricle::Border::epi ? outer : inner;
    const int k = r_.slice > 0 ? r_.slice - 1 : asked.best_slice;
    if (k < 0 || k >= image.grid.dims[2]) throw OptionError("--slice: no contour there");
    ContourView view;
    view.image = &image;
    view.slice = k;
    view.start = circle_contour(Vec2(gate.labels.axis.x_at(k), gate.labels.axis.y_at(k)), gate.labels.circle.radius_px,
                                r_.options.contour.model.edge_px);
    if (const auto& found = asked.slices[k]) view.found = *found;
    const field::VectorField pull = dynamics::scaled_to_one(dynamics::force_of(dynamics::image_potential(
        dynamics::plane_of(image, k), {dynamics::PotentialSource::gradient, r_.options.contour.sigma_px})));
    view.field = &pull;
    view.stacks = {{ink_of::epi, outer.slices}, {ink_of::endo, inner.slices}};
    show_resampling(view, pull);
    view.title = "Discrete contour, slice " + std::to_string(k + 1) + ", " + word_for(r_.wall) + ", gate " +
                 std::to_string(r_.gate);
    return draw_contours(view);
  }

 private:
  /// The same from a start with long edges, without resampling and with it.
  void show_resampling(ContourView& view, const field::VectorField& pull) const {
    dynamics::DiscreteContour model = r_.options.contour.model;
    if (view.found.points.empty() || model.resample_every == 0) return;
    // Resampling splits edges above 1.5 l_des (thesis 3.48, 3.49): at 3.5 l_des every edge of the start is split.
    const Contour coarse = circle_contour(
        centroid_of(view.start), std::sqrt(std::abs(signed_area(view.start)) / std::numbers::pi), 3.5 * model.edge_px);
    view.resampled = dynamics::evolve_contour(coarse, pull, model).contour;
    model.resample_every = 0;
    view.unsampled = dynamics::evolve_contour(coarse, pull, model).contour;
  }

  struct Place {
    int slice = 0, row = 0;  // of the border's grid, which has room around the image
    int slice_number = 1, row_number = 1;
  };

  bool is_mesh() const {
    const std::string ending = r_.input.extension().string();
    return ending == ".ply" || ending == ".stl" || ending == ".obj" || ending == ".off";
  }
  bool is_result() const { return fs::is_directory(r_.input) && fs::exists(r_.input / "results.json"); }
  bool has_stages() const { return !is_result() || fs::exists(r_.input / "stages"); }

  void check_gate(const Study& study) const {
    if (r_.gate < 1 || static_cast<std::size_t>(r_.gate) > study.gates.size())
      throw OptionError("--gate " + std::to_string(r_.gate) + "; expected 1 to " + std::to_string(study.gates.size()));
  }

  ShownGate read_gate() const {
    if (is_mesh()) throw InputError(r_.input.string() + ": a mesh; expected a study or a result of dynasurf ventricle");
    ShownGate gate = is_result() ? gate_of_result(r_.input, r_.gate)
                                 : gate_of_study(io::read_study(r_.input, r_.series), r_.options, r_.gate, progress_);
    const dynamics::Evolution& evolution = gate.options.evolution;
    // The other drags follow from border and field; this one needs the image, spread over the grid of each wall.
    if (const auto* by_intensity = std::get_if<dynamics::IntensityDrag>(&evolution.damping))
      for (auto* wall : {&gate.endo, &gate.epi})
        if (*wall)
          (*wall)->drag = dynamics::drag_by_intensity(ventricle::spread_to(gate.image, (*wall)->border.grid),
                                                      evolution.force.drag, by_intensity->ratio);
    return gate;
  }

  ShownBeat read_beat() const {
    if (is_mesh()) throw InputError(r_.input.string() + ": a mesh; expected a study or a result of dynasurf ventricle");
    if (is_result()) return beat_of_result(r_.input);
    return beat_of_study(io::read_study(r_.input, r_.series), r_.options, progress_);
  }

  /// Of the gate, the inner one first.
  std::vector<NamedSurface> surfaces_of(const ShownBeat& beat) const {
    const std::size_t gates = beat.surfaces[0].size();
    if (r_.gate < 1 || static_cast<std::size_t>(r_.gate) > gates)
      throw OptionError("--gate " + std::to_string(r_.gate) + "; expected 1 to " + std::to_string(gates));
    std::vector<NamedSurface> found;
    for (std::size_t w = 0; w < 2; ++w)
      if (const auto& surface = beat.surfaces[w][r_.gate - 1])
        found.push_back({word_for(walls[w]), *surface, colour_of(walls[w])});
    if (found.empty()) throw InputError(r_.input.string() + ": gate " + std::to_string(r_.gate) + " has no surface");
    return found;
  }

  /// As it came to rest, without any smoothing; the finished surface where the stages are not at hand.
  TriMesh unsettled_surface() const {
    if (is_mesh() || !has_stages()) return one_surface();
    const ShownGate gate = read_gate();
    const ShownWall& wall = wall_of(gate);
    if (wall.start.vertices.empty()) return one_surface();
    dynamics::Evolution evolution = gate.options.evolution;
    // What is to be smoothed must not be smooth already: the run is repeated without the smoothing of its steps and
    // end.
    evolution.smooth_every = 0;
    evolution.smooth_after.sweeps = 0;
    return to_world(wall.border.grid,
                    move_again(wall, field_of(wall, gate.options), evolution, {}, progress_).result.mesh);
  }

  TriMesh one_surface() const {
    if (is_mesh()) return io::read_mesh(r_.input);
    for (NamedSurface& surface : surfaces_of(read_beat()))
      if (surface.name == word_for(r_.wall)) return std::move(surface.mesh);
    throw InputError(r_.input.string() + ": no surface of the " + word_for(r_.wall));
  }

  const ShownWall& wall_of(const ShownGate& gate) const {
    const auto& wall = gate.of(r_.wall);
    if (!wall) throw InputError(r_.input.string() + ": the " + word_for(r_.wall) + " has no border");
    return *wall;
  }

  field::VectorField field_of(const ShownWall& wall, const ventricle::Options& options) const {
    return field::flow_field(wall.map, options.field, progress_).field;
  }

  std::string where(const Place& at) const {
    return "gate " + std::to_string(r_.gate) + ", slice " + std::to_string(at.slice_number) + ", row " +
           std::to_string(at.row_number);
  }

  /// The slice and the row that were asked for, or those through the middle of the border's voxels.
  Place place_in(const ShownGate& gate, const ShownWall& wall) const {
    const Grid& g = wall.border.grid;
    // Slices and rows are counted in the image; the grid of the border may begin before it.
    const Index3 shift = voxel_of(g, to_grid(g, gate.image.grid.origin));
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (int k = 0; k < g.dims[2]; ++k)
      for (int j = 0; j < g.dims[1]; ++j)
        for (int i = 0; i < g.dims[0]; ++i)
          if (wall.border(i, j, k) > 0) sum += Vec3(i, j, k), ++count;
    Place at;
    at.slice_number = r_.slice > 0 ? r_.slice : round_int(sum[2] / count) - shift[2] + 1;
    at.row_number = r_.row > 0 ? r_.row : round_int(sum[1] / count) - shift[1] + 1;
    const auto check = [](const char* name, int value, int most) {
      if (value < 1 || value > most)
        throw OptionError(std::string(name) + " " + std::to_string(value) + "; expected 1 to " + std::to_string(most));
    };
    check("--slice", at.slice_number, gate.image.grid.dims[2]);
    check("--row", at.row_number, gate.image.grid.dims[1]);
    at.slice = at.slice_number - 1 + shift[2];
    at.row = at.row_number - 1 + shift[1];
    if (!g.contains(0, at.row, at.slice))
      throw InputError(r_.input.string() + ": the border's grid does not hold slice " +
                       std::to_string(at.slice_number));
    return at;
  }

  Motion motion_of(const ShownWall& wall, const ventricle::Options& options, int count) const {
    if (wall.start.vertices.empty())
      throw InputError(r_.input.string() +
                       ": no mesh was deformed (pipeline contour); expected pipeline surface or direct");
    return move_in_frames(wall, field_of(wall, options), options.evolution, r_.steps, count, progress_);
  }

  std::string title_of(const dynamics::EvolutionResult& result) const {
    return "The surface on its way, " + word_for(r_.wall) + ", gate " + std::to_string(r_.gate) + ": " +
           std::string(dynamics::name_of(result.reason)) + " after " + std::to_string(result.steps) + " steps";
  }

  std::vector<std::pair<std::string, std::string>> parameters_of(const ventricle::Options& options,
                                                                 const ShownWall& wall) const {
    const Grid& g = wall.border.grid;
    std::vector<std::pair<std::string, std::string>> rows{
        {"field", std::string(std::visit([](const auto& o) { return o.name; }, options.field))},
        {"grid", std::to_string(g.dims[0]) + " x " + std::to_string(g.dims[1]) + " x " + std::to_string(g.dims[2])},
        {"voxel",
         number_text(g.spacing[0]) + " x " + number_text(g.spacing[1]) + " x " + number_text(g.spacing[2]) + " mm"}};
    if (const field::Gvf* gvf = std::get_if<field::Gvf>(&options.field)) {
      rows.insert(rows.begin() + 1, {"mu", number_text(gvf->mu)});
      rows.insert(rows.begin() + 2, {"iterations", std::to_string(gvf->iterations)});
      rows.insert(rows.begin() + 3, {"step", "dx dy dz / (" + number_text(gvf->step_divisor) + " mu)"});
    }
    return rows;
  }

  const ShowRequest& r_;
  const Progress& progress_;
};

struct Entry {
  PictureKind kind;
  Canvas (Show::*draw)() const;
};

struct FilmEntry {
  PictureKind kind;
  Film (Show::*draw)() const;
};

constexpr std::array<Entry, 17> entries{{
    {{"slice", "vectors and image of a slice, with a profile along a row"}, &Show::slice},
    {{"field", "the field under six choices of mu and iterations"}, &Show::field},
    {{"field3d", "the field in space"}, &Show::field3d},
    {{"voxels", "the border voxels in space"}, &Show::voxels},
    {{"labels", "the labelled edges in space"}, &Show::labels},
    {{"damping", "the drag of each voxel"}, &Show::damping},
    {{"mesh", "surfaces shaded, as wires, and over their border voxels"}, &Show::mesh},
    {{"section", "surfaces cut by the slices"}, &Show::section},
    {{"evolution", "the mesh at several steps, stopped particles red"}, &Show::evolution},
    {{"scatter", "the signed distance of every particle"}, &Show::scatter},
    {{"histogram", "particles by their distance, step after step"}, &Show::histogram},
    {{"areas", "triangles by area and shape"}, &Show::areas},
    {{"cycle", "the surfaces of all gates"}, &Show::cycle},
    {{"curve", "volumes over the beat"}, &Show::curve},
    {{"contour", "a discrete contour, its pull, and the stack of contours"}, &Show::contour},
    {{"smooth", "a surface as it came to rest, and smoothed"}, &Show::smooth},
    {{"instances", "200 instances of a cloud's result or of a mesh, each at the level that its distance asks for"},
     &Show::instances},
}};

constexpr std::array<FilmEntry, 2> films{{
    {{"evolution-film", "evolution as an animated PNG"}, &Show::evolution_film},
    {{"beat-film", "the surfaces of a beat, interpolated, as an animated PNG"}, &Show::beat_film},
}};

}  // namespace

std::span<const PictureKind> picture_kinds() {
  static const std::array<PictureKind, entries.size() + films.size()> kinds = [] {
    std::array<PictureKind, entries.size() + films.size()> all{};
    for (std::size_t n = 0; n < entries.size(); ++n) all[n] = entries[n].kind;
    for (std::size_t n = 0; n < films.size(); ++n) all[entries.size() + n] = films[n].kind;
    return all;
  }();
  return kinds;
}

Canvas draw_picture(const ShowRequest& request, const Progress& progress) {
  for (const Entry& entry : entries)
    if (entry.kind.name == request.what) return (Show(request, progress).*entry.draw)();
  std::string names;
  for (const PictureKind& kind : picture_kinds()) names += (names.empty() ? "" : ", ") + std::string(kind.name);
  throw OptionError("WHAT " + request.what + "; expected one of " + names);
}

bool is_film(std::string_view what) {
  return std::any_of(films.begin(), films.end(), [&](const FilmEntry& film) { return film.kind.name == what; });
}

Film draw_film(const ShowRequest& request, const Progress& progress) {
  for (const FilmEntry& film : films)
    if (film.kind.name == request.what) return (Show(request, progress).*film.draw)();
  throw OptionError("WHAT " + request.what + " is not a film");
}

}  // namespace dynasurf::show
