#!/usr/bin/env python3
"""Compares THIRD-PARTY.md, the notices of the crates in the binary, with what Cargo.lock gives.

    python3 scripts/check_third_party.py

The file is made by cargo-about (https://crates.io/crates/cargo-about):

    cargo install cargo-about --locked --features cli
    cargo about generate --locked about.hbs --output-file THIRD-PARTY.md
"""

import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
NOTICES = PROJECT / "THIRD-PARTY.md"


def crates_of_the_binary():
    """Names with versions of the crates that the binary for this platform is linked from."""
    command = ["cargo", "tree", "--locked", "--package", "asperity", "--edges", "normal,no-proc-macro", "--prefix", "none"]
    listed = subprocess.run(command, cwd=PROJECT, check=True, capture_output=True, text=True).stdout
    # Those of the project itself have their folder behind the version.
    words = [line.split() for line in listed.splitlines() if "(/" not in line]
    return {f"{name} {version.removeprefix('v')}" for name, version, *_ in words}


def main():
    noticed = set(re.findall(r"^- ([\w-]+ [\w.+-]+)$", NOTICES.read_text(), re.MULTILINE))
    missing = sorted(crates_of_the_binary() - noticed)
    if missing:
        sys.exit(
            f"{NOTICES.name} has no notice of: {', '.join(missing)}\n"
            "make it again: cargo about generate --locked about.hbs --output-file THIRD-PARTY.md"
        )
    print(f"{NOTICES.name}: {len(noticed)} crates noticed, none of the binary is missing")


if __name__ == "__main__":
    main()
