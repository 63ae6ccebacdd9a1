#include "solver_plugin/simulation/checkpoint.hpp"

#include <fmt/format.h>

#include <optional>

#include "core/base/output_file.hpp"
#include "core/packing/hdf5_file.hpp"

namespace tomodem {
namespace fs = std::filesystem;
namespace {

std::vector<std::int64_t> gathered(std::int64_t mine, MPI_Comm communicator) {
    int processes = 1;
    MPI_Comm_size(communicator, &processes);
    std::vector<std::int64_t> all(processes);
    MPI_Allgather(&mine, 1, MPI_INT64_T, all.data(), 1, MPI_INT64_T, communicator);
    return all;
}

struct Share {
    std::size_t before = 0, mine = 0, all = 0;
};

Share share(std::size_t mine, MPI_Comm communicator) {
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    Share result{0, mine, 0};
    const auto counts = gathered(static_cast<std::int64_t>(mine), communicator);
    for (int p = 0; p < static_cast<int>(counts.size()); ++p) {
        if (p < rank) result.before += counts[p];
        result.all += counts[p];
    }
    return result;
}

void create(const Checkpoint& checkpoint, const Inputs& inputs, const fs::path& where, const fs::path& shown,
            hsize_t particles, hsize_t words, hsize_t rows, const std::vector<std::int64_t>& counts) {
    Hdf5Writer writer(where, shown);
    {
        const Hdf5Handle group = writer.group(writer.file(), "inputs");
        writer.text_dataset(group, "version", {inputs.version}, false);
        writer.text_dataset(group, "scene", {inputs.scene}, false);
        writer.text_dataset(group, "digests", {inputs.digests}, false);
    }
    {
        const Hdf5Handle group = writer.group(writer.file(), "numbers");
        for (const auto& [name, values] : checkpoint.numbers)
            writer.dataset(group, name.c_str(), {values.size()}, values.data());
    }
    const Hdf5Handle group = writer.group(writer.file(), "particles");
    writer.dataset(group, "count", {counts.size()}, counts.data());
    writer.reserved<std::int32_t>(group, "tag", {particles});
    writer.reserved<std::int32_t>(group, "type", {particles});
    writer.reserved<std::int32_t>(group, "image", {particles});
    writer.reserved<double>(group, "position", {particles, 3});
    writer.reserved<double>(group, "velocity", {particles, 3});
    writer.reserved<std::int32_t>(group, "memory_length", {particles});
    writer.reserved<std::int64_t>(group, "memory", {words});
    writer.reserved<double>(group, "sums", {rows, static_cast<hsize_t>(checkpoint.sums.components)});
    writer.close();
}

void require_same(const Hdf5Reader& reader, const std::string& what, const std::string& mine, const fs::path& path) {
    const std::string found = reader.one_text("/inputs/" + what);
    if (found == mine) return;
    const std::string change = what == "version"
                                   ? fmt::format("another version of tomodem ({}, this is {})", found, mine)
                               : what == "scene" ? std::string("another scene")
                                                 : std::string("another sample or wall");
    throw InvalidInput(
        fmt::format("cannot resume from '{}': it was made with {}; use the same again, or start again without --resume",
                    path.string(), change));
}

}  // namespace

void agree(MPI_Comm communicator, const std::string& error) {
    int rank = 0, processes = 1;
    MPI_Comm_rank(communicator, &rank);
    MPI_Comm_size(communicator, &processes);
    const int mine = error.empty() ? processes : rank;
    int first = processes;
    MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, communicator);
    if (first == processes) return;
    int size = static_cast<int>(error.size());
    MPI_Bcast(&size, 1, MPI_INT, first, communicator);
    std::string text = error;
    text.resize(size);
    MPI_Bcast(text.data(), size, MPI_CHAR, first, communicator);
    throw InvalidInput(text);
}

std::size_t first_row(std::size_t rows, int rank, int processes) {
    return rows * static_cast<std::size_t>(rank) / static_cast<std::size_t>(processes);
}

void write_checkpoint(const Checkpoint& checkpoint, const Inputs& inputs, const fs::path& path, MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    const ParticleState& mine = checkpoint.particles;
    const Share particles = share(mine.tag.size(), communicator);
    const Share words = share(mine.memory.size(), communicator);
    const bool summed = checkpoint.sums.components > 0;
    const Share rows = share(summed ? checkpoint.sums.values.size() / checkpoint.sums.components : 0, communicator);
    const auto counts = gathered(static_cast<std::int64_t>(mine.tag.size()), communicator);

    fs::path part = path;
    part += ".part";
    std::optional<OutputFile> output;
    together(communicator, [&] {
        if (rank != 0) return;
        output.emplace(path, part);
        create(checkpoint, inputs, part, path, particles.all, words.all, rows.all, counts);
    });
    together(communicator, [&] {
        Hdf5Filler filler(part, path, communicator);
        const auto write = [&](const char* name, const Share& share, hsize_t components, const auto* data) {
            Hdf5Shape start{share.before}, shape{share.mine};
            if (components > 0) {
                start.push_back(0);
                shape.push_back(components);
            }
            filler.write(name, start, shape, data, Hdf5Filler::Call::together);
        };
        write("/particles/tag", particles, 0, mine.tag.data());
        write("/particles/type", particles, 0, mine.type.data());
        write("/particles/image", particles, 0, mine.image.data());
        write("/particles/position", particles, 3, mine.position.data());
        write("/particles/velocity", particles, 3, mine.velocity.data());
        write("/particles/memory_length", particles, 0, mine.memory_length.data());
        if (words.all > 0) write("/particles/memory", words, 0, mine.memory.data());
        if (rows.all > 0)
            write("/particles/sums", rows, static_cast<hsize_t>(checkpoint.sums.components),
                  checkpoint.sums.values.data());
        filler.close();
    });
    together(communicator, [&] {
        if (output) output->commit();
    });
}

FoundCheckpoint read_checkpoint(const fs::path& path, const Inputs& inputs, MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    int rank = 0, processes = 1;
    MPI_Comm_rank(communicator, &rank);
    MPI_Comm_size(communicator, &processes);
    FoundCheckpoint found;
    const Hdf5Reader reader(path);
    if (!reader.exists("/inputs") || !reader.exists("/particles")) reader.fail("it is not a checkpoint of tomodem");
    require_same(reader, "version", inputs.version, path);
    require_same(reader, "scene", inputs.scene, path);
    require_same(reader, "digests", inputs.digests, path);
    for (const std::string& name : reader.members("/numbers"))
        found.checkpoint.numbers[name] = reader.array<double>("/numbers/" + name);

    const auto counts = reader.array<std::int64_t>("/particles/count");
    std::size_t all = 0, first = 0;
    for (std::size_t p = 0; p < counts.size(); ++p) {
        if (static_cast<int>(p) < rank) first += counts[p];
        all += counts[p];
    }
    found.same_processes = static_cast<int>(counts.size()) == processes;
    if (!found.same_processes) first = first_row(all, rank, processes);
    const std::size_t mine = found.same_processes ? counts[rank] : first_row(all, rank + 1, processes) - first;

    ParticleState& particles = found.checkpoint.particles;
    particles.tag = reader.part<std::int32_t>("/particles/tag", first, mine);
    particles.type = reader.part<std::int32_t>("/particles/type", first, mine);
    particles.image = reader.part<std::int32_t>("/particles/image", first, mine);
    particles.position = reader.part<double>("/particles/position", first, mine);
    particles.velocity = reader.part<double>("/particles/velocity", first, mine);
    const auto lengths = reader.part<std::int32_t>("/particles/memory_length", 0, first + mine);
    std::size_t words_before = 0, words = 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) (i < first ? words_before : words) += lengths[i];
    particles.memory_length.assign(lengths.begin() + static_cast<std::ptrdiff_t>(first), lengths.end());
    particles.memory = reader.part<std::int64_t>("/particles/memory", words_before, words);

    const Hdf5Shape sums = reader.shape(reader.dataset("/particles/sums"), "/particles/sums");
    RowBlock& block = found.checkpoint.sums;
    block.components = static_cast<int>(sums[1]);
    block.first = first_row(sums[0], rank, processes);
    if (block.components > 0)
        block.values =
            reader.part<double>("/particles/sums", block.first, first_row(sums[0], rank + 1, processes) - block.first);
    return found;
}

}  // namespace tomodem
