"""The bridge tower of Palmeri and Makris (2008) without and with the energy absorbers that their analysis leaves out.

Prints the tables of docs/studies/tower.md and draws tower.png beside this file. `--records FOLDER` names a folder with the records of Table I, as
docs/unit/figures.md lists them; the pulse of Table I replaces a missing record. `--yield-force` and `--yield-elongation` try other absorbers.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

import rocking_block as rb

GRAVITY = 9.81
# Half of a pier with its part of the deck, on whose weight the paper designs the pads [kg].
MASS = 700e3
# Two absorbers at each leg [N], N. Makris and M. Aghagholizadeh (2019) after R. I. Skinner and others (1980).
YIELD_FORCE = 2 * 450e3
# Chosen here: elongation at which an absorber yields [m], stiffness after yielding over that before, and length [m].
YIELD_ELONGATION, HARDENING, LENGTH = 0.01, 0.05, 1.0
FOUNDATIONS = {"η = 40": 40.0, "η = 60": 60.0, "η = 100": 100.0, "rigid base": None}
# In the order of the paper's peak accelerations: file of the record, unit and time step where the file lacks them, pulse of Table I.
MOTIONS = {
    "Erzincan": ("ERZ-NS_unrotated.AT2", {}, rb.Pulse("c1", 2.44, 1.80)),
    "Sylmar": ("SCS052.AT2", {"unit": "g", "dt": 0.005}, rb.Pulse("c2", 1.64, 2.30)),
    "Rinaldi": ("NGA_no_1063_RRS228.AT2", {}, rb.Pulse("one-sine", 6.87, 0.80)),
    "Pacoima Dam": ("PCD164.AT2", {}, rb.Pulse("c1", 4.11, 1.30)),
}


def tower(eta, absorbers=None):
    """The tower on supports of this stiffness ratio, or on the rigid base, with a pair of absorbers of given numbers."""
    foundation = {"foundation": "rigid"} if eta is None else {"eta": eta, "xi_v": 0.1}
    free = rb.Block(alpha=0.15, p=0.38, mass=MASS, **foundation)
    if absorbers is None:
        return free
    yield_force, elongation = absorbers
    law = {"yield_force": yield_force, "stiffness": yield_force / elongation, "hardening": HARDENING}
    ends = ({"block_x": x, "ground_x": x, "ground_z": -LENGTH} for x in (-free.width / 2, free.width / 2))
    return free.replace(dampers=[rb.Damper(**law, **end) for end in ends])


def motion(name, folder=None):
    """The arguments of `Block.run` for a motion, and whether it is a record."""
    file, options, pulse = MOTIONS[name]
    found = [path for path in folder.rglob(file)] if folder else []
    return ({"record": rb.read_record(found[0], **options)}, True) if found else ({"pulse": pulse}, False)


def runs(folder, absorbers, names=tuple(MOTIONS)):
    """For each motion and foundation the runs without and with absorbers."""
    found = {}
    for name in names:
        shaking, _ = motion(name, folder)
        for foundation, eta in FOUNDATIONS.items():
            pair = [tower(eta, numbers).run(**shaking, tolerance=1e-8) for numbers in (None, absorbers)]
            found[name, foundation] = pair
    return found


def run_rows(found):
    """The table of the runs: peaks of |θ|/α, greatest uplift and plastic elongation [mm] with absorbers, their energy over the input, |θ|/α at the end."""
    yield "| motion | foundation | without | with | change | uplift, mm | plastic, mm | absorbed | left |"
    yield "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    for (name, foundation), (free, absorbed) in found.items():
        before, after = (run.peak.theta / run.block.alpha for run in (free, absorbed))
        uplift = 1e3 * max(absorbed["uplift_L"].max(), absorbed["uplift_R"].max())
        plastic = 1e3 * max(absorbed.peak.plastic_elongations)
        energy = 100 * absorbed.energy.dampers[-1] / absorbed.energy.input.max()
        left = abs(absorbed.theta[-1]) / absorbed.block.alpha
        change = 100 * (after / before - 1)
        yield f"| {name} | {foundation} | {before:.3f} | {after:.3f} | {change:+.0f} % | {uplift:.0f} | {plastic:.0f} | {energy:.0f} % | {left:.3f} |"


def curve_rows(absorbers):
    """The table of slow rotations, with cycles of α/10."""
    yield "| foundation | L lifts at θ/α | yields at θ/α | F/(M g) at α/10 | ξ_eq | λ | residual θ/α |"
    yield "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"
    for foundation, eta in FOUNDATIONS.items():
        block = tower(eta, absorbers)
        curve = block.pushover(amplitude=0.1 * block.alpha)
        at = {landmark.name: landmark.theta / block.alpha for landmark in curve.landmarks}
        cycle = curve.cycle
        force, residual = cycle.table["force/weight"][-1], cycle.residual_theta / block.alpha
        yield (
            f"| {foundation} | {at['L lifts']:.4f} | {at['damper 1 yields']:.4f} | {force:.4f} | {cycle.equivalent_damping:.3f} |"
            f" {cycle.recentring_ratio:.2f} | {residual:.4f} |"
        )


def draw(found, absorbers):
    """Figure 14 without and with absorbers, the static curve, and the loops of the strongest motion."""
    figure, (bars, static, loops) = plt.subplots(1, 3, figsize=(15, 4.6), layout="constrained")
    names = list(dict.fromkeys(name for name, _ in found))
    greys = ("0.85", "0.65", "0.45")
    for place, foundation in enumerate(FOUNDATIONS):
        for group, name in enumerate(names):
            free, absorbed = (run.peak.theta / run.block.alpha for run in found[name, foundation])
            if foundation == "rigid base":
                for peak, style in ((free, "-."), (absorbed, ":")):
                    bars.plot([group - 0.45, group + 0.45], [peak, peak], style, color="black", lw=1)
                continue
            x = group + 0.28 * (place - 1)
            bars.bar(x, free, 0.25, color=greys[place], label=f"{foundation}, without" if group == 0 else None)
            bars.bar(x, absorbed, 0.13, color="#BB5566")
    bars.set(xticks=range(len(names)), xticklabels=names, ylabel="peak |θ|/α")
    bars.bar(0, 0, color="#BB5566", label="with absorbers")
    bars.plot([], [], "-.", color="black", lw=1, label="rigid base, without")
    bars.plot([], [], ":", color="black", lw=1, label="rigid base, with")
    bars.legend(frameon=False, fontsize=8)
    curve = tower(40.0, absorbers).pushover(amplitude=0.15 * 0.15, to=0.15 * 0.3)
    curve.plot(static)
    free = tower(40.0).pushover(to=0.15 * 0.3).table
    static.plot(free["theta"], free["force/weight"], "--", color="0.4", lw=1, label="without absorbers")
    static.set_title("η = 40")
    static.legend(frameon=False, fontsize=7)
    name = max(names, key=lambda name: found[name, "η = 40"][1].peak.theta)
    found[name, "η = 40"][1].plot_loops(loops)
    loops.set_title(f"{name}, η = 40")
    return figure


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=Path, help="folder with the records of Table I")
    parser.add_argument("--yield-force", type=float, default=YIELD_FORCE, help="of the absorbers of a leg [N]")
    parser.add_argument("--yield-elongation", type=float, default=YIELD_ELONGATION, help="at which they yield [m]")
    options = parser.parse_args(argv)
    absorbers = (options.yield_force, options.yield_elongation)
    for name in MOTIONS:
        print(f"{name}: {'record' if motion(name, options.records)[1] else 'pulse of Table I'}")
    found = runs(options.records, absorbers)
    print("", *run_rows(found), "", *curve_rows(absorbers), sep="\n")
    draw(found, absorbers).savefig(Path(__file__).with_suffix(".png"), dpi=100)


if __name__ == "__main__":
    main()
