"""Runs the code blocks of a page in their order and compares what the page shows of their output.

    python scripts/run_page.py docs/first_steps.md --programs target/release --copy data
    python scripts/run_page.py docs/python.md --link runs/smoke=SOME_RUN

Blocks marked `sh` are run by bash, blocks marked `python` here, all of a page in one name space; both in a new
folder that holds what --copy and --link put there. A block marked `text` that follows at once is what the page
shows of the output: `...` alone on a line stands for any lines, and numbers of seconds and megabytes may differ.
An image that the page shows and a block makes must be the same file. Exit code 1 at the first that differs.
"""

import argparse
import contextlib
import difflib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from markdown_it import MarkdownIt

# Wall times and memory are those of one machine; padding goes with them.
MEASURED = re.compile(r"\s+\d+(\.\d+)? (s|min|MB)\b")
SECONDS = 300  # of one block
IMAGE = re.compile(r"!\[[^]]*\]\(([^)]*)\)")


def blocks(page):
    """The blocks to be run: language, code, line, and what is shown of the output or None."""
    found = []
    before = None  # the token before, if it is a block to be run
    for token in MarkdownIt("commonmark").parse(page.read_text(encoding="utf-8")):
        language = token.info.strip() if token.type == "fence" else ""
        if language == "text" and before:
            before["shown"] = token.content
        before = None
        if language in ("sh", "python"):
            before = {"language": language, "code": token.content, "line": token.map[0] + 1}
            before["shown"] = None
            found.append(before)
    return found


def shell(code, environment):
    """Output of a block of shell commands, errors and notes included."""
    command = ["bash", "-eu", "-o", "pipefail", "-c", code]
    options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    done = subprocess.run(command, env=environment, text=True, timeout=SECONDS, **options)
    if done.returncode != 0:
        raise SystemExit(f"{done.stdout}\nrun_page: exit code {done.returncode} of\n{code}")
    return done.stdout


def python(code, name, names):
    """Output of a block of Python; an exception ends the page with its trace."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        exec(compile(code, name, "exec"), names)
    return output.getvalue()


def comparable(text):
    unit = {"min": "s"}  # a slower machine takes minutes where another takes seconds
    of = lambda found: " # " + unit.get(found[2], found[2])  # noqa: E731
    return [MEASURED.sub(of, line).rstrip() for line in text.strip().splitlines()]


def differences(shown, printed):
    """What the page shows against what was printed; none if it is so."""
    shown, printed = comparable(shown), comparable(printed)
    anything = r"(?:.*\n)*?"
    pattern = "".join(anything if line == "..." else re.escape(line) + r"\n" for line in shown)
    if re.fullmatch(pattern, "".join(line + "\n" for line in printed)):
        return []
    return list(difflib.unified_diff(shown, printed, "the page", "the output", lineterm=""))


def compare_images(page, folder, update):
    """Images that the page shows and its blocks made; taken over on request."""
    for name in IMAGE.findall(page.read_text(encoding="utf-8")):
        made, shown = folder / name, page.parent / name
        if not made.is_file():
            continue
        if update:
            shutil.copyfile(made, shown)
        elif not shown.is_file() or made.read_bytes() != shown.read_bytes():
            raise SystemExit(f"run_page: {page.name}: {name} is not the image that the page makes")


def run(page, environment):
    names = {"__name__": "__main__"}
    found = blocks(page)
    if not found:
        raise SystemExit(f"run_page: {page.name} has no blocks to be run")
    compared = 0
    for block in found:
        where = f"{page.name}, line {block['line']}"
        start = time.monotonic()
        if block["language"] == "sh":
            printed = shell(block["code"], environment)
        else:
            printed = python(block["code"], where, names)
        print(f"{where}: {block['language']}, {time.monotonic() - start:.1f} s")
        if block["shown"] is not None:
            compared += 1
            if wrong := differences(block["shown"], printed):
                raise SystemExit("\n".join([*wrong, f"run_page: {where} shows other output"]))
    print(f"{page.name}: {len(found)} blocks ran, {compared} outputs are as shown")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", type=Path)
    parser.add_argument("--programs", type=Path, help="folder to put first on the path")
    parser.add_argument("--copy", type=Path, nargs="*", default=[], help="folders to copy")
    parser.add_argument("--link", nargs="*", default=[], metavar="NAME=PATH", help="to link")
    parser.add_argument("--update-images", action="store_true", help="take over what blocks made")
    return parser.parse_args()


def main():
    given = arguments()
    page = given.page.resolve()
    environment = dict(os.environ)
    if given.programs:
        programs = given.programs.resolve()
        environment["PATH"] = f"{programs}{os.pathsep}{environment['PATH']}"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for source in given.copy:
            shutil.copytree(source, folder / source.name)
        for link in given.link:
            target, source = link.split("=", 1)
            (folder / target).parent.mkdir(parents=True, exist_ok=True)
            (folder / target).symlink_to(Path(source).resolve())
        os.chdir(folder)
        try:
            run(page, environment)
            compare_images(page, folder, given.update_images)
        finally:
            os.chdir(page.parent)


if __name__ == "__main__":
    sys.exit(main())
