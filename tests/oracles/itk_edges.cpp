// ITK as the judge of Canny and Sobel. Built where ITK is installed.
#include <cmath>

#include <gtest/gtest.h>
#include <itkCannyEdgeDetectionImageFilter.h>
#include <itkImage.h>
#include <itkImageRegionIterator.h>
#include <itkSobelEdgeDetectionImageFilter.h>

#include "dynasurf/image/edges.hpp"

#include "support/blurred_heart.hpp"
#include "support/edge_images.hpp"

namespace dynasurf::image {
namespace {

using ItkImage = itk::Image<float, 2>;

ItkImage::Pointer to_itk(const Image& m, int k) {
  auto image = ItkImage::New();
  image->SetRegions(ItkImage::SizeType{static_cast<itk::SizeValueType>(m.grid.dims[0]),
                                       static_cast<itk::SizeValueType>(m.grid.dims[1])});
  image->Allocate();
  for (int j = 0; j < m.grid.dims[1]; ++j)
    for (int i = 0; i < m.grid.dims[0]; ++i) image->SetPixel({i, j}, m(i, j, k));
  return image;
}

std::vector<Image> slices() {
  std::vector<Image> all{test::disc_image(48, 23.4, 24.1, 12.3), test::noise_image(40, 33, 1),
                         test::step_image(40, 19.3, 18.8, 33)};
  test::HeartShape h;
  h.noise = 0.03;
  const Image heart = test::blurred_heart(h);
  for (const int k : {8, 12, 16}) {
    Grid one = heart.grid;
    one.dims[2] = 1;
    Image slice(one);
    std::copy_n(heart.values.begin() + static_cast<std::ptrdiff_t>(heart.grid.index(0, 0, k)), one.size(),
                slice.values.begin());
    all.push_back(slice);
  }
  return all;
}

TEST(ItkOracle, SobelGivesTheSameMagnitudes) {
  for (const Image& m : slices()) {
    auto filter = itk::SobelEdgeDetectionImageFilter<ItkImage, ItkImage>::New();
    filter->SetInput(to_itk(m, 0));
    filter->Update();
    const Image gradient = detect_edges(m, SobelEdges{}).gradient;
    for (int j = 0; j < m.grid.dims[1]; ++j)
      for (int i = 0; i < m.grid.dims[0]; ++i)
        EXPECT_NEAR(gradient(i, j, 0), filter->GetOutput()->GetPixel({i, j}), 1e-5);  // both sum in other orders
  }
}

/// Share of the pixels of `a` that have a pixel of `b` among their eight neighbours or on themselves.
template <class A, class B>
double share_near(const Grid& g, const A& a, const B& b) {
  double near = 0, all = 0;
  for (int j = 0; j < g.dims[1]; ++j)
    for (int i = 0; i < g.dims[0]; ++i) {
      if (!a(i, j)) continue;
      bool found = false;
      for (int q = std::max(0, j - 1); q <= std::min(g.dims[1] - 1, j + 1); ++q)
        for (int p = std::max(0, i - 1); p <= std::min(g.dims[0] - 1, i + 1); ++p) found |= b(p, q);
      near += found, all += 1;
    }
  return all > 0 ? near / all : 1;
}

TEST(ItkOracle, CannyFindsTheSameLines) {
  const auto all = slices();
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (n == 1) continue;  // white noise: its ridges are everywhere, so being near proves nothing
    const Image& m = all[n];
    const Canny o{.sigma_px = 1.4, .low = 0.2, .high = 0.4};
    const EdgeMap ours = detect_edges(m, o);
    const float max = *std::max_element(ours.gradient.values.begin(), ours.gradient.values.end());
    auto filter = itk::CannyEdgeDetectionImageFilter<ItkImage, ItkImage>::New();
    filter->SetInput(to_itk(m, 0));
    filter->SetVariance(o.sigma_px * o.sigma_px);
    filter->SetLowerThreshold(static_cast<float>(o.low) * max);
    filter->SetUpperThreshold(static_cast<float>(o.high) * max);
    filter->Update();
    const auto mine = [&](int i, int j) { return ours.edges(i, j, 0) != 0; };
    const auto its = [&](int i, int j) { return filter->GetOutput()->GetPixel({i, j}) != 0; };
    // ITK marks zero crossings of the second derivative, we mark ridges of the first: the same line to a pixel.
    EXPECT_GT(share_near(m.grid, mine, its), 0.95) << n;
    EXPECT_GT(share_near(m.grid, its, mine), 0.9) << n;
  }
}

}  // namespace
}  // namespace dynasurf::image
