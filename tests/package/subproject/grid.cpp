// A volume, with what the sources give as a part of another project.
#include <cstdio>

#include <dynasurf/core/detail/memory_limit.hpp>
#include <dynasurf/core/volume.hpp>

int main() {
  const dynasurf::Image image(dynasurf::Grid{{2, 3, 4}}, 1.0F);
  std::printf("%zu voxels\n", image.values.size());
  return image.values.size() == 24 ? 0 : 1;
}
