#pragma once
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf::ventricle {

/// How far the borders of every gate lie from where the whole beat would have them: the mean distance of a border from
/// the axis against its smooth course (`smooth_over_cycle`), mm, the larger of the two walls. Absent for a gate that
/// lacks a border. Slices above the base slice of a gate do not count.
struct GateLabels {
  const Labels* labels = nullptr;
  int base_slice = -1;  // -1: unknown
};
std::vector<std::optional<double>> strays_mm(std::span<const GateLabels> gates);

/// A gate labelled with the help of two others: each of its edges within `reach_mm` of their borders, slice by slice,
/// belongs to the wall whose border lies nearest, other edges to none. Circle, axis and division slice are those of
/// `before`. All lie on one grid.
Labels relabel(const Mask& edges, const Labels& before, const Labels& after, double reach_mm);

/// Who may help a gate that strays: the nearest gates before and after it in the beat that do not.
struct Helpers {
  std::size_t gate = 0, before = 0, after = 0;
  std::optional<double> stray_mm;
};
/// The gates whose borders stray by more than 4 mm or are missing. None when they are more than a third (nobody knows
/// then which are right) or the beat has fewer than 6 gates.
std::vector<Helpers> gates_to_help(std::span<const std::optional<double>> strays);

/// A beat has one end of the cavity, but for a few millimetres: gates that could only guess it ("slice_find.fallback",
/// "slice_find.no_rise") above where the others see it (their median) take it from these, if they are a third at least,
/// and say so ("slice_find.shared"). Borders stay as they are. All lie on one grid.
void share_division_slice(std::span<Labels* const> gates);

}  // namespace dynasurf::ventricle
