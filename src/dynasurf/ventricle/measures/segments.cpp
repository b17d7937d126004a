#include "dynasurf/ventricle/measures/detail/segments.hpp"

#include <cmath>

namespace dynasurf::ventricle {
namespace {

// Cerqueira et al., Circulation 105:539 (2002): numbers, names and territories.
constexpr std::array<Segment, 17> aha{{
    {1, "basal anterior", "LAD", 0.75, 1, 90, 60},
    {2, "basal anteroseptal", "LAD", 0.75, 1, 150, 60},
    {3, "basal inferoseptal", "RCA", 0.75, 1, 210, 60},
    {4, "basal inferior", "RCA", 0.75, 1, 270, 60},
    {5, "basal inferolateral", "LCX", 0.75, 1, 330, 60},
    {6, "basal anterolateral", "LCX", 0.75, 1, 30, 60},
    {7, "mid anterior", "LAD", 0.5, 0.75, 90, 60},
    {8, "mid anteroseptal", "LAD", 0.5, 0.75, 150, 60},
    {9, "mid inferoseptal", "RCA", 0.5, 0.75, 210, 60},
    {10, "mid inferior", "RCA", 0.5, 0.75, 270, 60},
    {11, "mid inferolateral", "LCX", 0.5, 0.75, 330, 60},
    {12, "mid anterolateral", "LCX", 0.5, 0.75, 30, 60},
    {13, "apical anterior", "LAD", 0.25, 0.5, 90, 90},
    {14, "apical septal", "LAD", 0.25, 0.5, 180, 90},
    {15, "apical inferior", "RCA", 0.25, 0.5, 270, 90},
    {16, "apical lateral", "LCX", 0.25, 0.5, 0, 90},
    {17, "apex", "LAD", 0, 0.25, 90, 360},
}};

constexpr std::array<Segment, 20> twenty{{
    {1, "distal anterior", "LAD", 0.25, 0.5, 90, 60},       {2, "distal anteroseptal", "LAD", 0.25, 0.5, 150, 60},
    {3, "distal inferoseptal", "LAD", 0.25, 0.5, 210, 60},  {4, "distal inferior", "RCA", 0.25, 0.5, 270, 60},
    {5, "distal inferolateral", "LCX", 0.25, 0.5, 330, 60}, {6, "distal anterolateral", "LCX", 0.25, 0.5, 30, 60},
    {7, "mid anterior", "LAD", 0.5, 0.75, 90, 60},          {8, "mid anteroseptal", "LAD", 0.5, 0.75, 150, 60},
    {9, "mid inferoseptal", "RCA", 0.5, 0.75, 210, 60},     {10, "mid inferior", "RCA", 0.5, 0.75, 270, 60},
    {11, "mid inferolateral", "LCX", 0.5, 0.75, 330, 60},   {12, "mid anterolateral", "LCX", 0.5, 0.75, 30, 60},
    {13, "basal anterior", "LAD", 0.75, 1, 90, 60},         {14, "basal anteroseptal", "LAD", 0.75, 1, 150, 60},
    {15, "basal inferoseptal", "RCA", 0.75, 1, 210, 60},    {16, "basal inferior", "RCA", 0.75, 1, 270, 60},
    {17, "basal inferolateral", "LCX", 0.75, 1, 330, 60},   {18, "basal anterolateral", "LCX", 0.75, 1, 30, 60},
    {19, "anteroapical", "LAD", 0, 0.25, 90, 180},          {20, "inferoapical", "LAD", 0, 0.25, 270, 180},
}};

bool holds(const Segment& s, const PolarPoint& at) {
  if (at.rho < s.rho_low || at.rho >= s.rho_high) return s.rho_high == 1 && at.rho == 1;
  if (s.width_deg >= 360) return true;
  // Angles close at 360: the sector about 0 begins below it.
  double from_start = at.angle_deg - (s.middle_deg - s.width_deg / 2);
  from_start -= 360 * std::floor(from_start / 360);
  return from_start < s.width_deg;
}

}  // namespace

std::span<const Segment> segments_of(SegmentModel model) {
  if (model == SegmentModel::aha17) return aha;
  return twenty;
}

int segment_at(SegmentModel model, const PolarPoint& at) {
  if (at.rho > 1) return 0;
  for (const Segment& s : segments_of(model))
    if (holds(s, at)) return s.number;
  return 0;
}

std::vector<int> segments_of_vertices(SegmentModel model, const HeartAxes& axes, std::span<const Vec3> vertices,
                                      double slack_mm) {
  std::vector<int> segments;
  segments.reserve(vertices.size());
  for (const Vec3& p : vertices)
    segments.push_back(axes.above_base(p) > -slack_mm ? 0 : segment_at(model, axes.polar(p)));
  return segments;
}

}  // namespace dynasurf::ventricle
