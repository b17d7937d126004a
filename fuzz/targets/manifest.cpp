#include "dynasurf/io/detail/manifest.hpp"

#include "target.hpp"

bool dynasurf::fuzz::run_manifest(std::string_view bytes) {
  return reads("manifest.txt", [&] {
    const std::string again = io::manifest_text(io::parse_manifest(bytes, "manifest.txt"));
    require(again == bytes, "nothing is read that the program does not write");
  });
}
