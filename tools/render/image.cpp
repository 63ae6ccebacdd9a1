#include "tools/render/image.hpp"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <string_view>

#include "core/base/output_file.hpp"

namespace tomodem::render {

void write_png(const Image& image, const std::filesystem::path& path) {
    vtkNew<vtkImageData> data;
    data->SetDimensions(image.width, image.height, 1);
    data->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* to = static_cast<std::uint8_t*>(data->GetScalarPointer());
    const std::size_t row = std::size_t{3} * image.width;
    for (int y = 0; y < image.height; ++y)  // VTK begins at the bottom
        std::copy_n(image.pixels.data() + (image.height - 1 - y) * row, row, to + y * row);
    vtkNew<vtkPNGWriter> writer;
    writer->WriteToMemoryOn();
    writer->SetInputData(data);
    writer->Write();
    vtkUnsignedCharArray* png = writer->GetResult();
    write_text(path, {reinterpret_cast<const char*>(png->GetPointer(0)), std::size_t(png->GetNumberOfValues())});
}

}  // namespace tomodem::render
