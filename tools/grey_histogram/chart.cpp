#include "tools/grey_histogram/chart.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkAxis.h>
#include <vtkChartXY.h>
#include <vtkContextScene.h>
#include <vtkContextView.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/output_file.hpp"
#include "core/picture/offscreen_window.hpp"

namespace tomodem::grey_histogram {
namespace {

vtkSmartPointer<vtkTable> curve(const char* name, const std::vector<std::pair<double, double>>& points) {
    vtkNew<vtkDoubleArray> x, y;
    x->SetName("grey value");
    y->SetName(name);
    for (const auto& [abscissa, ordinate] : points) {
        x->InsertNextValue(abscissa);
        y->InsertNextValue(ordinate);
    }
    const auto table = vtkSmartPointer<vtkTable>::New();
    table->AddColumn(x);
    table->AddColumn(y);
    return table;
}

void add_line(vtkChartXY& chart, vtkTable* table, const std::array<unsigned char, 3>& colour, float width) {
    vtkPlot* const plot = chart.AddPlot(vtkChart::LINE);
    plot->SetInputData(table, 0, 1);
    plot->SetColor(colour[0], colour[1], colour[2], 255);
    plot->SetWidth(width);
}

void name_axis(vtkAxis* axis, const char* title) {
    axis->SetTitle(title);
    axis->GetTitleProperties()->SetFontSize(18);
    axis->GetTitleProperties()->SetBold(false);
    axis->GetLabelProperties()->SetFontSize(15);
    axis->GetGridPen()->SetColor(225, 225, 225, 255);
}

}  // namespace

void draw_histogram(const GreyHistogram& histogram, const std::vector<double>& thresholds,
                    const std::filesystem::path& picture, int threads) {
    // Empty bins at both ends are left out; many bins are drawn as a few, by their sums.
    std::size_t first = 0, end = histogram.counts.size();
    while (first < end && histogram.counts[first] == 0) ++first;
    while (end > first && histogram.counts[end - 1] == 0) --end;
    constexpr std::size_t columns = 512;
    const std::size_t step = std::max<std::size_t>(1, (end - first + columns - 1) / columns);
    std::vector<std::pair<double, double>> points;
    double highest = 1;
    for (std::size_t i = first; i < end; i += step) {
        const std::size_t last = std::min(i + step, end);
        double count = 0;
        for (std::size_t k = i; k < last; ++k) count += static_cast<double>(histogram.counts[k]);
        const double centre =
            (histogram.upper(i) + histogram.upper(last - 1)) / 2 - (histogram.whole ? 0 : histogram.width / 2);
        points.emplace_back(centre, std::max(count, 0.5));
        highest = std::max(highest, count);
    }

    vtkNew<vtkContextView> view;
    const auto window = offscreen_window(1000, 650, threads);
    view->SetRenderWindow(window);
    view->GetRenderer()->SetBackground(1, 1, 1);
    vtkNew<vtkChartXY> chart;
    view->GetScene()->AddItem(chart);
    add_line(*chart, curve("voxels", points), {40, 90, 160}, 2);
    for (const double threshold : thresholds)
        add_line(*chart, curve("threshold", {{threshold, 0.5}, {threshold, 2 * highest}}), {200, 60, 40}, 2);
    name_axis(chart->GetAxis(vtkAxis::BOTTOM), "grey value");
    name_axis(chart->GetAxis(vtkAxis::LEFT),
              step == 1 ? "voxels" : fmt::format("voxels in {} grey steps", step).c_str());
    vtkAxis* const counts = chart->GetAxis(vtkAxis::LEFT);
    counts->SetLogScale(true);
    counts->SetBehavior(vtkAxis::FIXED);
    counts->SetRange(0.5, 2 * highest);
    chart->SetTitle(thresholds.empty() ? "Histogram"
                                       : fmt::format("Histogram; threshold{} {:g}", thresholds.size() > 1 ? "s" : "",
                                                     fmt::join(thresholds, ", ")));
    chart->GetTitleProperties()->SetFontSize(20);
    window->Render();

    OutputFile output(picture);
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(grab->GetOutputPort());
    writer->SetFileName(output.path().c_str());
    writer->Write();
    if (writer->GetErrorCode() != 0)
        throw InvalidInput(fmt::format("cannot write picture '{}': is the disk full?", picture.string()));
    output.commit();
}

}  // namespace tomodem::grey_histogram
