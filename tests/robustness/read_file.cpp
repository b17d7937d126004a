#include <iostream>
#include <span>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/study_io.hpp"

// Reads one file and does nothing else, so that what a reader costs can be counted.

int main(int count, char** words) {
  using namespace dynasurf;
  const std::span arguments(words, static_cast<std::size_t>(count));
  if (arguments.size() != 3) return 1;
  const std::string kind = arguments[1];
  const std::filesystem::path path = arguments[2];
  try {
    if (kind == "study") io::read_study(path);
    if (kind == "mesh") io::read_mesh(path);
    if (kind == "cloud") io::read_cloud(std::span(&path, 1));
    if (kind == "points") io::read_tracked_points(path);
  } catch (const InputError& error) {
    std::cout << error.what() << '\n';
    return 2;
  }
  return 0;
}
