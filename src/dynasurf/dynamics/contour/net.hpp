#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::dynamics {

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
