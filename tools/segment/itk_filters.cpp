// ITK's templates cost half a minute a translation unit: its headers are here and in no other file.
#include "tools/segment/itk_filters.hpp"

#include <itkBoxMeanImageFilter.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkGradientAnisotropicDiffusionImageFilter.h>
#include <itkHMaximaImageFilter.h>
#include <itkImage.h>
#include <itkMedianImageFilter.h>
#include <itkMorphologicalWatershedFromMarkersImageFilter.h>
#include <itkRegionalMaximaImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>

namespace tomodem::segment {
namespace {

using Grey = itk::Image<float, 3>;
using Mask = itk::Image<std::uint8_t, 3>;
using Parts = itk::Image<std::int32_t, 3>;

/// An image that looks at these voxels, which must outlive it.
template <class Image, class Value>
typename Image::Pointer view(const std::vector<Value>& voxels, const VoxelIndex& size, const Vec3& spacing) {
    const auto image = Image::New();
    typename Image::SizeType edges;
    typename Image::SpacingType of_voxel;
    for (unsigned axis = 0; axis < 3; ++axis) {
        edges[axis] = static_cast<itk::SizeValueType>(size[axis]);
        of_voxel[axis] = spacing[axis];
    }
    image->SetRegions(edges);
    image->SetSpacing(of_voxel);
    // ITK takes no pointer to const, and reads only: no filter here works in place.
    image->GetPixelContainer()->SetImportPointer(const_cast<Value*>(voxels.data()), voxels.size(), false);
    return image;
}

template <class Image>
auto copy(const Image& image) {
    const auto* const first = image.GetBufferPointer();
    return std::vector<typename Image::PixelType>(first, first + image.GetPixelContainer()->Size());
}

/// Runs one stage of a computation whose progress goes from `start` by `share`.
template <class Filter>
void run(Filter& filter, Progress& progress, double start, double share) {
    filter.AddObserver(itk::ProgressEvent(), [&filter, &progress, start, share](const itk::EventObject&) {
        progress.update(start + share * static_cast<double>(filter.GetProgress()));
    });
    filter.Update();
}

void use_threads(int threads) {
    itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
}

/// Runs a filter of grey values whose window is a box.
template <class Filter>
std::vector<float> filtered(const GreyVolume& grey, Filter& filter, int threads, const char* name, Reporter& reporter) {
    const auto progress = reporter.progress(name, 1);
    filter.SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(threads));
    filter.SetInput(view<Grey>(grey.values, grey.size, Vec3::Ones()));
    run(filter, *progress, 0, 1);
    return copy(*filter.GetOutput());
}

}  // namespace

std::vector<float> median(const GreyVolume& grey, int radius, int threads, Reporter& reporter) {
    use_threads(threads);
    const auto filter = itk::MedianImageFilter<Grey, Grey>::New();
    filter->SetRadius(static_cast<itk::SizeValueType>(radius));
    return filtered(grey, *filter, threads, "median", reporter);
}

std::vector<float> diffusion(const GreyVolume& grey, int steps, double edge, int threads, Reporter& reporter) {
    use_threads(threads);
    const auto filter = itk::GradientAnisotropicDiffusionImageFilter<Grey, Grey>::New();
    filter->SetNumberOfIterations(static_cast<itk::IdentifierType>(steps));
    filter->SetTimeStep(1.0 / 16);  // the largest that is stable in three dimensions
    filter->SetConductanceParameter(edge);
    filter->SetUseImageSpacing(false);
    return filtered(grey, *filter, threads, "diffusion", reporter);
}

std::vector<float> local_mean(const GreyVolume& grey, int radius, int threads, Reporter& reporter) {
    use_threads(threads);
    const auto filter = itk::BoxMeanImageFilter<Grey, Grey>::New();
    filter->SetRadius(static_cast<itk::SizeValueType>(radius));
    return filtered(grey, *filter, threads, "local mean", reporter);
}

Watershed watershed(std::vector<std::uint8_t> outside, const VoxelIndex& size, const Vec3& spacing, double min_depth,
                    int threads, Reporter& reporter) {
    if (std::find(outside.begin(), outside.end(), std::uint8_t{1}) == outside.end())
        return {std::vector<std::int32_t>(outside.size(), 1), 1};  // nothing to measure a distance to
    use_threads(threads);
    const auto progress = reporter.progress("watershed", 1);

    // In edges of a voxel, so that distances which are equal are equal in floating point too, whatever the edge.
    const Vec3 edges = spacing / spacing[0];
    const auto depth = static_cast<float>(min_depth / spacing[0]);
    const auto distance = itk::SignedMaurerDistanceMapImageFilter<Mask, Grey>::New();
    distance->SetInput(view<Mask>(outside, size, edges));
    distance->SetSquaredDistance(false);
    distance->SetUseImageSpacing(true);
    distance->SetInsideIsPositive(false);
    run(*distance, *progress, 0, 0.1);
    const Grey::Pointer map = distance->GetOutput();
    map->DisconnectPipeline();
    // Outside lies far below every part of the phase, however thin: no maximum reaches through it into another part.
    const auto far_below = static_cast<float>(-depth - 1e3 * edges.sum());
    float* const value = map->GetBufferPointer();
    for (std::size_t i = 0; i < outside.size(); ++i)
        if (outside[i] != 0) value[i] = far_below;

    Parts::Pointer seeds;
    std::int32_t count = 0;
    {
        const auto deep = itk::HMaximaImageFilter<Grey, Grey>::New();
        deep->SetInput(map);
        deep->SetHeight(depth);
        run(*deep, *progress, 0.1, 0.3);
        const auto maxima = itk::RegionalMaximaImageFilter<Grey, Mask>::New();
        maxima->SetInput(deep->GetOutput());
        run(*maxima, *progress, 0.4, 0.1);
        const auto numbered = itk::ConnectedComponentImageFilter<Mask, Parts>::New();
        numbered->SetInput(maxima->GetOutput());
        run(*numbered, *progress, 0.5, 0.05);
        count = static_cast<std::int32_t>(numbered->GetObjectCount());
        seeds = numbered->GetOutput();
        seeds->DisconnectPipeline();
    }
    std::transform(value, value + outside.size(), value, [](float level) { return -level; });
    const auto flooded = itk::MorphologicalWatershedFromMarkersImageFilter<Grey, Parts>::New();
    flooded->SetInput1(map);
    flooded->SetInput2(seeds);
    flooded->SetMarkWatershedLine(false);
    run(*flooded, *progress, 0.55, 0.45);
    Watershed result{copy(*flooded->GetOutput()), count};
    for (std::size_t i = 0; i < outside.size(); ++i)
        if (outside[i] != 0) result.part[i] = 0;
    return result;
}

}  // namespace tomodem::segment
