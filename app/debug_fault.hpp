#pragma once
#include <string>

namespace dynasurf::app {

/// Misbehaves where the environment variable DYNASURF_DEBUG_FAULT asks for it, so that it can be tested what a batch
/// makes of a study that does: hang (sleeps for ever), memory (takes all there is), crash (a wrong access), kill (kills
/// itself, as the system does when memory is short). Else does nothing.
void cause_debug_fault();

/// The variable for the run of one study, "DYNASURF_DEBUG_FAULT=hang", out of DYNASURF_DEBUG_FAULTS of the batch, which
/// lists ID=FAULT with commas between them; empty without a fault.
std::string debug_fault_of(const std::string& id);

}  // namespace dynasurf::app
