#pragma once

namespace dynasurf::app {

const char* version();  // "0.1.0"
const char* commit();   // short hash, "+changes" when the sources differ from it; "unknown" outside a git checkout

}  // namespace dynasurf::app
