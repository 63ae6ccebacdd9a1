"""The command line of every tool, for one in Python: one declaration, and from it parsing (argparse), checks, --help and
what the launcher and the reference read.

Texts and exit status are those of core/cli: 0 done, 1 failed, 2 wrong usage; one line on stderr.
"""
import argparse
import dataclasses
import json
import os
import pathlib
import resource
import shlex
import shutil
import signal
import sys
import threading
import time
import traceback


class InvalidInput(Exception):
    """What is wrong, where, and what to do; ends the tool with status 1."""


class WrongUsage(Exception):
    """The same for the command line, with status 2."""


@dataclasses.dataclass
class Argument:
    """A positional argument (NAME) or an option (--name VALUE), as core/cli describes it."""

    name: str
    kind: str  # input, output, integer, text, flag
    help: str
    value: str = ""  # how --help calls what an option takes
    parse: object = pathlib.Path
    default: object = None
    formats: tuple = ()  # extensions that an output accepts

    @property
    def positional(self):
        return not self.name.startswith("--")

    def full_help(self):
        remarks = [" or ".join(self.formats)] * bool(self.formats)
        remarks += [f"default {self.default}"] * (self.default is not None)
        return self.help + (f" [{'; '.join(remarks)}]" if remarks else "")

    def shown(self):
        return f"{self.name} {self.value}".strip() if not self.positional else self.name


@dataclasses.dataclass
class Usage:
    tool: str
    purpose: str
    step: str  # of the chain, as core/cli names them
    arguments: list
    examples: list

    def positionals(self):
        return [one for one in self.arguments if one.positional]

    def help_text(self):
        rows = [(f"  {one.shown()}", one.full_help())
                for one in sorted(self.arguments, key=lambda one: not one.positional)]
        rows += [("  --threads INTEGER", "Number of threads. [default: one for every core that this process may use]"),
                 ("  --json FILE", "Also write the results, their units, time and memory to this file as JSON."),
                 ("  --quiet", "Print warnings and errors only."), ("  --help", "Print this text."),
                 ("  --version", "Print the version."), ("  --describe", "Print this usage as JSON, for other programs.")]
        width = max(min(len(name), 34) for name, _ in rows)
        table = "".join(f"{name:<{width}}  {text}\n" for name, text in rows)
        words = " ".join(one.name for one in self.positionals())
        examples = "".join(f"  {one}\n" for one in self.examples)
        return f"{self.tool}: {self.purpose}\n\nusage: {self.tool} {words} [options]\n\n{table}\nexamples:\n{examples}"

    def reference_page(self):
        def in_cell(text):
            return text.replace("|", "\\|")

        rows = "".join(f"| `{in_cell(one.shown())}` | {in_cell(one.full_help())} |\n" for one in self.arguments)
        examples = "".join(f"\n    {one}\n" for one in self.examples)
        return f"## {self.tool}\n\n{self.purpose}\n\n| argument | what it is |\n|---|---|\n{rows}{examples}"

    def description(self):
        arguments = [{"name": one.name, "kind": one.kind, "required": one.positional, "help": one.full_help(),
                      **({"formats": list(one.formats)} if one.formats else {})} for one in self.arguments]
        return json.dumps({"name": self.tool, "purpose": self.purpose, "step": self.step, "threads": True,
                           "arguments": arguments, "exclusive": [], "examples": self.examples, "display": None},
                          indent=2, ensure_ascii=False) + "\n"

    def parser(self, version):
        parser = Parser(prog=self.tool, add_help=False, allow_abbrev=False)
        for one in self.arguments:
            if one.kind == "flag":
                parser.add_argument(one.name, dest=one.name, action="store_true")
                continue
            place = {} if one.positional else {"dest": one.name, "metavar": one.value}
            parser.add_argument(one.name, type=one.parse, default=one.default, **place)
        parser.add_argument("--threads", dest="--threads", metavar="INTEGER", type=threads_number)
        parser.add_argument("--json", dest="--json", metavar="FILE", type=pathlib.Path)
        parser.add_argument("--quiet", dest="--quiet", action="store_true")
        for flag, text in (("--help", self.help_text()), ("-h", self.help_text()),
                           ("--version", f"{self.tool} (tomodem) {version}\n"), ("--describe", self.description()),
                           ("--help-markdown", self.reference_page())):
            parser.add_argument(flag, dest=flag, action=Print, text=text)
        return parser


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongUsage(f"{message.removeprefix('argument ')}; see {self.prog} --help")


class Print(argparse.Action):
    """Prints a text and ends, whatever else stands on the command line."""

    def __init__(self, option_strings, dest, text):
        super().__init__(option_strings, dest, nargs=0, default=argparse.SUPPRESS)
        self.text = text

    def __call__(self, parser, *_):
        sys.stdout.write(self.text)
        parser.exit()


def threads_number(text):
    if not text.isdigit() or not 1 <= int(text) <= 4096:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number of at least 1 and at most 4096")
    return int(text)


class Request:
    """The words of a command line: `request["RUN"]`, `request["--with"]`; results for stdout and --json."""

    def __init__(self, usage, version, words):
        self.usage, self.version = usage, version
        self.command_line = shlex.join([usage.tool, *words])
        self.values = vars(usage.parser(version).parse_args(words))
        self.quiet = self["--quiet"]
        self.results, self.units = {}, {}
        self.threads = self["--threads"] or len(os.sched_getaffinity(0))

    def __getitem__(self, name):
        return self.values[name]

    def check_files(self):
        of_kind = {kind: [one.name for one in self.usage.positionals() if one.kind == kind] for kind in ("input", "output")}
        inputs = [(name, self[name]) for name in of_kind["input"]]
        for name, path in inputs:
            if path.exists():
                continue
            # What solve keeps of a run until it is complete.
            if (partial := path.with_name(f"{path.name}.partial")).exists():
                raise InvalidInput(f"cannot read {name} '{path}': this run is unfinished; give '{partial}', which holds what it has "
                                   "written so far, or let it end (if solve has stopped, repeat its command with --resume)")
            raise InvalidInput(f"cannot read {name} '{path}': there is no such file or folder")
        for one in self.usage.arguments:
            if one.formats and self[one.name].suffix not in one.formats:
                raise WrongUsage(f"{one.name} '{self[one.name]}': the name must end in {' or '.join(one.formats)}")
        for name in (*of_kind["output"], "--json"):
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
    """A bar on stderr when that is a terminal, with what is at work; may be told from several threads."""

    def __init__(self, request, total):
        self.shown = sys.stderr.isatty() and not request.quiet
        self.total, self.done, self.begun = total, 0, time.monotonic()
        self.at_work, self.lock = [], threading.Lock()

    def begin(self, label):
        with self.lock:
            self.at_work.append(label)
            self.draw()

    def __call__(self, label):
        with self.lock:
            self.done += 1
            if label in self.at_work:
                self.at_work.remove(label)
            self.draw()

    def draw(self):
        if not self.shown:
            return
        filled = round(30 * min(1, self.done / self.total))
        bar = "#" * filled + "." * (30 - filled)
        words = f"[{bar}] {self.done} of {self.total}, {time.monotonic() - self.begun:.0f} s: {', '.join(self.at_work)}"
        width = shutil.get_terminal_size().columns - 1
        print(f"\r\033[K{words[:width]}", end="", file=sys.stderr, flush=True)

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
    try:
        request = Request(usage, version, sys.argv[1:])
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
