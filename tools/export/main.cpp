// export_packing: a packing or run as files that OVITO (LAMMPS dump) and ParaView (VTP) open.
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/mesh/export_frames.hpp"
#include "core/packing/packing_file.hpp"

namespace {
using namespace tomodem;

struct Request {
    std::filesystem::path input, output;
    std::string frames = "all";
};

cli::Usage usage(Request& request) {
    return cli::Usage{"export_packing", "Write a packing or run as LAMMPS dump (OVITO) or VTP (ParaView)."}
        .input("packing", request.input, "packing or run (.h5)")
        .output("output", request.output,
                "file to write: .dump (all frames in one file), .vtp (several frames: NAME_0000.vtp ... and NAME.pvd) "
                "or .pvd")
        .option("--frames", request.frames, "frames to write: all, first, last or a number from 0")
        .example("export_packing run.h5 run.dump")
        .example("export_packing --frames last run.h5 deformed.vtp");
}

void run(const Request& request, cli::Tool& tool) {
    const auto extension = request.output.extension();
    if (extension != ".dump" && extension != ".vtp" && extension != ".pvd")
        throw WrongUsage("output '" + request.output.string() + "': the name must end in .dump, .vtp or .pvd");
    const RunReader run(request.input);
    const auto frames = cli::chosen_frames(request.frames, run.frame_count());

    const auto progress = tool.progress("frames", static_cast<double>(frames.size()));
    const auto done = [&](std::size_t count) { progress->update(static_cast<double>(count)); };
    if (extension == ".dump")
        export_dump(run, frames, request.output, done);
    else
        export_vtp(run, frames, request.output, done);

    tool.report("frames", static_cast<std::int64_t>(frames.size()));
    tool.report("particles", static_cast<std::int64_t>(run.packing().size()));
}
}  // namespace

int main(int argc, char** argv) {
    return cli::main(argc, argv, usage, run);
}
