"""Equal free-standing columns under a freely supported beam."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass

import numpy as np

from rocking_block import _engine
from rocking_block._block import Block
from rocking_block._pulse import Pulse
from rocking_block._record import Record
from rocking_block._run import Run
from rocking_block._words import Floats, number


@dataclass(frozen=True, eq=False, repr=False)
class FrameRun:
    """The history of a frame, in rows at evenly spaced times and at the end of the run; made by `Frame.run`.

    Arrays have the shape (n,). Forces are means over the columns: how the columns share them depends on the dimensions of the
    beam, which have no influence on the motion.
    """

    run: Run
    """The run of the equivalent block, whose rotation and ground motion are those of the frame."""
    beam_u: Floats
    """Horizontal displacement of the beam relative to the ground [m], positive to the right."""
    beam_v: Floats
    """Vertical displacement of the beam relative to the ground [m], positive up."""
    base_H: Floats
    """Mean horizontal force of the base on a column [N], positive to the right."""
    base_N: Floats
    """Mean vertical force of the base on a column [N]."""
    top_H: Floats
    """Mean horizontal force of a column on the beam [N], positive to the right."""
    top_N: Floats
    """Mean vertical force of a column on the beam [N]; below zero the beam would have to be held down."""

    @property
    def t(self) -> Floats:
        """Time [s]."""
        return self.run.t

    @property
    def theta(self) -> Floats:
        """Rotation of the columns [rad], positive to the right."""
        return self.run.theta

    @property
    def outcome(self) -> str:
        """How the run ended: "completed", "overturned", "separated" or "undecided"."""
        return self.run.outcome

    def __repr__(self) -> str:
        rotation = self.run.peak.theta / self.run.block.alpha
        beam = np.abs(self.beam_u).max()
        return f"<FrameRun {self.outcome} at {self.run.end_time:.4g} s, |θ|/α = {rotation:.4g}, beam {beam:.3g} m>"


@dataclass(frozen=True)
class Frame:
    """Equal free-standing columns under a freely supported rigid beam; made by `frame`."""

    columns: int
    """Number of columns."""
    column: Block
    """One of the columns."""
    beam_mass: float
    """Mass of the beam [kg]."""
    block: Block
    """The block on a rigid base with the frame's rotation, for any study of blocks."""

    @property
    def mass_ratio(self) -> float:
        """Mass of the beam over that of all columns [1]."""
        return self.beam_mass / (self.columns * self.column.mass)

    def run(
        self,
        record: Record | str | os.PathLike[str] | None = None,
        *,
        vertical: Record | str | os.PathLike[str] | None = None,
        scale: float = 1.0,
        pulse: Pulse | None = None,
        theta: float = 0.0,
        theta_dot: float = 0.0,
        tolerance: float = 1e-8,
        duration: float | None = None,
        step: float | None = None,
    ) -> FrameRun:
        """Simulates the frame under a record or a pulse, or in free motion.

        The arguments are those of `Block.run`. The run ends where the equivalent block leaves the ground, since a frame flies
        differently.

        Warns
        -----
        RuntimeWarning
            The beam would have to be held down: from there on it leaves the columns, and the motion is not that of the frame.
        """
        run = self.block.run(
            record,
            vertical=vertical,
            scale=scale,
            pulse=pulse,
            theta=theta,
            theta_dot=theta_dot,
            tolerance=tolerance,
            on_separation="terminate",
            duration=duration,
            step=step,
        )
        motion = [run.u, run.v, run.u_ddot, run.v_ddot, run.H, run.N_L + run.N_R, run.a_gx, run.a_gz]
        found = _engine.frame_response(self.columns, self.column, self.beam_mass, motion)
        response = {name: values for name, _, values in found}
        leaves = np.flatnonzero(response["top_N"] < 0)
        if self.beam_mass > 0 and leaves.size:
            message = f"the beam leaves the columns at t = {run.t[leaves[0]]:.4g} s; the motion after it is not that of the frame"
            warnings.warn(message, RuntimeWarning, stacklevel=2)
        return FrameRun(run, **response)

    def __repr__(self) -> str:
        column = f"{self.column.width:.3g} m × {self.column.height:.3g} m, {self.column.mass:g} kg"
        block = f"alpha={self.block.alpha:.6g}, p={self.block.p:.6g}, e={self.block.e:.4g}"
        return f"<Frame {self.columns} columns {column}, beam {self.beam_mass:g} kg: {block}>"


def frame(columns: int, column: Block, beam_mass: float) -> Frame:
    """Returns the frame of equal free-standing columns under a rigid beam that rests freely on them, on a rigid base.

    It rocks like a block of the same slenderness (Makris and Vassiliou 2013, doi:10.1002/eqe.2222); docs/studies/frames.md derives
    the block and the forces.

    Parameters
    ----------
    columns : int
        Number of columns, at least 2.
    column : Block
        One of the columns, on a rigid base. Its `restitution_factor` becomes that of the frame.
    beam_mass : float
        Mass of the beam [kg], ≥ 0.

    Raises
    ------
    ValueError
        A column on supports, tied, eccentric, with friction or with epsilon: no block moves like that frame.

    Examples
    --------
    >>> import rocking_block as rb
    >>> column = rb.Block(width=1.6, height=9.6, mass=3e4, foundation="rigid")
    >>> bridge = rb.frame(4, column, beam_mass=4.8e5)
    >>> bridge
    <Frame 4 columns 1.6 m × 9.6 m, 30000 kg, beam 480000 kg: alpha=0.165149, p=1.0231, e=0.947>
    >>> bridge.run(theta=0.1).outcome
    'completed'
    """
    mass = number("beam_mass", beam_mass)
    block = Block(**_engine.frame_block(columns, column, mass).parameters())
    return Frame(columns, column, mass, block)
