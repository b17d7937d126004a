#include "dynasurf/mesh/detail/surface_editor.hpp"

#include <algorithm>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/repair.hpp"

namespace dynasurf::mesh {
namespace {

/// A triangle on the other side of every edge that has one on one side only, with the number of the vertex that those
/// of its loop meet in. Empty where a vertex is on two loops, or on an edge of more than two triangles.
std::vector<SurfaceEditor::Corners> lids_of(const TriMesh& mesh, std::uint32_t& vertices) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) edges.push_back({t[c], t[(c + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  constexpr std::uint32_t none = SurfaceEditor::none;
  std::vector<std::uint32_t> next(vertices, none);  // along the boundary, with the lids on the left
  for (const auto& [a, b] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), std::pair{b, a})) {
      if (next[b] != none) return {};
      next[b] = a;
    }
  std::vector<SurfaceEditor::Corners> lids;
  for (std::uint32_t first = 0; first < next.size(); ++first) {
    if (next[first] == none) continue;
    for (std::uint32_t v = first; next[v] != none;) {
      const std::uint32_t then = std::exchange(next[v], none);
      lids.push_back({v, then, vertices});
      v = then;
    }
    ++vertices;
  }
  return lids;
}

}  // namespace

SurfaceEditor::SurfaceEditor(const TriMesh& mesh, Boundary boundary)
    : positions_(mesh.vertices), from_(3 * mesh.triangles.size()), alive_(mesh.triangles.size()) {
  const auto refuse = [] { throw InputError("the surface is not closed, manifold and oriented"); };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t c = 0; c < 3; ++c) {
      if (mesh.triangles[t][c] >= mesh.vertices.size()) refuse();
      from_[3 * t + c] = mesh.triangles[t][c];
    }
  if (boundary == Boundary::kept) {
    first_lid_ = end_lids_ = positions_.size();
    const std::vector<Corners> lids = lids_of(mesh, end_lids_);
    if (!lids.empty()) {
      positions_.resize(end_lids_, Vec3::Zero());
      is_lid_.assign(mesh.triangles.size(), 0);
      is_lid_.resize(mesh.triangles.size() + lids.size(), 1);
      on_boundary_.assign(positions_.size(), 0);
    }
    for (const Corners& lid : lids) {
      from_.insert(from_.end(), lid.begin(), lid.end());
      on_boundary_[lid[0]] = 1;
    }
  }
  out_.assign(positions_.size(), none);
  twin_.assign(from_.size(), none);
  std::vector<std::uint32_t> first(out_.size() + 1, 0);
  for (const std::uint32_t v : from_) ++first[v + 1];
  for (std::size_t v = 0; v < out_.size(); ++v) first[v + 1] += first[v];
  std::vector<std::uint32_t> leaving(from_.size());
  std::vector<std::uint32_t> fill(first.begin(), first.end() - 1);
  for (std::uint32_t h = 0; h < from_.size(); ++h) leaving[fill[from_[h]]++] = h;
  for (std::uint32_t h = 0; h < from_.size(); ++h) {
    // Each half-edge has one twin that runs the other way: with none the surface has a hole or is turned, with two it
    // branches.
    out_[from_[h]] = h;
    const std::uint32_t end = to(h);
    std::uint32_t found = none;
    for (std::uint32_t i = first[end]; i < first[end + 1]; ++i)
      if (to(leaving[i]) == from_[h]) {
        if (found != none) refuse();
        found = leaving[i];
      }
    if (found == none) refuse();
    twin_[h] = found;
  }
  // Turning about a vertex meets all half-edges that leave it, unless several fans meet there.
  for (std::uint32_t v = 0; v < out_.size(); ++v)
    if (out_[v] == none || static_cast<std::uint32_t>(valence(v)) != first[v + 1] - first[v]) refuse();
}

int SurfaceEditor::valence(std::uint32_t v) const {
  int n = 0;
  std::uint32_t h = out_[v];
  do {
    ++n;
    h = turned(h);
  } while (h != out_[v]);
  return n;
}

bool SurfaceEditor::can_collapse(std::uint32_t h) const {
  const std::uint32_t a = from(h), b = to(h), c = to(next(h)), d = to(next(twin(h)));
  // The opposite corners lose an edge each: one of three would be left with two.
  if (valence(c) <= 3 || valence(d) <= 3) return false;
  // Two places of the boundary that are no neighbours on it would become a pinch.
  if (is_on_boundary(a) && is_on_boundary(b) && !is_boundary_edge(h)) return false;
  // Both ends may have no other neighbours in common than the opposite corners (link condition).
  for (std::uint32_t g = turned(h); g != h; g = turned(g)) {
    const std::uint32_t neighbour = to(g);
    if (neighbour == c || neighbour == d) continue;
    std::uint32_t k = twin(h);
    do {
      if (to(k) == neighbour) return false;
      k = turned(k);
    } while (k != twin(h));
  }
  return a != b && c != d;
}

void SurfaceEditor::collapse(std::uint32_t h, const Vec3& p) {
  const bool is_boundary = is_boundary_edge(h);
  const std::uint32_t a = from(h), b = to(h), o = twin(h);
  const std::uint32_t c = to(next(h)), d = to(next(o));
  for (std::uint32_t g = turned(h); g != h; g = turned(g)) from_[g] = b;
  from_[h] = b;
  // c to b, b to c; d to b, b to d, once a is b.
  const std::uint32_t h1 = twin(next(h)), h2 = twin(previous(h)), o1 = twin(next(o)), o2 = twin(previous(o));
  pair(h1, h2);
  pair(o1, o2);
  for (const std::uint32_t t : {h / 3, o / 3})
    for (std::uint32_t i = 0; i < 3; ++i) from_[3 * t + i] = none;
  out_[a] = none;
  out_[b] = h2;
  out_[c] = h1;
  out_[d] = o1;
  positions_[b] = p;
  alive_ -= is_boundary ? 1 : 2;
  if (!on_boundary_.empty()) on_boundary_[b] |= on_boundary_[a];
}

bool SurfaceEditor::can_flip(std::uint32_t h) const {
  const std::uint32_t c = to(next(h)), d = to(next(twin(h)));
  if (is_boundary_edge(h) || !is_alive(h / 3)) return false;
  if (c == d || valence(from(h)) <= 3 || valence(to(h)) <= 3) return false;
  std::uint32_t g = out_[c];
  do {
    if (to(g) == d) return false;
    g = turned(g);
  } while (g != out_[c]);
  return true;
}

void SurfaceEditor::flip(std::uint32_t h) {
  const std::uint32_t o = twin(h), a = from(h), b = to(h);
  const std::uint32_t hn = next(h), hp = previous(h), on = next(o), op = previous(o);
  const std::uint32_t c = from(hp), d = from(op);
  const std::uint32_t bc = twin(hn), ca = twin(hp), ad = twin(on), db = twin(op);
  // h: d -> c, then c -> a, a -> d; o: c -> d, then d -> b, b -> c.
  from_[h] = d, from_[hn] = c, from_[hp] = a;
  from_[o] = c, from_[on] = d, from_[op] = b;
  pair(hn, ca);
  pair(hp, ad);
  pair(on, db);
  pair(op, bc);
  out_[a] = hp, out_[b] = op, out_[c] = hn, out_[d] = h;
}

std::uint32_t SurfaceEditor::split(std::uint32_t h, const Vec3& p) {
  const bool is_boundary = is_boundary_edge(h);
  const std::uint32_t o = twin(h), b = to(h), c = to(next(h)), d = to(next(o));
  const std::uint32_t v = positions_.size();
  positions_.push_back(p);
  const std::uint32_t bc = next(h), db = previous(o), bc_twin = twin(bc), db_twin = twin(db);
  const std::uint32_t s = from_.size(), r = s + 3;
  // h: a -> v -> c; s: v -> b -> c. o: v -> a -> d; r: b -> v -> d.
  from_.insert(from_.end(), {v, b, c, b, v, d});
  twin_.resize(from_.size());
  from_[bc] = v;
  from_[o] = v;
  pair(s, r);
  pair(s + 1, bc_twin);
  pair(s + 2, bc);
  pair(r + 1, db);
  pair(r + 2, db_twin);
  out_.push_back(s);
  out_[b] = r;
  out_[d] = db;
  alive_ += is_boundary ? 1 : 2;
  if (!is_lid_.empty()) {
    is_lid_.push_back(is_lid_[h / 3]);
    is_lid_.push_back(is_lid_[o / 3]);
    on_boundary_.push_back(is_boundary ? 1 : 0);
  }
  return v;
}

TriMesh SurfaceEditor::mesh(std::vector<std::uint32_t>* old_vertex) const {
  TriMesh m;
  std::vector<std::uint32_t> id(positions_.size(), none);
  if (old_vertex) old_vertex->clear();
  for (std::uint32_t v = 0; v < positions_.size(); ++v) {
    if (!has_vertex(v)) continue;
    id[v] = m.vertices.size();
    m.vertices.push_back(positions_[v]);
    if (old_vertex) old_vertex->push_back(v);
  }
  for (std::uint32_t t = 0; t < triangle_slots(); ++t)
    if (is_alive(t)) m.triangles.push_back({id[from_[3 * t]], id[from_[3 * t + 1]], id[from_[3 * t + 2]]});
  return m;
}

}  // namespace dynasurf::mesh
