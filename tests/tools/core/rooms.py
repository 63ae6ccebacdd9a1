#!/usr/bin/python3
"""Compares every #include of core, solver_plugin and tools with the two tables of docs/architecture.md.

usage: rooms.py [SOURCE]        SOURCE: root of the repository, the current folder unless given

Prints one line for each include that the page does not allow, and for each statement of the page that is not true.
Exit status 1 if there is any.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
CHECKED = ("core", "solver_plugin", "tools")
COMMAND_LINE = "core/cli"
NOT_IN_CORE = {COMMAND_LINE, "core/picture"}  # rooms of core that the name `core` does not stand for
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)
MAIN = re.compile(r"^int main\(", re.MULTILINE)


def table(page, first_column):
    """The rows of the Markdown table whose first heading is `first_column`, as lists of cells."""
    rows, inside = [], False
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and cells[0] == first_column:
            inside = True
        elif inside and not line.startswith("|"):
            return rows
        elif inside and not set(line) <= set("|- "):
            rows.append(cells)
    sys.exit(f"docs/architecture.md has no table that begins with the column '{first_column}'")


def names(cell):
    return re.findall(r"`([^`]+)`", cell)


def read_page():
    page = (ROOT / "docs/architecture.md").read_text()
    rooms = {names(row[0])[0].rstrip("/"): row for row in table(page, "room")}
    core = {room for room in rooms if room.startswith("core/")} - NOT_IN_CORE
    allowed = {}
    for room, row in rooms.items():
        allowed[room] = set()
        for name in names(row[2]):
            name = name.rstrip("/")
            allowed[room] |= core if name == "core" else {name}
    libraries = {names(row[1])[0]: (row[0], names(row[2])) for row in table(page, "library")}
    return allowed, libraries


def room_of(path, rooms):
    """The innermost room that holds `path`, or None."""
    return max((room for room in rooms if path.startswith(room + "/")), key=len, default=None)


def cycle(allowed):
    """A room that may include itself through others, or None."""
    for start in allowed:
        reached, waiting = set(), list(allowed[start])
        while waiting:
            room = waiting.pop()
            if room not in reached:
                reached.add(room)
                waiting += allowed.get(room, ())
        if start in reached:
            return start
    return None


def main():
    allowed, libraries = read_page()
    complaints = []
    for room, others in allowed.items():
        if not (ROOT / room).is_dir():
            complaints.append(f"docs/architecture.md: the room {room} is no folder")
        complaints += [f"docs/architecture.md: {room} may include {other}, which is no room"
                       for other in others if other not in allowed]
    if cycle(allowed):
        complaints.append(f"docs/architecture.md: {cycle(allowed)} may include itself through other rooms")

    includes_of_library = {}
    files = sorted(path for top in CHECKED for path in (ROOT / top).rglob("*") if path.suffix in (".cpp", ".hpp", ".h"))
    for path in files:
        file = path.relative_to(ROOT).as_posix()
        room = room_of(file, allowed)
        if room is None:
            complaints.append(f"{file}: in no room of docs/architecture.md")
            continue
        text = path.read_text()
        for quoted, angled in INCLUDE.findall(text):
            header = quoted or angled
            target = room_of(header, allowed) if quoted else None
            if target == COMMAND_LINE and room != COMMAND_LINE:
                if not MAIN.search(text):
                    complaints.append(f"{file}: includes {header}, and has no main(): only mains know the command line")
            elif target:
                if target != room and target not in allowed[room]:
                    complaints.append(f"{file}: includes {header}, and {room} may not include {target}")
            elif quoted and "/" in quoted:
                complaints.append(f"{file}: includes {header}, which is in no room of docs/architecture.md")
            else:
                if quoted and not (path.parent / quoted).exists():
                    header = "lammps.h"  # every header of LIGGGHTS, whatever its name
                for prefix, (library, places) in libraries.items():
                    if not header.startswith(prefix):
                        continue
                    place = next((p for p in places if file == p or p.endswith("/") and file.startswith(p)), None)
                    if place:
                        includes_of_library.setdefault(library, set()).add(place)
                    else:
                        complaints.append(f"{file}: includes {quoted or angled} of {library}, which belongs in "
                                          f"{', '.join(places)}")
    for library, places in libraries.values():
        complaints += [f"docs/architecture.md: {place} includes no header of {library}"
                       for place in places if place not in includes_of_library.get(library, ())]
    print("\n".join(complaints), end="\n" if complaints else "")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
