// export_packing: a packing or run as files that OVITO (LAMMPS dump) and ParaView (VTP) open.
#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/mesh/export_frames.hpp"
#include "core/packing/packing_file.hpp"

namespace tomodem::export_packing {
namespace {

struct Request {
    std::filesystem::path input, output;
    std::string frames = "all";
};

cli::Usage usage(Request& request) {
    return cli::Usage{"export_packing", "Write a sample or run as LAMMPS dump (for OVITO) or VTP (for ParaView)."}
        .input("RUN", request.input, "Run or sample (.h5).")
        .output("OUTPUT", request.output,
                "File to write. A .dump holds all frames; several frames as .vtp become NAME_0000.vtp and so on, with "
                "NAME.pvd, which lists them.",
                {".dump", ".vtp", ".pvd"})
        .option("--frames", request.frames,
                "Frames to write: all, first, last, a number from 0, or several as 0,5,last.")
        .step(cli::Step::picture)
        .example("export_packing run.h5 run.dump")
        .example("export_packing --frames last run.h5 deformed.vtp");
}

void run(const Request& request, cli::Tool& tool) {
    const auto extension = request.output.extension();
    if (extension != ".dump" && extension != ".vtp" && extension != ".pvd")
        throw WrongUsage("OUTPUT '" + request.output.string() + "': the name must end in .dump, .vtp or .pvd");
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
}  // namespace tomodem::export_packing

int main(int argc, char** argv) {
    return tomodem::cli::main(argc, argv, tomodem::export_packing::usage, tomodem::export_packing::run);
}
