#pragma once

namespace dynasurf::app {

/// Lets the heap keep what stages take and give back again and again, which the system would clear each time, and asks
/// for large pages. Call it before other threads start.
void prepare_heap();

}  // namespace dynasurf::app
