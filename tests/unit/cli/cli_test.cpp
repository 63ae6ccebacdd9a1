#include "core/cli/cli.hpp"
#include "core/cli/frames_cli.hpp"
#include "core/cli/help.hpp"

#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tomodem::cli {
namespace {

using testing::HasSubstr;
using testing::internal::CaptureStderr;
using testing::internal::CaptureStdout;
using testing::internal::GetCapturedStderr;
using testing::internal::GetCapturedStdout;

struct Request {
    std::filesystem::path input, output;
    double radius = 1.0;
    std::int64_t count = 10;
    std::string filter = "box";
    bool deep = false;
};

Usage usage(Request& request) {
    return Usage("try", "Try the command line.")
        .input("INPUT", request.input, "what to read")
        .output("OUTPUT", request.output, "what to write")
        .option("--radius", request.radius, Unit::length, positive, "probe radius")
        .option("--count", request.count, Unit::particles, Range{1, 1000}, "how many")
        .choice("--filter", request.filter, {"box", "nearest"}, "which filter")
        .flag("--deep", request.deep, "look deeper")
        .exclusive({"--count", "--deep"})
        .example("try in out --radius 2um");
}

struct Outcome {
    int status;
    std::string out, err;
    Request request;
};

Outcome call(
    std::vector<std::string> words, const std::function<void(Tool&)>& work = [](Tool&) {}) {
    Outcome outcome;
    words.insert(words.begin(), "try");
    std::vector<const char*> arguments;
    for (const auto& word : words) arguments.push_back(word.c_str());
    CaptureStdout();
    CaptureStderr();
    outcome.status = run_tool(static_cast<int>(arguments.size()), arguments.data(), usage(outcome.request), work);
    outcome.out = GetCapturedStdout();
    outcome.err = GetCapturedStderr();
    return outcome;
}

TEST(CommandLine, LeavesOutAnOutputThatIsOptional) {
    const auto call_with = [](std::vector<const char*> words, std::filesystem::path& output) {
        std::filesystem::path input;
        const Usage usage = Usage("try", "Try.")
                                .input("INPUT", input, "what to read")
                                .optional_output("OUTPUT", output, "what to write");
        words.insert(words.begin(), "try");
        CaptureStderr();
        const int status = run_tool(static_cast<int>(words.size()), words.data(), usage, [](Tool&) {});
        GetCapturedStderr();
        return status;
    };
    std::filesystem::path output = "unless given";
    EXPECT_EQ(call_with({"/dev/null"}, output), 0);
    EXPECT_EQ(output, "unless given");
    EXPECT_EQ(call_with({"/dev/null", "given"}, output), 0);
    EXPECT_EQ(output, "given");
    EXPECT_EQ(call_with({"/dev/null", "given", "and more"}, output), 2);
}

TEST(CommandLine, StoresValuesWithTheirUnits) {
    const Outcome outcome =
        call({"/etc/hostname", "out.h5", "--radius", "2.4um", "--count", "1e2", "--filter", "nearest"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_DOUBLE_EQ(outcome.request.radius, 2.4e-3);
    EXPECT_EQ(outcome.request.count, 100);
    EXPECT_EQ(outcome.request.filter, "nearest");
    EXPECT_EQ(outcome.request.output, "out.h5");
}

TEST(CommandLine, WrongUsageIsOneLineAndStatusTwo) {
    const auto wrong = [](std::vector<std::string> words, const std::string& what) {
        const Outcome outcome = call(std::move(words));
        EXPECT_EQ(outcome.status, 2);
        EXPECT_THAT(outcome.err, HasSubstr(what));
        EXPECT_THAT(outcome.err, testing::StartsWith("try: "));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    };
    wrong({}, "expected 2 files (INPUT, OUTPUT) but got 0");
    wrong({"/etc/hostname", "out", "--radius", "2.4"}, "no unit");
    wrong({"/etc/hostname", "out", "--radius", "-1um"}, "--radius -1um is out of range: expected more than 0");
    wrong({"/etc/hostname", "out", "--count", "2.5"}, "not a whole number");
    wrong({"/etc/hostname", "out", "--count", "2000"}, "at least 1 and at most 1000");
    wrong({"/etc/hostname", "out", "--filter", "cone"}, "not one of box, nearest");
    wrong({"/etc/hostname", "out", "--depth", "3"}, "--depth");
    wrong({"/etc/hostname", "out", "--count", "3", "--deep"}, "exclude each other");
    wrong({"/etc/hostname", "out", "--count", "3", "--count", "4"}, "--count: At Most 1 required but received 2");
}

TEST(CommandLine, FailureIsOneLineAndStatusOne) {
    const Outcome missing = call({"/nowhere/in.h5", "out"});
    EXPECT_EQ(missing.status, 1);
    EXPECT_EQ(missing.err, "try: cannot read INPUT '/nowhere/in.h5': there is no such file or folder\n");
    const Outcome folder = call({"/etc/hostname", "/nowhere/out.h5"});
    EXPECT_EQ(folder.status, 1);
    EXPECT_THAT(folder.err, HasSubstr("folder '/nowhere' does not exist"));
    const Outcome failed = call({"/etc/hostname", "out"}, [](Tool&) { throw InvalidInput("broken; mend it"); });
    EXPECT_EQ(failed.status, 1);
    EXPECT_EQ(failed.err, "try: broken; mend it\n");
}

TEST(CommandLine, ARunThatIsUnfinishedIsCalledThat) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("cli-u" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const std::string run = folder / "run.h5";
    std::ofstream(run + ".partial") << "frames so far";
    const Outcome outcome = call({run, "out"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "try: cannot read INPUT '" + run + "': this run is unfinished; give '" + run +
                               ".partial', which holds what it has written so far, or let it end (if solve has "
                               "stopped, repeat its command with --resume)\n");
    EXPECT_EQ(call({run + ".partial", "out"}).status, 0);
    std::filesystem::remove_all(folder);
}

TEST(CommandLine, AnInputIsNotOverwritten) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("cli-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const std::string scan = folder / "scan.h5", other = folder / "." / "scan.h5";
    std::ofstream(scan) << "precious";
    for (const auto& words : {std::vector<std::string>{scan, scan}, {scan, other}, {scan, "x.h5", "--json", scan}}) {
        const Outcome outcome = call(words);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_THAT(outcome.err, HasSubstr("is also an input, which would be lost"));
    }
    std::filesystem::remove_all(folder);
}

TEST(CommandLine, APercentageBelowOneWantsItsSign) {
    double share = 0;
    const auto parse = [&](const char* text) {
        const char* words[] = {"try", "--share", text};
        CaptureStderr();
        const int status =
            run_tool(3, words, Usage("try", "").option("--share", share, Unit::percent, {0, 100}, ""), [](Tool&) {});
        return std::pair(status, GetCapturedStderr());
    };
    EXPECT_EQ(parse("0.5%").first, 0);
    EXPECT_DOUBLE_EQ(share, 0.5);
    EXPECT_EQ(parse("5").first, 0);
    const auto [status, error] = parse("0.1");
    EXPECT_EQ(status, 2);
    EXPECT_THAT(error, HasSubstr("is that 0.1% or 10%?"));
}

TEST(CommandLine, HelpNamesUnitsRangesDefaultsAndAnExample) {
    const Outcome outcome = call({"--help"});
    EXPECT_EQ(outcome.status, 0);
    for (const char* text :
         {"usage: try INPUT OUTPUT", "more than 0; default 1mm", "box|nearest", "try in out --radius 2um", "--json"})
        EXPECT_THAT(outcome.out, HasSubstr(text));
}

TEST(CommandLine, AcceptsThreadsOnlyWhereTheToolUsesThem) {
    int threads = 0;
    const auto status_of = [&](const Usage& usage) {
        const char* words[] = {"try", "--threads", "3"};
        CaptureStderr();
        const int status = run_tool(3, words, usage, [&](Tool& tool) {
            threads = tool.threads();
            EXPECT_EQ(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), 3);
        });
        GetCapturedStderr();
        return status;
    };
    EXPECT_EQ(status_of(Usage("try", "Try.")), 2);
    EXPECT_EQ(status_of(Usage("try", "Try.").threads()), 0);
    EXPECT_EQ(threads, 3);
}

TEST(CommandLine, RefusesAnOutputOfAnotherFormatThanTheDeclaredOnes) {
    std::filesystem::path output;
    const Usage usage = Usage("try", "Try.").output("TABLE", output, "Curve to write.", {".csv", ".txt"});
    const auto error_of = [&](const char* name) {
        const char* words[] = {"try", name};
        CaptureStderr();
        run_tool(2, words, usage, [](Tool&) {});
        return GetCapturedStderr();
    };
    EXPECT_EQ(error_of("curve.csv"), "");
    EXPECT_EQ(error_of("curve.dat"), "");  // promises nothing
    EXPECT_EQ(error_of("curve.png"), "try: TABLE 'curve.png': the name must end in .csv or .txt\n");
    EXPECT_THAT(help_text(usage), HasSubstr("Curve to write. [.csv or .txt]"));
}

TEST(CommandLine, NamesOfPositionalsAreInCapitals) {
    std::filesystem::path path;
    EXPECT_THROW(Usage("try", "Try.").input("sample", path, "Sample."), std::logic_error);
    EXPECT_THROW(Usage("try", "Try.").output("Table", path, "Table."), std::logic_error);
    EXPECT_NO_THROW(Usage("try", "Try.").input("SAMPLE_2", path, "Sample.").input_option("--scene", path, "Scene."));
}

TEST(ChosenFrame, IsFirstLastOrANumber) {
    EXPECT_EQ(chosen_frame("first", 5), 0u);
    EXPECT_EQ(chosen_frame("last", 5), 4u);
    EXPECT_EQ(chosen_frame("-1", 5), 4u);
    EXPECT_EQ(chosen_frame("3", 5), 3u);
    EXPECT_THAT([] { chosen_frame("5", 5); },
                testing::ThrowsMessage<InvalidInput>(HasSubstr("--frame 5: the file has frames 0 to 4")));
    EXPECT_THAT([] { chosen_frame("all", 5); },
                testing::ThrowsMessage<WrongUsage>(HasSubstr("--frame 'all': give first, last or a number from 0")));
}

TEST(CommandLine, DescribesItselfToPrograms) {
    Request request;
    const auto described = description(usage(request).measure(
        {.heading = "Tries", .results = {{"count", "tries", "-"}}, .x = {"strain", "strain", ""}}));
    EXPECT_EQ(described["name"], "try");
    EXPECT_EQ(described["step"], "measure");
    EXPECT_EQ(described["arguments"][1]["kind"], "output");
    EXPECT_EQ(described["exclusive"][0][1], "--deep");
    EXPECT_EQ(described["display"]["heading"], "Tries");
    EXPECT_EQ(described["display"]["results"][0]["label"], "tries");
    EXPECT_EQ(described["display"]["x"]["key"], "strain");
}

TEST(CommandLine, TheReferenceKeepsExclusiveOptionsAndItsTables) {
    Request request;
    const std::string page = reference_page(usage(request).flag("--either", request.deep, "this | that"));
    EXPECT_THAT(page, HasSubstr("At most one of --count, --deep may be given."));
    EXPECT_THAT(page, HasSubstr("| `--either` | this \\| that |"));
    EXPECT_THAT(page, HasSubstr("| `--filter box\\|nearest` |"));
}

TEST(CommandLine, ReportsGoToStandardOutputAndToJson) {
    const auto file = std::filesystem::temp_directory_path() / ("tomodem-cli-" + std::to_string(getpid()) + ".json");
    const Outcome outcome = call({"/etc/hostname", "out", "--json", file.string()}, [](Tool& tool) {
        tool.report("enclosed_volume", 1.5, "mm^3");
        tool.report("particles", std::int64_t{12});
    });
    EXPECT_THAT(outcome.out, HasSubstr("enclosed_volume: 1.5 mm^3\nparticles: 12\n"));
    std::ifstream stream(file);
    const auto summary = nlohmann::json::parse(stream);
    EXPECT_EQ(summary["tool"], "try");
    EXPECT_EQ(summary["enclosed_volume"], 1.5);
    EXPECT_EQ(summary["units"]["enclosed_volume"], "mm^3");
    EXPECT_EQ(summary["particles"], 12);
    EXPECT_GT(summary["peak_bytes"], 0);
    EXPECT_THAT(std::string(summary["command_line"]), HasSubstr("try /etc/hostname out --json"));
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace tomodem::cli
