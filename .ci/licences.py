#!/usr/bin/env python3
"""Prints every crate that the self-contained program contains: name, version, licence, and the licence texts.

The crates are those that `cargo metadata` resolves for the program, without build scripts and tests.
"""

import json
import subprocess
from pathlib import Path

COMMAND = [
    "cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", "x86_64-unknown-linux-gnu",
    "--features", "billow-study/self-contained",
]
# Code that a crate brings along: licence file below its folder.
BUNDLED = {"hdf5-metno-src": "ext/hdf5/LICENSE", "libz-sys": "src/zlib/LICENSE"}
# Beginnings of the names of licence files.
NAMES = ("license", "licence", "copying", "notice", "unlicense")


def normal(dependency):
    """Whether the program contains a dependency."""
    return any(kind["kind"] is None for kind in dependency["dep_kinds"])


def texts(package):
    folder = Path(package["manifest_path"]).parent
    found = sorted(path for path in folder.iterdir() if path.is_file() and path.name.lower().startswith(NAMES))
    bundled = folder / BUNDLED[package["name"]] if package["name"] in BUNDLED else None
    if bundled is not None:
        if not bundled.is_file():
            raise SystemExit(f"licences.py: {bundled} is missing")
        found.append(bundled)
    return found


def main():
    metadata = json.loads(subprocess.run(COMMAND, check=True, capture_output=True, text=True).stdout)
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    pending = [package["id"] for package in metadata["packages"] if package["name"] == "billow-study"]
    found = set(pending)
    while pending:
        for dependency in nodes[pending.pop()]["deps"]:
            if normal(dependency) and dependency["pkg"] not in found:
                found.add(dependency["pkg"])
                pending.append(dependency["pkg"])
    chosen = sorted((packages[id] for id in found), key=lambda package: (package["name"], package["version"]))
    chosen = [package for package in chosen if package["source"] is not None]
    without = [package["name"] for package in chosen if not package["license"] and not texts(package)]
    if without:
        raise SystemExit(f"licences.py: no licence is known of {', '.join(without)}")
    print(f"The program billow contains these {len(chosen)} crates.\n")
    for package in chosen:
        print(f"{package['name']} {package['version']}: {package['license'] or 'see its licence file'}")
    for package in chosen:
        for path in texts(package):
            print(f"\n{'=' * 100}\n{package['name']} {package['version']}: {path.name}\n{'=' * 100}\n")
            print(path.read_text(encoding="utf-8", errors="replace").strip())


if __name__ == "__main__":
    main()
