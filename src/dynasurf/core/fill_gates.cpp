#include "dynasurf/core/detail/fill_gates.hpp"

namespace dynasurf {

std::vector<FilledGate> fill_gates(std::vector<Image>& gates, const std::vector<bool>& missing) {
  const std::size_t count = gates.size();
  std::vector<FilledGate> filled;
  for (std::size_t g = 0; g < count; ++g) {
    if (!missing[g]) continue;
    std::size_t back = 1, on = 1;
    while (missing[(g + count - back) % count]) ++back;
    while (missing[(g + on) % count]) ++on;
    const FilledGate from{g, (g + count - back) % count, (g + on) % count};
    const Image &a = gates[from.before], &b = gates[from.after];
    const float from_before = back, to_after = on;
    for (std::size_t v = 0; v < a.values.size(); ++v)
      gates[g].values[v] = (to_after * a.values[v] + from_before * b.values[v]) / (from_before + to_after);
    filled.push_back(from);
  }
  return filled;
}

}  // namespace dynasurf
