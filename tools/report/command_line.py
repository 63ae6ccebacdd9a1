"""The house command line for a tool in Python: one declaration, and from it parsing, checks, --help, the reference page.

The texts and the exit status are those of core/cli/cli.hpp: 0 done, 1 failed, 2 wrong usage; one line on stderr.
"""
import dataclasses
import json
import os
import pathlib
import resource
import shlex
import signal
import sys
import time
import traceback


class InvalidInput(Exception):
    """What is wrong, where, and what to do; ends the tool with status 1."""


class WrongUsage(Exception):
    """The same for the command line, with status 2."""


@dataclasses.dataclass
class Option:
    """--name VALUE: a folder, an input file, or (value "INTEGER", "WIDTHxHEIGHT", ...) what `parse` makes of the text."""

    name: str
    value: str
    help: str
    parse: object = str
    default: object = None


@dataclasses.dataclass
class Usage:
    tool: str
    purpose: str
    inputs: list  # (name, help)
    output: tuple  # (name, help)
    options: list
    examples: list

    def common(self):
        return [
            Option("--threads", "INTEGER", "threads to use [default: every core that this process may use]", threads_number),
            Option("--json", "FILE", "also write the results, units, time and memory as JSON", pathlib.Path),
        ]

    def help_text(self):
        rows = [(name, text) for name, text in [*self.inputs, self.output]]
        rows += [(f"{one.name} {one.value}", one.help) for one in [*self.options, *self.common()]]
        rows += [("--quiet", "print errors only"), ("--help", "print this text"), ("--version", "print the version")]
        width = max(len(name) for name, _ in rows)
        words = " ".join(name for name, _ in [*self.inputs, self.output])
        table = "\n".join(f"  {name:<{width}}  {text}" for name, text in rows)
        examples = "\n".join(f"  {one}" for one in self.examples)
        return f"{self.tool}: {self.purpose}\n\nusage: {self.tool} {words} [options]\n\n{table}\n\nexamples:\n{examples}\n"

    def reference_page(self):
        rows = [*self.inputs, self.output, *((f"{one.name} {one.value}", one.help) for one in self.options)]
        table = "\n".join(f"| `{name}` | {text} |" for name, text in rows)
        examples = "\n".join(f"    {one}" for one in self.examples)
        return f"## {self.tool}\n\n{self.purpose}\n\n| argument | what it is |\n|---|---|\n{table}\n\n{examples}\n"


def threads_number(text):
    if not text.isdigit() or not 1 <= int(text) <= 4096:
        raise WrongUsage(f"--threads '{text}' is not a whole number of at least 1 and at most 4096")
    return int(text)


class Request:
    """The words of a command line: `request["RUN"]`, `request["--with"]`; results for stdout and --json."""

    def __init__(self, usage, version, words):
        self.usage, self.version = usage, version
        self.command_line = shlex.join([usage.tool, *words])
        self.quiet = "--quiet" in words
        self.results, self.units = {}, {}
        self.values = self.parsed([word for word in words if word != "--quiet"])
        self.threads = self.values["--threads"] or len(os.sched_getaffinity(0))

    def __getitem__(self, name):
        return self.values[name]

    def parsed(self, words):
        tool = self.usage.tool
        options = {one.name: one for one in [*self.usage.options, *self.usage.common()]}
        values = {name: one.default for name, one in options.items()}
        files = []
        while words:
            word, *words = words
            name, equals, value = word.partition("=")
            if not word.startswith("-"):
                files.append(word)
            elif name not in options:
                raise WrongUsage(f"The following argument was not expected: {word}; see {tool} --help")
            else:
                if not equals:
                    if not words:
                        raise WrongUsage(f"{name}: 1 required {options[name].value} missing; see {tool} --help")
                    value, *words = words
                values[name] = options[name].parse(value)
        names = [name for name, _ in [*self.usage.inputs, self.usage.output]]
        if len(files) != len(names):
            raise WrongUsage(f"expected {len(names)} files ({', '.join(names)}) but got {len(files)}; see {tool} --help")
        values.update(zip(names, map(pathlib.Path, files)))
        return values

    def check_files(self):
        inputs = [(name, self[name]) for name, _ in self.usage.inputs]
        for name, path in inputs:
            if not path.exists():
                raise InvalidInput(f"cannot read {name} '{path}': there is no such file or folder")
        for name in (self.usage.output[0], "--json"):
            if self[name] is None:
                continue
            path = self[name]
            if not path.parent.is_dir():
                raise InvalidInput(
                    f"cannot write {name} '{path}': folder '{path.parent}' does not exist; create it first")
            if path.is_dir():
                raise InvalidInput(f"cannot write {name} '{path}': it is a folder")
            for input_name, input_path in inputs:
                if path.exists() and path.samefile(input_path):
                    raise WrongUsage(f"{name} '{path}' is the {input_name} itself; give another name")

    def report(self, key, value, unit=""):
        self.results[key] = value
        if unit:
            self.units[key] = unit
        if not self.quiet:
            shown = f"{value:.6g}" if isinstance(value, float) else value
            print(f"{key}: {shown}{' ' + unit if unit else ''}")

    def warn(self, line):
        print(f"{self.usage.tool}: warning: {line}", file=sys.stderr)


class Progress:
    """A bar on stderr when that is a terminal."""

    def __init__(self, request, total):
        self.shown = sys.stderr.isatty() and not request.quiet
        self.total, self.done = total, 0

    def __call__(self, label):
        self.done += 1
        if self.shown:
            filled = round(30 * self.done / self.total)
            bar = "#" * filled + "." * (30 - filled)
            print(f"\r\033[K[{bar}] {self.done} of {self.total}: {label}", end="", file=sys.stderr, flush=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def write_atomically(path, text):
    """The file appears complete or not at all."""
    part = path.with_name(f".{path.name}.part-{os.getpid()}")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        part.rename(path)
    except OSError as error:
        raise InvalidInput(f"cannot write '{path}': {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)


def write_summary(request, seconds):
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    write_atomically(request["--json"], json.dumps({
        "tool": request.usage.tool,
        "version": request.version,
        "command_line": request.command_line,
        "wall_seconds": seconds,
        "cpu_seconds": sum(one.ru_utime + one.ru_stime for one in used),
        "peak_bytes": max(one.ru_maxrss for one in used) * 1024,
        **request.results,
        "units": request.units,
    }, indent=2, ensure_ascii=False) + "\n")


def main(usage, version, run):
    """Parses, runs, prints errors; returns the exit status."""
    start = time.monotonic()
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    words = sys.argv[1:]
    try:
        if "--help" in words or "-h" in words:
            print(usage.help_text(), end="")
        elif "--version" in words:
            print(f"{usage.tool} (tomodem) {version}")
        elif "--help-markdown" in words:
            print(usage.reference_page(), end="")
        else:
            request = Request(usage, version, words)
            request.check_files()
            run(request)
            if request["--json"]:
                write_summary(request, time.monotonic() - start)
        sys.stdout.flush()
        return 0
    except WrongUsage as error:
        status, message = 2, error
    except InvalidInput as error:
        status, message = 1, error
    except OSError as error:
        message = f"{error.filename}: {error.strerror}" if error.filename else error.strerror or str(error)
        status = 1
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # a fault of ours, on one line that says where
        place = traceback.extract_tb(error.__traceback__)[-1]
        status, message = 1, f"{type(error).__name__}: {error} ({pathlib.Path(place.filename).name}:{place.lineno})"
    print(f"{usage.tool}: {message}", file=sys.stderr)
    return status
