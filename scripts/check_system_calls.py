#!/usr/bin/env python3
"""Let each single system call of a run fail, one at a time, and look at what is left.

    python3 scripts/check_system_calls.py --program target/release/asperity          40 of them
    python3 scripts/check_system_calls.py --program target/release/asperity --all    every one

The recipe is pipelines/smoke.toml with one number of waves and one speed. `strace` counts its calls in an undisturbed run and then, in a run of
its own for each, lets the n-th call of a kind fail with an error that this kind can have on a real machine:
a full disk, a disk that is defect, a file without permission, no memory. SQLite tests itself so
(https://www.sqlite.org/testing.html, "I/O error testing").

Of each disturbed run is demanded:

1. It ends within a time limit, by itself: no hang, no panic, no signal.
2. It ends with an error that names the file or folder of the call that failed (of a temporary one, what it was
   to become or the folder in which it was to be made), or the memory or thread that could not be had; or, where
   the call did not matter, with success and the content of the undisturbed run.
3. The same command afterwards ends with success and the content of the undisturbed run.
4. `asperity verify` then calls the folder intact.

Content is the digest of the content of each result, as the manifests list it; times differ between any two
runs and are no part of it.

Which calls count: those from the first own action of the program on, which is the first time that it
opens or looks at the recipe. Before that the dynamic loader maps libraries and the C and Rust libraries
set themselves up; a failure there ends any program before its first line. `strace` counts the calls of each
thread by itself, so that a number may fail once in each of several threads. How many calls a thread makes
differs between runs; a number that a run does not reach disturbs nothing, and is counted as such.

Memory: the kernel refuses memory by a failing `mmap` (ENOMEM). Rust programs then end with SIGABRT and
"memory allocation of ... bytes failed". This is the only signal that is accepted, and 3 and 4 are demanded after it.

The exit code is 0 if every run did what is demanded, 1 otherwise, 2 if strace cannot be used.
"""

import argparse
import collections
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# Kinds of calls, and the errors that each is given in turn.
CALLS = {
    "write": ["ENOSPC", "EIO"],
    "pwrite64": ["ENOSPC", "EIO"],
    "rename": ["EACCES", "EIO"],
    "renameat": ["ENOSPC", "EIO"],
    "renameat2": ["ENOSPC", "EIO"],
    "mkdir": ["ENOSPC", "EACCES"],
    "mkdirat": ["ENOSPC", "EACCES"],
    "openat": ["EACCES", "EIO"],
    "fsync": ["EIO", "ENOSPC"],
    "ftruncate": ["EIO", "ENOSPC"],
    "mmap": ["ENOMEM"],
    "statx": ["EIO", "EACCES"],
    "newfstatat": ["EIO", "EACCES"],
}
SAMPLE = 40
SEED = 16
TIME_LIMIT_SECONDS = 120
RECIPE = "pipelines/smoke.toml"
# What of it is left out: more curves make more calls of the same kinds.
LESS = {
    "\nwaves = [7, 8]": "\nwaves = [7]",
    "speeds_mm_s = [10.0, 50.0]": "speeds_mm_s = [10.0]",
    "area_fractions = [0.02, 0.05, 0.1]": "area_fractions = [0.05, 0.1]",
}
# What asperity calls the temporary files and folders from which a result is made.
TEMPORARY = re.compile(r"\.asperity-(?:new-|old-)?(?P<becomes>.+)-\w{6}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the binary asperity")
    parser.add_argument("--all", action="store_true", help="every call, in place of a sample")
    parser.add_argument("--sample", type=int, default=SAMPLE, help=f"runs of the sample ({SAMPLE})")
    parser.add_argument("--call", action="append", choices=sorted(CALLS), help="only this kind")
    parser.add_argument("--threads", type=int, default=2, help="threads of the runs (2)")
    return parser.parse_args()


class Failed:
    """What the calls concerned that failed in a disturbed run."""

    def __init__(self, trace, call, folder):
        self.folder = str(folder)
        self.paths, self.others, begun, self.reached = set(), set(), {}, False
        for line in trace.splitlines():
            process, _, told = line.partition(" ")
            told = told.strip()
            if told.endswith("<unfinished ...>"):
                begun[process] = told
            if "(INJECTED)" not in told:
                continue
            self.reached = True
            if told.startswith("<..."):
                told = begun.get(process, "")
            self.note(told.rpartition(" = ")[0] or told, call)

    def note(self, told, call):
        # Descriptors with their paths (`5</a/b>`) and texts, of which those of a write are content.
        descriptor = re.search(r"\((\d+|AT_FDCWD)<([^>]*)>", told)
        base = descriptor[2] if descriptor else self.folder
        named = [] if "write" in call else re.findall(r'"((?:[^"\\]|\\.)*)"', told)
        named = [os.path.normpath(os.path.join(base, name)) for name in named if name]
        if named:
            self.paths.update(named)
        elif call == "mmap" and not (mapped := re.search(r", \d+<(/[^>]*)>", told)):
            self.others.update(("memory", "thread", "threads"))
        elif call == "mmap":
            self.paths.add(mapped[1])
        elif base.startswith("/"):
            self.paths.add(base)
        else:
            self.others.update(("standard output", "standard error"))

    def names(self):
        """Every way in which a message may name one of them."""
        names = set(self.others)
        for path in self.paths:
            inside = os.path.relpath(path, self.folder)
            path = path if inside.startswith("..") else inside
            names.add(path)
            folder, name = os.path.split(path)
            if temporary := TEMPORARY.fullmatch(name):
                names.update((os.path.join(folder, temporary["becomes"]), folder))
        return names

    def are_named_in(self, told):
        # Neither as the beginning nor as the end of another name.
        whole = (rf"(?<![\w.-]){re.escape(name)}(?![\w/-]|\.\w)" for name in self.names())
        return any(re.search(name, told) for name in whole)


class Bench:
    """A folder with the recipe and its data, in which runs are disturbed."""

    def __init__(self, program, threads, folder):
        root = pathlib.Path(__file__).resolve().parent.parent
        self.program = program.resolve()
        self.threads = threads
        self.folder = folder
        shutil.copytree(root / "data", folder / "data")
        (folder / "pipelines").mkdir()
        recipe = (root / RECIPE).read_text()
        for text, less in LESS.items():
            if text not in recipe:
                sys.exit(f"{RECIPE} has no {text!r} any more: change LESS")
            recipe = recipe.replace(text, less)
        (folder / RECIPE).write_text(recipe)

    def command(self, out):
        threads = str(self.threads)
        return [self.program, "--quiet", "run", RECIPE, "--out", out, "--threads", threads]

    def run(self, command, tracer=()):
        """Exit code and messages; a code of None is a run that did not end in time."""
        process = subprocess.Popen(
            [*tracer, *command],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        try:
            _, told = process.communicate(timeout=TIME_LIMIT_SECONDS)
        except subprocess.TimeoutExpired:
            # The tracer and what it traces, which are one session.
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, ""
        return process.returncode, told.decode(errors="replace")

    def undisturbed(self):
        """Content of an undisturbed run; for each kind of call its first and its last number that count."""
        trace = self.folder / "trace"
        calls = ",".join(CALLS)
        tracer = ["strace", "-f", "-qq", "-o", trace, "-e", f"trace={calls}"]
        code, told = self.run(self.command("undisturbed"), tracer)
        if code != 0:
            sys.exit(f"the undisturbed run failed: {told}")
        # Numbers of the calls of each thread, and the last of each kind before the first own action.
        numbers, before = collections.Counter(), {}
        for line in trace.read_text(errors="replace").splitlines():
            call = re.match(r"(\d+) +(\w+)\(", line)
            if call is None:
                continue
            if not before and pathlib.Path(RECIPE).name in line:
                before = {kind: number for (_, kind), number in numbers.items()}
                before[""] = 0
            numbers[call.groups()] += 1
        counts = {}
        for call in CALLS:
            last = max((number for (_, kind), number in numbers.items() if kind == call), default=0)
            if last > before.get(call, 0):
                counts[call] = range(before.get(call, 0) + 1, last + 1)
        return self.content("undisturbed"), counts

    def content(self, out):
        """Digests of the content of all results in a folder."""
        digests = {}
        for manifest in sorted((self.folder / out).glob("*/manifest.json")):
            stage = json.loads(manifest.read_bytes())
            for output in stage["outputs"]:
                digests[f"{stage['stage']}/{output['file']}"] = output["content_digest"]
        return digests

    def disturb(self, call, error, number, content):
        """What is wrong with a run whose call fails, none if nothing is; and how the run ended."""
        out = "disturbed"
        shutil.rmtree(self.folder / out, ignore_errors=True)
        trace = self.folder / "trace"
        inject = f"inject={call}:error={error}:when={number}"
        tracer = ["strace", "-f", "-y", "-qq", "-o", trace, "-e", f"trace={call}", "-e", inject]
        code, told = self.run(self.command(out), tracer)
        failed = Failed(trace.read_text(errors="replace"), call, self.folder)
        ending, wrong = self.judge(code, told, failed, content, out)
        if wrong is None:
            wrong = self.again(out, content)
        if wrong:
            wrong = f"{wrong}\n    {told.strip()}\n    failed: {sorted(failed.names())}"
        return wrong, ending if failed.reached else "not reached"

    def judge(self, code, told, failed, content, out):
        if code is None:
            return "hang", f"did not end within {TIME_LIMIT_SECONDS} s"
        if code == 0:
            same = self.content(out) == content
            return "success", None if same else "succeeded with other content"
        if code in (-signal.SIGABRT, 128 + signal.SIGABRT):
            out_of_memory = "memory" in failed.others and "memory allocation of" in told
            return "out of memory", None if out_of_memory else "aborted"
        if code < 0 or code >= 128:
            return "signal", f"ended by a signal ({code})"
        if "panicked" in told or code not in (1, 2):
            return "panic", f"panicked (exit code {code})"
        # A standard error that cannot be written to leaves the exit code to tell.
        silent = "standard error" in failed.others and not told
        named = silent or failed.are_named_in(told)
        return "error", None if named else "the error does not name what failed"

    def again(self, out, content):
        code, told = self.run(self.command(out))
        if code != 0:
            return f"the same command afterwards fails ({code}): {told.strip()}"
        if self.content(out) != content:
            return "the same command afterwards has other content"
        code, told = self.run([self.program, "--quiet", "verify", out])
        return None if code == 0 else f"verify afterwards: {told.strip()}"


def usable():
    """Whether strace is here and may trace."""
    probe = ["strace", "-qq", "-o", os.devnull, "-e", "trace=none", "true"]
    return shutil.which("strace") is not None and subprocess.run(probe, check=False).returncode == 0


def main():
    options = arguments()
    if not usable():
        print("strace is missing or may not trace (sh scripts/setup --strace)", file=sys.stderr)
        return 2
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options.program, options.threads, pathlib.Path(folder))
        content, counts = bench.undisturbed()
        wanted = options.call or list(counts)
        every = [
            (call, CALLS[call][number % len(CALLS[call])], number)
            for call in wanted
            for number in counts.get(call, ())
        ]
        told = ", ".join(f"{call} {len(counts[call])}" for call in wanted if call in counts)
        print(f"{len(every)} calls of {RECIPE}: {told}", flush=True)
        if not options.all:
            # As many of each kind: there are hundreds of some and one of others.
            chance = random.Random(SEED)
            kinds = [[one for one in every if one[0] == call] for call in wanted]
            for kind in kinds:
                chance.shuffle(kind)
            turns = [kind[turn] for turn in range(len(every)) for kind in kinds if turn < len(kind)]
            every = turns[: options.sample]
        endings, failures = collections.Counter(), 0
        for call, error, number in every:
            wrong, ending = bench.disturb(call, error, number, content)
            endings[ending] += 1
            if wrong:
                failures += 1
                print(f"{call} {number} with {error}: {wrong}", flush=True)
    endings = ", ".join(f"{ending} {count}" for ending, count in sorted(endings.items()))
    seconds = time.monotonic() - started
    print(f"{len(every)} runs in {seconds:.0f} s: {endings}; {failures} not as they should be")
    return 1 if failures or not every else 0


if __name__ == "__main__":
    sys.exit(main())
