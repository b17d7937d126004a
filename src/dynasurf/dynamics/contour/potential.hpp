#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::dynamics {

// Planes are volumes of one slice whose pixels have the side 1, so that positions are columns and rows in px.

/// Slice k of a volume as a plane. Throws InputError when there is no such slice.
Image plane_of(const Image& volume, int k);

/// Gaussian of a plane, replicated border; 0 returns it as it is.
Image smoothed_plane(const Image& plane, double sigma_px);

/// The four external energies of classical snakes (FLD-SNAKE, thesis eqs 3.21-3.24).
enum class SnakeEnergy {
  gradient,            // E1 = -|grad I|^2
  smoothed_gradient,   // E2 = -|grad (G * I)|^2
  intensity,           // E3 = I: black lines on white; hand in -I for white ones
  smoothed_intensity,  // E4 = G * I
};
std::span<const std::string_view> names_of(SnakeEnergy);
/// The energy at every pixel of a plane, low where the snake is drawn to.
Image snake_energy(const Image& plane, SnakeEnergy kind, double sigma_px = 1);

/// FLD-POT (thesis 3.3.3): paths that are wanted become valleys of depth 1.
enum class PotentialSource { gradient, bright, dark };
std::span<const std::string_view> names_of(PotentialSource);
struct Potential {
  PotentialSource source = PotentialSource::gradient;
  double sigma_px = 1;
};
void describe(auto& visit, Potential& o) {
  visit("source", o.source, OptionInfo{"gradient: borders are valleys; bright, dark: lines of that kind are"});
  visit("sigma_px", o.sigma_px, OptionInfo{"Gaussian before all else", "px", 0, 20});
}
/// E_im, from -1 to 0; a constant plane gives 0 everywhere.
Image image_potential(const Image& plane, const Potential& options);

/// What a user draws: a point or a polyline that digs a valley (strength < 0) or raises a wall (> 0) of Gaussian
/// profile strength * exp(-distance^2 / (2 width^2)).
struct Stroke {
  std::vector<Vec2> points;  // px
  double strength = -1;
  double width_px = 2;
};
/// E_im + E_user. Throws OptionError for a stroke without points or width.
void add_strokes(Image& energy, std::span<const Stroke> strokes);

/// -grad E, scaled by `scale`.
field::VectorField force_of(const Image& energy, double scale = 1);
/// The field divided by its largest length; a zero field stays.
field::VectorField scaled_to_one(field::VectorField field);

/// The field at a point of the plane, between pixels bilinear, outside as on the border.
Vec2 force_at(const field::VectorField& field, const Vec2& point);

}  // namespace dynasurf::dynamics
