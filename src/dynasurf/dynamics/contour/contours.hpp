#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/dynamics/contour/detail/curvature.hpp"
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::dynamics {

/// The discrete contour of Lobregt and Viergever (MOD-CONTOUR, thesis 3.4.1, eqs 3.43-3.49). The thesis publishes no
/// parameters; these are ours (O19).
struct DiscreteContour {
  double external = 1;
  double internal = 0.5;
  double damping = 0.5;
  double mass = 1;
  double step = 0.5;
  double edge_px = 2;
  int resample_every = 10;
  bool radial_only = true;
  CurvatureFilter filter = CurvatureFilter::fixed;
  double still_px = 1e-3;
  int still_checks = 5;
  int max_steps = 2000;
};
void describe(auto& visit, DiscreteContour& o) {
  visit("external", o.external, OptionInfo{"w_ex: weight of the field, whose largest vector should be 1", "", 0, 1e3});
  visit("internal", o.internal,
        OptionInfo{"w_in: weight of the local curvature force; 0 leaves the contour limp", "", 0, 1e3});
  visit("damping", o.damping, OptionInfo{"-w_damp: force against the velocity", "", 0, 1e3});
  visit("mass", o.mass, OptionInfo{"of each point", "", 1e-6, 1e6});
  visit("step", o.step, OptionInfo{"time step", "", 1e-6, 1e3});
  visit("edge_px", o.edge_px,
        OptionInfo{"l_des: edges below half of it are merged, above 1.5 of it split (thesis 3.48-3.49)", "px", 0.1,
                   1000});
  visit("resample_every", o.resample_every, OptionInfo{"steps between two resamplings; 0 never", "", 0, 1000000});
  visit("radial_only", o.radial_only,
        OptionInfo{"only the radial part of the field acts, so that points do not gather (thesis 3.32)"});
  visit("filter", o.filter, OptionInfo{"fixed {-1/2, 1, -1/2} or by local edge length"});
  visit("still_px", o.still_px, OptionInfo{"at rest below this velocity and acceleration", "px", 0, 1});
  visit("still_checks", o.still_checks, OptionInfo{"steps in a row", "", 1, 100000});
  visit("max_steps", o.max_steps, OptionInfo{"the run ends here in any case", "", 1, 100000000});
}

/// Where a contour came to rest.
struct ContourResult {
  Contour contour;
  StopReason reason = StopReason::max_steps;  // at_rest, max_steps, or diverged: shrunk to nothing or flown
                                              // apart; the contour is the last one that was in order
  int steps = 0;
};

/// Moves a contour under a field of its plane (see potential.hpp) until velocity and acceleration vanish. An empty
/// field (no values) stands for no external force. Throws InputError for fewer than 3 points or points that are not
/// finite, OptionError.
ContourResult evolve_contour(const Contour& start, const field::VectorField& field, const DiscreteContour& options);

/// One resampling (A.6): edges shorter than half of `edge_px` are replaced by their middle, then edges longer than
/// 1.5 `edge_px` are halved, again and again until none is left (at most 10 rounds). At least 3 points stay.
/// `carried`, one value per point, is averaged along; it may be empty.
void resample(Contour& contour, double edge_px, std::vector<Vec2>& carried);
void resample(Contour& contour, double edge_px);

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

/// The classical snake (SNK-CLASSIC, thesis 3.3.1, eqs 3.20, 3.25, 3.37).
struct Snake {
  double alpha = 0.2;
  double beta = 0.05;
  double step = 0.5;
  double external = 1;
  double edge_px = 1.5;
  int respace_every = 20;
  double still_px = 1e-3;
  int max_steps = 2000;
};
void describe(auto& visit, Snake& o) {
  visit("alpha", o.alpha, OptionInfo{"tension: resists stretching", "", 0, 1e6});
  visit("beta", o.beta, OptionInfo{"rigidity: resists bending", "", 0, 1e6});
  visit("step", o.step, OptionInfo{"time step", "", 1e-6, 1e6});
  visit("external", o.external, OptionInfo{"weight of the field, whose largest vector should be 1", "", 0, 1e3});
  visit("edge_px", o.edge_px, OptionInfo{"distance of the points", "px", 0.1, 1000});
  visit("respace_every", o.respace_every,
        OptionInfo{"steps between two spacings at equal arcs; 0 never", "", 0, 1000000});
  visit("still_px", o.still_px, OptionInfo{"at rest when no point moves farther in a step", "px", 0, 1});
  visit("max_steps", o.max_steps, OptionInfo{"the run ends here in any case", "", 1, 100000000});
}

/// x_t = alpha x'' - beta x'''' + V(x), points one unit of the parameter apart, implicit in the internal part:
/// (I + dt A) x_new = x + dt V(x) with A cyclic and pentadiagonal. Stable for any step as far as the internal part
/// goes. `field` is -grad E of a snake energy, or a gradient vector flow. Closed contours only; an empty field stands
/// for none. Throws InputError and OptionError like `evolve_contour`.
ContourResult evolve_snake(const Contour& start, const field::VectorField& field, const Snake& options);

/// Solves (I + dt A) x = b for a ring of n unknowns, n >= 5, in O(n): the band is factored with its corners
/// eliminated by a small dense system.
std::vector<Vec2> solve_cyclic_pentadiagonal(double main, double next, double second, const std::vector<Vec2>& b);

/// Active nets and topological active nets (NET-ACTIVE, NET-TOPO, thesis 3.3.2, eqs 3.26-3.30), after Bro-Nielsen and
/// Ansia. The thesis compares them on paper only and gives no weights; these are ours (O26).
struct ActiveNet {
  int rows = 20, columns = 20;
  double alpha = 0.5;
  double beta = 0.1;
  double xi = 2;
  int window = 3;
  double sigma_px = 1;
  bool dark_objects = false;
  int max_sweeps = 300;
  double bad_distance_px = 2;
  double hole_level = 0.8;
  double reach = 0.5;
  int sparse = 10;
};
void describe(auto& visit, ActiveNet& o) {
  visit("rows", o.rows, OptionInfo{"nodes of the dense net", "", 3, 500});
  visit("columns", o.columns, OptionInfo{"nodes of the dense net", "", 3, 500});
  visit("alpha", o.alpha, OptionInfo{"contraction: squared distance of linked nodes, in first spacings", "", 0, 1e6});
  visit("beta", o.beta, OptionInfo{"bending of the lines of the net", "", 0, 1e6});
  visit("xi", o.xi, OptionInfo{"pull of external nodes to strong gradients", "", 0, 1e6});
  visit("window", o.window, OptionInfo{"side of the square over which the image is averaged", "px", 1, 31});
  visit("sigma_px", o.sigma_px, OptionInfo{"Gaussian before the gradient", "px", 0, 20});
  visit("dark_objects", o.dark_objects, OptionInfo{"objects are dark on bright, as in the thesis"});
  visit("max_sweeps", o.max_sweeps, OptionInfo{"passes over all nodes before a minimum is given up", "", 1, 1000000});
  visit("bad_distance_px", o.bad_distance_px,
        OptionInfo{
            "a link of the rim that lies in the background and farther than this from every strong gradient breaks",
            "px", 0, 1000});
  visit("hole_level", o.hole_level,
        OptionInfo{"an internal node with more of the background than this lies in a hole or concavity", "", 0, 1});
  visit("reach", o.reach,
        OptionInfo{
            "pull of external nodes to the nearest strong gradient, per px: moves of whole pixels do not carry a net "
            "over "
            "an empty plane by its contraction alone",
            "", 0, 1e3});
  visit("sparse", o.sparse, OptionInfo{"nodes per side of the first net, which finds the objects", "", 3, 500});
}

/// A mesh of squares over part of a plane. Nodes that lost all their squares are gone.
struct Net {
  std::vector<Vec2> nodes;                          // px
  std::vector<std::array<std::uint32_t, 4>> quads;  // corners in turn
  std::vector<std::uint8_t> external;               // per node: not surrounded by four squares
  int sweeps = 0;                                   // all passes together
  int broken_links = 0;
};
/// Number of connected parts, and of holes in them (from V - E + F).
struct NetShape {
  int parts = 0, holes = 0;
};
/// Counts the parts and holes of a net.
NetShape shape_of(const Net& net);

/// NET-ACTIVE: a net over the whole plane that shrinks onto the objects, by greedy moves of one pixel per node until
/// none lowers the energy. Its topology stays.
Net fit_net(const Image& plane, const ActiveNet& options);

/// NET-TOPO: a sparse net finds the objects; over each a dense net is laid whose links break where external nodes lie
/// far from every strong gradient, and around internal nodes that lie in the background, so that it splits, opens and
/// follows concavities. One net per object; none for a plane without contrast. Throws OptionError, and InputError for
/// a plane below 8 x 8 px or with values that are not finite.
std::vector<Net> fit_topological_nets(const Image& plane, const ActiveNet& options);

}  // namespace dynasurf::dynamics
