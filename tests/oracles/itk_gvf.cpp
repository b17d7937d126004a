// ITK as the judge of explicit gradient vector flow. Built where ITK is installed.
#include <gtest/gtest.h>
#include <itkCovariantVector.h>
#include <itkGradientVectorFlowImageFilter.h>
#include <itkImage.h>

#include "dynasurf/field/detail/gradient.hpp"
#include "dynasurf/field/gvf.hpp"

#include "support/edge_maps.hpp"

namespace dynasurf::field {
namespace {

using ItkVector = itk::CovariantVector<float, 3>;
using ItkField = itk::Image<ItkVector, 3>;

ItkField::Pointer gradient_of(const Image& f) {
  auto field = ItkField::New();
  ItkField::SizeType size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<itk::SizeValueType>(f.grid.dims[a]);
  field->SetRegions(size);
  field->Allocate();
  for (int k = 0; k < f.grid.dims[2]; ++k)
    for (int j = 0; j < f.grid.dims[1]; ++j)
      for (int i = 0; i < f.grid.dims[0]; ++i) {
        const Vec3 slope = detail::gradient_at(f, i, j, k);
        ItkVector v;
        for (unsigned a = 0; a < 3; ++a) v[a] = static_cast<float>(slope[a]);
        field->SetPixel({i, j, k}, v);
      }
  return field;
}

TEST(ItkOracle, ExplicitFlowIsTheSameStepForStepWhereVoxelsAreCubes) {
  // ITK drops the spacing, so that the two can be compared on cubes of 1 mm alone. Its step is 1 / (2^dim mu).
  const Grid g = test::box(30, 28, 26);
  const Image sphere = test::border_of(g, [](const Vec3& p) { return p.norm() < 8 + 0.2 * p[0]; });
  for (const Image& f : {sphere, test::blurred(test::noise(g, 5), 2)})
    for (double mu : {0.5, 1.0}) {
      auto filter = itk::GradientVectorFlowImageFilter<ItkField, ItkField, float>::New();
      filter->SetInput(gradient_of(f));
      filter->SetNoiseLevel(mu);
      filter->SetIterationNum(60);
      filter->Update();
      const FlowResult r =
          flow_field(f, Gvf{.mu = mu, .iterations = 60, .step_divisor = 8, .scheme = GvfScheme::metric});
      ASSERT_TRUE(r.notes.empty());
      double apart = 0, size = 0;
      for (int k = 0; k < g.dims[2]; ++k)
        for (int j = 0; j < g.dims[1]; ++j)
          for (int i = 0; i < g.dims[0]; ++i) {
            const ItkVector v = filter->GetOutput()->GetPixel({i, j, k});
            const std::size_t at = g.index(i, j, k);
            const Vec3 theirs(v[0], v[1], v[2]);
            apart += (theirs - Vec3(r.field.x[at], r.field.y[at], r.field.z[at])).squaredNorm();
            size += theirs.squaredNorm();
          }
      EXPECT_LT(std::sqrt(apart / size), 1e-5);  // 60 roundings of 6e-8, summed in other orders
    }
}

}  // namespace
}  // namespace dynasurf::field
