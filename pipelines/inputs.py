#!/usr/bin/python3
"""Prints digests of what a chain reads: NAME=DIGEST words, so that make goes by content and not by dates.

usage: inputs.py [--cache FILE] [--scene SCENE] [--image VOLUME --bin BIN] NAME=FILE...

The digest `image` is that of all files that VOLUME is made of, as BIN/volume_info lists them.
Of SCENE there are three digests, none of which sees comments or layout, all of which see the files that it names:
`scene`, all of it; `scene_phases`, which label is called what; `scene_relax`, what relaxing a sample can depend on. `law` is
the name of its law itself.

The cache remembers the digest of a file as long as its size and dates (also that of its last change of any kind, which
no program can set) stay; it is written if its folder exists.
"""
import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time
import tomllib

# A file written twice within this time may keep its dates [s].
COARSEST_CLOCK = 2


def text_digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()


class Digests:
    def __init__(self, cache):
        self.cache, self.known, self.used = cache, {}, {}
        try:
            self.known = json.loads(cache.read_text()) if cache else {}
        except (OSError, ValueError):
            pass

    def of_file(self, path):
        try:
            state = path.stat()
        except FileNotFoundError:
            return "missing"
        key, date = os.path.realpath(path), [state.st_size, state.st_mtime_ns, state.st_ctime_ns]
        if self.known.get(key, [None])[0] != date:
            with open(path, "rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            if time.time() - max(state.st_mtime, state.st_ctime) < COARSEST_CLOCK:
                return digest
            self.used[key] = [date, digest]
            return digest
        return self.known[key][1]

    def of_volume(self, files, volume):
        return text_digest([(os.path.relpath(one, volume), self.of_file(pathlib.Path(one))) for one in files])

    def save(self):
        if not self.used or not self.cache or not self.cache.parent.is_dir():
            return
        part = self.cache.with_name(f"{self.cache.name}.part-{os.getpid()}")
        part.write_text(json.dumps({**self.known, **self.used}, indent=0, sort_keys=True))
        part.rename(self.cache)


def files_of_volume(volume, tools):
    listed = subprocess.run([tools / "volume_info", volume, "--files"], stdout=subprocess.PIPE, text=True)
    return listed.stdout.splitlines() if listed.returncode == 0 else sys.exit(1)


def files_named_in(value, folder):
    if isinstance(value, str):
        return [folder / value] if value and (folder / value).is_file() else []
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else []
    return [path for one in inside for path in files_named_in(one, folder)]


def what_relaxing_depends_on(scene):
    """Not on what is written, nor how far the load goes, unless its rate follows from that."""
    scene = {key: value for key, value in scene.items() if key != "output"}
    accuracy = {key: value for key, value in scene.get("accuracy", {}).items() if key not in ("frames", "averaging_strain")}
    load = dict(scene.get("load", {}))
    steps = load.get("steps", [])
    if not any(isinstance(step["rate"], list) for step in steps):
        load["steps"] = [{key: value for key, value in step.items() if key != "strain"} for step in steps]
    return {**scene, "accuracy": accuracy, "load": load}


def law_of(text):
    """Of the first phase; none where the scene is not as it should be."""
    try:
        law = next(iter(tomllib.loads(text)["phase"].values()))["law"]
        return law if law.isidentifier() else None
    except (tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError, StopIteration):
        return None


def scene_digests(path, digests):
    text = path.read_text()
    try:
        scene = tomllib.loads(text)
        files = [digests.of_file(one) for one in files_named_in(scene, path.parent)]
        parts = {
            "scene": [scene, files],
            "scene_phases": {name: phase["label"] for name, phase in scene["phase"].items()},
            "scene_relax": [what_relaxing_depends_on(scene), files],
        }
    except (tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError):
        parts = dict.fromkeys(("scene", "scene_phases", "scene_relax"), text)  # the tools say what is wrong with it
    found = {name: text_digest(part) for name, part in parts.items()}
    law = law_of(text)
    return found | ({"law": law} if law else {})


def main():
    parser = argparse.ArgumentParser(prog="inputs", description=__doc__.splitlines()[0])
    parser.add_argument("--cache", type=pathlib.Path)
    parser.add_argument("--scene", type=pathlib.Path)
    parser.add_argument("--image")
    parser.add_argument("--bin", type=pathlib.Path)
    parser.add_argument("inputs", nargs="*", metavar="NAME=FILE")
    options = parser.parse_args()
    digests = Digests(options.cache)
    found = {}
    try:
        for one in options.inputs:
            name, _, path = one.partition("=")
            found[name] = digests.of_file(pathlib.Path(path))
        if options.image:
            found["image"] = digests.of_volume(files_of_volume(options.image, options.bin), options.image)
        if options.scene:
            found |= scene_digests(options.scene, digests)
        digests.save()
    except OSError as error:
        sys.exit(f"inputs: cannot read '{error.filename}': {error.strerror}")
    print(*(f"{name}={digest}" for name, digest in found.items()))


main()
