#pragma once
#include <cstdint>

namespace dynasurf::io {

/// Half of what there is, bytes: of the machine's memory, of what its control group allows, or of the address space
/// that the process may take, whichever is least. 1 GiB where the system does not tell. What a job may need at most
/// when the user names no limit.
std::uint64_t default_memory_limit();

}  // namespace dynasurf::io
