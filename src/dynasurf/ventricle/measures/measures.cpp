#include "dynasurf/ventricle/measures/measures.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/heart/lv_volumes.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/ventricle/measures/detail/reference.hpp"

namespace dynasurf::ventricle {
namespace {

/// Both surfaces, or the inner one where no outer one is looked for.
bool is_measured(const WallGate& gate, bool cavity_alone) {
  return gate.image && gate.endo.mesh && (cavity_alone || gate.epi.mesh);
}

/// Centre of the volume inside a closed surface.
Vec3 centroid(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double volume = 0;
  const Vec3 origin = mesh.vertices.front();  // near, so that nothing is lost to cancellation
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
    const double six = a.dot(b.cross(c));
    volume += six, sum += six * (a + b + c) / 4;
  }
  return volume != 0 ? Vec3(origin + sum / volume) : origin;
}

/// A point of the long axis in the cavities of all gates.
Vec3 middle_of(const MeasureInput& input, bool cavity_alone) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const WallGate& gate : input.gates)
    if (is_measured(gate, cavity_alone)) sum += centroid(*gate.endo.mesh), ++count;
  return sum / count;
}

/// Applies f(values at sample n...) where all are present.
template <class F, class... Maps>
PolarValues combine(const F& f, const PolarValues& first, const Maps&... maps) {
  PolarValues result(first.size());
  for (std::size_t n = 0; n < first.size(); ++n)
    if (first[n] && (maps[n] && ...)) result[n] = f(*first[n], *maps[n]...);
  return result;
}

double percent_change(double from, double to) { return 100 * (to - from) / from; }

/// Gates whose wall was mapped, in order.
std::vector<const GateMeasures*> mapped(const Measures& m) {
  std::vector<const GateMeasures*> gates;
  for (const GateMeasures& g : m.gates)
    if (g.axes) gates.push_back(&g);
  return gates;
}

/// One value per sample and gate; a sample that lacks one gate is empty.
using Curves = std::vector<std::vector<double>>;

template <class ValueAt>
Curves curves_of(const Measures& m, const ValueAt& value_at) {
  Curves curves(m.grid.size());
  const auto gates = mapped(m);
  for (std::size_t n = 0; n < curves.size(); ++n) {
    for (const GateMeasures* gate : gates) {
      const std::optional<double> value = value_at(*gate, n);
      if (!value) break;
      curves[n].push_back(*value);
    }
    if (curves[n].size() != gates.size()) curves[n].clear();
  }
  return curves;
}

PolarValues means_of(const Curves& curves) {
  PolarValues means(curves.size());
  for (std::size_t n = 0; n < curves.size(); ++n) {
    if (curves[n].empty()) continue;
    double sum = 0;
    for (const double v : curves[n]) sum += v;
    means[n] = sum / curves[n].size();
  }
  return means;
}

PolarValues onsets_of(const Curves& curves) {
  PolarValues onsets(curves.size());
  for (std::size_t n = 0; n < curves.size(); ++n) onsets[n] = onset_phase_deg(curves[n]);
  return onsets;
}

/// Percent of the mean of the reference.
PolarValues in_percent_of_reference(const PolarValues& values, bool is_uptake) {
  const std::vector<std::size_t> reference = reference_samples(values, is_uptake);
  double whole = 0;
  for (const std::size_t n : reference) whole += *values[n] / reference.size();
  return combine([&](double c) { return whole > 0 ? 100 * c / whole : 0.0; }, values);
}

/// Curves of counts as means over the samples around, about as wide as the blur: neighbours tell the same muscle, and
/// their noise would pass for walls out of step.
Curves smoothed(const Measures& m, const Curves& curves) {
  constexpr int rings = 1, sectors = 3;  // to both sides
  Curves result(curves.size());
  for (int r = 0; r < m.grid.rings; ++r)
    for (int s = 0; s < m.grid.sectors; ++s) {
      const std::size_t here = m.grid.index(r, s);
      if (curves[here].empty()) continue;
      std::vector<double>& mean = result[here];
      mean.assign(curves[here].size(), 0.0);
      double area = 0;
      for (int dr = std::max(0, r - rings); dr <= std::min(m.grid.rings - 1, r + rings); ++dr)
        for (int ds = -sectors; ds <= sectors; ++ds) {
          const std::size_t n = m.grid.index(dr, (s + ds + m.grid.sectors) % m.grid.sectors);
          if (curves[n].empty()) continue;
          area += m.area_mm2[n];
          for (std::size_t g = 0; g < mean.size(); ++g) mean[g] += m.area_mm2[n] * curves[n][g];
        }
      for (double& v : mean) v /= area;
    }
  return result;
}

/// The mean curve of each segment.
Curves segment_curves(const Measures& m, const Curves& curves) {
  Curves sums(segments_of(m.model).size());
  std::vector<double> weights(sums.size(), 0.0);
  for (std::size_t n = 0; n < curves.size(); ++n) {
    const int number = segment_at(m.model, m.grid.point(n));
    if (curves[n].empty() || number == 0) continue;
    const std::size_t s = number - 1;
    sums[s].resize(curves[n].size(), 0.0);
    for (std::size_t g = 0; g < curves[n].size(); ++g) sums[s][g] += m.area_mm2[n] * curves[n][g];
    weights[s] += m.area_mm2[n];
  }
  for (std::size_t s = 0; s < sums.size(); ++s)
    for (double& v : sums[s]) v /= weights[s];
  return sums;
}

void measure_beat(Measures& m, const std::vector<double>& cavity, int waves) {
  const std::optional<heart::LvVolumes> f = heart::lv_volumes(cavity);
  if (!f) return;
  m.ed_gate = f->ed_gate, m.es_gate = f->es_gate;
  m.function = fit_volume_curve(cavity, waves);
}

/// Fitted walls without uptake move as is believed of them: nobody saw when they contract.
Curves where_seen(const Measures& m, Curves curves) {
  constexpr double least_percent = 25;  // of perfusion
  if (m.perfusion_is != Perfusion::uptake) return curves;
  for (std::size_t n = 0; n < curves.size(); ++n)
    if (m.maps.perfusion_percent[n].value_or(0) < least_percent) curves[n].clear();
  return curves;
}

void measure_maps(Measures& m) {
  const GateMeasures& ed = m.gates[m.ed_gate];
  m.area_mm2 = ed.map.area_mm2;
  const Curves counts = curves_of(m, [](const GateMeasures& g, std::size_t n) { return g.map.counts[n]; });
  const Curves uptake = curves_of(m, [](const GateMeasures& g, std::size_t n) { return g.map.uptake[n]; });
  const auto is_known = [](const Curves& curves) {
    return std::any_of(curves.begin(), curves.end(), [](const std::vector<double>& curve) { return !curve.empty(); });
  };
  const bool is_uptake = is_known(uptake);
  if (is_uptake || is_known(counts)) m.perfusion_is = is_uptake ? Perfusion::uptake : Perfusion::counts;
  m.maps.perfusion_percent = in_percent_of_reference(means_of(is_uptake ? uptake : counts), is_uptake);
  m.maps.thickness_ed_mm = ed.map.thickness_mm;
  if (m.es_gate < 0) return;

  const GateMeasures& es = m.gates[m.es_gate];
  const Curves motion = curves_of(m, [&](const GateMeasures& g, std::size_t n) -> std::optional<double> {
    if (!g.map.endo[n] || !ed.map.endo[n]) return std::nullopt;
    return (*ed.map.endo[n] - *g.map.endo[n]).dot(ed.map.outwards[n]);
  });
  const Curves thickness = curves_of(m, [](const GateMeasures& g, std::size_t n) { return g.map.thickness_mm[n]; });
  m.maps.thickness_es_mm = es.map.thickness_mm;
  m.maps.thickening_percent = combine(percent_change, ed.map.thickness_mm, es.map.thickness_mm);
  m.maps.count_thickening_percent = combine(percent_change, ed.map.counts, es.map.counts);
  m.maps.motion_mm.resize(m.grid.size());
  for (std::size_t n = 0; n < m.grid.size(); ++n)
    if (ed.map.endo[n] && es.map.endo[n])
      m.maps.motion_mm[n] = (*ed.map.endo[n] - *es.map.endo[n]).dot(ed.map.outwards[n]);
  const Curves seen_motion = where_seen(m, motion), seen_thickness = where_seen(m, thickness);
  m.maps.phase_counts_deg = onsets_of(smoothed(m, counts));
  m.maps.phase_motion_deg = onsets_of(seen_motion);
  m.maps.phase_thickness_deg = onsets_of(seen_thickness);
  m.phase_counts = summarise_phases(m.maps.phase_counts_deg, m.area_mm2);
  m.phase_motion = summarise_phases(m.maps.phase_motion_deg, m.area_mm2);
  m.phase_thickness = summarise_phases(m.maps.phase_thickness_deg, m.area_mm2);
  const Curves count_curves = segment_curves(m, counts), motion_curves = segment_curves(m, seen_motion);
  const Curves thickness_curves = segment_curves(m, seen_thickness);
  for (std::size_t s = 0; s < m.segments.size(); ++s) {
    m.segments[s].phase_counts_deg = onset_phase_deg(count_curves[s]);
    m.segments[s].phase_motion_deg = onset_phase_deg(motion_curves[s]);
    m.segments[s].phase_thickness_deg = onset_phase_deg(thickness_curves[s]);
  }
}

/// Area of the triangles around each vertex, a third of each.
std::vector<double> areas_of_vertices(const TriMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const double area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 6;
    for (const auto v : {a, b, c}) areas[v] += area;
  }
  return areas;
}

/// How far every vertex of every gate is from where it was at end diastole, and what that means for the segments.
void measure_motion(Measures& m, const MeasureInput& input) {
  const WallGate& rest = input.gates[m.ed_gate];
  const auto motion_of = [](const TriMesh* from, const TriMesh* to) -> std::optional<mesh::SurfaceMotion> {
    if (!from || !to || from->vertices.size() != to->vertices.size() || from->triangles != to->triangles)
      return std::nullopt;
    return mesh::surface_motion(*from, *to);
  };
  for (std::size_t g = 0; g < m.gates.size(); ++g) {
    m.gates[g].endo_motion = motion_of(rest.endo.mesh, input.gates[g].endo.mesh);
    m.gates[g].epi_motion = motion_of(rest.epi.mesh, input.gates[g].epi.mesh);
  }
  if (m.es_gate < 0) return;
  const auto& contracted = m.gates[m.es_gate].endo_motion;
  if (!contracted) return;
  const GateMeasures& ed = m.gates[m.ed_gate];
  const std::vector<int> numbers = segments_of_vertices(m.model, *ed.axes, rest.endo.mesh->vertices);
  const std::vector<double> areas = areas_of_vertices(*rest.endo.mesh);
  std::vector<double> weight(m.segments.size(), 0.0), moved = weight, strain = weight;
  for (std::size_t v = 0; v < numbers.size(); ++v) {
    if (numbers[v] == 0) continue;
    const std::size_t s = numbers[v] - 1;
    weight[s] += areas[v];
    moved[s] += areas[v] * contracted->displacement_mm[v];
    strain[s] += areas[v] * contracted->area_strain_percent[v];
  }
  for (std::size_t s = 0; s < m.segments.size(); ++s)
    if (weight[s] > 0)
      m.segments[s].displacement_mm = moved[s] / weight[s], m.segments[s].area_strain_percent = strain[s] / weight[s];
}

void measure_segments(Measures& m) {
  const auto means = [&](const PolarValues& values) { return segment_means(m.model, m.grid, values, m.area_mm2); };
  const GateMeasures& ed = m.gates[m.ed_gate];
  const PolarValues perfusion = means(m.maps.perfusion_percent), thickness = means(m.maps.thickness_ed_mm);
  const PolarValues counts = means(ed.map.counts);
  double all = 0;
  std::vector<double> area(m.segments.size(), 0.0);
  for (std::size_t n = 0; n < m.grid.size(); ++n)
    if (const int s = segment_at(m.model, m.grid.point(n)); s > 0) all += m.area_mm2[n], area[s - 1] += m.area_mm2[n];
  for (std::size_t s = 0; s < m.segments.size(); ++s) {
    m.segments[s].wall_share_percent = all > 0 ? 100 * area[s] / all : 0;
    m.segments[s].perfusion_percent = perfusion[s];
    m.segments[s].thickness_ed_mm = thickness[s];
  }
  if (m.es_gate < 0) return;
  const GateMeasures& es = m.gates[m.es_gate];
  const PolarValues thickness_es = means(m.maps.thickness_es_mm), counts_es = means(es.map.counts);
  const PolarValues motion = means(m.maps.motion_mm);
  const PolarValues thickening = combine(percent_change, thickness, thickness_es);
  const PolarValues count_thickening = combine(percent_change, counts, counts_es);
  for (std::size_t s = 0; s < m.segments.size(); ++s) {
    m.segments[s].thickness_es_mm = thickness_es[s];
    m.segments[s].thickening_percent = thickening[s];
    m.segments[s].count_thickening_percent = count_thickening[s];
    m.segments[s].motion_mm = motion[s];
  }
}

/// A map without any value is none.
void drop_blank_maps(PolarMaps& maps) {
  for (PolarValues* map : {&maps.perfusion_percent, &maps.thickness_ed_mm, &maps.thickness_es_mm,
                           &maps.thickening_percent, &maps.count_thickening_percent, &maps.motion_mm,
                           &maps.phase_counts_deg, &maps.phase_motion_deg, &maps.phase_thickness_deg})
    if (std::none_of(map->begin(), map->end(), [](const auto& value) { return value.has_value(); })) map->clear();
}

}  // namespace

Measures measure_walls(const MeasureInput& input, const MeasureOptions& requested) {
  MeasureOptions options = requested;
  check_options(options, "measures");
  Measures m;
  m.from_edges = input.from_edges;
  m.model = options.segments;
  m.gates.resize(input.gates.size());
  m.cavity_alone = std::none_of(input.gates.begin(), input.gates.end(), [](const WallGate& g) { return g.epi.mesh; });
  const auto has_walls = [&](const WallGate& gate) { return is_measured(gate, m.cavity_alone); };
  const auto first = std::find_if(input.gates.begin(), input.gates.end(), has_walls);
  if (first == input.gates.end()) return m;

  m.anterior = find_anterior(input.axis, first->image->grid, options.anterior);
  const Vec3 middle = middle_of(input, m.cavity_alone);
  parallel_for(input.gates.size(), 1, [&](std::size_t g, std::size_t) {
    const WallGate& gate = input.gates[g];
    if (!has_walls(gate)) return;
    GateMeasures& measured = m.gates[g];
    const mesh::TracedSurface endo(*gate.endo.mesh);
    std::optional<mesh::TracedSurface> epi;
    if (!m.cavity_alone) epi.emplace(*gate.epi.mesh);
    const mesh::TracedSurface& outermost = epi ? *epi : endo;
    measured.endo_ml = mesh::volume_mm3(endo.mesh) / 1000;
    measured.axes = axes_of(endo, outermost, middle, input.axis, m.anterior.direction, gate.base_plane);
    if (epi) measured.epi_ml = mesh::volume_mm3(epi->mesh) / 1000;
    if (!measured.axes) return;
    if (!epi) {
      measured.map = map_cavity(endo, *measured.axes, m.grid);
      return;
    }
    measured.thickness = wall_thickness(endo, *epi, *measured.axes);
    measured.map = map_wall(endo, *epi, {gate.endo.uptake, gate.epi.uptake}, measured.thickness, *measured.axes,
                            *gate.image, m.grid);
  });

  double muscle = 0;
  int walls = 0;
  std::vector<double> cavity;
  for (std::size_t g = 0; g < m.gates.size(); ++g) {
    if (!has_walls(input.gates[g])) continue;
    muscle += m.gates[g].epi_ml - m.gates[g].endo_ml, ++walls;
    cavity.push_back(m.gates[g].endo_ml);
  }
  if (!m.cavity_alone) m.muscle_ml = muscle / walls, m.muscle_g = muscle_density * *m.muscle_ml;
  if (cavity.size() == m.gates.size() && cavity.size() > 1) measure_beat(m, cavity, options.waves);
  if (m.gates.size() == 1) m.ed_gate = 0;

  // Maps of a beat need its extremes.
  const auto is_mapped = [&](int gate) { return gate >= 0 && m.gates[gate].axes; };
  if (!is_mapped(m.ed_gate) || (m.gates.size() > 1 && !is_mapped(m.es_gate))) return m;
  if (m.cavity_alone && m.es_gate < 0) return m;  // a cavity at rest has nothing to map
  for (const Segment& segment : segments_of(m.model)) m.segments.emplace_back().segment = segment;
  measure_maps(m);
  measure_segments(m);
  measure_motion(m, input);
  drop_blank_maps(m.maps);
  return m;
}

}  // namespace dynasurf::ventricle
