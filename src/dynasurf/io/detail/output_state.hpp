#pragma once

namespace dynasurf::io {

/// How far the outputs of this process have come: none was begun, none is in its place yet, or at least one is. What is
/// written inside an unpublished OutputFolder counts when that folder is published.
enum class OutputState { none, begun, published };

}  // namespace dynasurf::io
