"""Bookcases and filing cabinets of FEMA P-58 that overturn on the floors of buildings: medians of peak floor velocity.

Prints the table of docs/studies/contents.md: the medians of the library beside those of rigid blocks of the same size, on rough and on
smooth floors. `--records FOLDER` takes your own accelerograms instead of the two that come with the project.
"""

import argparse
from pathlib import Path

import numpy as np

import rocking_block as rb

ROOT = Path(__file__).resolve().parents[2]
INCH = 0.0254
# FEMA P-58, second edition: number, contents, depth and height [in], median of PFV [m/s]; the dispersion of all is 0.5.
COMPONENTS = [
    ("E2022.102a", "bookcase, 2 shelves", 12.625, 29.0, 0.724),
    ("E2022.103a", "bookcase, 3 shelves", 12.625, 41.0, 0.493),
    ("E2022.104a", "bookcase, 4 shelves", 12.625, 56.0, 0.361),
    ("E2022.105a", "bookcase, 5 shelves", 12.625, 71.0, 0.290),
    ("E2022.106a", "bookcase, 6 shelves", 12.625, 81.25, 0.251),
    ("E2022.112a", "vertical cabinet, 2 drawers", 15.0, 24.0, 1.229),
    ("E2022.114a", "vertical cabinet, 4 drawers", 15.0, 52.0, 0.498),
    ("E2022.124a", "lateral cabinet", 18.6, 52.5, 0.688),
    ("E2022.125a", "lateral cabinet", 18.6, 67.75, 0.526),
]
# No limit, or Coulomb's coefficient between contents and floor.
FRICTIONS = (None, 0.5, 0.3)
LEVELS = np.geomspace(0.15, 4.0, 16)


def building(storeys):
    """A uniform shear building with a first period of a tenth of a second per storey and 5 % damping in all modes."""
    mass, period = 3e5, 0.1 * storeys
    first = 2 * np.sin(np.pi / (2 * (2 * storeys + 1)))  # of unit masses and stiffnesses
    stiffness = mass * (2 * np.pi / period / first) ** 2
    return rb.Building(floor_masses=[mass] * storeys, storey_stiffnesses=[stiffness] * storeys, damping=0.05)


def floor_motions(records, storeys):
    """The ground and all floors of the buildings under each record: name of the record, motion, PFA, PFV."""
    for record in records:
        yield record.name, record, record.pga, record.pgv
        for count in storeys:
            motions = rb.floor_motions(record, building(count))
            yield from zip([record.name] * count, motions.records, motions.PFA, motions.PFV)


def outcomes(records, blocks, levels=LEVELS, storeys=(2, 5, 10)):
    """One table per block, with a row per motion and level of PFV."""
    parts = [[] for _ in blocks]
    for name, motion, pfa, pfv in floor_motions(records, storeys):
        table = rb.outcomes(blocks, [motion], scale=levels / pfv, progress=False)
        measures = {"record": np.array([name] * len(levels)), "PFV": levels, "PFA": levels * pfa / pfv}
        for number, part in enumerate(parts):
            rows = slice(number, None, len(blocks))
            part.append(measures | {column: table[column][rows] for column in ("outcome", "peak.theta/alpha")})
    tables = [{column: np.concatenate([rows[column] for rows in part]) for column in part[0]} for part in parts]
    return [rb.Table(table, {"PFV": "m/s", "PFA": "m/s2"}) for table in tables]


def runs(records, components=COMPONENTS, frictions=FRICTIONS, levels=LEVELS):
    """One table per component and coefficient of friction, with a row per motion and level of PFV."""
    blocks = [
        rb.Block(width=depth * INCH, height=height * INCH, foundation="rigid", friction=friction)
        for _, _, depth, height, _ in components
        for friction in frictions
    ]
    tables = outcomes(records, blocks, levels)
    return [tables[i : i + len(frictions)] for i in range(0, len(tables), len(frictions))]


def read_records(folder=None):
    """Returns the accelerograms of a folder, by default those of the project."""
    paths = sorted((folder or ROOT / "examples/records").iterdir())
    return [rb.read_record(path) for path in paths if path.suffix.lower() in (".smc", ".at2")]


def shown(table, limit="overturned"):
    """Median and dispersion of a table, or the fraction of rows where the block exceeded the limit, if that is too small for a curve."""
    try:
        fit = rb.fragility(table, im="PFV", limit=limit)
    except ValueError:
        exceeded = table["outcome"] == "overturned" if limit == "overturned" else table["peak.theta/alpha"] > limit
        return f"in {np.mean(exceeded):.0%}"
    return f"{fit.median:.3f}, {fit.beta:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=Path, help="folder of accelerograms of any format that needs no options")
    options = parser.parse_args()
    records = read_records(options.records)
    heads = " | ".join("no sliding" if friction is None else f"μ = {friction:g}" for friction in FRICTIONS)
    print(f"| component | contents | depth × height (m) | FEMA P-58 | lifts | {heads} |")
    print("| --- " * 3 + "| ---: " * (2 + len(FRICTIONS)) + "|")
    for (number, name, depth, height, median), tables in zip(COMPONENTS, runs(records)):
        lifts = shown(tables[0], 0.01)
        cells = " | ".join(shown(table) for table in tables)
        print(f"| {number} | {name} | {depth * INCH:.3f} × {height * INCH:.3f} | {median:.3f}, 0.50 | {lifts} | {cells} |")


if __name__ == "__main__":
    main()
