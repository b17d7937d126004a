#include <cmath>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/detail/assembly.hpp"
#include "dynasurf/synthetic/detail/irregular.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/synthetic/detail/torso.hpp"
#include "dynasurf/synthetic/ventricle_shape.hpp"

namespace dynasurf::synthetic {
namespace {

/// Directions of columns, rows and slices of a short-axis stack: i towards the lateral wall, j towards the inferior
/// wall, k from apex to base. With i horizontal the anterior wall is up and the septum left, as such stacks are shown.
Mat3 short_axis_directions(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * degrees, e = elevation_deg * degrees;
  Mat3 direction;
  direction.col(0) = Vec3(own::cos(a), own::sin(a), 0);
  direction.col(2) = Vec3(-own::sin(a) * own::cos(e), own::cos(a) * own::cos(e), own::sin(e));
  direction.col(1) = direction.col(2).cross(direction.col(0));
  return direction;
}

VentricleMotion motion_of(const VirtualPatient& o) {
  return {o.edv_ml, o.edv_ml * (1 - o.ef_percent / 100), o.wall_ml, o.length_to_width, o.base_excursion_mm};
}

/// An opening of `width_deg` around the axis downwards, seen from the middle of the heart.
bool near_apex(const Vec3& p, double middle_z, double width_deg) {
  return own::atan2(own::hypot(p[0], p[1]), middle_z - p[2]) <= width_deg / 2 * degrees;
}

bool in_defect(const VirtualPatient& o, const VentricleShape& shape, const Vec3& p) {
  // Territories of the coronary arteries do not reach the outermost apex, except the anterior one.
  const double width = o.defect_extent_deg;
  const bool above_apex = p[2] >= 0.2 * shape.base_z;
  switch (o.defect) {
    case Defect::none:
      return false;
    case Defect::lateral:
      return above_apex && in_sector(p, 0, width);
    case Defect::inferior:
      return above_apex && in_sector(p, 90, width);
    case Defect::septal:
      return above_apex && in_sector(p, 180, width);
    case Defect::apical:
      return near_apex(p, shape.centre_z, width);
    case Defect::anteroapical:
      return near_apex(p, shape.centre_z, width) || in_sector(p, 270, width);
  }
  return false;
}

struct Gut {
  Vec3 centre{0, 0, 0}, half{1, 1, 1};
  bool contains(const Vec3& p) const { return (p - centre).cwiseQuotient(half).squaredNorm() <= 1; }
};

Gut gut_below(const VirtualPatient& o, const VentricleShape& relaxed) {
  const double height = o.gut_position * relaxed.base_z;
  const double u = (height - relaxed.centre_z) / relaxed.epi_half_length;
  const double heart = relaxed.epi_radius * std::sqrt(std::max(0.0, 1 - u * u));
  Gut gut;
  gut.half = {2 * o.gut_radius_mm, o.gut_radius_mm, o.gut_radius_mm};
  gut.centre = {0, heart + o.gut_gap_mm + o.gut_radius_mm, height};
  return gut;
}

/// The sector that contracts later than the rest.
bool is_late(const VirtualPatient& o, const Vec3& p) {
  switch (o.late_wall) {
    case Defect::lateral:
      return in_sector(p, 0, o.late_extent_deg);
    case Defect::inferior:
      return in_sector(p, 90, o.late_extent_deg);
    case Defect::septal:
      return in_sector(p, 180, o.late_extent_deg);
    default:
      return false;
  }
}

/// One instant of a ventricle whose walls need not be at the same point of their beat.
struct Instant {
  VentricleShape shape, late;
};

Instant instant_at(const VirtualPatient& o, const VentricleMotion& motion, double phase) {
  const auto shape = [&](double at) {
    return shape_at(motion, motion.esv_ml + (motion.edv_ml - motion.esv_ml) * filling_at(at));
  };
  Instant now{shape(phase), {}};
  now.late = now.shape;
  if (o.late_wall == Defect::none) return now;
  now.late = shape(phase - o.delay_percent / 100 + 1);
  now.late.base_z = now.shape.base_z;  // the valve plane moves as one
  return now;
}

/// The surface of the shape with the late sector's part from that of the late one; they have the same triangles.
TriMesh with_late_sector(const VirtualPatient& o, TriMesh mesh, const TriMesh& late) {
  if (o.late_wall == Defect::none) return mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (is_late(o, late.vertices[v])) mesh.vertices[v] = late.vertices[v];
  return mesh;
}

/// A smooth surface with the unevenness of a wall.
TriMesh made_uneven(const VirtualPatient& o, TriMesh mesh, double base_z, auto factor) {
  if (o.irregular.walls > 0)
    for (Vec3& p : mesh.vertices) p = widened(p, factor(o.irregular, p, base_z));
  return mesh;
}

/// Activity of the wall at the vertices of one of its surfaces.
std::vector<double> uptake_at(const VirtualPatient& o, const Instant& now, const TriMesh& surface) {
  std::vector<double> uptake;
  for (const Vec3& p : surface.vertices)
    uptake.push_back(in_defect(o, is_late(o, p) ? now.late : now.shape, p) ? 1 - o.defect_severity : 1.0);
  return uptake;
}

/// Activity above the background at one instant, in the frame of the heart.
Scene scene_of(const VirtualPatient& o, const Instant& now, const VentricleShape& relaxed) {
  const VentricleShape& shape = now.shape;
  const Gut gut = gut_below(o, relaxed);
  const RightVentricle right = right_ventricle_beside(shape.epi_radius, 0.1 * shape.base_z, shape.base_z);
  Scene scene;
  // Uneven walls are at most 1.3 times as wide.
  const double radius = (1 + 0.3 * o.irregular.walls) * std::max(shape.epi_radius, now.late.epi_radius);
  scene.support = {{-radius, -radius, 0}, {radius, radius, shape.base_z}};
  if (o.gut_amplitude > 0) scene.support = hull(scene.support, {gut.centre - gut.half, gut.centre + gut.half});
  if (o.right_ventricle > 0) scene.support = hull(scene.support, box_of(right));
  scene.activity = [o, now, gut, right](const Vec3& p) {
    const VentricleShape& wall = is_late(o, p) ? now.late : now.shape;
    const Irregularity& irregular = o.irregular;
    if (wall.in_epi(narrowed(p, outer_width_factor(irregular, p, wall.base_z)))) {
      const Vec3 smooth = narrowed(p, width_factor(irregular, p, wall.base_z));
      if (wall.in_endo(smooth) && !in_papillary(irregular, wall, smooth)) return o.cavity - o.background;
      return (in_defect(o, wall, p) ? 1 - o.defect_severity : 1.0) - o.background;
    }
    if (o.right_ventricle > 0 && right.in_wall(p)) return o.right_ventricle - o.background;
    if (o.right_ventricle > 0 && right.in_cavity(p)) return o.cavity - o.background;
    if (o.gut_amplitude > 0 && gut.contains(p)) return o.gut_amplitude - o.background;
    return 0.0;
  };
  return scene;
}

/// The grid of the stack and where the heart lies in it.
struct Setting {
  Grid grid;
  Frame heart;
};

Setting setting_of(const VirtualPatient& o, const Vec3& middle) {
  // Where a heart lies against the middle of a scanner's field, roughly: to the left and in front.
  const Vec3 heart_world{45, -35, 10};
  const Mat3 short_axis = short_axis_directions(o.azimuth_deg, o.elevation_deg);
  Setting s;
  if (o.cut == Cut::short_axis) {
    s.grid = make_grid(o.lattice, short_axis, heart_world);
    s.heart = make_frame(s.grid, o.pose, middle);
    return s;
  }
  const Vec3 offset{o.pose.offset_x_mm, o.pose.offset_y_mm, o.pose.offset_z_mm};
  s.grid = make_grid(o.lattice, Mat3::Identity(), heart_world - offset);
  s.heart = make_frame(s.grid, o.pose, middle);
  const Vec3 at = s.heart.to_grid(middle);
  s.heart.rotation = short_axis * s.heart.rotation;
  s.heart.origin = at - s.heart.rotation * middle;
  return s;
}

/// A tracked point: where it lies in the wall, whatever the wall does.
struct Tag {
  double from_apex = 0;  // angle from the apex over that of the rim, of both ellipsoids
  double azimuth = 0;    // about the axis, rad
  double depth = 0;      // 0 inner, 1 outer side
};

/// Evenly over the wall, at three depths.
Tag tag(int n, int count) {
  constexpr double golden = 2.399963229728653;
  const double height = (n + 0.5) / count;
  return {own::acos(1 - height) / (M_PI / 2), golden * n, 0.2 + 0.3 * (n % 3)};
}

Vec3 place_of(const Tag& t, const VentricleShape& s) {
  const auto on = [&](double radius, double half_length) -> Vec3 {
    const double angle = t.from_apex * own::acos(-(s.base_z - s.centre_z) / half_length);
    return {radius * own::sin(angle) * own::cos(t.azimuth), radius * own::sin(angle) * own::sin(t.azimuth),
            s.centre_z - half_length * own::cos(angle)};
  };
  return (1 - t.depth) * on(s.endo_radius, s.endo_half_length) + t.depth * on(s.epi_radius, s.epi_half_length);
}

/// The part of the twist at a height: the base turns back by 3/10 of it while the apex goes on by 7/10.
double share_of_twist(double height) { return 0.7 - height; }

/// Points of the smooth wall over the beat. At end-diastole nothing is turned.
TrackedTruth track(const VirtualPatient& o, const VentricleMotion& motion, const Setting& s,
                   const std::vector<TrueGate>& gates) {
  TrackedTruth truth;
  const auto to_world_of = [&](const Vec3& p) { return to_world(s.grid, s.heart.to_grid(p)); };
  const VentricleShape first = instant_at(o, motion, gates[0].phase).shape;
  const auto turned_deg = [&](std::size_t g) { return o.tags.twist_deg * (1 - filling_at(gates[g].phase)); };
  truth.apex = to_world_of({0, 0, 0}), truth.base = to_world_of({0, 0, first.base_z});
  for (int n = 0; n < o.tags.points; ++n) truth.points.name.push_back(std::to_string(n + 1));
  for (std::size_t g = 0; g < gates.size(); ++g) {
    const Instant now = instant_at(o, motion, gates[g].phase);
    truth.twist_deg.push_back(turned_deg(g) - turned_deg(0));
    auto& places = truth.points.gates.emplace_back();
    for (int n = 0; n < o.tags.points; ++n) {
      const Tag t = tag(n, o.tags.points);
      const Vec3 rest = place_of(t, first), p = place_of(t, is_late(o, rest) ? now.late : now.shape);
      // Seen from the apex counter-clockwise is clockwise about the axis, which points away.
      const double angle = -turned_deg(g) * share_of_twist(rest[2] / first.base_z) * degrees;
      Vec3 place(own::cos(angle) * p[0] - own::sin(angle) * p[1], own::sin(angle) * p[0] + own::cos(angle) * p[1],
                 p[2]);
      constexpr std::uint64_t stream = 0x7a65;  // of its own, beside that of the voxels
      Random random(o.noise.seed, stream, g * o.tags.points + n);
      for (int a = 0; a < 3; ++a) place[a] += o.tags.error_mm * random.normal();
      places.push_back(to_world_of(place));
    }
  }
  return truth;
}

/// What does not beat, less the background: the trunk up to a thin rim around the relaxed heart.
Image render_torso(const VirtualPatient& o, const Setting& s, const VentricleShape& relaxed, double fwhm) {
  constexpr double rim_mm = 4, sub_step_mm = 2.5;
  VentricleShape around = relaxed;
  around.epi_radius += rim_mm, around.epi_half_length += rim_mm, around.base_z += rim_mm;
  const Vec3 middle = s.heart.to_grid({0, 0, relaxed.base_z / 2});
  const Vec3 size(s.grid.dims[0] * s.grid.spacing[0], s.grid.dims[1] * s.grid.spacing[1],
                  s.grid.dims[2] * s.grid.spacing[2]);
  const Vec3 beyond = Vec3::Constant(3 * fwhm);
  return render(
      s.grid,
      [&](const Vec3& p) {
        if (around.in_epi(s.heart.to_object(p))) return 0.0;
        return torso_activity(o.torso, o.background, s.grid.direction * (p - middle)) - o.background;
      },
      {-beyond, size + beyond}, fwhm, sub_samples_for(s.grid, sub_step_mm, 1));
}

/// The same voxels counted from the other end of the stack.
Image with_base_first(const Image& image) {
  const Grid& from = image.grid;
  Grid grid = from;
  grid.direction.col(2) *= -1;
  grid.origin = to_world(from, centre_of(from, {0, 0, from.dims[2] - 1}));
  Image result(grid);
  const std::size_t slice = from.slice_size();
  for (int k = 0; k < from.dims[2]; ++k)
    std::copy_n(image.values.begin() + slice * (from.dims[2] - 1 - k), slice, result.values.begin() + slice * k);
  return result;
}

/// The walls of the beating heart at one instant, in the world, with their volumes and uptake.
TrueGate true_gate(const VirtualPatient& o, const Setting& s, const Instant& now, double phase) {
  TrueGate truth;
  truth.phase = phase;
  const TriMesh endo = made_uneven(o, with_late_sector(o, endo_surface(now.shape), endo_surface(now.late)),
                                   now.shape.base_z, width_factor);
  const TriMesh epi = made_uneven(o, with_late_sector(o, epi_surface(now.shape), epi_surface(now.late)),
                                  now.shape.base_z, outer_width_factor);
  const bool is_one = o.late_wall == Defect::none && o.irregular.walls == 0;
  truth.endo_ml = is_one ? endo_ml(now.shape) : mesh::volume_mm3(endo) / 1000;
  truth.epi_ml = is_one ? epi_ml(now.shape) : mesh::volume_mm3(epi) / 1000;
  truth.endo_uptake = uptake_at(o, now, endo), truth.epi_uptake = uptake_at(o, now, epi);
  truth.endo = place_in_world(s.grid, s.heart, endo);
  truth.epi = place_in_world(s.grid, s.heart, epi);
  return truth;
}

/// Every gate as the camera sees it, without noise; fills `truth`, one for each gate.
std::vector<Image> see_beat(const VirtualPatient& o, const VentricleMotion& motion, const Setting& setting,
                            const VentricleShape& relaxed, std::vector<TrueGate>& truth) {
  constexpr double sub_step_mm = 1.2;
  const Index3 sub_samples = sub_samples_for(setting.grid, sub_step_mm);
  const double fwhm = fwhm_before_filter(o.fwhm_mm, o.noise), narrow = narrow_fwhm(o.irregular, fwhm);
  Image at_rest(setting.grid);
  if (o.torso.present) at_rest = render_torso(o, setting, relaxed, fwhm);

  std::vector<Image> images(truth.size());
  parallel_for(images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      const double phase = o.gates > 1 ? (g + 0.5) / o.gates : 0;
      const Instant now = instant_at(o, motion, phase);
      truth[g] = true_gate(o, setting, now, phase);
      const Image seen = render_scene(setting.grid, setting.heart, scene_of(o, now, relaxed), narrow, sub_samples);
      images[g] = see_unevenly(o.irregular, seen, narrow, fwhm);
      for (std::size_t v = 0; v < at_rest.values.size(); ++v) {
        const double sum = images[g].values[v] + double{at_rest.values[v]};
        images[g].values[v] = std::max(0.0, sum + o.background);
      }
    }
  });
  return images;
}

/// In the order and with the words that were asked for.
Study study_of(const VirtualPatient& o, std::vector<Image> images) {
  if (o.base_first)
    for (Image& image : images) image = with_base_first(image);
  Study study = make_study(std::move(images), 60000 / o.heart_rate_bpm);
  if (o.base_first) study.slice_order = SliceOrder::base_to_apex;
  if (o.cut == Cut::transaxial) {
    study.view = View::transaxial;
    study.slice_order = SliceOrder::unknown;
  }
  return study;
}

}  // namespace

Phantom make_phantom(const VirtualPatient& options) {
  VirtualPatient o = options;
  check_options(o, std::string(VirtualPatient::name));
  if (o.late_wall == Defect::apical || o.late_wall == Defect::anteroapical)
    throw OptionError("option patient.late_wall is " + std::string(word_of(o.late_wall)) +
                      "; expected none, inferior, lateral or septal");
  Phantom phantom;
  phantom.kind = VirtualPatient::name;
  o.noise = limit_filter(o.noise, o.fwhm_mm, phantom.notes);
  const VentricleMotion motion = motion_of(o);
  const VentricleShape relaxed = shape_at(motion, motion.edv_ml);
  const Setting setting = setting_of(o, {0, 0, relaxed.base_z / 2});

  phantom.truth.resize(o.gates);
  phantom.study = study_of(o, expose(see_beat(o, motion, setting, relaxed, phantom.truth), o.noise));
  phantom.axis = setting.grid.direction * setting.heart.rotation.col(2);
  if (o.tags.points > 0) phantom.tracked = track(o, motion, setting, phantom.truth);
  phantom.fwhm_mm = o.fwhm_mm;
  phantom.options = o;
  summarise(phantom);
  if (o.gates > 1) {
    phantom.beat_edv_ml = motion.edv_ml;
    phantom.beat_esv_ml = motion.esv_ml;
    phantom.beat_ef_percent = o.ef_percent;
  }
  return phantom;
}

}  // namespace dynasurf::synthetic
