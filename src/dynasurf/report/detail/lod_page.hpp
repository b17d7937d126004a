#pragma once
#include <filesystem>
#include <span>
#include <vector>

#include "dynasurf/cloud/lod.hpp"

namespace dynasurf::report {

struct LodPage {
  cloud::Camera camera;
  cloud::LodRule rule;
  int instances = 200;
  std::vector<double> largest_px = {};  // as LodChain's, in place of those of the rule; empty: those
};

/// A self-contained page on which many instances of a chain of levels move, each at the level that its size on the
/// screen asks for (thesis fig 6.29). `transitions[n]` grows level n out of level n + 1. Whole or not at all. Throws
/// InputError for an empty chain or another number of transitions, IoError.
void write_lod_page(std::span<const TriMesh> levels, std::span<const cloud::LodTransition> transitions,
                    const LodPage& options, const std::filesystem::path& path);

}  // namespace dynasurf::report
