// The gradient vector flow of a cube's border, with what the installed library gives.
#include <cstdio>

#include <dynasurf/field.hpp>

int main() {
  dynasurf::Image border(dynasurf::Grid{{12, 12, 12}});
  for (int k = 4; k < 8; ++k) border(6, 6, k) = 1;
  const dynasurf::field::FlowResult flow = dynasurf::field::flow_field(border, dynasurf::field::Gvf{});
  std::printf("%zu vectors\n", flow.field.x.size());
  return flow.field.x.size() == border.values.size() ? 0 : 1;
}
