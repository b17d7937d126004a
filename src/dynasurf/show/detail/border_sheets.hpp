#pragma once
#include <filesystem>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::show {

/// The sheets of every gate as gNN_edges.png, and with `labels` what was made of the edges: gNN_labels.png and
/// gNN_rings.png. Throws IoError.
void write_border_sheets(const ventricle::BorderResult& result, const ventricle::Options& options, bool labels,
                         const std::filesystem::path& folder);

}  // namespace dynasurf::show
