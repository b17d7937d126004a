#include <cmath>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/detail/assembly.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

namespace dynasurf::synthetic {
namespace {

/// A part of a surface that stands out of the rest, or lies deeper.
struct Bump {
  Vec3 towards;
  double height = 0, width_rad = 0.5;  // of the radius; standard deviation
};

/// A body seen whole from its middle: an ellipsoid with bumps. mm.
struct Body {
  Vec3 half{1, 1, 1};
  std::vector<Bump> bumps;
  double usual_ml = 0;

  /// Distance of the surface from the middle along a unit vector.
  double radius(const Vec3& direction) const {
    double factor = 1;
    for (const Bump& b : bumps) {
      const double angle = own::acos(std::clamp(direction.dot(b.towards.normalized()), -1.0, 1.0));
      factor += b.height * own::exp(-0.5 * own::pow(angle / b.width_rad, 2));
    }
    return factor / direction.cwiseQuotient(half).norm();
  }
};

/// The liver: a large right lobe, a thin left one, hollow below. The prostate: a walnut with a furrow behind.
Body body_of(OrganShape shape) {
  if (shape == OrganShape::liver)
    return {
        {92, 62, 72}, {{{1, -0.2, 0.15}, 0.4, 0.4}, {{0.25, 0.3, -1}, -0.38, 0.5}, {{-1, 0.2, -0.7}, 0.2, 0.5}}, 1500};
  return {{26, 19, 21}, {{{0, 1, 0}, -0.18, 0.35}, {{0, 0, -1}, 0.12, 0.4}}, 40};
}

TriMesh surface_of(const Body& body) {
  TriMesh mesh = sphere_surface(1);
  for (Vec3& p : mesh.vertices) {
    const Vec3 direction = p.normalized();
    p = body.radius(direction) * direction;
  }
  return mesh;
}

/// The body with the volume that is asked for.
Body sized(Body body, double volume_ml) {
  const double wanted = volume_ml > 0 ? volume_ml : body.usual_ml;
  body.half *= own::cbrt(1000 * wanted / mesh::volume_mm3(surface_of(body)));
  return body;
}

}  // namespace

Phantom make_phantom(const Organ& options) {
  Organ o = options;
  check_options(o, std::string(Organ::name));
  Phantom phantom;
  phantom.kind = Organ::name;
  o.noise = limit_filter(o.noise, o.fwhm_mm, phantom.notes);
  const Body body = sized(body_of(o.shape), o.volume_ml);
  const Grid grid = make_grid(o.lattice);
  const Frame frame = make_frame(grid, o.pose, {0, 0, 0});
  // Behind and below, a tenth of the organ's size away from it.
  const Vec3 towards = Vec3(-0.3, 1, -0.5).normalized();
  const double ball_mm = 0.3 * body.half.minCoeff();
  const Vec3 ball = (1.15 * body.radius(towards) + ball_mm) * towards;
  const auto label_at = [&](const Vec3& p) {
    const double r = p.norm();
    if (r < 1e-9 || r <= body.radius(p / r)) return 1;
    return (p - ball).norm() <= ball_mm ? 2 : 0;
  };

  Image image(grid);
  if (o.values == OrganValues::labels) {
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) image(i, j, k) = label_at(frame.to_object(centre_of(grid, {i, j, k})));
  } else {
    const double around[] = {0, o.inside - o.outside, o.neighbour - o.outside};
    const double reach = 2.2 * body.half.maxCoeff();
    Scene scene{[&](const Vec3& p) { return around[label_at(p)]; }, {Vec3::Constant(-reach), Vec3::Constant(reach)}};
    image = render_scene(grid, frame, scene, fwhm_before_filter(o.fwhm_mm, o.noise), sub_samples_for(grid, 1.5));
    const float outside = o.outside;
    for (float& v : image.values) v = std::max(0.0F, v + outside);
    image = std::move(expose({std::move(image)}, o.noise).front());
  }
  const TriMesh surface = surface_of(body);
  TrueGate truth;
  truth.epi_ml = mesh::volume_mm3(surface) / 1000;
  truth.epi = place_in_world(grid, frame, surface);
  phantom.truth.push_back(std::move(truth));
  phantom.study = make_study({std::move(image)}, 0);
  phantom.fwhm_mm = o.fwhm_mm;
  phantom.options = o;
  return phantom;
}

}  // namespace dynasurf::synthetic
