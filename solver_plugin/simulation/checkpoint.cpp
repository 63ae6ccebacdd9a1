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

/// The inputs of a checkpoint, as text.
void create_inputs(Hdf5Writer& writer, const Inputs& inputs) {
    const Hdf5Handle group = writer.group(writer.file(), "inputs");
    writer.text_dataset(group, "version", {inputs.version}, false);
    writer.text_dataset(group, "scene", {inputs.scene}, false);
    writer.text_dataset(group, "digests", {inputs.digests}, false);
}

/// How the state of all processes lies in a file.
struct Layout {
    explicit Layout(const Checkpoint& checkpoint, MPI_Comm communicator)
        : particles(share(checkpoint.particles.tag.size(), communicator)),
          words(share(checkpoint.particles.memory.size(), communicator)),
          rows(share(checkpoint.sums.components > 0 ? checkpoint.sums.values.size() / checkpoint.sums.components : 0,
                     communicator)),
          counts(gathered(static_cast<std::int64_t>(checkpoint.particles.tag.size()), communicator)) {}
    Share particles, words, rows;
    std::vector<std::int64_t> counts;
};

void create_state(Hdf5Writer& writer, hid_t parent, const Checkpoint& checkpoint, const Layout& layout) {
    {
        const Hdf5Handle group = writer.group(parent, "numbers");
        for (const auto& [name, values] : checkpoint.numbers)
            writer.dataset(group, name.c_str(), {values.size()}, values.data());
    }
    const hsize_t particles = layout.particles.all;
    const Hdf5Handle group = writer.group(parent, "particles");
    writer.dataset(group, "count", {layout.counts.size()}, layout.counts.data());
    writer.reserved<std::int32_t>(group, "tag", {particles});
    writer.reserved<std::int32_t>(group, "type", {particles});
    writer.reserved<std::int32_t>(group, "image", {particles});
    writer.reserved<double>(group, "position", {particles, 3});
    writer.reserved<double>(group, "velocity", {particles, 3});
    writer.reserved<std::int32_t>(group, "memory_length", {particles});
    writer.reserved<std::int64_t>(group, "memory", {layout.words.all});
    writer.reserved<double>(group, "sums", {layout.rows.all, static_cast<hsize_t>(checkpoint.sums.components)});
}

/// Collective. @param parent  "" or the path of a group
void fill_state(const Checkpoint& checkpoint, const Layout& layout, const std::string& parent, const fs::path& file,
                const fs::path& shown, MPI_Comm communicator) {
    Hdf5Filler filler(file, shown, communicator);
    const auto write = [&](const char* name, const Share& share, hsize_t components, const auto* data) {
        Hdf5Shape start{share.before}, shape{share.mine};
        if (components > 0) {
            start.push_back(0);
            shape.push_back(components);
        }
        filler.write(parent + "/particles/" + name, start, shape, data, Hdf5Filler::Call::together);
    };
    const ParticleState& mine = checkpoint.particles;
    write("tag", layout.particles, 0, mine.tag.data());
    write("type", layout.particles, 0, mine.type.data());
    write("image", layout.particles, 0, mine.image.data());
    write("position", layout.particles, 3, mine.position.data());
    write("velocity", layout.particles, 3, mine.velocity.data());
    write("memory_length", layout.particles, 0, mine.memory_length.data());
    if (layout.words.all > 0) write("memory", layout.words, 0, mine.memory.data());
    if (layout.rows.all > 0)
        write("sums", layout.rows, static_cast<hsize_t>(checkpoint.sums.components), checkpoint.sums.values.data());
    filler.close();
}

/// Every process reads its part. @param parent  as in fill_state()
FoundCheckpoint read_state(const Hdf5Reader& reader, const std::string& parent, MPI_Comm communicator) {
    int rank = 0, processes = 1;
    MPI_Comm_rank(communicator, &rank);
    MPI_Comm_size(communicator, &processes);
    FoundCheckpoint found;
    for (const std::string& name : reader.members(parent + "/numbers"))
        found.checkpoint.numbers[name] = reader.array<double>(parent + "/numbers/" + name);

    const std::string group = parent + "/particles/";
    const auto counts = reader.array<std::int64_t>(group + "count");
    std::size_t all = 0, first = 0;
    for (std::size_t p = 0; p < counts.size(); ++p) {
        if (static_cast<int>(p) < rank) first += counts[p];
        all += counts[p];
    }
    found.same_processes = static_cast<int>(counts.size()) == processes;
    if (!found.same_processes) first = first_row(all, rank, processes);
    const std::size_t mine = found.same_processes ? counts[rank] : first_row(all, rank + 1, processes) - first;

    ParticleState& particles = found.checkpoint.particles;
    particles.tag = reader.part<std::int32_t>(group + "tag", first, mine);
    particles.type = reader.part<std::int32_t>(group + "type", first, mine);
    particles.image = reader.part<std::int32_t>(group + "image", first, mine);
    particles.position = reader.part<double>(group + "position", first, mine);
    particles.velocity = reader.part<double>(group + "velocity", first, mine);
    const auto lengths = reader.part<std::int32_t>(group + "memory_length", 0, first + mine);
    std::size_t words_before = 0, words = 0;
    for (std::size_t i = 0; i < lengths.size(); ++i) (i < first ? words_before : words) += lengths[i];
    particles.memory_length.assign(lengths.begin() + static_cast<std::ptrdiff_t>(first), lengths.end());
    particles.memory = reader.part<std::int64_t>(group + "memory", words_before, words);

    const Hdf5Shape sums = reader.shape(reader.dataset(group + "sums"), group + "sums");
    RowBlock& block = found.checkpoint.sums;
    block.components = static_cast<int>(sums[1]);
    block.first = first_row(sums[0], rank, processes);
    if (block.components > 0)
        block.values =
            reader.part<double>(group + "sums", block.first, first_row(sums[0], rank + 1, processes) - block.first);
    return found;
}

constexpr const char* end_group = "/end";
/// Of what stands in that group.
constexpr std::int32_t end_format = 2;

void require_same(const Hdf5Reader& reader, const std::string& what, const std::string& mine, const fs::path& path) {
    const std::string found = reader.one_text("/inputs/" + what);
    if (found == mine) return;
    // Its scene said no scheme, and the present one says what its law chose now.
    if (what == "scene" && mine.starts_with(found) && mine.find("[resolved]", found.size()) != std::string::npos)
        throw InvalidInput(
            fmt::format("cannot resume from '{}': it was made in explicit steps, then the default of its law, which is "
                        "quasi-static now; start again without --resume",
                        path.string()));
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

std::vector<double> numbers_of(const LoadClock& clock) {
    return {clock.time, static_cast<double>(clock.step), clock.time_step};
}

LoadClock clock_of(const std::vector<double>& numbers) {
    return {numbers.at(0), static_cast<std::int64_t>(numbers.at(1)), numbers.at(2)};
}

void write_checkpoint(const Checkpoint& checkpoint, const Inputs& inputs, const fs::path& path, MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    const Layout layout(checkpoint, communicator);
    fs::path part = path;
    part += ".part";
    std::optional<OutputFile> output;
    together(communicator, [&] {
        if (rank != 0) return;
        output.emplace(path, part);
        Hdf5Writer writer(part, path);
        create_inputs(writer, inputs);
        create_state(writer, writer.file(), checkpoint, layout);
        writer.close();
    });
    together(communicator, [&] { fill_state(checkpoint, layout, "", part, path, communicator); });
    together(communicator, [&] {
        if (output) output->commit();
    });
}

FoundCheckpoint read_checkpoint(const fs::path& path, const Inputs& inputs, MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    const Hdf5Reader reader(path);
    if (!reader.exists("/inputs") || !reader.exists("/particles")) reader.fail("it is not a checkpoint of tomodem");
    require_same(reader, "version", inputs.version, path);
    require_same(reader, "scene", inputs.scene, path);
    require_same(reader, "digests", inputs.digests, path);
    return read_state(reader, "", communicator);
}

void write_end_state(const Checkpoint& checkpoint, const fs::path& run_file, const fs::path& shown,
                     MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    int rank = 0;
    MPI_Comm_rank(communicator, &rank);
    const Layout layout(checkpoint, communicator);
    together(communicator, [&] {
        if (rank != 0) return;
        Hdf5Writer writer(run_file, shown, Hdf5Writer::Start::from_existing);
        writer.remove_group(end_group);  // of a process that was killed here
        {
            const Hdf5Handle group = writer.group(writer.file(), end_group);
            writer.attribute(group, "format", end_format);
            create_state(writer, group, checkpoint, layout);
        }
        writer.close();
    });
    together(communicator, [&] { fill_state(checkpoint, layout, end_group, run_file, shown, communicator); });
}

FoundCheckpoint read_end_state(const fs::path& run_file, MPI_Comm communicator) {
    const auto lock = hdf5_lock();
    const Hdf5Reader reader(run_file);
    if (!reader.is_group(end_group))
        reader.fail(
            "it does not hold the state of its end, from which a load continues: finish an unfinished run with "
            "--resume, repeat one of an earlier version");
    if (reader.number_attribute<std::int32_t>(end_group, "format") != end_format)
        reader.fail("the state of its end was written by another version of tomodem: repeat the run");
    return read_state(reader, end_group, communicator);
}

}  // namespace tomodem
