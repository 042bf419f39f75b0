"""Reads every artifact of a run folder with pyarrow, polars and h5py and checks what it says.

    python scripts/check_artifacts.py runs/asphalt

Prints one line per file; ends with exit code 1 at the first thing that is wrong. Needs what
scripts/requirements.txt lists. It is also an example of how to read the artifacts.
"""

import json
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import polars as pl
import pyarrow as pa

LARGEST_RESIDUAL = 1e-10  # of a contact solve, relative to the pressure
ROUNDING = 1e-14  # of a mean over some tens of numbers of order one
CURVE = ["waves", "realisation", "speed_mm_s"]
TABLE = ["model", "waves", "speed_mm_s", "contact_area_fraction"]


def demand(condition, message):
    if not condition:
        raise SystemExit(f"check_artifacts: {message}")


def read_table(path):
    """An Arrow table: pyarrow keeps the units, polars and pandas drop them."""
    with pa.ipc.open_file(path) as reader:
        return reader.read_all()


def metadata(schema_or_field):
    return {key.decode(): value.decode() for key, value in (schema_or_field.metadata or {}).items()}


def check_table(path):
    """Units and absent values of the columns; returns schema, version, size and the polars frame."""
    table = read_table(path)
    for field, column in zip(table.schema, table.columns):
        where = f"{path}: column {field.name}"
        values = column.combine_chunks()
        demand(field.nullable or values.null_count == 0, f"{where} has nulls but is not nullable")
        if pa.types.is_list(field.type):
            values = values.flatten()
        if pa.types.is_integer(values.type) or pa.types.is_floating(values.type):
            demand(metadata(field).get("unit"), f"{where} has no unit")
            finite = np.isfinite(values.drop_null().to_numpy())
            demand(finite.all(), f"{where} has {np.sum(~finite)} values that are not finite")
    frame = pl.read_ipc(path)
    demand(frame.equals(pl.from_arrow(table)), f"{path}: polars and pyarrow read different values")
    about = metadata(table.schema)
    return about["schema"], int(about["version"]), f"{table.num_rows} rows", frame


def check_arrays(path):
    """Units and gaps of the HDF5 datasets; returns schema, version and size."""
    with h5py.File(path) as file:
        datasets = []
        file.visititems(
            lambda _, item: datasets.append(item) if isinstance(item, h5py.Dataset) else None
        )
        for dataset in datasets:
            where = f"{path}: dataset {dataset.name}"
            demand(dataset.attrs.get("unit"), f"{where} has no unit")
            values = dataset[:]
            demand(not np.isinf(values).any(), f"{where} has infinite values")
            missing = dataset.attrs.get("missing_fraction", 0.0)
            found = np.isnan(values).mean()
            demand(abs(found - missing) < ROUNDING, f"{where} has {found:.2%} NaN, not {missing:.2%}")
        return file.attrs["schema"], int(file.attrs["version"]), f"{len(datasets)} datasets"


def check_document(path):
    """A text for people: figures are well-formed, documents name files that are there."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".svg":
        root = ElementTree.fromstring(text)
        demand(root.tag.endswith("svg"), f"{path} is no SVG but {root.tag}")
        return f"figure of {root.get('width')} x {root.get('height')}"
    for target in re.findall(r"!\[[^]]*\]\(([^)]*)\)", text):
        demand((path.parent / target).is_file(), f"{path} shows {target}, which is not there")
    return f"document of {len(text.splitlines())} lines"


def check_solves(path, solves):
    worst = solves["residual"].max()
    demand(worst <= LARGEST_RESIDUAL, f"{path}: residual {worst:.1e} exceeds {LARGEST_RESIDUAL}")
    demand((solves["pressure_mpa"] > 0).all(), f"{path}: a pressure is not positive")
    demand(solves["contact_area_fraction"].is_between(0, 1).all(), f"{path}: an area exceeds 1")


def check_curves(path, curves):
    for curve, rows in curves.group_by(CURVE, maintain_order=True):
        area, pressure = rows["contact_area_fraction"], rows["pressure_mpa"]
        ascending = (area.diff().drop_nulls() > 0).all() and (pressure.diff().drop_nulls() > 0).all()
        demand(ascending, f"{path}: area does not grow with pressure for {dict(zip(CURVE, curve))}")
    demand((curves["friction_coefficient"] > 0).all(), f"{path}: a friction is not positive")


def check_friction(path, friction, model, curves):
    """The averages are those of the realisations, and these are the friction of the curves."""
    friction = friction.filter(pl.col("model") == model)
    off = (friction["mean"] - friction["realisations"].list.mean()).abs().max()
    demand(off < ROUNDING, f"{path}: an average differs by {off:.1e} from the realisations")
    long = friction.select(*TABLE, "realisations").explode("realisations")
    ours = curves.sort(*CURVE[::2], "contact_area_fraction", "realisation")
    # A model may lack a value for some realisation; its average is left out then.
    ours = ours.join(friction.select(*TABLE[1:]), on=TABLE[1:], how="semi", maintain_order="left")
    same = long["realisations"].equals(ours["friction_coefficient"])
    demand(same, f"{path}: the realisations are not the friction that {model} has for each")


def check_multilevel(path, friction, frames):
    """The averages are the mean of the half-space plus the mean difference of the pairs."""
    friction = friction.filter(pl.col("model") == "multilevel")
    further, pairs = frames["multilevel/half_space.arrow"], frames["multilevel/pairs.arrow"]
    half_space = pl.concat([frames["bem/curves.arrow"], further]).group_by(TABLE[1:])
    half_space = half_space.agg(pl.col("friction_coefficient").mean().alias("half_space"))
    differences = pairs.group_by(TABLE[1:]).agg(pl.col("difference").mean())
    ours = friction.join(half_space, on=TABLE[1:]).join(differences, on=TABLE[1:], how="left")
    off = (ours["mean"] - ours["half_space"] - ours["difference"].fill_null(0.0)).abs().max()
    demand(off < ROUNDING, f"{path}: an average of multilevel differs by {off:.1e} from its parts")


def check_run(run):
    manifests = sorted(run.glob("*/manifest.json"))
    demand(manifests, f"{run} has no results")
    frames = {}
    for manifest in manifests:
        outputs = json.loads(manifest.read_text())["outputs"]
        listed = {output["file"] for output in outputs}
        there = {path.name for path in manifest.parent.iterdir()} - {manifest.name}
        demand(listed == there, f"{manifest} lists {sorted(listed)}, the folder has {sorted(there)}")
        for output in outputs:
            path = manifest.parent / output["file"]
            size = path.stat().st_size
            demand(size == output["size"], f"{path} has {size} bytes, not {output['size']}")
            if output["schema"] == "asperity.document":
                print(f"{path}: {check_document(path)}")
                continue
            if path.suffix == ".h5":
                schema, version, shape = check_arrays(path)
            else:
                schema, version, shape, frame = check_table(path)
                # The stage multilevel has tables with the schemas of others; those of the others come first.
                frames.setdefault(schema, frame)
                frames[f"{manifest.parent.name}/{output['file']}"] = frame
            stated = output["schema"], output["schema_version"]
            demand((schema, version) == stated, f"{path} is {schema} {version}, not {stated}")
            print(f"{path}: {schema} version {version}, {shape}")
    needed = ["asperity.bem.solves", "asperity.bem.curves", "asperity.tables.friction"]
    demand(set(needed) <= frames.keys(), f"{run} is unfinished: it has not all of {needed}")
    solves, curves, friction = (frames[schema] for schema in needed)
    check_solves(run / "bem/solves.arrow", solves)
    check_curves(run / "bem/curves.arrow", curves)
    for model in friction["model"].unique():
        if model == "multilevel":
            check_multilevel(run / "tables/friction.arrow", friction, frames)
            continue
        of_model = frames.get(f"asperity.{model}.curves")
        if of_model is None:
            of_model = frames["asperity.tables.theories"].filter(pl.col("model") == model)
        check_friction(run / "tables/friction.arrow", friction, model, of_model)
    print(f"{run}: all artifacts are sound")


if __name__ == "__main__":
    demand(len(sys.argv) > 1, "give one or more run folders")
    for folder in sys.argv[1:]:
        check_run(Path(folder))
