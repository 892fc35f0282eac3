"""Anchored bookcases and filing cabinets of FEMA P-58: the curves that the library leaves to the user, as files for pelicun.

Prints the table of docs/studies/contents.md on anchored contents, and writes fragility.csv and fragility.json into a folder, by default
examples/python/anchored_contents. `--records FOLDER` takes your own accelerograms instead of the two that come with the project.
"""

import argparse
from pathlib import Path

import numpy as np
from contents import COMPONENTS, INCH, outcomes, read_records, shown
from contents import LEVELS as ALL_LEVELS

import rocking_block as rb

GRAVITY = 9.81
# Strength of an anchor over the weight of the contents.
STRENGTH = 0.5
# Stretch of an anchor at its strength [m].
STRETCH = 0.005
# The library's measure of the anchored components: peak floor velocity for vertical cabinets, else acceleration.
VELOCITY = ("E2022.112a", "E2022.114a")
LEVELS = ALL_LEVELS[::2]


def block(depth, height, strength):
    """Contents on supports, held at the top by an anchor to each side; depth and height in metres."""
    alpha, p = np.arctan(depth / height), np.sqrt(1.5 * GRAVITY / np.hypot(depth, height))
    mass = 100.0  # Strengths are in proportion to the weight, so that the mass has no effect.
    ties = []
    if strength > 0:
        limit = strength * mass * GRAVITY
        for side in (-1, 1):
            anchor = {"block_x": side * depth / 2, "ground_x": side * (depth / 2 + 0.1), "block_z": height, "ground_z": height}
            ties.append(rb.Tie(**anchor, stiffness=limit / STRETCH, strength=limit))
    return rb.Block(alpha=alpha, p=p, eta=50, xi_v=0.1, mass=mass, ties=ties)


def runs(records, strengths, components=COMPONENTS, levels=LEVELS):
    """One table per component and strength, 0 without anchors, with a row per motion and level of PFV."""
    blocks = [block(depth * INCH, height * INCH, strength) for _, _, depth, height, _ in components for strength in strengths]
    tables = outcomes(records, blocks, levels)
    return [tables[i : i + len(strengths)] for i in range(0, len(tables), len(strengths))]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=Path, help="folder of accelerograms of any format that needs no options")
    parser.add_argument("--strength", type=float, default=STRENGTH, help="strength of an anchor over the weight of the contents")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(""), help="folder for the files of pelicun")
    options = parser.parse_args()
    print(f"| component | contents | unanchored | anchored, {options.strength:g} W | anchored, in the library's measure |")
    print("| --- | --- | ---: | ---: | ---: |")
    curves = {}
    for (number, name, *_), (free, anchored) in zip(COMPONENTS, runs(read_records(options.records), (0.0, options.strength))):
        measure = "PFV" if number in VELOCITY else "PFA"
        fit = rb.fragility(anchored, im=measure)
        # E.20.22.102b in the library.
        twin = f"{number[0]}.{number[1:3]}.{number[3:5]}.{number[6:-1]}b"
        curves[twin] = fit
        value = f"PFA {fit.median / GRAVITY:.3f} g" if measure == "PFA" else f"PFV {fit.median:.3f} m/s"
        print(f"| {twin} | {name} | {shown(free)} | {shown(anchored)} | {value}, {fit.beta:.2f} |")
    rb.export_fragility(curves, "pelicun", options.out, g=GRAVITY)


if __name__ == "__main__":
    main()
