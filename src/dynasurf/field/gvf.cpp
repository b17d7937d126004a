#include "dynasurf/field/gvf.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/detail/gradient.hpp"

namespace dynasurf::field {

namespace {

constexpr std::array<std::string_view, 2> scheme_names{"thesis", "metric"};

/// Diffusion per unit of time towards the neighbours along each axis, and the cell that the printed step divides.
/// An axis of one voxel has no neighbours: a single slice is the two-dimensional case.
struct Diffusion {
  Vec3 rate = Vec3::Zero();
  double cell = 1;
};

/// What both explicit schemes are made of: v_t = mu g lap(v) - b (v - grad f). GVF has g = 1 and b = |grad f|^2, GGVF
/// mu = 1 and b = 1 - g.
struct Scheme {
  double mu = 1;
  double inverse_k = 0;  // GGVF: of g = exp(-|grad f| / K); GVF: 0
  int iterations;
  double residual, step_divisor;
  GvfScheme kind;
  bool safe_step;

  double spread(double slope_squared) const {
    return inverse_k > 0 ? own::exp(-inverse_k * std::sqrt(slope_squared)) : 1;
  }
  double pull(double slope_squared) const { return inverse_k > 0 ? 1 - spread(slope_squared) : slope_squared; }
};

Scheme scheme_of(const Gvf& o, double) {
  return {o.mu, 0, o.iterations, o.residual, o.step_divisor, o.scheme, o.safe_step};
}
Scheme scheme_of(const Ggvf& o, double largest_slope_squared) {
  const double steepest = std::sqrt(largest_slope_squared);
  return {1, steepest > 0 ? 1 / (o.k * steepest) : 1, o.iterations, o.residual, o.step_divisor, o.scheme, o.safe_step};
}

Diffusion diffusion_of(const Grid& grid, const Scheme& o) {
  Diffusion d;
  for (int a = 0; a < 3; ++a)
    if (grid.dims[a] > 1) d.cell *= grid.spacing[a];
  for (int a = 0; a < 3; ++a)
    if (grid.dims[a] > 1) d.rate[a] = o.mu / (o.kind == GvfScheme::thesis ? d.cell : grid.spacing[a] * grid.spacing[a]);
  return d;
}

/// The linear bound: a step times this number must stay below 2, and below 1 for a field that never swings.
double stiffness(double largest_b, const Diffusion& d) { return largest_b + 4 * d.rate.sum(); }

/// Rows with one spare voxel on either side, which repeats the border, so that a row is one loop without exceptions.
/// The stride is a whole number of vectors.
struct Layout {
  int nx, ny, nz;
  std::size_t stride, size;

  explicit Layout(const Index3& n)
      : nx(n[0]), ny(n[1]), nz(n[2]), stride((n[0] + 2 + 15) / 16 * 16), size(stride * n[1] * n[2] + 32) {}
  std::size_t row(int j, int k) const { return 16 + stride * index_in({ny, nz, 1}, {j, k, 0}); }
};

/// What an iteration reads and writes.
struct Sweep {
  Layout layout;
  std::array<detail::FloatBuffer, 3> from, to, gradient;
  detail::FloatBuffer pull;            // b dt: how strongly a voxel is drawn back to the gradient
  detail::FloatBuffer spread;          // g of GGVF; empty for GVF
  std::vector<std::uint8_t> has_pull;  // one per row; most rows of a border map have none
  float rx = 0, ry = 0, rz = 0;        // diffusion per step
  bool measure_change = false;

  Sweep(const Index3& dims, bool generalised) : layout(dims), pull(layout.size), spread(generalised ? layout.size : 0) {
    for (auto* group : {&from, &to, &gradient})
      for (auto& component : *group) component = detail::FloatBuffer(layout.size);
    has_pull.resize(size_of({1, dims[1], dims[2]}));
  }
};

/// Largest magnitudes as bit patterns: without the sign they order like the numbers, and a NaN is above all of them.
/// Whole numbers have a maximum that the compiler can vectorise without changing any result.
struct Extremes {
  int value = 0, change = 0;
};

DYNASURF_INLINE int magnitude_bits(float v) { return std::bit_cast<int>(v) & 0x7fffffff; }

struct Neighbours {
  const float *own, *ym, *yp, *zm, *zp;
};

/// One row of one component. In differences, so that a field at rest stays at rest to the last bit.
enum class Pull { none, gvf, ggvf };

template <Pull how, bool measured>
DYNASURF_INLINE void step_row(const Sweep& s, const Neighbours& p, const float* __restrict pull,
                              const float* __restrict spread, const float* __restrict gradient, float* __restrict out,
                              Extremes& e) {
  const int n = s.layout.nx;
  const float rx = s.rx, ry = s.ry, rz = s.rz;
  int value = e.value, change = e.change;
  for (int i = 0; i < n; ++i) {
    const float u = p.own[i];
    float du = rx * ((p.own[i - 1] - u) + (p.own[i + 1] - u)) + ry * ((p.ym[i] - u) + (p.yp[i] - u)) +
               rz * ((p.zm[i] - u) + (p.zp[i] - u));
    if constexpr (how == Pull::ggvf) du *= spread[i];
    if constexpr (how != Pull::none) du += pull[i] * (gradient[i] - u);
    const float next = u + du;
    out[i] = next;
    value = std::max(value, magnitude_bits(next));
    if constexpr (measured) change = std::max(change, magnitude_bits(du));
  }
  e.value = value;
  e.change = change;
  out[-1] = out[0];
  out[n] = out[n - 1];
}

template <bool measured>
DYNASURF_INLINE void step_any_row(const Sweep& s, const Neighbours& p, Pull how, const float* pull, const float* spread,
                                  const float* gradient, float* out, Extremes& e) {
  if (how == Pull::none)
    step_row<Pull::none, measured>(s, p, pull, spread, gradient, out, e);
  else if (how == Pull::gvf)
    step_row<Pull::gvf, measured>(s, p, pull, spread, gradient, out, e);
  else
    step_row<Pull::ggvf, measured>(s, p, pull, spread, gradient, out, e);
}

DYNASURF_CLONES Extremes step_slices(const Sweep& s, int begin, int end) {
  const Layout& l = s.layout;
  const bool generalised = s.spread.size() > 0;
  Extremes e;
  for (int k = begin; k < end; ++k)
    for (int j = 0; j < l.ny; ++j) {
      const std::size_t row = l.row(j, k);
      const std::size_t ym = l.row(std::max(j - 1, 0), k), yp = l.row(std::min(j + 1, l.ny - 1), k);
      const std::size_t zm = l.row(j, std::max(k - 1, 0)), zp = l.row(j, std::min(k + 1, l.nz - 1));
      const bool pulled = s.has_pull[j + l.ny * k] != 0;
      const Pull how = !pulled ? Pull::none : generalised ? Pull::ggvf : Pull::gvf;
      for (std::size_t c = 0; c < 3; ++c) {
        const float* u = s.from[c].data();
        const Neighbours p{u + row, u + ym, u + yp, u + zm, u + zp};
        const float* pull = s.pull.data() + row;
        const float* g = s.gradient[c].data() + row;
        float* out = s.to[c].data() + row;
        const float* spread = generalised ? s.spread.data() + row : nullptr;
        s.measure_change ? step_any_row<true>(s, p, how, pull, spread, g, out, e)
                         : step_any_row<false>(s, p, how, pull, spread, g, out, e);
      }
    }
  return e;
}

/// Slices per piece of work: large enough to pay for handing it to a thread.
std::size_t grain_of(const Layout& l) {
  const std::size_t slice = l.stride * l.ny;
  return std::max<std::size_t>(1, (std::size_t{1} << 14) / slice);
}

/// One iteration of all three components; the largest value and the largest change.
std::pair<double, double> step(const Sweep& s, std::vector<Extremes>& pieces) {
  const std::size_t grain = grain_of(s.layout), slices = s.layout.nz;
  pieces.assign((slices + grain - 1) / grain, {});
  parallel_for(slices, grain, [&](std::size_t begin, std::size_t end) {
    const detail::FlushDenormals flush;
    pieces[begin / grain] = step_slices(s, begin, end);
  });
  Extremes all;
  for (const Extremes& e : pieces) all = {std::max(all.value, e.value), std::max(all.change, e.change)};
  return {std::bit_cast<float>(all.value), std::bit_cast<float>(all.change)};
}

/// V0 = grad f (Xu and Prince), and the pull b dt.
void start(Sweep& s, const Image& f, const Scheme& o, double dt) {
  const Layout& l = s.layout;
  const bool generalised = s.spread.size() > 0;
  parallel_for(l.nz, 4, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < l.ny; ++j) {
        const std::size_t row = l.row(j, k);
        bool pulled = false;
        for (int i = 0; i < l.nx; ++i) {
          const Vec3 g = detail::gradient_at(f, i, j, k);
          const float pull = o.pull(g.squaredNorm()) * dt;
          s.pull.data()[row + i] = pull;
          if (generalised) s.spread.data()[row + i] = o.spread(g.squaredNorm());
          pulled = pulled || pull != 0;
          for (std::size_t c = 0; c < 3; ++c) {
            const float value = g[c];
            s.gradient[c].data()[row + i] = value;
            s.from[c].data()[row + i] = value;
          }
        }
        for (auto& u : s.from) {
          u.data()[row - 1] = u.data()[row];
          u.data()[row + l.nx] = u.data()[row + l.nx - 1];
        }
        s.has_pull[j + l.ny * k] = pulled;
      }
  });
}

void copy_out(const Sweep& s, VectorField& field) {
  const Layout& l = s.layout;
  std::array<float*, 3> out{field.x.data(), field.y.data(), field.z.data()};
  for (std::size_t c = 0; c < 3; ++c)
    for (int k = 0; k < l.nz; ++k)
      for (int j = 0; j < l.ny; ++j)
        std::copy_n(s.from[c].data() + l.row(j, k), l.nx, out[c] + field.grid.index(0, j, k));
}

/// The printed step, shortened where it would make the field blow up.
double choose_step(const Diffusion& d, double largest_b, const Scheme& o, Notes& notes) {
  const double printed = d.cell / (o.step_divisor * o.mu);
  const double safe = 1.9 / stiffness(largest_b, d);  // 5 % below the bound of 2
  if (!o.safe_step || printed <= safe) return printed;
  TextOutput text;
  text << "the time step " << printed << " of divisor " << o.step_divisor << " is above the stability bound; " << safe
       << " was used";
  notes.push_back({Severity::info, "gvf.step_limited", text.str()});
  return safe;
}

void iterate(Sweep& s, const Scheme& o, double limit, FlowResult& r, const Progress& progress) {
  std::vector<Extremes> pieces;
  while (r.iterations < o.iterations) {
    progress.check();
    s.measure_change = o.residual > 0 || r.iterations + 1 == o.iterations;
    const auto [value, change] = step(s, pieces);
    if (!(value <= limit)) {
      r.diverged = true;
      TextOutput text;
      text << "the field blew up in iteration " << r.iterations + 1 << " with a time step of " << r.step
           << "; a larger step divisor or mu, or safe_step, is needed";
      r.notes.push_back({Severity::failure, "gvf.diverged", text.str()});
      return;
    }
    std::swap(s.from, s.to);
    ++r.iterations;
    if (s.measure_change) r.residual = change / r.step;
    if (r.iterations % 16 == 0 || r.iterations == o.iterations) progress("field", r.iterations, o.iterations);
    if (o.residual > 0 && r.residual < o.residual) return;
  }
}

template <class Options>
double stable_step_of(const Image& edge_map, Options o) {
  check_options(o, std::string(Options::name));
  detail::check_edge_map(edge_map);
  const double steepest = detail::largest_gradient_squared(edge_map);
  const Scheme scheme = scheme_of(o, steepest);
  return 2 / stiffness(scheme.pull(steepest), diffusion_of(edge_map.grid, scheme));
}

template <class Options>
FlowResult run(const Image& edge_map, Options options, const Progress& progress) {
  check_options(options, std::string(Options::name));
  detail::check_edge_map(edge_map);
  FlowResult r;
  r.field = VectorField(edge_map.grid);
  const double steepest = detail::largest_gradient_squared(edge_map);
  const Scheme o = scheme_of(options, steepest);
  const Diffusion d = diffusion_of(edge_map.grid, o);
  r.step = choose_step(d, o.pull(steepest), o, r.notes);
  if (steepest == 0) return r;

  Sweep s(edge_map.grid.dims, o.inverse_k > 0);
  s.rx = d.rate[0] * r.step;
  s.ry = d.rate[1] * r.step;
  s.rz = d.rate[2] * r.step;
  start(s, edge_map, o, r.step);
  iterate(s, o, 10 * std::sqrt(steepest), r, progress);
  copy_out(s, r.field);
  return r;
}

}  // namespace

std::span<const std::string_view> names_of(GvfScheme) { return scheme_names; }

double stable_step(const Image& edge_map, const Gvf& options) { return stable_step_of(edge_map, options); }
double stable_step(const Image& edge_map, const Ggvf& options) { return stable_step_of(edge_map, options); }

FlowResult flow_field(const Image& edge_map, const Gvf& options, const Progress& progress) {
  return run(edge_map, options, progress);
}

FlowResult flow_field(const Image& edge_map, const Ggvf& options, const Progress& progress) {
  return run(edge_map, options, progress);
}

FlowResult flow_field(const Image& edge_map, const FieldOptions& options, const Progress& progress) {
  return std::visit([&](const auto& method) { return flow_field(edge_map, method, progress); }, options);
}

}  // namespace dynasurf::field
