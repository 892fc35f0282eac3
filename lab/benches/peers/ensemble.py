"""Compares this project's program with other solvers on blocks of many sizes under a one-sine pulse, on the rigid base and on supports.

    lab/benches/peers/run --quick                         # builds Boost.odeint's program, installs heyoka
    .venv/bin/python lab/benches/peers/ensemble.py        # about four minutes; needs target/release/rocking

heyoka compiles a Taylor integrator of adaptive order for the equation of motion, for one block or for one block per lane of a vector.
Impacts are terminal events; a callback in Python changes the pivot, and ends the run of a block that comes to rest. diffrax takes all
blocks at once, in its compiled form. Both take part on the rigid base. Blocks that overturn go on turning there until the end, or
until their next impact or the end of the pulse, while the program and odeint.cpp end their runs. The program also
follows reactions, separation, works and peaks, and writes a table; its time is that of all blocks less that of a tenth of them, so that
its start does not count. The programs take turns, and the shortest CPU time counts. The error is the largest |Δθ|/α of 12 blocks at the
end, compared with heyoka at 1e-15.
"""

import csv
import io
import json
import math
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import cases
import diffrax_peer
import heyoka
import numpy as np

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = Path(os.environ.get("ROCKING_BLOCK_PROGRAM", ROOT / "target" / "release" / "rocking"))
ODEINT = ROOT / "target" / "peers" / "odeint"
ALPHA, PERIOD, END, GRAVITY = 0.2, 1.0472, 6.0, 9.81
ETA, XI_V = 40.0, 0.1
BLOCKS, ROUNDS = 4000, 5
# Blocks of a run of the program; on the rigid base the others would take as little time as its start varies by.
OF_THE_PROGRAM = {"rigid": 40_000, "supports": 4000}
# Amplitude (m/s2) and frequency parameters (rad/s): most overturn; all stay up.
ENSEMBLES = {"most overturn": (4.375, 1.0, 4.0), "all stay up": (4.375, 0.5, 1.2)}
TOLERANCES = [1e-6, 1e-9, 1e-12]
LANES = [1, 4, 8]
METHODS = ["dopri5", "fehlberg78"]


def options(amplitude, least, greatest, foundation):
    """Returns the options of `rocking` for an ensemble."""
    pulse = ["--pulse", "one-sine", "--amplitude", amplitude, "--period", PERIOD]
    sizes = ["--p-min", least, "--p-max", greatest]
    base = ["--foundation", "rigid"] if foundation == "rigid" else ["--foundation", f"{ETA},{XI_V},0"]
    return [str(x) for x in [*pulse, "--alpha", ALPHA, *base, "--duration", END, *sizes]]


def program_time(ensemble, foundation, blocks, tolerance, lanes):
    """Returns the CPU time (s) of the program, and the frequency parameters of its blocks."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "table.csv"
        command = [PROGRAM, "spectrum", *options(*ensemble, foundation), "--points", blocks, "--tolerance", tolerance]
        command += ["--threads", 1, "--lanes", lanes, "--csv", table]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([str(word) for word in command], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
    sizes = [float(row["p [rad/s]"]) for row in csv.DictReader(lines)]
    return after.ru_utime - before.ru_utime, sizes


def program_theta(ensemble, p, tolerance):
    """Returns the rotation (rad) of a block at the end by the program, or nothing if it has overturned."""
    amplitude, _, _ = ensemble
    command = [PROGRAM, "simulate", "--pulse", "one-sine", "--amplitude", amplitude, "--period", PERIOD, "--alpha", ALPHA]
    command += ["--foundation", "rigid", "--p", p, "--duration", END, "--tolerance", tolerance, "--step", END, "--csv", "-"]
    done = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True)
    rows = list(csv.DictReader(io.StringIO("".join(line for line in done.stdout.splitlines(True) if line[0] != "#"))))
    time_column, theta = (next(name for name in rows[0] if name.startswith(word)) for word in ("t", "theta"))
    return float(rows[-1][theta]) if float(rows[-1][time_column]) == END else None


def odeint_time(ensemble, foundation, folder, method, tolerance):
    """Returns the CPU time per block (s) by Boost.odeint."""
    amplitude, least, greatest = ensemble
    values = dict.fromkeys(cases.KEYS, 0.0) | {
        "alpha": ALPHA, "p": least, "eta": ETA, "xi_v": XI_V, "gamma": 3.0, "gravity": GRAVITY, "rigid": int(foundation == "rigid"),
        "shape": cases.SHAPES["sine"], "a_p": amplitude, "omega_p": 2.0 * math.pi / PERIOD, "t_end": END, "dt": END, "record_samples": 0,
    }
    path = Path(folder) / "ensemble.case"
    cases.write(path, values, [])
    command = [ODEINT, path, method, tolerance, "ensemble", least, greatest, BLOCKS]
    done = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)["cpu"]


class Peer:
    """Blocks by heyoka: y is the rotation away from the base, and `side` the side to which a block tilts."""

    def __init__(self, lanes, tolerance):
        y, v = heyoka.make_vars("y", "v")
        p2, side, amplitude = (heyoka.par[i] for i in range(3))
        ground = side * amplitude * heyoka.sin(2.0 * math.pi / PERIOD * heyoka.time) / GRAVITY
        equations = [(y, v), (v, -p2 * (heyoka.sin(ALPHA - y) + heyoka.cos(ALPHA - y) * ground))]
        restitution = 1.0 - 1.5 * math.sin(ALPHA) ** 2
        slowest = ALPHA * math.sqrt(2.0 * tolerance)
        self.lanes = lanes

        def impact_of_one(integrator, _):
            state, parameters = integrator.state, integrator.pars
            state[1] *= -restitution
            parameters[1] = -parameters[1]
            return state[1] > slowest * math.sqrt(parameters[0])

        def impact(integrator, _, lane):
            state, parameters = integrator.state, integrator.pars
            state[1, lane] *= -restitution
            parameters[1, lane] = -parameters[1, lane]
            # A block at rest stays there without weight.
            if state[1, lane] < slowest * math.sqrt(parameters[0, lane]):
                state[:, lane], parameters[0, lane] = 0.0, 0.0
            return True

        falling = heyoka.event_direction.negative
        if lanes == 1:
            events = [heyoka.t_event(y, callback=impact_of_one, direction=falling)]
            self.integrator = heyoka.taylor_adaptive(equations, [0.0] * 2, tol=tolerance, t_events=events, pars=[1.0] * 3)
        else:
            events = [heyoka.t_event_batch(y, callback=impact, direction=falling)]
            self.integrator = heyoka.taylor_adaptive_batch(
                equations, np.zeros((2, lanes)), tol=tolerance, t_events=events, pars=np.ones((3, lanes))
            )

    def run(self, amplitude, sizes):
        """Returns the rotations of blocks of these frequency parameters at the end; the number of blocks is one of full batches."""
        begin = math.asin(GRAVITY * math.tan(ALPHA) / amplitude) * PERIOD / (2.0 * math.pi)
        integrator, lanes, found = self.integrator, self.lanes, np.empty(len(sizes))
        for first in range(0, len(sizes), lanes):
            p = sizes[first : first + lanes]
            integrator.reset_cooldowns()
            integrator.state[:] = 0.0
            integrator.pars[0], integrator.pars[1], integrator.pars[2] = (p[0] ** 2 if lanes == 1 else p**2), -1.0, amplitude
            if lanes == 1:
                integrator.time = begin
                if integrator.propagate_until(PERIOD)[0] == heyoka.taylor_outcome.time_limit:
                    integrator.pars[2] = 0.0
                    integrator.propagate_until(END)
            else:
                integrator.set_time([begin] * lanes)
                integrator.propagate_until([PERIOD] * lanes)
                integrator.pars[2] = 0.0
                integrator.propagate_until([END] * lanes)
            found[first : first + lanes] = integrator.state[0] * integrator.pars[1]
        return found


def compare(name, ensemble):
    """Prints times and errors of all on an ensemble on the rigid base."""
    _, sizes = program_time(ensemble, "rigid", BLOCKS, TOLERANCES[0], 1)
    sizes = np.array(sizes)
    some = sizes[:: len(sizes) // 12][:12]
    exact = Peer(1, 1e-15).run(ensemble[0], some)
    # Beyond a quarter turn the program has ended the run.
    stays = np.abs(exact) < ALPHA
    print(f"\n{describe(name, ensemble)}, rigid base")
    for tolerance in TOLERANCES:
        peers = {lanes: Peer(lanes, tolerance) for lanes in LANES}
        peers["vmap"] = diffrax_peer.Peer(ALPHA, PERIOD, END, GRAVITY, tolerance)
        at_once = peers["vmap"].run(ensemble[0], sizes)
        theirs = dict.fromkeys(peers, math.inf)

        def their_turn(peers=peers, theirs=theirs):
            for name, peer in peers.items():
                before = time.process_time()
                peer.run(ensemble[0], sizes)
                theirs[name] = min(theirs[name], 1e6 * (time.process_time() - before) / BLOCKS)

        line = turns(ensemble, "rigid", tolerance, their_turn)
        errors = [peers[1].run(ensemble[0], some), at_once[:: len(sizes) // 12][:12]]
        errors = [np.abs(found - exact)[stays].max() / ALPHA for found in errors]
        own = [program_theta(ensemble, p, tolerance) for p in some[stays]]
        own = max(abs(theta - there) for theta, there in zip(own, exact[stays], strict=True) if theta is not None) / ALPHA
        columns = "  ".join(f"{lanes}: {theirs[lanes]:.1f}" for lanes in LANES)
        line += f"; heyoka in lanes {columns}; diffrax {theirs['vmap']:.1f}"
        print(f"  {tolerance:.0e}: {line}; errors {own:.1e}, {errors[0]:.1e}, {errors[1]:.1e} alpha", flush=True)


def describe(name, ensemble):
    """Returns the heading of an ensemble."""
    return f"{name}: amplitude {ensemble[0]} m/s2, p = {ensemble[1]} to {ensemble[2]} rad/s; us of CPU time per block"


def turns(ensemble, foundation, tolerance, another=lambda: None):
    """Returns a line with the least times of the program and of Boost.odeint, which take turns with another solver."""
    many, few = dict.fromkeys(LANES, math.inf), dict.fromkeys(LANES, math.inf)
    odeint, blocks = dict.fromkeys(METHODS, math.inf), OF_THE_PROGRAM[foundation]
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS):
            for lanes in LANES:
                many[lanes] = min(many[lanes], program_time(ensemble, foundation, blocks, tolerance, lanes)[0])
                few[lanes] = min(few[lanes], program_time(ensemble, foundation, blocks // 10, tolerance, lanes)[0])
            for method in METHODS:
                odeint[method] = min(odeint[method], 1e6 * odeint_time(ensemble, foundation, folder, method, tolerance))
            another()
    ours = {lanes: 1e6 * (many[lanes] - few[lanes]) / (blocks - blocks // 10) for lanes in LANES}
    line = "ours in lanes " + "  ".join(f"{lanes}: {ours[lanes]:.1f}" for lanes in LANES)
    return line + "; odeint " + "  ".join(f"{method}: {odeint[method]:.1f}" for method in METHODS)


if __name__ == "__main__":
    for name, ensemble in ENSEMBLES.items():
        compare(name, ensemble)
    # On supports, those of the other ensemble separate from them, which odeint.cpp does not follow.
    name, ensemble = list(ENSEMBLES.items())[-1]
    print(f"\n{describe(name, ensemble)}, supports")
    for tolerance in TOLERANCES:
        print(f"  {tolerance:.0e}: {turns(ensemble, 'supports', tolerance)}", flush=True)
